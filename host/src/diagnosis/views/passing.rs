//! What passes in a record and has no law: stretches that are louder, and those in which something moves the sensor.

use std::f64::consts::PI;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::result::finding::Finding;
use crate::model::Term;
use crate::model::burst::{self, Burst};
use crate::model::effect::Part;
use crate::model::kernel::{self, Kernel};
use crate::model::marks::Mark;

/// All of it.
pub(crate) struct Passing {
    bursts: Vec<Louder>,
    terms: Vec<Box<dyn Term>>,
    samples: u64,
    rate_hz: f64,
    /// Part of the record in which it is.
    part: f64,
}

/// A stretch of another variance.
struct Louder {
    burst: Burst,
    /// What it adds to the power of faster noise in the mean over the record, as a share.
    share: f64,
    /// What it adds to the density below one over its length, for what is faster than it lasts does not end there.
    slow: f64,
}

impl Louder {
    /// Of a stretch in noise of this two-sided density.
    fn new(burst: Burst, record_s: f64, rate_hz: f64, density: impl Fn(f64) -> f64) -> Self {
        let share = burst.adds(record_s);
        let passes = |f_hz: f64| burst.passes(f_hz) * density(f_hz);
        Self {
            burst,
            share,
            slow: share * sum_of_stretch(burst.to_s - burst.from_s, rate_hz, passes),
        }
    }

    /// What it adds to a density that is `density` elsewhere, as a mean over the record.
    fn adds(&self, f_hz: f64, density: f64) -> f64 {
        if f_hz * (self.burst.to_s - self.burst.from_s) < 1.0 {
            return self.slow;
        }
        self.share * self.burst.passes(f_hz) * density
    }
}

/// Density at frequency zero of a stretch cut out of noise whose density is `S(f)` above one over its length `D` and
/// the same from there down: its sum has the power
///
/// ```text
/// int S(f) sin^2(pi f D) / sin^2(pi f / rate) df
/// ```
///
/// over all frequencies, with the mean of the oscillating square above one over its length. In white noise that is the
/// density itself; of noise that rises with the frequency most is what the ends of the stretch cut off.
fn sum_of_stretch(duration_s: f64, rate_hz: f64, density: impl Fn(f64) -> f64) -> f64 {
    /// Steps over the band, logarithmic: where the density is a power of the frequency, 20 octaves are integrated to
    /// a thousandth.
    const STEPS: u32 = 1024;
    /// Twice the integral of the squared sinc from 0 to 1.
    const MAIN_LOBE: f64 = 0.902_823;
    let lowest = 1.0 / duration_s;
    if 2.0 * lowest >= rate_hz {
        return density(0.5 * rate_hz);
    }
    let step = (0.5 * rate_hz / lowest).ln() / f64::from(STEPS);
    let above: f64 = (0..STEPS)
        .map(|n| {
            let f_hz = lowest * ((f64::from(n) + 0.5) * step).exp();
            let sine = (PI * f_hz / rate_hz).sin();
            density(f_hz) * f_hz * step / (sine * sine)
        })
        .sum();
    MAIN_LOBE * density(lowest) + above / (duration_s * rate_hz * rate_hz)
}

impl Passing {
    /// Of what was found in an axis.
    pub fn new(axis: &AxisState, findings: &[Finding]) -> Self {
        let samples = axis.residual.len();
        let record_s = samples as f64 / axis.rate_hz;
        let is_burst = |one: &&Finding| one.effect == burst::KIND;
        let burst = |finding: &Finding| {
            let burst = Burst::of(&finding.estimate.plain());
            Louder::new(burst, record_s, axis.rate_hz, |f_hz| axis.density(f_hz))
        };
        let lasts_s = |finding: &Finding| -> f64 {
            let marks = finding.effect.marks(&finding.estimate.plain());
            let lengths = marks.into_iter().map(|mark| match mark {
                Mark::Stretch(from_s, to_s) => to_s - from_s,
                _ => 0.0,
            });
            lengths.sum()
        };
        let passes = |one: &&Finding| {
            let part = one.effect.part(&one.estimate.plain());
            is_burst(one) || matches!(part, Part::Term(term) if term.is_drift())
        };
        let term = |finding: &Finding| match finding.effect.part(&finding.estimate.plain()) {
            Part::Term(term) => Some(term),
            Part::Distortion(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => None,
        };
        Self {
            bursts: findings.iter().filter(is_burst).map(burst).collect(),
            terms: findings.iter().filter_map(term).collect(),
            samples: samples as u64,
            rate_hz: axis.rate_hz,
            part: findings.iter().filter(passes).map(lasts_s).sum::<f64>() / record_s,
        }
    }

    /// Degrees of freedom of what it adds to an Allan variance that has `edf` of them all over the record: a stretch is a
    /// part of it, and happens once.
    pub fn freedom(&self, edf: f64) -> f64 {
        (self.part * edf).max(1.0)
    }

    /// What it adds to a density at `f_hz` that is `density` without it.
    pub fn adds(&self, f_hz: f64, density: f64) -> f64 {
        let record_s = self.samples as f64 / self.rate_hz;
        let bursts = self.bursts.iter().map(|one| one.adds(f_hz, density));
        let terms = self.terms.iter();
        let terms = terms.map(|one| one.passing_density(f_hz, record_s, self.rate_hz));
        bursts.sum::<f64>() + terms.sum::<f64>()
    }

    /// What it adds to the Allan variance over `m` samples of noise of this `density`.
    pub fn allan_variance(&self, m: u64, density: impl Fn(f64) -> f64) -> f64 {
        let louder = |f_hz: f64| -> f64 {
            let density = density(f_hz);
            self.bursts.iter().map(|one| one.adds(f_hz, density)).sum()
        };
        let bursts = if self.bursts.is_empty() {
            0.0
        } else {
            kernel::variance(Kernel::Allan, m, self.rate_hz, louder)
        };
        let terms = self.terms.iter();
        bursts
            + terms
                .map(|one| one.passing(m, self.samples, self.rate_hz))
                .sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_of_white_noise_is_white_and_one_of_rounding_is_its_ends() {
        const RATE_HZ: f64 = 100.0;
        for samples in [64.0, 1000.0, 20_001.0] {
            let duration_s = samples / RATE_HZ;
            let white = sum_of_stretch(duration_s, RATE_HZ, |_| 3.0);
            // The mean of the oscillating square stands for it from its first oscillation on: 1 %.
            assert!((white / 3.0 - 1.0).abs() < 0.01, "{samples}: {white}");
            // Increments of numbers of deviation 1 sum up to the last less the first: a variance of 2.
            let density = |f_hz: f64| (2.0 * (PI * f_hz / RATE_HZ).sin()).powi(2) / RATE_HZ;
            let ends = sum_of_stretch(duration_s, RATE_HZ, density);
            let expected = 2.0 / (samples * RATE_HZ);
            let off = ends / expected - 1.0;
            // Below one over its length, the main lobe, there is a part of two over its samples more.
            assert!(
                off.abs() < 0.02 + 20.0 / samples,
                "{samples}: {ends} of {expected}"
            );
        }
    }
}
