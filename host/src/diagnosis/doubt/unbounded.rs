//! Effects of which the record says too little: an interval that spans more than a factor of ten, or holds none of the
//! effect, is no finding.
//!
//! A peak whose width lies between a thousandth and five hertz may be a line, a top of something else, or half of the
//! band. What was significant about it stays so, without the name.

use super::{Doubt, Hearing};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::{lines, spectral};
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::laws::spread::Spread;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::value::Value;
use crate::model::effect::{Part, Quantity};
use crate::model::kind::Kind;

/// Upper over lower end of a 95 % interval from which it says too little: an order of magnitude.
const WIDEST: f64 = 10.0;

/// Takes such names back, the least sure first: what two of them share, the other may then have for itself. No test.
pub static DOUBT: Doubt = Doubt {
    tests: 0,
    why: "its interval spans more than a factor of ten, or holds none of it",
    hear,
};

fn hear(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    while let Some((place, factor)) = least_sure(hearing.axis) {
        let one = &hearing.axis.explanations()[place];
        let Some(which) = hearing.axis.law_number(one) else {
            hearing.axis.withdraw_one(place);
            hearing.axis.refresh()?;
            continue;
        };
        let remark = remark(hearing.axis, one, which, factor);
        let with = hearing.axis.fit.log_likelihood;
        hearing.axis.withdraw_laws(&[which]);
        hearing.axis.refresh()?;
        // What others explain as well once it is gone is no more to be said.
        let lost_nats = with - hearing.axis.fit.log_likelihood;
        if (-lost_nats).exp() < hearing.level {
            hearing.remarks.push(remark);
        }
    }
    Ok(())
}

/// The explanation whose worst interval is the widest, if it says too little, and how wide that is.
pub fn least_sure(axis: &AxisState) -> Option<(usize, f64)> {
    let spread = Spread::new(&axis.bins, &axis.data, &axis.laws, &axis.fit);
    let explanations = axis.explanations().iter().enumerate();
    // What happened is dated and kept out of the fits, whatever is known of its size.
    let explanations = explanations.filter(|(_, one)| !one.happened());
    let factors = explanations.map(|(place, one)| {
        let values = match axis.law_number(one) {
            Some(which) => spread.values(which).into_iter().map(Some).collect(),
            // A line that was found first stood in noise that it was taken for.
            None => lines::in_noise_left(axis, one)
                .map_or_else(|| one.effect.values.clone(), |now| now.values),
        };
        (place, unsureness(one.kind(), &values))
    });
    let worst = factors.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (worst.1 > WIDEST).then_some(worst)
}

/// By which factor the least certain of an effect's widths spans, or the surest of its sizes; 1 where it has neither.
fn unsureness(kind: Kind, values: &[Option<Value>]) -> f64 {
    let plain: Vec<f64> = values
        .iter()
        .map(|one| one.map_or(0.0, |one| one.value))
        .collect();
    // A limit or a grid is a place among the values, not a size.
    let acts = matches!(kind.part(&plain), Part::Distortion(_));
    let parameters = kind.parameters(&plain);
    let known = || {
        let pairs = parameters.iter().zip(values);
        pairs.filter_map(|(parameter, value)| Some((parameter.quantity, (*value)?)))
    };
    let widths = known().filter(|(quantity, _)| *quantity == Quantity::Hertz);
    let widest = widths.map(|(_, value)| factor(value)).fold(1.0, f64::max);
    let is_size = |quantity: Quantity| {
        matches!(
            quantity,
            Quantity::Signal | Quantity::Density | Quantity::SignalPerKelvin
        )
    };
    let sizes = known().filter(|(quantity, _)| is_size(*quantity) && !acts);
    let surest = sizes.map(|(_, value)| factor(value)).reduce(f64::min);
    widest.max(surest.unwrap_or(1.0))
}

/// Upper over lower end of an interval; infinite where it has no end or holds zero.
fn factor(value: Value) -> f64 {
    let (Some(lo), Some(hi)) = (value.lo, value.hi) else {
        return f64::INFINITY;
    };
    let (least, most) = (lo.abs().min(hi.abs()), lo.abs().max(hi.abs()));
    if lo * hi <= 0.0 {
        f64::INFINITY
    } else {
        most / least
    }
}

