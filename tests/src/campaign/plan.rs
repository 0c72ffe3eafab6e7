//! What happens in one run, drawn from its seed.

use inm_emulator::Fault;
use inm_protocol::Rate;

use super::class::COMPANY;
use super::{Class, Dice, Link};

/// Offsets of the axes, steps of the 31-bit value: around zero, where a word tells nothing of a
/// slip, and 0.16 g, -0.26 g and 1 g on the 4 g range.
const OFFSETS: [i32; 4] = [0, 21_000_000, -34_000_000, 132_000_000];

/// Longest run, conversions: room for several proofs between any two misfortunes.
const LONGEST: u64 = 5000;

/// Conversions after a single misfortune: the longest death, and the rests between the attempts to
/// recover from it, the last of which may be as long as all before.
const TO_RECOVER: u64 = 4500;

/// One thing that happens.
#[derive(Debug, Clone, Copy)]
pub enum Act {
    /// To one axis.
    Fault(usize, Fault),
    /// DRDY of an axis is dead from now on, whatever is done about it, for so many conversions.
    Dead(usize, u64),
    /// Nothing runs on the board for so many conversions.
    HeldUp(u64),
    /// All frames are lost for so many conversions.
    Outage(u64),
}

/// When something happens.
#[derive(Debug, Clone, Copy)]
pub struct Misfortune {
    /// Data periods since the stream began.
    pub at: u64,
    /// What.
    pub act: Act,
}

/// How the stream ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The host stops it and waits for the answer.
    Stopped,
    /// The host hears nothing more.
    Cut,
    /// The host stops it, starts it again, and stops that, too.
    Again,
}

/// One run.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Its seed.
    pub seed: u64,
    /// Data rate.
    pub rate: Rate,
    /// Level of each axis, steps of the 31-bit value.
    pub offsets: [i32; 3],
    /// Conversions.
    pub length: u64,
    /// In the order of time.
    pub misfortunes: Vec<Misfortune>,
    /// The link to the host.
    pub link: Link,
    /// The end.
    pub ending: Ending,
}

impl Plan {
    /// The plan of this seed: some misfortunes, on a link that loses frames one time in three.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self::of(Class::Company, seed)
    }

    /// The plan of this class and seed.
    #[must_use]
    pub fn of(class: Class, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let offsets = [(); 3].map(|()| dice.pick(&OFFSETS));
        let rate = dice.pick(&Rate::ALL);
        if let Class::Single(kind) = class {
            let at = 100 + dice.below(600);
            let act = kind.act(&mut dice, &offsets);
            return Self {
                seed,
                rate,
                offsets,
                length: at + TO_RECOVER,
                misfortunes: vec![Misfortune { at, act }],
                link: Link::Sound,
                ending: Ending::Stopped,
            };
        }
        let count = 1 + dice.below(6);
        let mut misfortunes = Vec::new();
        let mut at = 100 + dice.below(600);
        for _ in 0..count {
            let kind = dice.pick(&COMPANY);
            let act = kind.act(&mut dice, &offsets);
            misfortunes.push(Misfortune { at, act });
            // Many fall into the time before the last one is noticed.
            at += if dice.one_in(3) {
                dice.below(1200)
            } else {
                dice.below(160)
            };
        }
        let link = class.link(&mut dice);
        let ending = dice.pick(&[Ending::Stopped, Ending::Stopped, Ending::Cut, Ending::Again]);
        // Some streams end before the last misfortune is noticed.
        let after = if dice.one_in(3) {
            dice.below(200)
        } else {
            600 + dice.below(1200)
        };
        Self {
            seed,
            rate,
            offsets,
            length: (at + after).min(LONGEST),
            misfortunes,
            link,
            ending,
        }
    }
}
