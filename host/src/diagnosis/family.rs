//! How the tests share the family's level.
//!
//! Every detector and every doubt says how many tests it makes. The level is shared evenly among all
//! of them (Bonferroni), so that whatever is added to one of the tables takes its share by itself.

use super::options::Options;
use super::{detect, doubt};

/// Level of one test: the family's, shared evenly by all tests.
pub fn level_of_one_test(options: &Options) -> f64 {
    options.family_level / f64::from(tests())
}

/// How many tests the tables of detectors and doubts make together.
fn tests() -> u32 {
    let detectors = detect::BEFORE_ROUNDS.iter().chain(detect::ROUND);
    let detectors: u32 = detectors.map(|one| one.tests).sum();
    let doubts: u32 = doubt::DOUBTS.iter().map(|one| one.tests).sum();
    detectors + doubts + detect::OF_THE_RECORD
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tests_together_have_the_family_level() {
        let options = Options {
            family_level: 0.005,
            covariate: None,
            suspects: Vec::new(),
            views: false,
        };
        let all = level_of_one_test(&options) * f64::from(tests());
        assert!((all / options.family_level - 1.0).abs() < 1e-12);
        // A table that is empty would give its share away.
        assert!(tests() > 20, "{} tests", tests());
    }
}
