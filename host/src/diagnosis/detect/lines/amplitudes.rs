//! Which of an effect's values are amplitudes of lines.

use crate::model::kind::Kind;
use crate::model::{hum, sinusoid, wandering_line};

/// Place of the first amplitude among the values of lines, that of its first multiple; the others follow in order. `None` for
/// what is none.
pub fn first(kind: Kind) -> Option<usize> {
    let kinds = [
        (sinusoid::KIND, sinusoid::AMPLITUDE),
        (hum::KIND, hum::FIRST_AMPLITUDE),
        (wandering_line::KIND, wandering_line::FIRST_AMPLITUDE),
    ];
    let mut places = kinds.into_iter();
    places.find_map(|(one, place)| (one == kind).then_some(place))
}
