//! What was suspected and not found, in sentences.

use super::rivals::rival;
use crate::diagnosis::result::suspicion::{Best, Limit, Suspicion};
use crate::numeric::written::{probability, significant};
use crate::signal::Unit;

/// Of the limits one in so many is told: they stand an octave apart, and JSON has all.
const ONE_IN: usize = 3;

/// What there is to say of a kind, each without a full stop.
pub fn suspicion(one: &Suspicion, unit: Unit) -> Vec<String> {
    let mut sentences: Vec<String> = one.best.iter().flat_map(best).collect();
    if one.best.is_none() {
        sentences.push("no odds: the spectrum's shape has no candidate of this kind".to_owned());
    }
    sentences.push(if one.limits.is_empty() {
        "no limit is computed for this kind".to_owned()
    } else {
        limits(one, unit)
    });
    sentences
}

fn best(best: &Best) -> Vec<String> {
    let values = best.parameters.iter();
    let values: Vec<String> = values
        .map(|(name, value)| format!("{name} {}", significant(*value, 3)))
        .collect();
    let mut sentences = vec![format!(
        "the likeliest, {}, gains {} nats where a name needs {} (by chance: {})",
        values.join(", "),
        significant(best.gain_nats, 2),
        significant(best.needed_nats, 3),
        probability(best.p_value)
    )];
    if best.gain_nats >= best.needed_nats {
        sentences.push(
            "as much is enough for a name: something else spoke against it, or explains it better"
                .to_owned(),
        );
    }
    sentences.extend(best.rivals.iter().map(rival));
    sentences
}

/// The sizes that the record still allows.
fn limits(one: &Suspicion, unit: Unit) -> String {
    let told: Vec<String> = one.limits.iter().step_by(ONE_IN).map(limit).collect();
    let size = &one.limits[0].size;
    let parameters = one.effect.parameters(&[]);
    let known = parameters.iter().find(|one| one.name == size.as_str());
    let unit = known.map_or(String::new(), |one| one.quantity.unit(unit));
    format!("{size} in {unit} at most, 95 %: {}", told.join(", "))
}

fn limit(one: &Limit) -> String {
    let at: Vec<String> = one
        .at
        .iter()
        .map(|(name, value)| format!("{name} {}", significant(*value, 3)))
        .collect();
    let upper = one
        .upper
        .map_or_else(|| "any".to_owned(), |upper| significant(upper, 3));
    format!("{upper} at {}", at.join(", "))
}
