//! A settling far above all noise, read off the beginning of a record before anything else.
//!
//! A level that falls by a hundred deviations within a second looks like a shock at the first sample, raises the noise that is
//! fitted beside it, and hides in that. So it is asked for first, and is one only if next to nothing of what it takes out
//! is left: no ringing, no jump and no course follows an exponential to a few hundredths of its energy.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::profile::Noise;
use crate::diagnosis::detect::Detector;
use crate::diagnosis::detect::look::Look;
use crate::diagnosis::detect::slow_change::SlowChange;
use crate::diagnosis::record::wave::Wave;

/// Time constants that the level is followed for: less than a hundredth of the settling is left then.
const FOLLOWED: f64 = 5.0;

/// Means a time constant that the level is compared in: as many show its bend, and noise that single samples have is small in
/// them.
const MEANS: f64 = 16.0;

/// Share of its energy that a settling may leave: a choice, a fifth of its size. A second time constant leaves some percent.
const LEFT: f64 = 0.04;

/// Looks for a settling that leaves nothing. Its test is that of the level.
pub static DETECTOR: Detector = Detector {
    tests: 0,
    look: |look| Ok(plain(look).into_iter().collect()),
};

fn plain(look: &Look<'_>) -> Option<super::Proposal> {
    let change = super::find(look, Noise::Fitted)?;
    let is_plain = left_of(look.axis, &change)? < LEFT;
    is_plain.then(|| super::proposal(look, change))?
}

/// Share of the energy of a settling that is left about it once it is taken out, until it has settled; `None` where the
/// record ends before, or too soon behind for its level.
fn left_of(axis: &AxisState, change: &SlowChange) -> Option<f64> {
    let Wave::WarmUp { amplitude, samples } = change.wave else {
        return None;
    };
    let block = (samples / MEANS).max(1.0) as usize;
    let until = (FOLLOWED * samples) as usize;
    let values = axis.residual.values();
    // Where it has settled is known from a time constant on.
    let end = (2 * until).min(values.len());
    if end < until + samples as usize {
        return None;
    }
    let mean = |from: usize, to: usize, settling: f64| {
        let good = (from..to).filter(|&n| values[n].is_finite());
        let without = |n: usize| values[n] - settling * (-(n as f64) / samples).exp();
        let (sum, count) = good.fold((0.0, 0.0), |(sum, count), n| {
            (sum + without(n), count + 1.0)
        });
        (count > 0.0).then(|| sum / count)
    };
    let settled = mean(until, end, 0.0)?;
    let energy = |settling: f64| -> f64 {
        let blocks = (0..until / block).map(|number| number * block);
        let means = blocks.filter_map(|from| mean(from, from + block, settling));
        means.map(|mean| (mean - settled).powi(2)).sum()
    };
    Some(energy(amplitude) / energy(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, RATE_HZ, Trial, noise};
    use crate::model::warmup::KIND;

    /// Whether a course is a plain settling, of seconds from the start.
    fn is_plain(seed: u64, course: impl Fn(f64) -> f64) -> bool {
        let mut values = noise(seed);
        for (n, value) in values.iter_mut().enumerate() {
            *value += course(n as f64 / RATE_HZ);
        }
        trial::kinds(&Trial::new(values).ask(&DETECTOR)) == [KIND]
    }

    #[test]
    fn a_settling_far_above_the_noise_is_read_off_the_beginning() {
        for (seed, time_s) in (1..).zip([1.3, 5.0, 20.0, 33.0]) {
            let settling = |size: f64| move |at_s: f64| size * (-at_s / time_s).exp();
            assert!(is_plain(seed, settling(300.0)), "seed {seed}, {time_s} s");
            assert!(is_plain(seed, settling(-300.0)), "seed {seed}, {time_s} s");
            // A few deviations leave too much to say so.
            assert!(!is_plain(seed, settling(0.3)), "seed {seed}, {time_s} s");
        }
    }

    #[test]
    fn what_rings_jumps_or_goes_on_is_none() {
        for seed in 11..14 {
            let rings = |at_s: f64| 300.0 * (-at_s / 5.0).exp() * (2.0 * at_s).cos();
            assert!(!is_plain(seed, rings), "seed {seed}: rings");
            let jumps = |at_s: f64| if at_s < 8.0 { 300.0 } else { 0.0 };
            assert!(!is_plain(seed, jumps), "seed {seed}: jumps");
            let half_sine = |at_s: f64| 300.0 * (at_s / 4.0).sin() * f64::from(at_s < 12.56);
            assert!(!is_plain(seed, half_sine), "seed {seed}: a half-sine");
            // Longer than the record lets it settle.
            let goes_on = |at_s: f64| 300.0 * (-at_s / 100.0).exp();
            assert!(!is_plain(seed, goes_on), "seed {seed}: goes on");
        }
    }
}
