//! Axes for tests: a drawn record with something in it, and explanations that nobody found.
//!
//! The noise is white with deviation 1, a walk of [`WALK`] a sample and quantisation noise of
//! [`STEP`], so that three of the five terms are there. Lengths are odd and drawn with the seed.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use rand_distr::{Distribution, Uniform};

use crate::diagnosis::axis::{AxisState, Excluded};
use crate::diagnosis::doubt::{Doubt, Heard, Hearing};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::laws::Law;
use crate::diagnosis::loser::Loser;
use crate::diagnosis::record::wave::{Jump, Outlier, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::value::Value;
use crate::model::kind::Kind;
use crate::model::random::{Gaussian, Seed, random};

/// Samples a second.
pub const RATE_HZ: f64 = 1000.0;

/// Level of one test: one in ten thousand records says what is not there.
pub const LEVEL: f64 = 1e-4;

/// Deviation of a step of the walk: it is as strong as the white noise at a third of a hertz.
const WALK: f64 = 2e-3;

/// Deviation of the quantisation noise: a third of a step of one.
const STEP: f64 = 0.3;

/// Seeded normal numbers of deviation 1; streams below 8 are those of [`axis`].
pub fn numbers(seed: u64, stream: u64) -> Gaussian {
    Gaussian::new(Seed { seed, stream }, 1.0)
}

/// An odd number of samples from 2^14 to 2^15.
pub fn short(seed: u64) -> usize {
    drawn(seed, 1 << 14)
}

/// An odd number of samples from 2^15 to 2^16.
pub fn long(seed: u64) -> usize {
    drawn(seed, 1 << 15)
}

fn drawn(seed: u64, least: usize) -> usize {
    let between = Uniform::new(least / 2, least).expect("a range");
    2 * between.sample(&mut random(Seed { seed, stream: 7 })) + 1
}

/// An axis of `len` samples that `make` makes of a sample's number and the noise there.
pub fn axis(seed: u64, len: usize, mut make: impl FnMut(usize, f64) -> f64) -> AxisState {
    let [mut white, mut walk, mut rounding] = [0, 1, 2].map(|stream| numbers(seed, stream));
    let (mut level, mut last) = (0.0, rounding.draw());
    let values = (0..len).map(|n| {
        level += WALK * walk.draw();
        let next = rounding.draw();
        let step = STEP * (next - last);
        last = next;
        make(n, white.draw() + level + step)
    });
    let axis = AxisState::new(Arc::new(values.collect()), RATE_HZ, None);
    axis.unwrap_or_else(|| panic!("seed {seed}: no fit to {len} samples"))
}

/// Markov noise of deviation 1.
pub fn markov(seed: u64, samples: f64) -> impl FnMut() -> f64 {
    let mut drive = numbers(seed, 8);
    let keep = f64::exp(-1.0 / samples);
    let mut level = drive.draw();
    move || {
        level = keep * level + (1.0 - keep * keep).sqrt() * drive.draw();
        level
    }
}

/// Noise of deviation 1 that rings at `f_hz`, `width_hz` wide at half of its power.
pub fn ringing(seed: u64, f_hz: f64, width_hz: f64) -> impl FnMut() -> f64 {
    let mut drive = numbers(seed, 9 + f_hz as u64);
    let (keep, turn) = (
        f64::exp(-PI * width_hz / RATE_HZ),
        (TAU * f_hz / RATE_HZ).cos(),
    );
    let (first, second) = (2.0 * keep * turn, keep * keep);
    // Variance of the second-order autoregression.
    let sum = 1.0 + second;
    let variance = sum / ((1.0 - second) * (sum * sum - first * first));
    let mut last = [0.0; 2];
    move || {
        let next = first * last[0] - second * last[1] + drive.draw() / variance.sqrt();
        last = [next, last[0]];
        next
    }
}

/// One that swings about 1 by the share `swing`, `cycles` times in `len` samples.
pub fn swinging(swing: f64, cycles: f64, len: usize) -> impl Fn(usize) -> f64 {
    move |n| 1.0 + swing * (TAU * cycles * n as f64 / len as f64).cos()
}

/// A line of `amplitude`, taken out of a record that holds `amplitude cos(2 pi f t)`.
pub fn line(f_hz: f64, amplitude: f64) -> Wave {
    Wave::Line {
        cycles: f_hz / RATE_HZ,
        cosine: amplitude,
        sine: 0.0,
        lost: None,
    }
}

/// A jump at a moment that is known.
pub fn jump(index: usize, height: f64) -> Wave {
    Wave::Steps(vec![Jump {
        index,
        height,
        height_sd: 0.01,
        index_sd: 0.0,
        z: 100.0,
        p_value: 0.0,
    }])
}

/// A single sample that does not belong.
pub fn spike(index: usize, size: f64) -> Wave {
    Wave::Outliers(Arc::new(vec![Outlier {
        index,
        size,
        size_sd: 1.0,
    }]))
}

impl From<Wave> for Change {
    fn from(wave: Wave) -> Self {
        Self::Waves(vec![wave])
    }
}

/// A statement about values, which changes nothing.
pub const NOTHING: Change = Change::Grid { decides: false };

/// A law, its size 1.
pub fn law(effect: Kind, values: &[f64]) -> Change {
    Change::Law(Law {
        effect,
        values: values.to_vec(),
    })
}

/// An explanation that nobody found.
pub fn made_up(kind: Kind, change: Change) -> Candidate {
    let effect = match change {
        Change::Law(_) => Estimate::of_law(kind),
        _ => Estimate::new(kind, [Value::exact(1.0); 2]),
    };
    Candidate::new(effect, 1e-9, 1.0, change)
}

/// Takes an explanation in that nobody found.
pub fn take_in(axis: &mut AxisState, kind: Kind, change: Change) {
    axis.accept(made_up(kind, change)).expect("a fit with it");
}

/// A band that is excluded, for no reason.
pub fn excluded(from_hz: f64, to_hz: f64) -> Excluded {
    Excluded {
        band_hz: from_hz..to_hz,
        remark: remark(from_hz, to_hz),
    }
}

/// Something that was said of a band.
pub fn remark(from_hz: f64, to_hz: f64) -> Remark {
    Remark {
        test: "trial".into(),
        place: (from_hz..to_hz).into(),
        p_value: 1e-9,
        description: "made up".into(),
    }
}

/// What a doubt says of an axis.
pub fn heard(doubt: &Doubt, axis: &mut AxisState, strength_moves: bool) -> Vec<Remark> {
    after(doubt, axis, strength_moves).remarks
}

/// The first course that a doubt takes back, if it takes any.
pub fn no_course(doubt: &Doubt, axis: &mut AxisState) -> Option<Loser> {
    after(doubt, axis, false).no_course
}

fn after(doubt: &Doubt, axis: &mut AxisState, strength_moves: bool) -> Heard {
    let mut hearing = Hearing {
        axis,
        level: LEVEL,
        strength_moves,
        large_samples_in_groups: false,
        remarks: Vec::new(),
        no_course: None,
    };
    (doubt.hear)(&mut hearing).expect("a fit of what is left");
    hearing.into()
}
