//! The level in time: of what follows a covariate, a settling and a jump, the one that shows most.
//!
//! The three take one another's place: what is not explained by the one that is there is explained in part
//! by the others. So they look together, and the largest is taken in first.

use super::{Detector, steps, thermal, warmup};
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::axis::profile::Noise;
use crate::diagnosis::detect::look::{Look, Proposal};

/// Tests of one look: what follows a covariate, settling, jumps.
const TESTS: u32 = 3;

/// Looks in noise as it was fitted.
pub static IN_FITTED_NOISE: Detector = Detector {
    tests: TESTS,
    look: |look| strongest(look, Noise::Fitted),
};

/// Looks in noise whose walk and flicker are fitted anew together with each of the three.
pub static IN_NOISE_ANEW: Detector = Detector {
    tests: TESTS,
    look: |look| strongest(look, Noise::Anew),
};

fn strongest(look: &Look<'_>, noise: Noise) -> Result<Vec<Proposal>, NoFit> {
    let thermal = thermal::find(look, noise);
    let settling = warmup::find(look, noise);
    let jump = steps::find(look, noise);
    let size = |z: Option<f64>| z.map_or(0.0, f64::abs);
    let of_thermal = size(thermal.as_ref().map(|(change, _)| change.z));
    let of_settling = size(settling.as_ref().map(|change| change.z));
    let of_jump = size(jump.map(|jump| jump.z));
    if let Some(thermal) = thermal.filter(|_| of_thermal >= of_settling && of_thermal >= of_jump) {
        return Ok(thermal::proposal(thermal).into_iter().collect());
    }
    if let Some(settling) = settling.filter(|_| of_settling > 0.0 && of_settling >= of_jump) {
        return Ok(warmup::proposal(look, settling).into_iter().collect());
    }
    Ok(jump.map_or_else(Vec::new, |jump| steps::proposals(look, jump)))
}