fn remark(axis: &AxisState, one: &Explanation, which: usize, factor: f64) -> Remark {
    /// Shares of the density from which it is the law's, the largest that it reaches: choices.
    const SEEN: [f64; 3] = [0.25, 0.05, 0.01];
    let bands = SEEN.map(|share| spectral::band_of(axis, which, share));
    let band = bands.into_iter().find(|band| band.end > 0.0);
    /// Factor from which an interval is as good as without an end: where its far end lies is chance then.
    const ENDLESS: f64 = 1e6;
    let how = if factor < ENDLESS {
        format!("by a factor of {factor:.0} between its ends")
    } else {
        "without an end".into()
    };
    Remark {
        test: "spectrum".into(),
        place: band.unwrap_or(0.0..0.5 * axis.rate_hz).into(),
        p_value: one.p_value,
        description: format!(
            "power that {} explains, of which the record says too little for a name: a 95 % interval {how}",
            one.kind().with_article()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::explanation::{Candidate, Change};
    use crate::diagnosis::result::estimate::Estimate;
    use crate::diagnosis::trial::{axis, heard, law, line, ringing, short, take_in};
    use crate::model::{clipping, markov, resonance, shock, sinusoid, steps};

    #[test]
    fn a_width_that_is_known_to_a_factor_of_ten_is_no_finding() {
        let interval = |lo: f64, hi: f64| {
            let value = Value {
                value: (lo * hi).abs().sqrt(),
                lo: Some(lo),
                hi: Some(hi),
            };
            Some(value)
        };
        let (sure, wide, none) = (
            interval(1.0, 2.0),
            interval(0.014, 5.5),
            interval(-1.0, 2.0),
        );
        let spans = |kind, values: &[Option<Value>]| unsureness(kind, values) > WIDEST;
        assert!(!spans(resonance::KIND, &[sure, sure, sure]));
        assert!(spans(resonance::KIND, &[sure, wide, sure]));
        assert!(spans(resonance::KIND, &[sure, sure, wide]));
        assert!(spans(sinusoid::KIND, &[sure, none]));
        // How long it takes is no width, and one step that is sure is enough.
        assert!(!spans(markov::KIND, &[sure, wide]));
        assert!(!spans(steps::KIND, &[sure, none, sure, sure]));
        // A limit is a place among the values.
        assert!(!spans(clipping::KIND, &[none, sure]));
        let no_end = Some(Value {
            value: 1.0,
            lo: Some(1.0),
            hi: None,
        });
        assert!(spans(resonance::KIND, &[sure, no_end, sure]));
    }

    #[test]
    fn what_happened_did_so_however_little_is_known_of_its_size() {
        let mut axis = axis(3, short(3), |_, noise| noise);
        let unsure = Value {
            value: 1.0,
            lo: None,
            hi: None,
        };
        let effect = Estimate::new(shock::KIND, [unsure; 5]);
        assert!(unsureness(shock::KIND, &effect.values) > WIDEST);
        let change = Change::Happened {
            masked: vec![5000..5010],
            waves: Vec::new(),
        };
        let candidate = Candidate::new(effect, 1e-9, 5.0, change);
        axis.accept(candidate).expect("a fit");
        assert_eq!(heard(&DOUBT, &mut axis, false), [], "seed 3");
        assert_eq!(axis.kinds(), [shock::KIND], "seed 3");
    }

    #[test]
    fn of_two_of_a_kind_the_one_that_is_unsure_goes() {
        let mut axis = axis(8, short(8), |_, noise| noise);
        // Of some ten thousand samples a line is known to a hundredth of the noise, whatever it was found in.
        for (f_hz, size) in [(100.0, 1.0), (200.0, 5e-3)] {
            let amplitude = Value::normal(size, 2.0);
            let effect = Estimate::new(sinusoid::KIND, [Value::exact(f_hz), amplitude]);
            let wave = Change::Waves(vec![line(f_hz, size)]);
            axis.accept(Candidate::new(effect, 1e-9, 5.0, wave))
                .expect("a fit");
        }
        assert_eq!(heard(&DOUBT, &mut axis, false), [], "seed 8");
        let left: Vec<_> = axis.explanations().iter().collect();
        assert_eq!(left.len(), 1, "seed 8");
        assert_eq!(left[0].effect.plain()[0], 100.0, "seed 8");
    }

    #[test]
    fn a_resonance_that_is_there_stays_and_one_that_is_not_goes() {
        let mut rings = ringing(1, 100.0, 10.0);
        let mut there = axis(1, short(1), |_, noise| noise + rings());
        take_in(
            &mut there,
            resonance::KIND,
            law(resonance::KIND, &[100.0, 10.0, 1.0]),
        );
        assert_eq!(heard(&DOUBT, &mut there, false), [], "seed 1");
        assert_eq!(there.kinds(), [resonance::KIND], "seed 1");
        let mut nothing = axis(2, short(2), |_, noise| noise);
        take_in(
            &mut nothing,
            resonance::KIND,
            law(resonance::KIND, &[100.0, 10.0, 1.0]),
        );
        // Nothing is lost with it, and nothing is left to be said.
        assert_eq!(heard(&DOUBT, &mut nothing, false), [], "seed 2");
        assert_eq!(nothing.kinds(), [], "seed 2");
    }

    #[test]
    fn what_is_lost_with_a_name_is_said() {
        // Two for one: the second takes what it can get, in some records more than chance.
        let said = |seed: &u64| {
            let mut rings = ringing(*seed, 100.0, 10.0);
            let mut axis = axis(*seed, short(*seed), |_, noise| noise + rings());
            for width_hz in [10.0, 12.0] {
                let change = law(resonance::KIND, &[100.0, width_hz, 1.0]);
                take_in(&mut axis, resonance::KIND, change);
            }
            !heard(&DOUBT, &mut axis, false).is_empty()
        };
        let said: Vec<u64> = (4..7).filter(said).collect();
        assert_eq!(said, [4], "of seeds 4 to 6");
    }
}
