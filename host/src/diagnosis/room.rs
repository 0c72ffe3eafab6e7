//! What a record can hold: a candidate whose parameters leave it is refused, whatever its p-value.
//!
//! A waveform may fit where it is not the truth, as an exponential of a few samples that starts a
//! thousand times higher than any value. Laws are kept inside where they are fitted
//! ([`Law::is_sound`](crate::diagnosis::laws::Law::is_sound)).

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::{Candidate, Change};
use crate::model::effect::{Part, Quantity};
use crate::model::warmup;

/// Share by which a size may be beyond the range of the values: a choice. An estimate of what fills all
/// of it has its own error.
const BEYOND: f64 = 0.05;

/// How many times as large as the range of the values a settling may be: of two against each other, the one's time constant twice the
/// other's or more, a quarter of each is left at least.
const OPPOSED: f64 = 4.0;

/// Whether a record like that of `axis` has room for a candidate: instants within it, waves no larger
/// than the range of its values, but for settlings that may go against each other, factors above zero.
pub fn holds(axis: &AxisState, candidate: &Candidate) -> bool {
    let values = candidate.effect.plain();
    let parameters = candidate.effect.kind.parameters(&values);
    let duration_s = axis.residual.len() as f64 / axis.rate_hz;
    let is_wave = matches!(candidate.change, Change::Waves(_));
    // A limit or a grid is a place among the values, not a size; ahead of a chain a wave may be larger than what comes
    // through.
    let acts = || matches!(candidate.effect.kind.part(&values), Part::Distortion(_));
    let range = match is_wave && axis.chain.is_none() && !acts() {
        true => range(axis.residual.measured()),
        false => f64::INFINITY,
    };
    let most = match candidate.effect.kind == warmup::KIND {
        true => OPPOSED,
        false => 1.0 + BEYOND,
    };
    parameters
        .iter()
        .zip(&values)
        .all(|(parameter, value)| match parameter.quantity {
            Quantity::Instant => (0.0..=duration_s).contains(value),
            Quantity::Signal => value.abs() <= range * most,
            Quantity::Factor => *value > 0.0,
            _ => value.is_finite(),
        })
}

/// Largest less smallest of the values that are there.
fn range(values: &[f64]) -> f64 {
    let finite = values.iter().filter(|value| value.is_finite());
    let ends = finite.fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, most), value| (least.min(*value), most.max(*value)),
    );
    ends.1 - ends.0
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Chain;
    use crate::diagnosis::record::wave::Wave;
    use crate::diagnosis::result::estimate::Estimate;
    use crate::diagnosis::result::value::Value;
    use crate::diagnosis::trial::{RATE_HZ, axis, jump, law, line, numbers, short};
    use crate::model::kind::Kind;
    use crate::model::{burst, clipping, markov, sinusoid, steps};

    fn is_held(kind: Kind, values: [f64; 2], change: Change) -> bool {
        let axis = axis(1, short(1), |_, noise| noise);
        let effect = Estimate::new(kind, values.map(Value::exact));
        holds(&axis, &Candidate::new(effect, 1e-9, 1.0, change))
    }

    #[test]
    fn a_step_is_no_higher_than_the_values_and_within_the_record() {
        let end_s = short(1) as f64 / RATE_HZ;
        let step = |time_s, height| {
            let wave: Change = jump(5000, height).into();
            is_held(steps::KIND, [time_s, height], wave)
        };
        assert!(step(0.5 * end_s, 1.0));
        assert!(step(0.5 * end_s, -1.0));
        assert!(!step(0.5 * end_s, 1e3));
        assert!(!step(0.5 * end_s, -1e3));
        assert!(!step(1.01 * end_s, 1.0));
        assert!(!step(0.5 * end_s, f64::NAN));
    }

    #[test]
    fn a_settling_may_go_against_another() {
        let settles = |amplitude: f64| {
            let wave = Wave::WarmUp {
                amplitude,
                samples: 500.0,
            };
            is_held(warmup::KIND, [amplitude, 0.5], Change::Waves(vec![wave]))
        };
        // Some thousand normal numbers span six to nine.
        assert!(settles(20.0) && settles(-20.0));
        assert!(!settles(50.0) && !settles(-50.0));
    }

    #[test]
    fn a_limit_may_be_far_above_the_range_of_the_values() {
        let waves = jump(5000, 0.1).into();
        assert!(is_held(clipping::KIND, [98.0, 1.0], waves));
    }

    #[test]
    fn what_is_no_wave_or_lies_ahead_of_a_chain_may_be_larger_than_the_values() {
        let markov = |deviation| {
            let change = law(markov::KIND, &[1.0, 0.01]);
            is_held(markov::KIND, [deviation, 0.01], change)
        };
        assert!(markov(1e3));
        assert!(!markov(f64::NAN));
        let mut normal = numbers(1, 0);
        let values = (0..short(1)).map(|_| normal.draw()).collect();
        let chain = Chain {
            converter: None,
            poles_hz: vec![10.0],
        };
        let behind = AxisState::new(Arc::new(values), RATE_HZ, Some(&chain)).expect("a fit");
        let effect = Estimate::new(sinusoid::KIND, [400.0, 1e3].map(Value::exact));
        let candidate = Candidate::new(effect, 1e-9, 3.0, line(400.0, 1e3).into());
        assert!(holds(&behind, &candidate));
        let plain = axis(1, short(1), |_, noise| noise);
        assert!(!holds(&plain, &candidate));
    }

    #[test]
    fn a_frequency_is_a_number() {
        let held = |f_hz| is_held(sinusoid::KIND, [f_hz, 0.1], line(50.0, 0.1).into());
        assert!(held(50.0));
        assert!(!held(f64::NAN));
    }

    #[test]
    fn no_noise_at_all_is_no_burst() {
        let axis = axis(1, short(1), |_, noise| noise);
        let burst = |factor| {
            let values = [0.1, 0.2, factor].map(Value::exact);
            let effect = Estimate::new(burst::KIND, values);
            holds(
                &axis,
                &Candidate::new(effect, 1e-9, 1.0, Change::Mask(Vec::new())),
            )
        };
        assert!(burst(0.1));
        assert!(!burst(0.0));
    }
}
