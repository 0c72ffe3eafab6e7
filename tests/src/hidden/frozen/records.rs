//! The list of records.

use super::change::Change;
use super::record::Frozen;
use crate::hidden::case::Plan;
use crate::hidden::draw::Draw;
use crate::hidden::effect::{self, Kind};
use crate::hidden::judge::trial::Task;
use crate::hidden::outside;
use crate::hidden::strength::Strength;

/// Samples of the first record of a kind, and of all that are not of another length on purpose:
/// the judge's least with room for every effect. The whole list is to take a minute or two.
const SAMPLES: usize = 1 << 16;
/// Samples of the second record of a kind: other lengths of transforms and blocks.
const MORE: usize = 3 << 15;

/// Multiples of what an ideal detector needs: from hardly seen to plain, for what is nearly
/// missed changes first.
const STRENGTH: Strength = Strength::Between(1.5, 10.0);

/// Samples of short records: the least that is diagnosed, a prime, and a little more.
const SHORT: [usize; 3] = [1 << 13, 10_007, 3 << 12];

/// Records whose answer is not frozen yet, and why.
pub const NOT_YET: [(&str, &str); 6] = [
    ("garch-1", NEW),
    ("garch-2", NEW),
    ("chirp-1", NEW),
    ("chirp-2", NEW),
    ("drifting_corner-1", NEW),
    ("drifting_corner-2", NEW),
];

/// It came with the wide draw, and no answer to it was looked at.
const NEW: &str = "new";

/// Whether the answer to this record is frozen.
pub fn is_frozen(name: &str) -> bool {
    NOT_YET.iter().all(|(not_yet, _)| *not_yet != name)
}

/// Everything that is frozen, under names that stay.
pub fn records() -> Vec<Frozen> {
    let mut all = Vec::new();
    for kind in effect::KINDS {
        all.push(Frozen::one(task(&[kind.name], SAMPLES, 1), Change::None));
        all.push(Frozen::one(task(&[kind.name], MORE, 2), Change::None));
    }
    for names in [
        ["hum", "steps"],
        ["sinusoid", "outliers"],
        ["markov", "stale"],
        ["thermal", "hum"],
        ["rolloff", "outliers"],
    ] {
        all.push(Frozen::one(task(&names, SAMPLES, 1), Change::None));
    }
    for kind in outside::KINDS {
        all.push(Frozen::one(task(&[kind.name], SAMPLES, 1), Change::None));
        all.push(Frozen::one(task(&[kind.name], MORE, 2), Change::None));
    }
    for seed in 1..=3 {
        all.push(Frozen::one(task(&[], SAMPLES, seed), Change::None));
    }
    all.extend(changed());
    all.extend(odd());
    all.extend(three_axes());
    all
}

/// Records that were shortened, rounded to codes, holed, or come with something beside them.
fn changed() -> Vec<Frozen> {
    let mut all = Vec::new();
    for samples in SHORT {
        let change = Change::First(samples);
        all.push(Frozen::one(task(&["sinusoid"], SAMPLES, 3), change));
    }
    for (names, steps) in [(&[][..], 0.02), (&["markov"], 0.1), (&["hum"], 1.5)] {
        let change = Change::Codes { steps };
        all.push(Frozen::one(task(names, SAMPLES, 4), change));
    }
    for (names, stretches, single) in [
        (&[][..], 0, 5),
        (&["steps"], 3, 0),
        (&["hum"], 2, 40),
        (&["burst"], 6, 10),
    ] {
        let change = Change::Gaps { stretches, single };
        all.push(Frozen::one(task(names, SAMPLES, 5), change));
    }
    for (names, beside) in [(&["warmup"][..], "thermal"), (&["hum"], "timebase")] {
        let beside = task(&[beside], SAMPLES, 6);
        let change = Change::Beside(beside);
        all.push(Frozen::one(task(names, SAMPLES, 6), change));
    }
    all
}

/// Lengths that are no product of 2, 3 and 5, with and without bad samples in them; two of them
/// prime.
fn odd() -> Vec<Frozen> {
    [
        (&[][..], false),
        (&["resonance"], true),
        (&["stale"], false),
        (&["clipping"], true),
        (&["outliers"], false),
    ]
    .into_iter()
    .zip(1..)
    .map(|((names, prime), seed)| {
        let samples = odd_length(prime, seed);
        Frozen::one(task(names, samples, seed), Change::Length)
    })
    .collect()
}

/// Records of three axes that share nothing, all without a chain.
fn three_axes() -> Vec<Frozen> {
    [["", "markov", "hum"], ["steps", "", "telegraph"]]
        .into_iter()
        .map(|axes| {
            let task = |name: &str| match name {
                "" => task(&[], SAMPLES, 1),
                name => task(&[name], SAMPLES, 1),
            };
            Frozen::axes(axes.map(task).into())
        })
        .collect()
}

fn task(names: &[&str], samples: usize, seed: u64) -> Task {
    let kind = |name: &&str| -> &'static Kind {
        let kind = effect::find(name).or_else(|| outside::find(name));
        kind.expect("the list holds names of kinds")
    };
    let plan = Plan {
        kinds: names.iter().map(kind).collect(),
        strength: STRENGTH,
        samples,
    };
    Task { plan, seed }
}

/// A length drawn at random that has a prime factor beyond 5, or is prime itself.
fn odd_length(prime: bool, seed: u64) -> usize {
    let mut draw = Draw::new(seed, "length");
    loop {
        let length = SAMPLES + draw.index(SAMPLES / 2);
        let is_odd = match prime {
            true => (2..)
                .take_while(|i| i * i <= length)
                .all(|i| !length.is_multiple_of(i)),
            false => {
                let left = [2, 3, 5].into_iter().fold(length, without);
                left > 1
            }
        };
        if is_odd {
            break length;
        }
    }
}

/// `number` without its factors `factor`.
fn without(mut number: usize, factor: usize) -> usize {
    while number.is_multiple_of(factor) {
        number /= factor;
    }
    number
}
