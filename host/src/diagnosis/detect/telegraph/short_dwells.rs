//! Whether large samples belong to a level that switches.
//!
//! A dwell of `d` samples that is too short to be resolved as two jumps leaves the sum `d h`, `h` being the
//! height. In noise that rises with the frequency, where single samples are seen best by what they
//! leave in the sum, that is what a sample of the size `d h` leaves.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::telegraph;
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::{Outlier, Wave};
use crate::diagnosis::statistic::p_value;
use crate::model::shock::Shock;

/// Share of a mean dwell up to which one counts as short: a choice. A fifth of all dwells are.
const SHORT: f64 = 0.25;

/// How much longer a dwell may be than its sum over the height: spread over many samples it looks
/// smaller than in one. Twice is a choice.
const SPREAD: f64 = 2.0;

/// Probability of as many short dwells from which all the large samples may be such: a choice.
const MAY_BE: f64 = 1e-3;

/// Whether an axis switches between two levels and so many dwells are so short.
pub fn is_of_switching(axis: &AxisState, found: &[Outlier]) -> bool {
    let sums = found.iter().map(|one| one.size / axis.rate_hz);
    may_be_of_switching(axis, sums)
}

/// The same of shocks that do not ring: behind a converter's filter a short dwell is as long as the filter.
pub fn are_of_switching(axis: &AxisState, found: &Candidate) -> bool {
    let (Change::Waves(waves) | Change::Happened { waves, .. }) = &found.change else {
        return false;
    };
    let shocks = waves.iter().flat_map(|wave| match wave {
        Wave::Shocks { shocks, .. } => shocks.as_slice(),
        _ => &[],
    });
    // No deflection of one sign sums up to more.
    let sum = |one: &Shock| (one.f_hz == 0.0).then_some(one.peak * one.duration_s);
    let sums: Option<Vec<f64>> = shocks.map(sum).collect();
    sums.is_some_and(|sums| !sums.is_empty() && may_be_of_switching(axis, sums.into_iter()))
}

/// Whether an axis switches between two levels and has so many dwells that leave these sums, in the unit of the record times
/// seconds.
fn may_be_of_switching(axis: &AxisState, sums: impl Iterator<Item = f64>) -> bool {
    let Some(levels) = telegraph::levels(axis) else {
        return false;
    };
    let dwells_s: Vec<f64> = sums.map(|sum| sum.abs() / levels.height).collect();
    let duration_s = axis.filled.len() as f64 / axis.rate_hz;
    may_be_short(&dwells_s, levels.dwell_s, duration_s)
}

/// Whether as many as `dwells_s`, by their sums, may be so short among all those of a record of
/// `duration_s`, of `mean_s` on average.
fn may_be_short(dwells_s: &[f64], mean_s: f64, duration_s: f64) -> bool {
    let longest_s = SPREAD * dwells_s.iter().copied().fold(0.0, f64::max);
    let short = duration_s / mean_s * -(-longest_s / mean_s).exp_m1();
    longest_s < SHORT * mean_s && p_value::poisson(dwells_s.len() as u64, short) > MAY_BE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{RATE_HZ, Trial, noise};
    use crate::diagnosis::result::estimate::Estimate;
    use crate::diagnosis::result::value::Value;
    use crate::model::{shock, telegraph};

    #[test]
    fn shocks_as_short_as_the_shortest_dwells_are_such() {
        let shocks = |peak: f64, duration_s: f64, f_hz: f64| {
            let one = |time_s| Shock {
                time_s,
                peak,
                duration_s,
                f_hz,
                decay_s: 0.0,
            };
            let waves = vec![Wave::Shocks {
                shocks: vec![one(3.0), one(7.0)],
                rate_hz: RATE_HZ,
            }];
            let effect = Estimate::new(shock::KIND, [Value::exact(1.0); 5]);
            Candidate::new(effect, 1e-9, 1.0, Change::Waves(waves))
        };
        let mut trial = Trial::new(noise(1));
        assert!(!are_of_switching(&trial.axis, &shocks(2.0, 0.05, 0.0)));
        // Levels that lie 4 apart, a second each time.
        trial.know(telegraph::KIND, [4.0, 1.0], Change::Waves(Vec::new()));
        assert!(are_of_switching(&trial.axis, &shocks(2.0, 0.05, 0.0)));
        assert!(
            !are_of_switching(&trial.axis, &shocks(2.0, 0.05, 20.0)),
            "it rings"
        );
        assert!(
            !are_of_switching(&trial.axis, &shocks(40.0, 0.05, 0.0)),
            "too large"
        );
    }

    #[test]
    fn a_few_short_dwells_are_no_outliers() {
        // 100 dwells of 5 s; of these 2.0 are shorter than 2 * 0.05 s.
        assert!(may_be_short(&[0.03, 0.05, 0.04], 5.0, 500.0));
        // Ten of them have a probability of 5e-5.
        assert!(!may_be_short(&[0.05; 10], 5.0, 500.0));
        // One that would be a dwell like any other is found by its jumps.
        assert!(!may_be_short(&[1.0], 5.0, 500.0));
    }
}
