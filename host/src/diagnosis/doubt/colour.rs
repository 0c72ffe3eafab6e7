//! Noise whose colour changes in time, which a law or the five terms describe on average.

use std::ops::Range;

use super::{Doubt, Hearing};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::steady::law::{self, Change};
use crate::model::kind::Kind;
use crate::model::{clipping, dropped, outliers, rounding, stale, telegraph};

/// Kinds that bend the law of amplitudes, or have what is too small to be taken out one by one: their
/// strengths are not those of Gaussian noise.
const BENDS: [Kind; 6] = [
    clipping::KIND,
    rounding::KIND,
    telegraph::KIND,
    outliers::KIND,
    stale::KIND,
    dropped::KIND,
];

/// The five terms themselves, where their sizes change against one another and nothing else is said of the
/// axis. One test, with that of the laws.
pub static OF_TERMS: Doubt = Doubt {
    tests: 1,
    why: "the colour of the noise changes",
    hear: of_terms,
};

fn of_terms(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    let mut explanations = hearing.axis.explanations().iter();
    if !hearing.remarks.is_empty() || explanations.any(|one| BENDS.contains(&one.kind())) {
        return Ok(());
    }
    let change = law::change_of_terms(hearing.axis);
    let change = change.filter(|one| one.p_value < hearing.level);
    hearing.remarks.extend(change.map(|change| {
        let band_hz = 0.0..0.5 * hearing.axis.rate_hz;
        let what = format!("as if {}", change.parameter);
        changing(&change, &band_hz, &what)
    }));
    Ok(())
}

/// A law of the name `kind` whose parameters change in time, which noise of another kind makes whose colour
/// does, and by how much, as the standard deviation of a logarithm.
pub fn of_law(
    axis: &AxisState,
    level: f64,
    which: usize,
    kind: Kind,
    band_hz: &Range<f64>,
) -> Option<(Remark, f64)> {
    // Two levels are not Gaussian.
    if kind == telegraph::KIND {
        return None;
    }
    let change = law::change_of_law(axis, which);
    let change = change.filter(|one| one.p_value < level)?;
    let what = format!("as {} whose {}", kind.with_article(), change.parameter);
    Some((changing(&change, band_hz, &what), change.log_sd))
}

fn changing(change: &Change, band: &Range<f64>, what: &str) -> Remark {
    let time_s = change.time_s;
    let when = if change.cyclic {
        format!("in cycles of {time_s:.3} s")
    } else {
        format!("over {time_s:.2} s")
    };
    Remark {
        test: "steadiness".into(),
        place: band.clone().into(),
        p_value: change.p_value,
        description: format!(
            "noise whose colour and strength change {when}: {what} moved by {:.0} %",
            100.0 * change.log_sd
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::{
        LEVEL, NOTHING, RATE_HZ, axis, heard, law, long, numbers, remark, ringing, swinging,
        take_in,
    };
    use crate::model::resonance;

    /// White noise beside quantisation noise that swings by the share `swing`.
    fn coloured(seed: u64, swing: f64) -> AxisState {
        let len = long(seed);
        let (mut more, swings) = (numbers(seed, 8), swinging(swing, 9.0, len));
        let mut last = more.draw();
        axis(seed, len, |n, noise| {
            let next = more.draw();
            let step = next - last;
            last = next;
            0.5 * noise + swings(n) * step
        })
    }

    #[test]
    fn a_term_that_changes_against_the_others_is_remarked_on() {
        let mut axis = coloured(1, 0.4);
        let remarks = heard(&OF_TERMS, &mut axis, false);
        assert_eq!(remarks.len(), 1, "seed 1: {remarks:?}");
        assert_eq!(remarks[0].test, "steadiness", "seed 1");
        assert_eq!(remarks[0].place, (0.0..0.5 * RATE_HZ).into(), "seed 1");
        let said = &remarks[0].description;
        assert!(said.contains("as if Q moved by"), "seed 1: {said}");
        assert!(remarks[0].p_value < LEVEL, "seed 1: {remarks:?}");
    }

    #[test]
    fn nothing_is_said_of_steady_terms() {
        let mut axis = coloured(2, 0.0);
        assert_eq!(heard(&OF_TERMS, &mut axis, false), [], "seed 2");
    }

    #[test]
    fn nothing_is_said_of_the_terms_where_something_else_is_said() {
        let mut axis = coloured(1, 0.4);
        let mut hearing = Hearing {
            axis: &mut axis,
            level: LEVEL,
            strength_moves: false,
            large_samples_in_groups: false,
            remarks: vec![remark(1.0, 2.0)],
            no_course: None,
        };
        assert!((OF_TERMS.hear)(&mut hearing).is_ok(), "seed 1");
        assert_eq!(hearing.remarks, [remark(1.0, 2.0)], "seed 1");
    }

    #[test]
    fn a_law_that_swings_is_remarked_on_but_for_two_levels() {
        let of = |seed: u64, swing: f64, kind: Kind| {
            let len = long(seed);
            let (mut rings, swings) = (ringing(seed, 100.0, 20.0), swinging(swing, 9.0, len));
            let mut axis = axis(seed, len, |n, noise| noise + 2.0 * swings(n) * rings());
            let bell = law(resonance::KIND, &[100.0, 20.0, 1.0]);
            take_in(&mut axis, resonance::KIND, bell);
            of_law(&axis, LEVEL, 0, kind, &(80.0..120.0))
        };
        assert!(of(3, 0.6, resonance::KIND).is_some(), "seed 3");
        assert!(of(3, 0.6, telegraph::KIND).is_none(), "seed 3: two levels");
        assert!(of(4, 0.0, resonance::KIND).is_none(), "seed 4: steady");
    }

    #[test]
    fn kinds_whose_strengths_are_not_gaussian_are_exempt() {
        let coloured = coloured(1, 0.4);
        for kind in [
            clipping::KIND,
            rounding::KIND,
            telegraph::KIND,
            outliers::KIND,
            stale::KIND,
            dropped::KIND,
        ] {
            let mut axis = coloured.clone();
            take_in(&mut axis, kind, NOTHING);
            assert_eq!(heard(&OF_TERMS, &mut axis, false), [], "{kind}, seed 1");
        }
    }
}
