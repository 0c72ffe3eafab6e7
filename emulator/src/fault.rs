//! Trouble that can be injected into a converter, each with the mechanism behind it.

use crate::Slip;

/// A fault of one converter or of its wiring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// DRDY stays high until RESET, while conversions go on: the output stage latched up, or the
    /// trace to the controller's interrupt pin is open.
    DrdyStops,
    /// DOUT reads as all ones or all zeros: shorted to a supply, or the part lost its digital
    /// supply and the line is pulled. DIN still works.
    BusStuck {
        /// All ones (true) or all zeros.
        high: bool,
        /// How many conversions it lasts; `None` is until RESET.
        conversions: Option<u32>,
    },
    /// From now on DIN is one bit late or early, and from the next word on DOUT is early or late: a
    /// glitch on SCLK clocked both registers once too often, or an edge was missed. The part
    /// understands no command, RESET included, and there is no CS that would realign it: it lasts
    /// until SCLK has been low for 64 conversions, or until the supply goes away.
    Slip(Slip),
    /// The input is driven to this value, whatever the signal: a shock, or a fault of the analog
    /// front end. Beyond 103 % of full scale the modulator saturates; the words are clean again
    /// 62 conversions after the end (SBAS378D page 12).
    Overload {
        /// Input in steps of the 31-bit code; full scale is +-2^30.
        input: i32,
        /// How many conversions it lasts.
        conversions: u32,
    },
    /// The supply dipped: registers at their defaults, read mode as after reset, conversions
    /// restarted at 1000/s. Nothing tells the driver but DRDY's silence of 63 ms and its new
    /// rate.
    BrownOut,
    /// The identity register reads as this: another part, or one that is damaged.
    WrongId(u8),
    /// The controller is held up ahead of its next word (a long interrupt, a debugger) for so
    /// long that the converter's update falls after `bits` bits of it: the word is torn.
    ///
    /// Time is common to the three converters: the others go on meanwhile, too.
    LateRead {
        /// Bits of the old word that get out, 1 to 31.
        bits: u8,
    },
    /// The controller's SPI peripheral reports an overrun, once, at the next transfer.
    BusError,
}

/// Faults that wait for their conversion.
#[derive(Debug, Clone, Default)]
pub(crate) struct Schedule {
    waiting: [Option<(u64, Fault)>; 8],
}

impl Schedule {
    /// Adds a fault; false if eight are waiting already.
    pub(crate) fn add(&mut self, conversion: u64, fault: Fault) -> bool {
        let Some(place) = self.waiting.iter_mut().find(|place| place.is_none()) else {
            return false;
        };
        *place = Some((conversion, fault));
        true
    }

    /// Takes out a fault that is due at this conversion.
    pub(crate) fn due(&mut self, conversion: u64) -> Option<Fault> {
        self.waiting
            .iter_mut()
            .find(|place| place.is_some_and(|(at, _)| at <= conversion))?
            .take()
            .map(|(_, fault)| fault)
    }
}
