//! How high an unsteady band comes by itself, and whether what was taken for shocks is no more than that.

use std::f64::consts::PI;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::steady::noise::Unsteady;
use crate::model::shock::Shock;

/// Standard deviations over its mean that the power of a band does not reach: the power of noise that keeps its strength
/// follows the exponential law, and comes as high once in 60 000 moments.
const FAR: f64 = 10.0;

/// Whether there are shocks, and all of them ring within an unsteady band, no higher than it comes by itself.
pub fn holds_shocks(axis: &AxisState, found: &Unsteady) -> bool {
    let mut shocks = axis.residual.shocks().peekable();
    if shocks.peek().is_none() {
        return false;
    }
    let highest = highest_power(axis, found);
    shocks.all(|one| is_within(one, found) && 0.5 * one.peak.powi(2) < highest)
}

/// Whether a shock rings within a band: to within half of its width, for it ends where it is seen no more and not where it is no
/// more, that of the pieces of which bands are put together, and that of the shock's line, where it rings for longer than these
/// tell apart.
fn is_within(shock: &Shock, found: &Unsteady) -> bool {
    let line_hz = (PI * shock.decay_s.max(found.tile_s)).recip();
    let more_hz = line_hz + found.tile_s.recip() + 0.5 * (found.to_hz - found.from_hz);
    shock.f_hz > 0.0 && (found.from_hz - more_hz..found.to_hz + more_hz).contains(&shock.f_hz)
}

/// The power that a band reaches, squared units of the samples.
fn highest_power(axis: &AxisState, found: &Unsteady) -> f64 {
    /// Places at which its density is taken: a choice. A bin of the spectrum is hardly narrower.
    const PLACES: usize = 16;
    let step_hz = (found.to_hz - found.from_hz) / PLACES as f64;
    let at = |place: usize| axis.measured_density(found.from_hz + (place as f64 + 0.5) * step_hz);
    // The density is that of both sides.
    let mean = 2.0 * step_hz * (0..PLACES).map(at).sum::<f64>();
    // Of strength of the relative variance v, times what follows the exponential law: 2 (1 + v) - 1.
    let sd = (1.0 + 2.0 * found.variance.max(0.0)).sqrt();
    mean * (1.0 + FAR * sd)
}
