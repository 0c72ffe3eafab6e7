//! What was made for a tone before it was known to be one.

use super::harmonics::Line;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::lines;
use crate::diagnosis::detect::shock::NEXT_GROUP;
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::steady::line::IMPERFECT;
use crate::model::burst::Burst;
use crate::model::kind::Kind;
use crate::model::unnamed::Band;
use crate::model::{burst, motion, shock, sinusoid};

/// Kinds that cut stretches out of the record.
pub const HAPPENED: [Kind; 2] = [shock::KIND, motion::KIND];

/// Kinds that are taken back: laws that were fitted to the tone with the rest of the spectrum, and lines that stand in
/// its bands, shocks among them.
pub fn made_for_it(axis: &AxisState, bands: &[Line]) -> Vec<Kind> {
    let laws = axis.explanations().iter().filter(|one| one.law().is_some());
    let mut kinds: Vec<_> = laws.map(Explanation::kind).collect();
    let mut lines_hz = lines::taken_out_hz(axis).into_iter();
    let is_inside = |f_hz: f64| bands.iter().any(|line| line.band_hz.contains(&f_hz));
    if lines_hz.any(is_inside) {
        kinds.push(sinusoid::KIND);
    }
    if are_of_tone(axis, is_inside) {
        kinds.push(shock::KIND);
    }
    if moves_as_tone(axis, bands) {
        kinds.push(motion::KIND);
    }
    kinds
}

/// Kinds that are sought anew: stretches that are louder by no more than the tone would make them if all of it were in them.
/// Where it went far, what was noise beside it looked louder.
pub fn may_be_made_for_it(axis: &AxisState, lines: &[Line]) -> Vec<Kind> {
    let record_s = axis.filled.len() as f64 / axis.rate_hz;
    let bursts = axis.explanations().iter();
    let bursts = bursts.filter(|one| one.kind() == burst::KIND);
    let louder = bursts.map(|one| Burst::of(&one.effect.plain()).adds(record_s));
    let seen = axis.whitened();
    let ordinates_s = seen.transform.len() as f64 / axis.rate_hz;
    let density = |f_hz: f64| {
        let last = seen.density.len() - 1;
        seen.density[((f_hz.max(0.0) * ordinates_s) as usize).min(last)]
    };
    let of_tone = lines.iter().map(|line| {
        // What was fitted to the tone is as wide as it.
        let (from_hz, to_hz) = (line.band_hz.start, line.band_hz.end);
        let beside = density(2.0 * from_hz - to_hz).min(density(2.0 * to_hz - from_hz));
        let power =
            0.5 * line.amplitude.value.powi(2) * axis.bins.chain_power(0.5 * (from_hz + to_hz));
        power / (beside * axis.rate_hz)
    });
    if louder.sum::<f64>() <= of_tone.sum() {
        vec![burst::KIND]
    } else {
        Vec::new()
    }
}

/// Whether all that is known to have moved the axis, but for what a steady line may miss, did so about these lines, by no more
/// than they do, and left nothing behind.
/// What is usual is known by [groups of ordinates](NEXT_GROUP): a tone that wanders from one into the next is no event.
fn moves_as_tone(axis: &AxisState, lines: &[Line]) -> bool {
    let Some(known) = axis.explanation(motion::KIND) else {
        return false;
    };
    let is_line = |band: &Band| {
        lines.iter().any(|line| {
            let half_hz = 0.5 * band.width_hz;
            let above = (band.f_hz - half_hz) / line.band_hz.end;
            let below = line.band_hz.start / (band.f_hz + half_hz);
            above.max(below) < NEXT_GROUP
                && 2.0 * band.amplitude.powi(2) <= line.amplitude.value.powi(2)
        })
    };
    let values = known.effect.plain();
    let stretches = values.chunks_exact(motion::ROW).map(motion::Stretch::of);
    let stretches: Vec<motion::Stretch> = stretches.collect();
    let power = |band: &Band| band.amplitude.powi(2);
    let all: f64 = stretches.iter().map(|one| power(&one.band)).sum();
    let is_of_tone = |band: &Band| is_line(band) || power(band) < IMPERFECT * all;
    !stretches.is_empty()
        && stretches
            .iter()
            .all(|one| one.step == 0.0 && one.mean == 0.0 && is_of_tone(&one.band))
}

/// Whether shocks are known that all ring at frequencies of the tone: where it seldom is it stands out of what is usual
/// there.
fn are_of_tone(axis: &AxisState, is_own: impl Fn(f64) -> bool) -> bool {
    let mut shocks = axis.residual.shocks().peekable();
    shocks.peek().is_some() && shocks.all(|one| is_own(one.f_hz))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::explanation::Change;
    use crate::diagnosis::result::estimate::Estimate;
    use crate::diagnosis::result::value::Value;
    use crate::diagnosis::trial::{axis, made_up, short};

    const LINE_HZ: f64 = 12.4;

    /// Whether motion of these `[step, f_hz, amplitude]` is taken for a tone of amplitude 2 about [`LINE_HZ`].
    fn is_made_for_it(stretches: &[[f64; 3]]) -> bool {
        is_made_for_it_if_as_wide(stretches, 0.1)
    }

    fn is_made_for_it_if_as_wide(stretches: &[[f64; 3]], width_hz: f64) -> bool {
        let line = Line {
            number: 1,
            amplitude: Value::exact(2.0),
            band_hz: LINE_HZ - 0.1..LINE_HZ + 0.1,
        };
        let mut axis = axis(1, short(1), |_, noise| noise);
        let rows = stretches.iter().flat_map(|&[step, f_hz, amplitude]| {
            [10.0, 5.0, step, f_hz, width_hz, amplitude, 0.0, 0.0].map(Value::exact)
        });
        let mut one = made_up(motion::KIND, Change::Waves(Vec::new()));
        one.effect = Estimate::new(motion::KIND, rows);
        axis.accept(one).expect("a fit");
        made_for_it(&axis, &[line]).contains(&motion::KIND)
    }

    #[test]
    fn motion_about_a_tone_and_no_louder_is_the_tone() {
        let near_hz = LINE_HZ / 1.12;
        assert!(is_made_for_it(&[[0.0, near_hz, 1.3]]));
        assert!(is_made_for_it(&[[0.0, LINE_HZ, 0.1], [0.0, near_hz, 0.1]]));
        assert!(!is_made_for_it(&[[0.0, near_hz, 1.5]]), "louder");
        assert!(!is_made_for_it(&[[0.0, LINE_HZ / 1.2, 1.3]]), "far off");
        // Told to half an octave it may lie there.
        let told = [[0.0, LINE_HZ / 1.2, 1.3]];
        assert!(is_made_for_it_if_as_wide(&told, 0.35 * LINE_HZ / 1.2));
        assert!(!is_made_for_it(&[[0.01, near_hz, 1.3]]), "lies otherwise");
        let beside = [[0.0, near_hz, 1.3], [0.0, 40.0, 1.3]];
        assert!(!is_made_for_it(&beside), "one of two");
        let beside = [[0.0, near_hz, 1.3], [0.0, 40.0, 0.1]];
        assert!(is_made_for_it(&beside), "one of two, weak");
    }
}
