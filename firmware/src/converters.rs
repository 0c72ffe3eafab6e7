//! Between the protocol and the driver of the converters: settings to registers, errors to troubles,
//! words to codes.

use ads1281::Error;
use ads1281::calibrate::Calibration;
use ads1281::config::Config;
use ads1281::register::{self, Config0, HPF_RESET, Output, SyncMode};
use ads1281::word::Word;
use inm_protocol::{AXES, Code, Filter, Phase, REGISTERS, Rate, Settings, Trouble};

// Registers of all converters cross the link as they are read.
const _: () = assert!(REGISTERS == register::REGISTERS && AXES == 3);

/// The configuration for `settings`. Synchronisation is by pulse: the three converters
/// share their clock, one edge aligns them for good.
pub const fn config(settings: Settings, calibration: Calibration) -> Config {
    let (phase, output, high_pass) = match settings.filter {
        Filter::Modulator => (Phase::Linear, Output::Modulator, HPF_RESET),
        Filter::Sinc => (Phase::Linear, Output::Sinc, HPF_RESET),
        Filter::Fir {
            phase,
            high_pass: None,
        } => (phase, Output::Fir, HPF_RESET),
        Filter::Fir {
            phase,
            high_pass: Some(word),
        } => (phase, Output::FirHighPass, word),
    };
    Config {
        config0: Config0 {
            sync: SyncMode::Pulse,
            rate: match settings.rate {
                Rate::Sps250 => register::Rate::Sps250,
                Rate::Sps500 => register::Rate::Sps500,
                Rate::Sps1000 => register::Rate::Sps1000,
                Rate::Sps2000 => register::Rate::Sps2000,
                Rate::Sps4000 => register::Rate::Sps4000,
            },
            phase: match phase {
                Phase::Linear => register::Phase::Linear,
                Phase::Minimum => register::Phase::Minimum,
            },
            output,
        },
        high_pass,
        calibration,
    }
}

/// Words a second that leave a converter under these settings, at
/// [`CLOCK_HZ`](ads1281::CLOCK_HZ).
pub fn conversions_hz(settings: Settings) -> u32 {
    config(settings, Calibration::default()).config0.words_hz()
}

/// An error of the driver as it is told to the host, which is not told what a bus calls its faults.
#[allow(clippy::needless_pass_by_value)] // for `map_err(trouble)`
pub fn trouble<B>(error: Error<B>) -> Trouble {
    match error {
        Error::WrongId { found } => Trouble::WrongId { found },
        Error::Verify {
            address,
            wrote,
            found,
        } => Trouble::RegisterLost {
            address: address as u8,
            wrote,
            found,
        },
        // Of the bus, a pin, or of the mode.
        _ => Trouble::Bus,
    }
}

/// A word as it goes over the link.
pub const fn code(word: Word) -> Code {
    Code(word.signed())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The useful values of CONFIG0 as tabulated for the part, not as computed here.
    #[test]
    fn settings_are_the_registers_of_the_table() {
        let linear = [0x42, 0x4A, 0x52, 0x5A, 0x62];
        for (rate, expected) in Rate::ALL.into_iter().zip(linear) {
            let with = |filter| config(Settings { rate, filter }, Calibration::default());
            let fir = |phase, high_pass| with(Filter::Fir { phase, high_pass });
            let minimum = fir(Phase::Minimum, None);
            let high_pass = fir(Phase::Linear, Some(0x19A));
            for (config, bits, word) in [
                (fir(Phase::Linear, None), expected, HPF_RESET),
                (minimum, expected + 4, HPF_RESET),
                (high_pass, expected + 1, 0x19A),
                (with(Filter::Sinc), expected - 1, HPF_RESET),
                (with(Filter::Modulator), expected - 2, HPF_RESET),
            ] {
                assert_eq!((config.config0.bits(), config.high_pass), (bits, word));
            }
        }
    }

    #[test]
    fn both_crates_mean_the_same_rates() {
        for rate in Rate::ALL {
            let filter = Filter::default();
            assert_eq!(conversions_hz(Settings { rate, filter }), rate.hz());
        }
    }
}
