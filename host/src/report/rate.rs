//! The data rate by the clocks that were there, in words.

use super::number::significant;
use crate::analyse::SourceSummary;
use crate::clocks::CRYSTALS;

/// The rate by the host's clock with its 95 % interval, where the record has one.
pub(super) fn by_host(source: &SourceSummary) -> Option<String> {
    let clocks = source.clocks?;
    let rate = clocks.rate_by_host_hz?;
    let half = rate.half_95()?;
    let ppm = 1e6 / source.rate_hz;
    Some(format!(
        "{}/s, {:+} ± {} ppm from nominal (95 %)",
        significant(rate.value, 8),
        // No minus sign on a zero.
        ((rate.value - source.rate_hz) * ppm * 10.0).round() / 10.0 + 0.0,
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
