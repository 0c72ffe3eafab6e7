//! What kinds of misfortune there are, and in what company they come.

use std::fmt;

use inm_emulator::{Fault, Slip};

use super::{Act, Dice, Link};

/// One kind of misfortune.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The bits of an axis slip by one.
    Slip,
    /// DRDY of an axis stops until its reset.
    DrdyStops,
    /// The bus of an axis reports a fault.
    BusError,
    /// An axis loses its registers.
    BrownOut,
    /// The bus of an axis reads all ones or zeros.
    Stuck,
    /// A word is read too late.
    LateRead,
    /// Another identity.
    WrongId,
    /// An input beyond full scale.
    Overload,
    /// DRDY of an axis is dead for a while, whatever is done.
    Dead,
    /// The board stands still.
    HeldUp,
    /// The port is away.
    Outage,
}

/// How often each kind comes in company: slips most, which are the hardest to notice.
pub(super) const COMPANY: [Kind; 16] = [
    Kind::Slip,
    Kind::Slip,
    Kind::Slip,
    Kind::Slip,
    Kind::Slip,
    Kind::Slip,
    Kind::DrdyStops,
    Kind::BusError,
    Kind::BrownOut,
    Kind::Stuck,
    Kind::LateRead,
    Kind::WrongId,
    Kind::Overload,
    Kind::Dead,
    Kind::HeldUp,
    Kind::Outage,
];

impl Kind {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Slip,
        Self::DrdyStops,
        Self::BusError,
        Self::BrownOut,
        Self::Stuck,
        Self::LateRead,
        Self::WrongId,
        Self::Overload,
        Self::Dead,
        Self::HeldUp,
        Self::Outage,
    ];

    /// One of this kind, on axes with these levels.
    pub(super) fn act(self, dice: &mut Dice, offsets: &[i32; 3]) -> Act {
        let axis = dice.below(3) as usize;
        match self {
            Self::Slip => {
                let slip = dice.pick(&[Slip::Early, Slip::Late]);
                Act::Fault(axis, Fault::Slip(slip))
            }
            Self::DrdyStops => Act::Fault(axis, Fault::DrdyStops),
            Self::BusError => Act::Fault(axis, Fault::BusError),
            Self::BrownOut => Act::Fault(axis, Fault::BrownOut),
            Self::Stuck => {
                let high = dice.one_in(2);
                // Around zero one word of zeros is as good as any.
                let short = offsets[axis] != 0 && dice.one_in(2);
                let conversions = short.then(|| 1 + dice.below(12) as u32);
                Act::Fault(axis, Fault::BusStuck { high, conversions })
            }
            Self::LateRead => {
                let bits = 1 + dice.below(31) as u8;
                Act::Fault(axis, Fault::LateRead { bits })
            }
            Self::WrongId => Act::Fault(axis, Fault::WrongId(dice.pick(&[0x20, 0x5A, 0x00]))),
            Self::Overload => {
                let conversions = 1 + dice.below(50) as u32;
                let input = dice.pick(&[1_200_000_000, -1_200_000_000]);
                Act::Fault(axis, Fault::Overload { input, conversions })
            }
            Self::Dead => Act::Dead(axis, 50 + dice.below(1500)),
            Self::HeldUp => Act::HeldUp(1 + dice.below(200)),
            Self::Outage => Act::Outage(1 + dice.below(400)),
        }
    }
}

/// In what company misfortunes come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// One of this kind, alone.
    Single(Kind),
    /// Up to six of any kind, on a link that may lose frames.
    Company,
    /// The same on a link that flips bits, loses bytes and adds some.
    Dirty,
    /// The same on a link on which frames come twice and change places.
    OutOfPlace,
}

impl Class {
    /// The link of one run.
    pub(super) fn link(self, dice: &mut Dice) -> Link {
        match self {
            Self::Single(_) => Link::Sound,
            Self::Company if dice.one_in(3) => Link::Lossy(10 + dice.below(100)),
            Self::Company => Link::Sound,
            // A batch takes 423 bytes: from every other one to one in fifty.
            Self::Dirty => Link::Dirty(500 + dice.below(20_000)),
            Self::OutOfPlace => Link::OutOfPlace(3 + dice.below(60)),
        }
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Single(Kind::Slip) => "slipped bit",
            Self::Single(Kind::DrdyStops) => "DRDY stops",
            Self::Single(Kind::BusError) => "bus error",
            Self::Single(Kind::BrownOut) => "brown-out",
            Self::Single(Kind::Stuck) => "bus stuck",
            Self::Single(Kind::LateRead) => "late read",
            Self::Single(Kind::WrongId) => "wrong ID",
            Self::Single(Kind::Overload) => "overload",
            Self::Single(Kind::Dead) => "DRDY dead for long",
            Self::Single(Kind::HeldUp) => "board held up",
            Self::Single(Kind::Outage) => "port away",
            Self::Company => "any in company",
            Self::Dirty => "in company, dirty link",
            Self::OutOfPlace => "in company, frames out of place",
        })
    }
}
