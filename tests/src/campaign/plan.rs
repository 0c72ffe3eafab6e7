//! What happens in one run, drawn from its seed.

use inm_emulator::{Fault, Slip};
use inm_protocol::Rate;

use super::Dice;

/// Offsets of the axes, steps of the 31-bit value: around zero, where a word tells nothing of a
/// slip, and 0.16 g, -0.26 g and 1 g on the 4 g range.
const OFFSETS: [i32; 4] = [0, 21_000_000, -34_000_000, 132_000_000];

/// Longest run, conversions: room for several proofs between any two misfortunes.
const LONGEST: u64 = 5000;

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
    /// One frame in so many is lost, one in as many damaged; `None` for a sound link.
    pub loss: Option<u64>,
    /// The end.
    pub ending: Ending,
}

impl Plan {
    /// The plan of this seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let offsets = [(); 3].map(|()| dice.pick(&OFFSETS));
        let rate = dice.pick(&Rate::ALL);
        let count = 1 + dice.below(6);
        let mut misfortunes = Vec::new();
        let mut at = 100 + dice.below(600);
        for _ in 0..count {
            let act = act(&mut dice, &offsets);
            misfortunes.push(Misfortune { at, act });
            // Many fall into the time before the last one is noticed.
            at += if dice.one_in(3) {
                dice.below(1200)
            } else {
                dice.below(160)
            };
        }
        let loss = dice.one_in(3).then(|| 10 + dice.below(100));
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
            loss,
            ending,
        }
    }
}

fn act(dice: &mut Dice, offsets: &[i32; 3]) -> Act {
    let axis = dice.below(3) as usize;
    let slip = dice.pick(&[Slip::Early, Slip::Late]);
    match dice.below(16) {
        0..=5 => Act::Fault(axis, Fault::Slip(slip)),
        6 => Act::Fault(axis, Fault::DrdyStops),
        7 => Act::Fault(axis, Fault::BusError),
        8 => Act::Fault(axis, Fault::BrownOut),
        9 => {
            let high = dice.one_in(2);
            // Around zero one word of zeros is as good as any.
            let short = offsets[axis] != 0 && dice.one_in(2);
            let conversions = short.then(|| 1 + dice.below(12) as u32);
            Act::Fault(axis, Fault::BusStuck { high, conversions })
        }
        10 => {
            let bits = 1 + dice.below(31) as u8;
            Act::Fault(axis, Fault::LateRead { bits })
        }
        11 => Act::Fault(axis, Fault::WrongId(dice.pick(&[0x20, 0x5A, 0x00]))),
        12 => {
            let conversions = 1 + dice.below(50) as u32;
            let input = dice.pick(&[1_200_000_000, -1_200_000_000]);
            Act::Fault(axis, Fault::Overload { input, conversions })
        }
        13 => Act::Dead(axis, 50 + dice.below(1500)),
        14 => Act::HeldUp(1 + dice.below(200)),
        _ => Act::Outage(1 + dice.below(400)),
    }
}
