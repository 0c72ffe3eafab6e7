//! Where the bins of a spectrum depart from what a model expects of them.

use crate::diagnosis::statistic::p_value;
use crate::fit::likelihood::Data;

/// Where and how far the bins depart from what is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Lower end of the band, hertz.
    pub from_hz: f64,
    /// Upper end of it, hertz.
    pub to_hz: f64,
    /// Measured over expected power in it.
    pub ratio: f64,
    /// Probability of as large a departure in any band.
    pub p_value: f64,
}

/// The band in which the bins depart most from `expected`, over all bands of 1, 2, 4 ... bins.
pub fn departure(data: &Data, expected: &[f64]) -> Option<Departure> {
    let bins = data.len();
    let mut best: Option<Departure> = None;
    let mut trials = 0.0;
    let mut width = 1;
    while width <= bins {
        for start in (0..=bins - width).step_by((width / 2).max(1)) {
            trials += 1.0;
            let band = start..start + width;
            let freedom: f64 = data.dof[band.clone()].iter().sum();
            let ratio = band
                .clone()
                .map(|b| data.dof[b] * data.psd[b] / expected[b])
                .sum::<f64>()
                / freedom;
            let p = p_value::mean_square(ratio, freedom);
            if best.is_none_or(|best| p < best.p_value) {
                best = Some(Departure {
                    from_hz: data.f_hz[band.start],
                    to_hz: data.f_hz[band.end - 1],
                    ratio,
                    p_value: p,
                });
            }
        }
        width *= 2;
    }
    best.map(|best| Departure {
        p_value: p_value::searched(best.p_value, trials),
        ..best
    })
}
