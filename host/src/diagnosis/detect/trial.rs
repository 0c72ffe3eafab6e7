//! A small axis on which one detector is tried, for the tests of the rules by which effects that look
//! alike are told apart.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::Detector;
use super::look::{Character, Context, Lesson, Look, Proposal};
use crate::diagnosis::axis::{AxisState, Excluded};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::loser::Loser;
use crate::diagnosis::record::reading::Reading;
use crate::diagnosis::record::wave::{Jump, Outlier, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::values::ValueFindings;
use crate::model::averaging::Averaging;
use crate::model::effect::Distortion;
use crate::model::kind::Kind;
use crate::model::random::{Gaussian, Seed};

/// Samples a second of all records here.
pub const RATE_HZ: f64 = 100.0;

/// Level of one test, about that of a diagnosis: what is put into a record is far plainer, so that a
/// fixed seed decides nothing.
pub const LEVEL: f64 = 2e-4;

/// White noise of deviation 1 beside a walk and quantisation too weak to hide anything. Its length is drawn,
/// odd, of 20 000 to 40 000 samples.
pub fn noise(seed: u64) -> Vec<f64> {
    let drawn = Gaussian::new(Seed { seed, stream: 1 }, 1.0)
        .draw()
        .abs()
        .fract();
    let length = 2 * (10_000.0 * (1.0 + drawn)) as usize + 1;
    let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let (mut level, mut before) = (0.0, 0.0);
    let values = (0..length).map(|_| {
        level += 1e-3 * normal.draw();
        let rounding = 0.1 * normal.draw();
        let step = rounding - before;
        before = rounding;
        normal.draw() + level + step
    });
    values.collect()
}

/// The running means of some values over so many samples.
pub fn averaged(mut values: Vec<f64>, samples: f64) -> Vec<f64> {
    let law = Averaging::of(&[samples / RATE_HZ]);
    let seed = Seed { seed: 0, stream: 0 };
    law.distorter(RATE_HZ, seed).apply(&mut values);
    values
}

/// An axis with what a search would know of it.
pub struct Trial {
    /// The axis.
    pub axis: AxisState,
    /// What was learnt of it.
    pub character: Character,
    /// What its values say.
    pub values: ValueFindings,
    /// Level of one test.
    pub level: f64,
    /// A covariate.
    pub covariate: Option<Reading>,
    /// What is not proposed any more.
    pub refused: Vec<Loser>,
}

impl Trial {
    /// Of a record about which nothing is known.
    pub fn new(values: Vec<f64>) -> Self {
        let said = ValueFindings::new(None, LEVEL, &values, 0.0);
        Self {
            axis: AxisState::new(Arc::new(values), RATE_HZ, None)
                .expect("a record with a spectrum"),
            character: Character::default(),
            values: said,
            level: LEVEL,
            covariate: None,
            refused: Vec::new(),
        }
    }

    /// Lets a kind be refused.
    pub fn refuse(&mut self, kind: Kind) {
        self.refused.push(Loser::all(kind));
    }

    /// Lets something look at the axis.
    pub fn look<T>(&self, at: impl FnOnce(&Look<'_>) -> T) -> T {
        let context = Context {
            level: self.level,
            covariate: self.covariate.as_ref(),
            values: &self.values,
            refused: &self.refused,
            decided: &|_| {},
        };
        at(&Look {
            axis: &self.axis,
            context: &context,
            character: &self.character,
        })
    }

    /// What a detector proposes.
    pub fn ask(&self, detector: &Detector) -> Vec<Proposal> {
        self.look(detector.look)
            .expect("a record that can be fitted")
    }

    /// Takes a candidate in.
    pub fn accept(&mut self, candidate: Candidate) {
        self.axis
            .accept(candidate)
            .expect("what is left can be fitted");
    }

    /// Makes an effect known that was found before: its parameters, and what it does.
    pub fn know<const N: usize>(&mut self, kind: Kind, values: [f64; N], change: Change) {
        let effect = Estimate::new(kind, values.map(Value::exact));
        self.accept(Candidate::new(effect, 1e-9, 1.0, change));
    }

    /// Excludes a band, hertz.
    pub fn exclude(&mut self, from_hz: f64, to_hz: f64) {
        self.axis.exclude(Excluded {
            band_hz: from_hz..to_hz,
            remark: Remark {
                test: "steadiness".into(),
                place: Place::Line(from_hz),
                p_value: 1e-9,
                description: String::new(),
            },
        });
        self.axis.refresh().expect("what is left can be fitted");
    }
}

/// Adds noise of a deviation in a band of three hertz about 20 Hz, `envelope` times as strong at a sample.
pub fn add_band(values: &mut [f64], seed: u64, deviation: f64, envelope: impl Fn(usize) -> f64) {
    // First-order noise of a correlation time of 0.1 s on both phases of a tone.
    let keep = (-10.0 / RATE_HZ).exp();
    let mut normal = Gaussian::new(
        Seed { seed, stream: 2 },
        deviation * (1.0 - keep * keep).sqrt(),
    );
    let mut phasor = [0.0, 0.0];
    for (n, value) in values.iter_mut().enumerate() {
        phasor = phasor.map(|one| keep * one + normal.draw());
        let turn = TAU * 0.2 * n as f64;
        *value += envelope(n) * (phasor[0] * turn.cos() + phasor[1] * turn.sin());
    }
}

/// Noise on a level that switches by `height`, once in a quarter of a second on average, and where it does.
pub fn switching(seed: u64, height: f64) -> (Vec<f64>, Vec<usize>) {
    let mut values = noise(seed);
    let mut normal = Gaussian::new(Seed { seed, stream: 3 }, 1.0);
    let (mut level, mut moments) = (0.5 * height, Vec::new());
    for (n, value) in values.iter_mut().enumerate() {
        // A normal number is beyond 2.054 of its deviations once in 25 times.
        if normal.draw().abs() > 2.054 {
            level = -level;
            moments.push(n);
        }
        *value += level;
    }
    (values, moments)
}

/// The only candidate among some proposals.
pub fn candidate(proposals: Vec<Proposal>) -> Option<Candidate> {
    let mut candidates = proposals.into_iter().filter_map(|one| match one {
        Proposal::Explain(candidate) => Some(*candidate),
        _ => None,
    });
    let first = candidates.next()?;
    assert!(
        candidates.next().is_none(),
        "one candidate beside {first:?}"
    );
    Some(first)
}

/// Kinds that some proposals explain.
pub fn kinds(proposals: &[Proposal]) -> Vec<Kind> {
    let kinds = proposals.iter().filter_map(Proposal::explained);
    kinds.collect()
}

/// A line of a frequency and an amplitude.
pub fn line(f_hz: f64, amplitude: f64) -> Wave {
    Wave::Line {
        cycles: f_hz / RATE_HZ,
        cosine: amplitude,
        sine: 0.0,
        lost: None,
    }
}

/// Whether a lesson is among some proposals.
pub fn teaches(proposals: &[Proposal], lesson: &Lesson) -> bool {
    let is_it = |one: &Proposal| matches!(one, Proposal::Learn(other) if other == lesson);
    proposals.iter().any(is_it)
}

/// Whether some proposals take a kind back.
pub fn withdraws(proposals: &[Proposal], kind: Kind) -> bool {
    let is_it = |one: &Proposal| matches!(one, Proposal::Withdraw(kinds) if kinds.contains(&kind));
    proposals.iter().any(is_it)
}

/// A large sample as it is taken out of a record.
pub fn outlier(index: usize, size: f64) -> Outlier {
    Outlier {
        index,
        size,
        size_sd: 1.0,
    }
}

/// A jump as it is taken out of a record.
pub fn jump(index: usize, height: f64) -> Jump {
    Jump {
        index,
        height,
        height_sd: 0.1,
        index_sd: 1.0,
        z: 20.0 * height.signum(),
        p_value: 1e-30,
    }
}

/// Jumps that are taken out of a record.
pub fn steps(jumps: &[Jump]) -> Change {
    Change::Waves(vec![Wave::Steps(jumps.to_vec())])
}

/// A settling by `amplitude` within `time_s`.
pub fn settling(amplitude: f64, time_s: f64) -> Wave {
    Wave::WarmUp {
        amplitude,
        samples: time_s * RATE_HZ,
    }
}

/// Adds to a record what would be taken out of it.
pub fn add(values: &mut [f64], wave: &Wave) {
    values.iter_mut().for_each(|value| *value = -*value);
    wave.take_out(values);
    values.iter_mut().for_each(|value| *value = -*value);
}

/// A covariate that goes up and down three times within a record of `length` samples, by 1 either way.
pub fn covariate(length: usize) -> Vec<f64> {
    let turn = |n: usize| TAU * 3.0 * n as f64 / length as f64;
    (0..length).map(|n| turn(n).sin()).collect()
}
