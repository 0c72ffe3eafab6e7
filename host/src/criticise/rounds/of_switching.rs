//! Whether large samples belong to a level that switches.
//!
//! A dwell of `d` samples that is too short to be told as two jumps leaves the sum `d h`, `h` being the
//! height. In noise that rises with the frequency, where single samples are seen best by what they
//! leave in the sum, that is what a sample of the size `d h` leaves.

use super::super::impulses::Outlier;
use super::super::laws;
use super::super::tail;
use super::Rounds;

/// Share of a mean dwell up to which one counts as short.
const SHORT: f64 = 0.25;

/// How much longer a dwell may be than its sum over the height: spread over many samples it looks smaller
/// than in one.
const SPREAD: f64 = 2.0;

/// Probability of as many short dwells from which all the large samples may be such.
const MAY_BE: f64 = 1e-3;

impl Rounds<'_> {
    /// Whether there is a switching of which so many dwells are so short.
    pub(super) fn is_of_switching(&self, found: &[Outlier]) -> bool {
        let Some([height, dwell_s]) = self.height_and_dwell() else {
            return false;
        };
        let largest = found.iter().map(|one| one.size.abs()).fold(0.0, f64::max);
        let longest_s = SPREAD * largest / height / self.axis.rate_hz;
        let dwells = self.duration_s() / dwell_s;
        let short = dwells * -(-longest_s / dwell_s).exp_m1();
        longest_s < SHORT * dwell_s && tail::poisson(found.len() as u64, short) > MAY_BE
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
