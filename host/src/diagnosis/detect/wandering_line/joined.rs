//! One tone that was found in parts: a multiple that was followed by itself, as where a strong tone's skirts reach the next one.

use std::ops::Range;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::wandering_line::FIRST_AMPLITUDE;

/// Multiples of a base that are one tone with it, at most: a choice, that of a family.
const MOST: f64 = 12.0;

/// How close the means of two parts over the same record lie, over how far the frequency wanders: a choice. They wander
/// together, so that what the mean is off by is the same in both; two machines stand as close once in fifty records.
const CLOSE: f64 = 0.02;

/// A tone with all its parts.
pub struct Joined {
    /// The number of the explanation that has had some of them.
    pub place: usize,
    /// All of it.
    pub effect: Estimate,
    /// The bands that it fills, hertz.
    pub bands_hz: Vec<Range<f64>>,
    /// What was gained on held-out data by what was known of it.
    pub held_out_nats: Option<f64>,
}

/// A tone that was found as `effect` in some bands, with the tone of an axis that it is a part of, or that is a part of it.
pub fn with_known(axis: &AxisState, effect: &Estimate, bands_hz: &[Range<f64>]) -> Option<Joined> {
    let known = axis.explanations().iter().enumerate();
    let mut tones = known.filter(|(_, one)| one.is_tone());
    tones.find_map(|(place, one)| {
        let [base, known_base] = [&effect.values, &one.effect.values].map(|values| values[0]);
        let wander = effect.values.get(1).copied().flatten()?;
        let (lower, higher) = if base?.value <= known_base?.value {
            (effect, &one.effect)
        } else {
            (&one.effect, effect)
        };
        let [low_hz, high_hz] = [lower, higher].map(|one| one.plain()[0]);
        let number = (high_hz / low_hz).round();
        let off_hz = high_hz - number * low_hz;
        let wanders_hz = wander.value * high_hz / base?.value;
        if number > MOST || off_hz.abs() > CLOSE * wanders_hz {
            return None;
        }
        let mut all_hz = one.bands_hz().to_vec();
        all_hz.extend_from_slice(bands_hz);
        Some(Joined {
            place,
            effect: Estimate {
                kind: lower.kind,
                values: with_multiples(&lower.values, &higher.values, number as usize),
            },
            bands_hz: all_hz,
            held_out_nats: one.held_out_nats,
        })
    })
}

/// The values of a tone with those amplitudes of another, of `number` times its base, that it has none of itself.
fn with_multiples(
    lower: &[Option<Value>],
    higher: &[Option<Value>],
    number: usize,
) -> Vec<Option<Value>> {
    let mut values = lower.to_vec();
    for (multiple, amplitude) in (1..).zip(&higher[FIRST_AMPLITUDE..]) {
        let place = FIRST_AMPLITUDE + multiple * number - 1;
        if amplitude.is_some() {
            values.resize(values.len().max(place + 1), None);
            values[place] = values[place].or(*amplitude);
        }
    }
    values
}
