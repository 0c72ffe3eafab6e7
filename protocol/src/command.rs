//! Host to board, and the board's answers.

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use crate::{AXES, REGISTERS, SensorCalibration, SensorRange, Settings, Trouble};

/// A request with the number by which its reply is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Command {
    /// Chosen by the host, repeated in the [`Reply`]; that of a [`Request::Start`] is the number of its
    /// stream, and not 0.
    pub id: u16,
    /// What is asked for.
    pub request: Request,
}

/// What the host can ask for. Every request is answered, or the host times out and sends the same
/// command again: one that equals the last, number and all, is not carried out a second time, its
/// reply is sent again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Request {
    /// Who are you? Answered by [`Answer::Identity`], in any state.
    Identify,
    /// Configure the converters, synchronise them and stream from index 0.
    Start,
    /// Stop streaming.
    Stop,
    /// Change data rate and filter. Refused while streaming, and where the link cannot carry it.
    Configure(Settings),
    /// Offset calibration (OFSCAL) of all axes. Refused while streaming.
    CalibrateOffset,
    /// Gain calibration (GANCAL) of all axes. Refused while streaming.
    CalibrateGain,
    /// Drive the sensors' self-test pin and measure the step. Refused while streaming.
    SelfTest,
    /// Read every register of every converter; while streaming, tell what the start read back, and
    /// each that has been read back since.
    ReadRegisters,
    /// Restart the microcontroller, after the reply has left.
    Reset,
    /// Begin the board's bins anew at a conversion to come, so that a host that has lost a
    /// batch can compare again. Answered by [`Answer::BinsEpoch`].
    RestartBins,
    /// Switch the accelerometers to a range, until the board restarts. Refused while streaming.
    SelectRange(SensorRange),
    /// Tell the calibration of the accelerometers that is kept for a range. Answered by
    /// [`Answer::SensorCalibration`], in any state.
    ReadSensorCalibration(SensorRange),
    /// Keep this calibration in place of that of its range. Refused while streaming; takes up to 5 s on
    /// the board, which does nothing else meanwhile.
    WriteSensorCalibration(SensorCalibration),
    /// Keep no calibration of this range any more. As [`Self::WriteSensorCalibration`].
    EraseSensorCalibration(SensorRange),
}

/// Answer to the [`Command`] with the same number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reply {
    /// Number of the command.
    pub id: u16,
    /// The answer, or why there is none.
    pub result: Result<Answer, Refusal>,
}

/// A request that was carried out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Answer {
    /// Done, nothing to tell.
    Done,
    /// To [`Request::Identify`].
    Identity(Identity),
    /// To [`Request::Configure`] and [`Request::Start`]: the settings now in force.
    Settings(Settings),
    /// To [`Request::ReadRegisters`]: 00h to 0Ah of X, Y, Z.
    Registers([[u8; REGISTERS]; AXES]),
    /// To the calibrations: the OFC (sign-extended) or FSC words found, X, Y, Z.
    Calibration([i32; AXES]),
    /// To [`Request::SelfTest`].
    SelfTest([SelfTestStep; AXES]),
    /// To [`Request::RestartBins`].
    BinsEpoch {
        /// Conversion with which the bins begin, about a second ahead; 0 when not streaming,
        /// since the bins of every stream begin with it.
        index: u64,
    },
    /// To [`Request::ReadSensorCalibration`]: `None` where none is kept.
    SensorCalibration(Option<SensorCalibration>),
}

/// Mean code of one axis with the self-test pin low and high.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct SelfTestStep {
    /// Mean code at rest.
    pub rest: i32,
    /// Mean code with self-test on.
    pub driven: i32,
}

