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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::explanation::Change;
    use crate::diagnosis::trial::{
        axis, heard, jump, kinds, law, line, ringing, short, spike, take_in,
    };
    use crate::model::{hum, outliers, resonance, sinusoid, steps};

    const SEED: u64 = 1;

    #[test]
    fn lines_near_a_resonance_are_its_tops_and_no_others_are() {
        let mut rings = ringing(SEED, 100.0, 10.0);
        let mut axis = axis(SEED, short(SEED), |_, noise| noise + rings());
        let bell = law(resonance::KIND, &[100.0, 10.0, 1.0]);
        take_in(&mut axis, resonance::KIND, bell);
        // Five widths are 50 Hz, which the fit knows to a few percent.
        let both = Change::Waves(vec![line(130.0, 0.1), line(250.0, 0.1)]);
        take_in(&mut axis, hum::KIND, both);
        take_in(&mut axis, sinusoid::KIND, line(80.0, 0.1).into());
        take_in(&mut axis, steps::KIND, jump(5000, 0.1).into());
        take_in(&mut axis, outliers::KIND, spike(6000, 0.1).into());
        assert_eq!(heard(&DOUBT, &mut axis, false), [], "seed {SEED}");
        // An explanation goes with its last line.
        let left = [resonance::KIND, hum::KIND, steps::KIND, outliers::KIND];
        assert_eq!(kinds(&axis), left, "seed {SEED}");
        let waves = [line(250.0, 0.1), jump(5000, 0.1), spike(6000, 0.1)];
        assert_eq!(*axis.residual.waves(), waves, "seed {SEED}");
    }

    #[test]
    fn without_a_resonance_lines_stay() {
        let mut axis = axis(SEED, short(SEED), |_, noise| noise);
        take_in(&mut axis, sinusoid::KIND, line(80.0, 0.1).into());
        heard(&DOUBT, &mut axis, false);
        assert_eq!(kinds(&axis), [sinusoid::KIND], "seed {SEED}");
    }
}
