//! Lines that are tops of a resonance: noise that rings about one frequency stands out at single ones.

use super::{Doubt, Hearing};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::lines::resonances_hz;
use crate::diagnosis::record::wave::Wave;

/// Takes back lines near a resonance that are no stronger than its noise is now and then; what they are follows from
/// the law, and is no test.
pub static DOUBT: Doubt = Doubt {
    tests: 0,
    why: "they are tops of noise that rings",
    hear: take_back,
};

fn take_back(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    let axis = &*hearing.axis;
    let rings = resonances_hz(axis);
    if rings.is_empty() {
        return Ok(());
    }
    let rate_hz = axis.rate_hz;
    let strongest = strongest(axis, hearing.level);
    let lines = axis.residual.waves().iter();
    let is_top = |wave: &&Wave| match wave {
        Wave::Line { cycles, .. } => {
            rings.iter().any(|band| band.contains(&(cycles * rate_hz)))
                && ratio(axis, wave) < strongest
        }
        _ => false,
    };
    let tops: Vec<Wave> = lines.filter(is_top).cloned().collect();
    if hearing.axis.withdraw_waves(|wave| tops.contains(wave)) {
        hearing.axis.refresh()?;
    }
    Ok(())
}

/// Power of a line over that of the noise at its frequency, in the record's own ordinate.
fn ratio(axis: &AxisState, line: &Wave) -> f64 {
    let &Wave::Line {
        cycles,
        cosine,
        sine,
        ..
    } = line
    else {
        return 0.0;
    };
    let duration_s = axis.residual.len() as f64 / axis.rate_hz;
    let power = 0.25 * (cosine * cosine + sine * sine) * duration_s;
    power / axis.density(cycles * axis.rate_hz)
}

/// Ratio that the strongest ordinate of noise stays below but with the probability `level`.
fn strongest(axis: &AxisState, level: f64) -> f64 {
    /// Factor by which the density may be too low where tops were taken out as lines: a choice.
    const TAKEN_OUT: f64 = 2.0;
    TAKEN_OUT * (0.5 * axis.residual.len() as f64 / level).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::explanation::Change;
    use crate::diagnosis::trial::{axis, heard, jump, law, line, ringing, short, spike, take_in};
    use crate::model::{hum, outliers, resonance, sinusoid, steps};

    const SEED: u64 = 1;

    #[test]
    fn lines_near_a_resonance_are_its_tops_and_no_others_are() {
        let mut rings = ringing(SEED, 100.0, 10.0);
        let mut axis = axis(SEED, short(SEED), |_, noise| noise + rings());
        let bell = law(resonance::KIND, &[100.0, 10.0, 1.0]);
        take_in(&mut axis, resonance::KIND, bell);
        // Five widths are 50 Hz, which the fit knows to a few percent.
        let both = Change::Waves(vec![line(130.0, 0.04), line(250.0, 0.1)]);
        take_in(&mut axis, hum::KIND, both);
        take_in(&mut axis, sinusoid::KIND, line(80.0, 0.04).into());
        take_in(&mut axis, steps::KIND, jump(5000, 0.1).into());
        take_in(&mut axis, outliers::KIND, spike(6000, 0.1).into());
        assert_eq!(heard(&DOUBT, &mut axis, false), [], "seed {SEED}");
        // An explanation goes with its last line.
        let left = [resonance::KIND, hum::KIND, steps::KIND, outliers::KIND];
        assert_eq!(axis.kinds(), left, "seed {SEED}");
        let waves = [line(250.0, 0.1), jump(5000, 0.1), spike(6000, 0.1)];
        assert_eq!(*axis.residual.waves(), waves, "seed {SEED}");
    }

    #[test]
    fn a_line_stronger_than_any_top_stays() {
        let mut rings = ringing(SEED, 100.0, 10.0);
        let mut axis = axis(SEED, short(SEED), |_, noise| noise + rings());
        let bell = law(resonance::KIND, &[100.0, 10.0, 1.0]);
        take_in(&mut axis, resonance::KIND, bell);
        // Its density at 100 Hz is 1 / (2 pi 10 Hz) and the white noise's 1e-3, both two-sided: in 16 to 33 s these are 4
        // and 600 to 1200 times as much.
        take_in(&mut axis, sinusoid::KIND, line(101.0, 0.14).into());
        take_in(&mut axis, hum::KIND, line(99.0, 1.6).into());
        heard(&DOUBT, &mut axis, false);
        assert_eq!(axis.kinds(), [resonance::KIND, hum::KIND], "seed {SEED}");
    }

    #[test]
    fn without_a_resonance_lines_stay() {
        let mut axis = axis(SEED, short(SEED), |_, noise| noise);
        take_in(&mut axis, sinusoid::KIND, line(80.0, 0.1).into());
        heard(&DOUBT, &mut axis, false);
        assert_eq!(axis.kinds(), [sinusoid::KIND], "seed {SEED}");
    }
}
