//! The data rate by the clocks that were there, in words.

use crate::analyse::SourceSummary;
use crate::clocks::{CRYSTALS, Measured};
use crate::numeric::written::significant;

/// The rate by each clock beside the board with its 95 % interval, where the record has one: by which, and what.
pub(super) fn by_clocks(source: &SourceSummary) -> Vec<(&'static str, String)> {
    let Some(clocks) = source.clocks else {
        return Vec::new();
    };
    let mut by_pps = known(source, clocks.rate_by_pps_hz);
    let by_host = known(source, clocks.rate_by_host_hz);
    if let (Some(words), Some(_)) = (&mut by_pps, &by_host) {
        *words += "; it counts before the host's clock";
    }
    let all = [("a pulse a second", by_pps), ("the host's clock", by_host)];
    let named = |(name, words): (_, Option<String>)| Some((name, words?));
    all.into_iter().filter_map(named).collect()
}

/// A rate and its 95 % interval in words.
fn known(source: &SourceSummary, rate: Option<Measured>) -> Option<String> {
    let rate = rate?;
    let half = rate.half_95()?;
    let ppm = 1e6 / source.rate_hz;
    // As many digits as are known, and no more than a crystal keeps for a minute.
    let (digits, steps) = match half * ppm < 0.05 {
        true => (10, 1000.0),
        false => (8, 10.0),
    };
    Some(format!(
        "{}/s, {:+} ± {} ppm from nominal (95 %)",
        significant(rate.value, digits),
        // No minus sign on a zero.
        ((rate.value - source.rate_hz) * ppm * steps).round() / steps + 0.0,
        significant(half * ppm, 2),
    ))
}

/// That the stamps contradict the rate, if they do.
pub(super) fn contradicted(source: &SourceSummary) -> Option<String> {
    let measured_hz = source.measured_rate_hz?;
    let off = measured_hz / source.rate_hz - 1.0;
    (off.abs() > CRYSTALS).then(|| {
        format!(
            "By the board's stamps the converters made {}/s, {:+.0} ppm from the rate: one of the two \
             clocks is off.",
            significant(measured_hz, 7),
            off * 1e6
        )
    })
}
