//! Lines as a model has them, ahead of what filters.
//!
//! A line is measured as the record shows it, behind the filters that are found beside it, now or later. A model's filters act on
//! all of it: there it is larger by what they keep from it, or it would be filtered twice.

use crate::diagnosis::detect::lines::amplitudes;
use crate::diagnosis::laws::{self, Law};
use crate::diagnosis::result::estimate::Estimate;

/// An estimate from a record at this rate ahead of the filters among `laws`; of a line that they let nothing of through, which
/// joins somewhere behind them, ahead of as much as a record [shows](crate::model::effect::Distortion::shown) of what is shut
/// out. What is no line stays as it is.
pub(super) fn ahead_of(laws: &[Law], rate_hz: f64, measured: &Estimate) -> Estimate {
    let mut estimate = measured.clone();
    let filters = laws::filters(laws);
    let Some(first) = amplitudes::first(measured.kind).filter(|_| !filters.is_empty()) else {
        return estimate;
    };
    let base_hz = measured.plain()[0];
    let numbered = (1_u32..).zip(&mut estimate.values[first..]);
    for (number, amplitude) in numbered {
        let f_hz = f64::from(number) * base_hz;
        let power: f64 = filters.iter().map(|one| one.shown(f_hz, rate_hz)).product();
        *amplitude = amplitude.map(|known| known.map(|one| one / power.sqrt()));
    }
    estimate
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::result::value::Value;
    use crate::model::{hum, resonance, rolloff, sinusoid};

    fn law(effect: crate::model::kind::Kind, values: &[f64]) -> Law {
        Law {
            effect,
            values: values.to_vec(),
        }
    }

    #[test]
    fn a_line_is_larger_by_what_a_pole_keeps_from_it() {
        let pole = [law(rolloff::KIND, &[50.0])];
        // A pole's amplitude is one over the root of 1 + (f / corner)^2, which half the rate is far above.
        let factor = |f_hz: f64| (1.0 + (f_hz / 50.0_f64).powi(2)).sqrt();
        let line = Estimate::new(
            sinusoid::KIND,
            [Value::told(100.0), Value::normal(2.0, 0.1)],
        );
        let ahead = ahead_of(&pole, 100_000.0, &line).values[1].expect("known");
        assert!((ahead.value / (2.0 * factor(100.0)) - 1.0).abs() < 1e-2);
        assert!((ahead.sd() / ahead.value - 0.05).abs() < 1e-9, "{ahead:?}");
        let mut mains = Estimate::new(hum::KIND, [50.0, 0.0, 0.0, 1.0, 0.0, 1.0].map(Value::told));
        mains.values[hum::FIRST_AMPLITUDE + 1] = None;
        let ahead = ahead_of(&pole, 100_000.0, &mains).values;
        for (place, f_hz) in [(0, 50.0), (2, 150.0)] {
            let one = ahead[hum::FIRST_AMPLITUDE + place].expect("known").value;
            assert!((one / factor(f_hz) - 1.0).abs() < 1e-2, "{f_hz}: {one}");
        }
        assert_eq!(ahead[hum::FIRST_AMPLITUDE + 1], None);
        assert_eq!(ahead[0], mains.values[0]);
    }

    #[test]
    fn what_filters_nothing_and_what_is_no_line_change_nothing() {
        let line = Estimate::new(sinusoid::KIND, [100.0, 2.0].map(Value::told));
        let bell = Estimate::new(resonance::KIND, [100.0, 10.0, 2.0].map(Value::told));
        let laws = [law(resonance::KIND, &[100.0, 10.0, 1.0])];
        assert_eq!(ahead_of(&laws, 1000.0, &line), line);
        let pole = [law(rolloff::KIND, &[50.0])];
        assert_eq!(ahead_of(&pole, 1000.0, &bell), bell);
    }
}