/// Why a request was not carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Refusal {
    /// Stop the stream first.
    Streaming,
    /// The link cannot carry these settings.
    LinkTooSlow {
        /// What they need, bytes a second.
        needed: u32,
        /// What the link carries, bytes a second.
        available: u32,
    },
    /// Three 32-bit words cannot be read within one period of this data rate.
    BusTooSlow {
        /// Conversions a second that were asked for.
        asked: u32,
        /// Conversions a second that the bus can read.
        readable: u32,
    },
    /// A converter did not do what was asked.
    Converter {
        /// Axis, 0 to 2.
        axis: u8,
        /// What happened.
        trouble: Trouble,
    },
    /// What was to be kept is no calibration: a scale or gravity is not above zero.
    Unsound,
    /// The memory for what is kept could not be erased or written. What was kept before, is.
    NotKept,
}

/// Who the board is. The host asks before anything else.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Unique number of the microcontroller.
    pub serial: [u32; 3],
    /// Firmware version, as in its Cargo.toml.
    pub firmware: String<16>,
    /// What the image was built for: `stm32f405`, `qemu`, `virtual`.
    pub platform: String<16>,
    /// Ticks of the stamp timer in a second.
    pub timer_hz: u32,
    /// Clock of the converters, hertz.
    pub converter_clock_hz: u32,
    /// Link speed, bit/s; ten bits make a byte.
    pub baud: u32,
    /// Range of the accelerometers.
    pub range: SensorRange,
    /// Reference voltage of the converters, microvolts.
    pub reference_uv: u32,
    /// Nominal supply of the accelerometers, microvolts.
    pub sensor_supply_uv: u32,
    /// ID registers of X, Y, Z as found at power-on or, since then, when a configuration was
    /// verified; `None` where no converter has answered.
    pub converters: [Option<u8>; AXES],
    /// Settings in force.
    pub settings: Settings,
    /// Why the board last started.
    pub restart: Restart,
}

/// Why the microcontroller started.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Restart {
    /// Power came on, or the reset pin.
    #[default]
    Power,
    /// [`Request::Reset`].
    Command,
    /// The main loop hung and the watchdog bit.
    Watchdog,
    /// The firmware panicked: line, and the end of the source file's name.
    Panic {
        /// Line in the source file.
        line: u32,
        /// End of the file's path.
        file: Vec<u8, 32>,
    },
    /// Power came on, but the clock did not start: the board runs on its internal oscillator.
    ClockFallback,
    /// As [`Self::ClockFallback`], after [`Request::Reset`].
    CommandClockFallback,
    /// As [`Self::ClockFallback`], after the watchdog bit.
    WatchdogClockFallback,
    /// As [`Self::ClockFallback`], after a panic.
    PanicClockFallback {
        /// Line in the source file.
        line: u32,
        /// End of the file's path.
        file: Vec<u8, 32>,
    },
}

impl Restart {
    /// The same reason on a board whose clock did not start: neither hides the other.
    #[must_use]
    pub fn on_internal_oscillator(self) -> Self {
        match self {
            Self::Power => Self::ClockFallback,
            Self::Command => Self::CommandClockFallback,
            Self::Watchdog => Self::WatchdogClockFallback,
            Self::Panic { line, file } => Self::PanicClockFallback { line, file },
            already => already,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_does_not_start_is_told_whatever_the_restart_was() {
        let file: Vec<u8, 32> = b"main.rs".iter().copied().collect();
        let panicked = Restart::Panic {
            line: 7,
            file: file.clone(),
        };
        let reasons = [
            Restart::Power,
            Restart::Command,
            Restart::Watchdog,
            panicked,
        ];
        let told = reasons.clone().map(Restart::on_internal_oscillator);
        for (k, reason) in reasons.iter().enumerate() {
            assert_ne!(*reason, told[k]);
            // The reason shows through: no two are told alike.
            assert!(!told[..k].contains(&told[k]), "{told:?}");
            assert_eq!(told[k].clone().on_internal_oscillator(), told[k]);
        }
        assert_eq!(told[3], Restart::PanicClockFallback { line: 7, file });
    }
}
