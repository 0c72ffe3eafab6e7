//! A small axis on which one detector is tried, for the tests of the rules by which effects that look
//! alike are told apart.

use std::sync::Arc;

use super::Detector;
use super::look::{Character, Context, Lesson, Look, Proposal};
use crate::diagnosis::axis::{AxisState, Excluded};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::{Jump, Outlier, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::values::ValueFindings;
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

/// An axis with what a search would know of it.
pub struct Trial {
    /// The axis.
    pub axis: AxisState,
    /// What was learnt of it.
    pub character: Character,
    /// What its values say.
    pub values: ValueFindings,
    /// A covariate.
    pub covariate: Option<Vec<f64>>,
    /// Kinds that are not proposed any more.
    pub refused: Vec<Kind>,
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
            covariate: None,
            refused: Vec::new(),
        }
    }

    /// Lets something look at the axis.
    pub fn look<T>(&self, at: impl FnOnce(&Look<'_>) -> T) -> T {
        let context = Context {
            level: LEVEL,
            covariate: self.covariate.as_deref(),
            values: &self.values,
            refused: &self.refused,
            found: &|_| {},
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

/// Adds the jumps to a record.
pub fn add_steps(values: &mut [f64], jumps: &[Jump]) {
    let back = jumps.iter().map(|one| Jump {
        height: -one.height,
        ..*one
    });
    Wave::Steps(back.collect()).take_out(values);
}
