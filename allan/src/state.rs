//! The state of the bins as a sequence of words, so that a recording can be resumed and its parts be
//! computed apart.
//!
//! Through serde a state is one sequence of `u64`; with postcard that is a length and as many
//! varints. The words are
//!
//! ```text
//! version (1), LEVELS
//! first, next, start, samples, end of the first run (all ones while it goes on)
//! running sum and sum of sums, two words each, lowest first
//! the ground's and each level's accumulators: for Allan, modified and Hadamard the number of terms
//!     and the 3, 4 and 3 limbs of the sum, lowest first
//! the knots of the history that the current run has, then those of the head: ground by index,
//!     then each level by index; a knot is its sum's low word, its double sum's low word, and the
//!     16 and 48 bits above them in one word, the double sum's in the lower part
//! ```
//!
//! Two states that compare equal have the same words. Reading checks what the code relies on and
//! never panics; a state made up with care can hold wrong numbers, not wrong memory.

use core::fmt;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeSeq, Serializer};

use crate::bins::Bins;
use crate::engine::LAST_INDEX;
use crate::history::History;
use crate::knot::{PairKnot, PairSums};
use crate::sums::{FamilySums, Sum};

/// Version of the sequence of words.
const VERSION: u64 = 1;
/// The first run has not ended.
const OPEN: u64 = u64::MAX;

impl<const LEVELS: usize> Bins<LEVELS> {
    /// Calls `visit` with each word of the state.
    fn for_each_word(&self, visit: &mut impl FnMut(u64)) {
        let engine = &self.engine;
        let PairSums { sum, double } = engine.running;
        let halves = |value: u128| [value as u64, (value >> 64) as u64];
        [
            VERSION,
            LEVELS as u64,
            engine.first,
            engine.next,
            engine.start,
            engine.samples,
        ]
        .into_iter()
        .chain([self.head.end.unwrap_or(OPEN)])
        .chain(halves(sum))
        .chain(halves(double))
        .for_each(&mut *visit);
        for sums in engine.ground.iter().chain(engine.levels.iter().flatten()) {
            crate::sums::Sums::fold_words(sums, (), |(), word| visit(word));
        }
        for (level, index) in History::<PairKnot, LEVELS>::slots(engine.next, engine.start) {
            let knot = engine.history.get_for(level, engine.next, index);
            knot.to_words().into_iter().for_each(&mut *visit);
        }
        for (level, index) in self.head.slots(engine.next) {
            let knot = self.head.get_for(level, index);
            knot.to_words().into_iter().for_each(&mut *visit);
        }
    }

    /// The state that a sequence of words describes.
    fn from_words<E: Error>(mut word: impl FnMut() -> Result<u64, E>) -> Result<Self, E> {
        let (version, levels) = (word()?, word()?);
        if version != VERSION {
            return Err(E::custom(format_args!(
                "state of version {version}, this program reads {VERSION}"
            )));
        }
        if levels != LEVELS as u64 {
            return Err(E::custom(format_args!(
                "state of {levels} levels where {LEVELS} belong"
            )));
        }
        let [first, next, start, samples, end] = [word()?, word()?, word()?, word()?, word()?];
        if !positions_fit([first, next, start, samples, end]) {
            return Err(E::custom("state whose positions contradict each other"));
        }
        let mut whole = || Ok(u128::from(word()?) | u128::from(word()?) << 64);
        let running = PairSums {
            sum: whole()?,
            double: whole()?,
        };

        let mut bins = Self::starting_at(first);
        let engine = &mut bins.engine;
        (engine.next, engine.start, engine.samples) = (next, start, samples);
        engine.running = running;
        for sums in engine
            .ground
            .iter_mut()
            .chain(engine.levels.iter_mut().flatten())
        {
            *sums = FamilySums {
                allan: sum_from_words(samples, &mut word)?,
                modified: sum_from_words(samples, &mut word)?,
                hadamard: sum_from_words(samples, &mut word)?,
            };
        }
        for (level, index) in History::<PairKnot, LEVELS>::slots(next, start) {
            let knot = PairKnot::from_words([word()?, word()?, word()?]);
            match level {
                0 => engine.history.put(index, knot),
                _ => engine.history.put_level(level, index, knot),
            }
        }
        bins.head.end = (end != OPEN).then_some(end);
        for (level, index) in bins.head.slots(next) {
            bins.head.put(
                level,
                index,
                PairKnot::from_words([word()?, word()?, word()?]),
            );
        }
        Ok(bins)
    }
}

/// Whether first, next, start, samples and end of a state can be true together.
const fn positions_fit([first, next, start, samples, end]: [u64; 5]) -> bool {
    first <= start
        && start <= next
        && next <= LAST_INDEX
        && samples <= next - first
        && samples >= next - start
        && if end == OPEN {
            start == first
        } else {
            first <= end && end < start
        }
}

/// One accumulator, with room left for all that can still be added to it.
fn sum_from_words<const LIMBS: usize, E: Error>(
    samples: u64,
    word: &mut impl FnMut() -> Result<u64, E>,
) -> Result<Sum<LIMBS>, E> {
    let terms = word()?;
    let mut limbs = [0; LIMBS];
    for limb in &mut limbs {
        *limb = word()?;
    }
    if terms > samples || limbs[LIMBS - 1] >> 48 != 0 {
        return Err(E::custom("state with an impossible sum of squares"));
    }
    Ok(Sum::from_parts(terms, limbs))
}

impl<const LEVELS: usize> Serialize for Bins<LEVELS> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut count = 0;
        self.for_each_word(&mut |_| count += 1);
        let mut sequence = serializer.serialize_seq(Some(count))?;
        let mut outcome = Ok(());
        self.for_each_word(&mut |word| {
            if outcome.is_ok() {
                outcome = sequence.serialize_element(&word);
            }
        });
        outcome?;
        sequence.end()
    }
}

impl<'de, const LEVELS: usize> Deserialize<'de> for Bins<LEVELS> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Words::<LEVELS>)
    }
}

struct Words<const LEVELS: usize>;

impl<'de, const LEVELS: usize> Visitor<'de> for Words<LEVELS> {
    type Value = Bins<LEVELS>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the words of a state of {LEVELS} levels")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut words: A) -> Result<Self::Value, A::Error> {
        let bins = Bins::from_words(|| {
            words
                .next_element()?
                .ok_or_else(|| A::Error::custom("state that ends too early"))
        })?;
        match words.next_element::<u64>()? {
            None => Ok(bins),
            Some(_) => Err(A::Error::custom("state with words left over")),
        }
    }
}
