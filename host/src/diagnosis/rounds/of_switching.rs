//! Whether large samples belong to a level that switches.
//!
//! A dwell of `d` samples that is too short to be told as two jumps leaves the sum `d h`, `h` being the
//! height. In noise that rises with the frequency, where single samples are seen best by what they
//! leave in the sum, that is what a sample of the size `d h` leaves.

use crate::diagnosis::detect::outliers::Outlier;
use crate::diagnosis::laws;
use crate::diagnosis::rounds::Rounds;
use crate::diagnosis::statistic::p_value;

/// Share of a mean dwell up to which one counts as short.
const SHORT: f64 = 0.25;

/// How much longer a dwell may be than its sum over the height: spread over many samples it looks smaller
/// than in one.
const SPREAD: f64 = 2.0;

/// Probability of as many short dwells from which all the large samples may be such.
const MAY_BE: f64 = 1e-3;

impl Rounds<'_> {
    /// Whether there is a switching of which so many dwells are so short.
    pub(crate) fn is_of_switching(&self, found: &[Outlier]) -> bool {
        let Some([height, dwell_s]) = self.height_and_dwell() else {
            return false;
        };
        let seconds = |size: f64| size.abs() / (height * self.axis.rate_hz);
        let dwells_s: Vec<f64> = found.iter().map(|one| seconds(one.size)).collect();
        may_be_short(&dwells_s, dwell_s, self.duration_s())
    }

    /// Distance of two levels and their mean dwell, seconds.
    fn height_and_dwell(&self) -> Option<[f64; 2]> {
        let telegraph = self.accepted.iter().find(|one| one.effect == "telegraph")?;
        match telegraph.law {
            // Its deviation is half the height, its correlation time half a dwell.
            Some(law) => {
                let axis = &*self.axis;
                let values = laws::sized(&axis.frame, &axis.laws, law, &axis.fit);
                Some([2.0 * values[0], 2.0 * values[1]])
            }
            None => {
                let value = |name| Some(telegraph.parameters.get(name)?.value);
                Some([value("height")?, value("dwell_s")?])
            }
        }
    }
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

    #[test]
    fn a_few_short_dwells_are_no_outliers() {
        // 100 dwells of 5 s; of these 2.0 are shorter than 2 * 0.05 s.
        assert!(may_be_short(&[0.03, 0.05, 0.04], 5.0, 500.0));
        // Ten of them have a probability of 5e-5.
        assert!(!may_be_short(&[0.05; 10], 5.0, 500.0));
        // One that would be a dwell like any other is told by its jumps.
        assert!(!may_be_short(&[1.0], 5.0, 500.0));
    }
}
