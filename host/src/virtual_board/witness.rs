//! The words of the converters, as witnessed at their pins: what is true, for who tests what arrives.

use std::sync::{Arc, Mutex};

use inm_emulator::Bench;
use inm_protocol::AXES;

use super::shaken::Shaken;

/// Words that the converters produced, X Y Z, as witnessed at their pins.
pub type Witness = Arc<Mutex<Vec<[u32; AXES]>>>;

/// The same, a list an axis: a converter that was reset has made fewer than the others.
pub type AxisWitness = Arc<Mutex<[Vec<u32>; AXES]>>;

/// Notes down the words that all three converters have made since the last time.
pub(super) fn note_words(bench: &Bench<Shaken>, words: &mut u64, witness: &Witness) {
    let made = (0..AXES)
        .map(|axis| bench.sent(axis).words())
        .min()
        .unwrap_or(0);
    if made == *words {
        return;
    }
    let Ok(mut list) = witness.lock() else { return };
    for index in *words..made {
        list.push([0, 1, 2].map(|axis| bench.word(axis, index).unwrap_or(0)));
    }
    *words = made;
}

/// Notes down the words that each converter has made since the last time.
pub(super) fn note_by_axis(bench: &Bench<Shaken>, noted: &mut [u64; AXES], witness: &AxisWitness) {
    let made = [0, 1, 2].map(|axis| bench.sent(axis).words());
    if made == *noted {
        return;
    }
    let Ok(mut lists) = witness.lock() else {
        return;
    };
    for (axis, list) in lists.iter_mut().enumerate() {
        let new = noted[axis]..made[axis];
        list.extend(new.map(|index| bench.word(axis, index).unwrap_or(0)));
    }
    *noted = made;
}
