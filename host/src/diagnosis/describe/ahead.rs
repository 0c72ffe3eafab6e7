//! Lines as a model has them, ahead of what filters.
//!
//! A line is measured as the record shows it, behind the filters that are found beside it, now or later. A model's filters act on
//! all of it: there it is larger by what they keep from it, or it would be filtered twice.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::lines::amplitudes;
use crate::diagnosis::laws::{self, Law};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::effect::Distortion;

/// An estimate from a record at this rate ahead of the filters among `laws`; of a line that they let nothing of through, which
/// joins somewhere behind them, ahead of as much as a record [shows](crate::model::effect::Distortion::shown) of what is shut
/// out. What is no line stays as it is.
pub(super) fn ahead_of(laws: &[Law], rate_hz: f64, measured: &Estimate) -> Estimate {
    let filters = laws::filters(laws);
    if filters.is_empty() {
        return measured.clone();
    }
    each_line(measured, |f_hz, amplitude| {
        let passed = amplitude_through(&filters, f_hz, rate_hz);
        amplitude.map(|one| one / passed)
    })
}

/// The same of an axis, as well as it is known how much its filters keep.
pub(super) fn ahead_in(axis: &AxisState, measured: &Estimate) -> Estimate {
    let ahead = ahead_of(&axis.laws, axis.rate_hz, measured);
    let found = axis.explanations().iter().map(|one| &one.effect);
    let by_one_sd: Vec<[Vec<Box<dyn Distortion>>; 2]> = found.flat_map(one_sd_off).collect();
    each_line(&ahead, |f_hz, amplitude| {
        let changes = by_one_sd.iter().map(|both| {
            let [as_found, off] = both
                .each_ref()
                .map(|filter| amplitude_through(filter, f_hz, axis.rate_hz));
            (amplitude.value * (off / as_found).ln()).powi(2)
        });
        let added = changes.sum::<f64>();
        if added > 0.0 && amplitude.hi.is_some() {
            Value::normal(amplitude.value, (amplitude.sd().powi(2) + added).sqrt())
        } else {
            amplitude
        }
    })
}

/// Lines with other amplitudes: `change` is given the frequency, hertz, and the amplitude of each that is known.
fn each_line(lines: &Estimate, change: impl Fn(f64, Value) -> Value) -> Estimate {
    let mut changed = lines.clone();
    let Some(first) = amplitudes::first(lines.kind) else {
        return changed;
    };
    let base_hz = lines.plain()[0];
    for (number, amplitude) in (1_u32..).zip(&mut changed.values[first..]) {
        *amplitude = amplitude.map(|known| change(f64::from(number) * base_hz, known));
    }
    changed
}

/// Factor on the amplitude of a line at `f_hz`.
fn amplitude_through(filters: &[Box<dyn Distortion>], f_hz: f64, rate_hz: f64) -> f64 {
    laws::shown_of(filters, f_hz, rate_hz).sqrt()
}

/// A filter as it was found, and with each of its values one standard deviation off; nothing of what filters nothing.
fn one_sd_off(found: &Estimate) -> Vec<[Vec<Box<dyn Distortion>>; 2]> {
    let values = found.plain();
    let filter = |values: &[f64]| {
        let law = Law {
            effect: found.kind,
            values: values.to_vec(),
        };
        laws::filters(&[law])
    };
    let known = found.values.iter().enumerate();
    let uncertain = known.filter_map(|(place, value)| Some((place, (*value)?.sd())));
    let uncertain = uncertain.filter(|(_, sd)| *sd > 0.0);
    let off = uncertain.map(|(place, sd)| {
        let mut off = values.clone();
        off[place] += sd;
        [filter(&values), filter(&off)]
    });
    off.filter(|[as_found, _]| !as_found.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::{self, axis, short};
    use crate::model::kind::Kind;
    use crate::model::{hum, resonance, rolloff, sinusoid};

    fn law(effect: Kind, values: &[f64]) -> Law {
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

    #[test]
    fn a_line_is_known_no_better_than_the_filter_that_it_passed() {
        let mut axis = axis(5, short(5), |_, noise| noise);
        let corner_hz = 50.0;
        trial::take_in(
            &mut axis,
            rolloff::KIND,
            trial::law(rolloff::KIND, &[corner_hz]),
        );
        let sd_hz = 1.0;
        axis.set_laws(|_, _| Estimate::new(rolloff::KIND, [Value::normal(corner_hz, sd_hz)]));
        let line = [Value::told(100.0), Value::normal(2.0, 0.01)];
        let ahead = ahead_in(&axis, &Estimate::new(sinusoid::KIND, line));
        let ahead = ahead.values[1].expect("known");
        // The logarithm of what a pole lets through, 1 over the root of 1 + (f / corner)^2, moves with that of its corner by
        // (f / corner)^2 / (1 + (f / corner)^2); a pole within a sensor by a little less, so near to half the rate.
        let expected = f64::hypot(0.01 / 2.0, 4.0 / 5.0 * sd_hz / corner_hz);
        let found = ahead.sd() / ahead.value;
        assert!(
            (found / expected - 1.0).abs() < 0.1,
            "seed 5: {found}, {expected}"
        );
    }
}
