//! Lines that are tops of a resonance: noise that rings about one frequency stands out at single ones.

use super::{Doubt, Hearing};
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::lines::resonances_hz;
use crate::diagnosis::record::wave::Wave;

/// Takes back lines near a resonance; what they are follows from the law, and is no test.
pub static DOUBT: Doubt = Doubt {
    tests: 0,
    hear: take_back,
};

fn take_back(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    let rate_hz = hearing.axis.rate_hz;
    let rings = resonances_hz(hearing.axis);
    let is_top = |wave: &Wave| match wave {
        Wave::Line { cycles, .. } => rings.iter().any(|band| band.contains(&(cycles * rate_hz))),
        _ => false,
    };
    if hearing.axis.withdraw_waves(is_top) {
        hearing.axis.refresh()?;
    }
    Ok(())
}
