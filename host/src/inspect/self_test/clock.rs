//! The board's clock against the host's: stamps of its health records, by when they arrived. Where the board has a pulse a
//! second, against that.

use std::time::Duration;

use inm_protocol::{Identity, ToHost};

use super::{Check, Verdict};
use crate::capture::ClockSource;
use crate::clocks::pulses::Pulses;
use crate::clocks::{FEWEST, Measured, Pair, ratio};
use crate::inspect::{Heard, Session};
use crate::link::LinkError;

/// Parts in a million by which the board's clock may differ from the host's. A third of what its internal
/// oscillator is good to (1 %), so that the fallback shows; and twice what the 16 ms that a USB adapter may
/// hold bytes back can feign over 10 s.
const CLOCK_LIMIT_PPM: f64 = 3000.0;

/// Upper end of the 99 % interval, as a probability of Student's distribution.
const UPPER_END: f64 = 0.995;

/// Listens for `watch`; the check, and the supply of the accelerometers in millivolts if it was told.
pub(super) fn clock(
    session: &mut Session,
    identity: &Identity,
    watch: Duration,
) -> Result<(Check, Option<u16>), LinkError> {
    // What was heard ahead of this waited for an answer to be read.
    while session.heard().is_some() {}
    let begun = session.now();
    let (mut ticks, mut pulses, mut supply_mv) = (Vec::new(), Pulses::default(), None);
    while session.now() < begun + watch {
        session.listen()?;
        while let Some(Heard { at, message }) = session.heard() {
            match message {
                ToHost::Health(health) => {
                    supply_mv = health.supply_mv.or(supply_mv);
                    ticks.push(Pair {
                        board_s: health.stamp as f64 / f64::from(identity.timer_hz.max(1)),
                        host_s: at.duration_since(begun).as_secs_f64(),
                    });
                }
                ToHost::Pulse(pulse) => pulses.push(&pulse, identity.timer_hz),
                _ => {}
            }
        }
    }
    let check = judged(&ticks, pulses.ratio());
    Ok(match ClockSource::of(identity).warning() {
        Some(warning) => {
            let failed = Check {
                verdict: Verdict::Failed,
                ..check
            };
            (failed.explained(warning), supply_mv)
        }
        None => (check, supply_mv),
    })
}

/// The rate of the board's clock by that of the host, or by the pulses of a second, and how well it is known.
fn judged(ticks: &[Pair], by_pulses: Option<Measured>) -> Check {
    let limits = [-CLOCK_LIMIT_PPM, CLOCK_LIMIT_PPM];
    let by_which = match by_pulses {
        Some(_) => ", by a pulse a second",
        None => "",
    };
    let found = by_pulses.or_else(|| ratio(ticks)).and_then(ppm);
    let Some((ppm, known_to_ppm)) = found else {
        let words = format!(
            "{} health records arrived, {FEWEST} are needed: watch it for longer (--watch)",
            ticks.len()
        );
        return Check::of("clock", None, 0.0, "ppm", limits).without(Verdict::Open, words);
    };
    let mut check = Check::of("clock", None, ppm, "ppm", limits);
    let digits = usize::from(known_to_ppm < 1.0) * 3;
    check.remark = format!("known to {known_to_ppm:.digits$} ppm (99 %){by_which}");
    if ppm.abs() + known_to_ppm > CLOCK_LIMIT_PPM && ppm.abs() - known_to_ppm <= CLOCK_LIMIT_PPM {
        check.verdict = Verdict::Open;
        check.remark += ": watch it for longer (--watch)";
    }
    check
}

/// How much faster a clock goes than another, parts in a million, and half its 99 % interval.
fn ppm(ratio: Measured) -> Option<(f64, f64)> {
    Some((1e6 * (ratio.value - 1.0), 1e6 * ratio.half(UPPER_END)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A record a second by a clock that is `ppm` fast, each held back by as much as `late_s` says.
    fn ticks(count: u32, ppm: f64, late_s: impl Fn(u32) -> f64) -> Vec<Pair> {
        let tick = |k: u32| Pair {
            board_s: 100.0 + f64::from(k),
            host_s: f64::from(k) / (1.0 + 1e-6 * ppm) + late_s(k),
        };
        (0..count).map(tick).collect()
    }

    #[test]
    fn an_even_clock_is_known_to_the_last_digit() {
        for ppm in [-400.0, 0.0, 50.0] {
            let check = judged(&ticks(10, ppm, |_| 0.02), None);
            assert_eq!(check.verdict, Verdict::Ok, "{check:?}");
            let value = check.value.expect("measured");
            assert!((value - ppm).abs() < 0.01, "{value}");
        }
        let fast = judged(&ticks(10, 9000.0, |_| 0.0), None);
        assert_eq!(fast.verdict, Verdict::Failed, "{fast:?}");
    }

    /// A host whose clock is far off is not asked then.
    #[test]
    fn a_pulse_a_second_comes_before_the_host() {
        let by_pulses = Measured {
            value: 1.0 + 3e-5,
            sd: 1e-8,
            freedom: 8.0,
        };
        let check = judged(&ticks(10, 9000.0, |_| 0.0), Some(by_pulses));
        assert_eq!(check.verdict, Verdict::Ok, "{check:?}");
        assert!(check.remark.contains("by a pulse a second"), "{check:?}");
        let value = check.value.expect("measured");
        assert!((value - 30.0).abs() < 1e-6, "{value}");
    }

    #[test]
    fn what_the_link_holds_back_leaves_the_answer_open_and_fails_nobody() {
        // A machine that stood still ahead of the last record.
        let check = judged(&ticks(5, 0.0, |k| if k == 4 { 0.3 } else { 0.0 }), None);
        assert_eq!(check.verdict, Verdict::Open, "{check:?}");
        assert!(check.remark.contains("--watch"), "{check:?}");
        let few = judged(&ticks(FEWEST as u32 - 1, 0.0, |_| 0.0), None);
        assert_eq!((few.verdict, few.value), (Verdict::Open, None));
    }

    /// Five records that alternate between 0 and 10 ms late, by hand.
    #[test]
    fn the_interval_is_that_of_a_slope() {
        let late = |k: u32| if k % 2 == 1 { 0.01 } else { 0.0 };
        let found = ratio(&ticks(5, 0.0, late)).expect("enough");
        let (ppm, half) = ppm(found).expect("an interval");
        // Symmetric delays do not tilt the line; their squares about their mean of 4 ms are 120 ms^2, the
        // sum of squares in time is 10 s^2 and 99 % of Student's law with 3 degrees lie within 5.841.
        let expected = 1e6 * 5.841 * (120e-6_f64 / 3.0 / 10.0).sqrt();
        assert!(ppm.abs() < 30.0, "{ppm}");
        assert!((half / expected - 1.0).abs() < 1e-2, "{half}, {expected}");
    }
}
