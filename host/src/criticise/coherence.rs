//! What axes have in common.

use super::tail;
use crate::spectrum::CrossCascade;

/// Bands an octave.
const PER_OCTAVE: f64 = 2.0;

/// What two axes have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Common {
    /// Axes.
    pub pair: (usize, usize),
    /// Lower end of the band in which it shows most, hertz.
    pub from_hz: f64,
    /// Upper end, hertz.
    pub to_hz: f64,
    /// Squared coherence there.
    pub coherence: f64,
    /// Real part of the cross-spectrum summed over where it shows, and the first axis' own.
    pub cross: f64,
    /// Probability of as much between independent axes.
    pub p_value: f64,
}

/// The pairs of axes that have something in common at a family-wise `level`.
pub fn common(axes: &[&[f64]], rate_hz: f64, level: f64) -> Vec<Common> {
    let mut cascade = CrossCascade::new(axes.len());
    if cascade.push(0, axes).is_err() {
        return Vec::new();
    }
    let mut all = Vec::new();
    for first in 0..axes.len() {
        for second in first + 1..axes.len() {
            let bins = cascade.cross(first, second, rate_hz, PER_OCTAVE);
            let trials = (bins.len() * axes.len() * (axes.len() - 1) / 2) as f64;
            let best = bins.iter().filter(|bin| bin.averages > 2.0).min_by(|a, b| {
                let p = |bin: &crate::spectrum::cross::CrossBin| {
                    (bin.averages - 1.0) * (-bin.coherence).ln_1p()
                };
                p(a).total_cmp(&p(b))
            });
            let Some(best) = best else { continue };
            // G. C. Carter, Proc. IEEE 75 (1987), eq. 34.
            let p = ((best.averages - 1.0) * (-best.coherence).ln_1p()).exp();
            let p_value = tail::searched(p, trials);
            if p_value < level {
                let width = (0.5 / PER_OCTAVE).exp2();
                all.push(Common {
                    pair: (first, second),
                    from_hz: best.f_hz / width,
                    to_hz: best.f_hz * width,
                    coherence: best.coherence,
                    cross: best.density.re,
                    p_value,
                });
            }
        }
    }
    all
}
