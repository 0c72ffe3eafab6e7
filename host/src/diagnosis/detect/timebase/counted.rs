//! The data rate as clocks counted it: is it the one that the record says?
//!
//! Clocks measure the rate itself, lines of a reference only how they stand against one another. So what was
//! counted comes first, and what lines say is heard where nothing was counted, or where that does not contradict
//! it: a machine that turned slower moves lines and no clock.

use crate::clocks::{Clocks, p_value};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Finding;
use crate::diagnosis::result::value::Value;
use crate::model::timebase::KIND;

/// Standard deviations by which two ratios that are one may differ: of 16 000 pairs that are, one lies
/// further off.
const SAME: f64 = 4.0;

/// The finding that the rate is not `nominal_hz`, at a family-wise `level`, for each of so many axes, which have
/// one clock; else what lines have said, but for what the clocks contradict.
pub fn counted(
    clocks: &Clocks,
    nominal_hz: f64,
    axes: usize,
    level: f64,
    by_lines: Vec<(usize, Finding)>,
) -> Vec<(usize, Finding)> {
    let (rate, good_to) = clocks.best();
    let p = p_value(&rate, nominal_hz, good_to);
    let (ratio, sd) = (rate.value / nominal_hz, rate.sd / nominal_hz);
    if p < level {
        let half = rate.half_95().unwrap_or(f64::INFINITY) / nominal_hz;
        let value = Value {
            value: ratio,
            lo: Some(ratio - half),
            hi: Some(ratio + half),
        };
        let finding = Finding::new(&Estimate::new(KIND, [value]), p);
        return (0..axes).map(|axis| (axis, finding.clone())).collect();
    }
    let agrees = |finding: &Finding| {
        finding.estimate.values[0].is_none_or(|lines| {
            let lines_sd = lines.sd();
            (lines.value - ratio).abs() < good_to + SAME * sd.hypot(lines_sd)
        })
    };
    by_lines
        .into_iter()
        .filter(|(_, finding)| agrees(finding))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clocks::{CRYSTALS, Measured};

    const NOMINAL_HZ: f64 = 2000.0;
    const LEVEL: f64 = 1e-3;

    /// Parts in a million by which the converters are fast, by a board's timer, and that timer by the host's clock.
    fn clocks(by_board_ppm: f64, board_ppm: f64, sd_ppm: f64) -> Clocks {
        let measured = |value: f64, sd: f64| Measured {
            value,
            sd,
            freedom: 10.0,
        };
        let rate = measured(NOMINAL_HZ * (1.0 + 1e-6 * by_board_ppm), 1e-6 * NOMINAL_HZ);
        let over_host = measured(1.0 + 1e-6 * board_ppm, 1e-6 * sd_ppm);
        Clocks::new(rate, CRYSTALS, Some(over_host), None)
    }

    fn by_lines(ratio: f64, sd: f64) -> Vec<(usize, Finding)> {
        let estimate = Estimate::new(KIND, [Value::normal(ratio, sd)]);
        vec![(1, Finding::new(&estimate, 1e-9))]
    }

    fn found(clocks: &Clocks, lines: Vec<(usize, Finding)>) -> Vec<(usize, f64)> {
        counted(clocks, NOMINAL_HZ, 3, LEVEL, lines)
            .into_iter()
            .map(|(axis, finding)| (axis, finding.estimate.values[0].expect("known").value))
            .collect()
    }

    #[test]
    fn the_host_tells_the_converters_clock_from_the_timer() {
        // A timer that is as far off as the converters hides it, and one that is off by itself feigns it.
        let hidden = found(&clocks(0.0, 700.0, 5.0), Vec::new());
        assert_eq!(hidden.len(), 3);
        assert!((hidden[0].1 - 1.0007).abs() < 1e-9, "{hidden:?}");
        assert!(found(&clocks(-700.0, 700.0, 5.0), Vec::new()).is_empty());
        // A host that knows too little leaves it to the timer.
        assert_eq!(found(&clocks(-700.0, 700.0, 300.0), Vec::new()).len(), 3);
    }

    /// By a pulse a second the host's clock is not asked, and one crystal is left.
    #[test]
    fn a_pulse_a_second_comes_before_the_host() {
        let measured = |value: f64, sd: f64| Measured {
            value,
            sd,
            freedom: 10.0,
        };
        let by_pps = |converters_ppm: f64, host_ppm: f64| {
            let rate = measured(NOMINAL_HZ, 1e-7 * NOMINAL_HZ);
            let over_host = measured(1.0 + 1e-6 * host_ppm, 1e-6);
            let over_pps = measured(1.0 + 1e-6 * converters_ppm, 1e-8);
            Clocks::new(rate, CRYSTALS, Some(over_host), Some(over_pps))
        };
        // A host that is off, which alone would be taken for the converters.
        assert!(found(&by_pps(10.0, 700.0), Vec::new()).is_empty());
        let off = found(&by_pps(80.0, 0.0), Vec::new());
        assert_eq!(off.len(), 3);
        assert!((off[0].1 - 1.000_08).abs() < 1e-9, "{off:?}");
    }

    #[test]
    fn crystals_are_as_good_as_they_are() {
        for ppm in [-90.0, 0.0, 90.0] {
            assert!(found(&clocks(ppm, 0.0, 1.0), Vec::new()).is_empty());
        }
        // Beyond it, and not by more than the uncertainty: 1e-3 of ten degrees of freedom is 4.6.
        assert!(found(&clocks(120.0, 0.0, 5.0), Vec::new()).is_empty());
        assert_eq!(found(&clocks(130.0, 0.0, 5.0), Vec::new()).len(), 3);
    }

    #[test]
    fn lines_are_heard_where_clocks_do_not_contradict_them() {
        let sound = clocks(0.0, 0.0, 5.0);
        // All lines of a machine that turned slower by 2 %.
        assert!(found(&sound, by_lines(1.02, 1e-4)).is_empty());
        let unsure = by_lines(1.0005, 2e-4);
        assert_eq!(found(&sound, unsure), [(1, 1.0005)]);
        // What was counted is surer than what lines say of the same.
        let off = clocks(0.0, 20_000.0, 5.0);
        assert!((found(&off, by_lines(1.0203, 1e-4))[0].1 - 1.02).abs() < 1e-9);
    }
}
