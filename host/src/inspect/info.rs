//! What a board is and in which state, without changing anything of it: a stream goes on.

use std::time::Duration;

use ads1281::register::FSC_UNITY;
use inm_protocol::{
    AXES, AxisCounters, Health, Identity, LinkCounters, Pulse, PulseCounters, REGISTERS, Request,
    Restart, SensorRange, Settings, VERSION,
};
use serde::Serialize;

use super::{AXIS_NAMES, Session, serial};
use crate::capture::ClockSource;
use crate::link::{LinkError, restarted};

/// How long to wait for a health record: two of the seconds between them, and slack for one that is
/// lost on the way.
pub(crate) const NEXT_HEALTH: Duration = Duration::from_millis(2500);

/// How long to wait for a pulse a second: one of the seconds between them, and slack for the way.
const NEXT_PULSE: Duration = Duration::from_millis(1200);

/// First of the three registers of the offset word (OFC), lowest byte first.
const OFFSET_WORD: usize = 5;

/// First of the three registers of the gain word (FSC), lowest byte first.
const GAIN_WORD: usize = 8;

/// A board, as `inm board info` tells it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Info {
    /// Port that it is on.
    pub port: String,
    /// Unique number of its microcontroller, 24 hexadecimal digits.
    pub serial: String,
    /// What its image was built for: `stm32f405`, `qemu`, `virtual`.
    pub platform: String,
    /// Release of its firmware.
    pub firmware: String,
    /// Release of this program.
    pub program: String,
    /// Protocol version that both speak.
    pub protocol: u8,
    /// Ticks of its stamps in a second.
    pub timer_hz: u32,
    /// Clock of the converters, hertz.
    pub converter_clock_hz: u32,
    /// Speed of its serial line, bit/s.
    pub baud: u32,
    /// Range of the accelerometers.
    pub range: SensorRange,
    /// Reference of the converters, volts.
    pub reference_v: f64,
    /// Nominal supply of the accelerometers, volts.
    pub sensor_supply_v: f64,
    /// Settings in force.
    pub settings: Settings,
    /// Why it last started.
    pub restart: Restart,
    /// The same, in words.
    pub restart_words: String,
    /// What its stamps run on.
    pub clock: ClockSource,
    /// The three axes.
    pub axes: [AxisInfo; AXES],
    /// Why the registers could not be read, in words; `None` where they were.
    pub registers_refused: Option<String>,
    /// What it last said of its state; `None` if it said nothing for 2.5 s.
    pub state: Option<State>,
    /// The pulse a second at its input; `None` if none came for 1.2 s.
    pub pulse: Option<PulseInfo>,
}

/// The pulse a second at a board's input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PulseInfo {
    /// When the last one came, seconds since the board started by its own clock.
    pub at_s: f64,
    /// Pulses since the board started.
    pub number: u32,
    /// What was wrong with them since then.
    pub counters: PulseCounters,
}

impl PulseInfo {
    fn of(pulse: &Pulse, timer_hz: u32) -> Self {
        Self {
            at_s: pulse.stamp as f64 / f64::from(timer_hz.max(1)),
            number: pulse.number,
            counters: pulse.counters,
        }
    }
}

/// One axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisInfo {
    /// X, Y or Z.
    pub name: &'static str,
    /// ID register of the converter; `None` where none has answered.
    pub converter_id: Option<u8>,
    /// Registers 00h to 0Ah; `None` where they could not be read.
    pub registers: Option<[u8; REGISTERS]>,
    /// Calibration; `None` where the registers could not be read.
    pub calibration: Option<Calibration>,
}

/// What the converter subtracts from each word, and by what it multiplies it then.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Calibration {
    /// Word of the offset registers, counts of 24 bits; 0 where it was not calibrated.
    pub offset: i32,
    /// Gain of the full-scale registers; 1 where it was not calibrated.
    pub gain: f64,
}

/// State of a board, from its health record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct State {
    /// Time since the board started, seconds by its own clock.
    pub up_s: f64,
    /// Whether samples are being sent.
    pub streaming: bool,
    /// Temperature of the microcontroller, degrees Celsius; `None` where it has no sensor.
    pub mcu_celsius: Option<f64>,
    /// Supply of the accelerometers, volts; `None` where it is not measured.
    pub supply_v: Option<f64>,
    /// Most stack ever used, bytes; 0 where it is not measured.
    pub stack_used: u32,
    /// Stack that there is, bytes.
    pub stack_size: u32,
    /// Trouble of X, Y, Z since the board started.
    pub axes: [AxisCounters; AXES],
    /// Trouble of the link since the board started.
    pub link: LinkCounters,
}

impl Info {
    /// Asks a board that has said who it is.
    ///
    /// # Errors
    /// What the link says. A board that cannot read its registers is no error: the result says why.
    pub fn ask(
        port: String,
        session: &mut Session,
        identity: &Identity,
    ) -> Result<Self, LinkError> {
        let (registers, registers_refused) = match session.ask(Request::ReadRegisters) {
            Ok(registers) => (Some(registers), None),
            Err(refused @ LinkError::Refused { .. }) => (None, Some(refused.to_string())),
            Err(error) => return Err(error),
        };
        let health = session.health(NEXT_HEALTH)?;
        let pulse = session.pulse(NEXT_PULSE)?;
        Ok(Self {
            port,
            serial: serial(identity),
            platform: identity.platform.to_string(),
            firmware: identity.firmware.to_string(),
            program: env!("CARGO_PKG_VERSION").to_owned(),
            protocol: VERSION,
            timer_hz: identity.timer_hz,
            converter_clock_hz: identity.converter_clock_hz,
            baud: identity.baud,
            range: identity.range,
            reference_v: f64::from(identity.reference_uv) * 1e-6,
            sensor_supply_v: f64::from(identity.sensor_supply_uv) * 1e-6,
            settings: identity.settings,
            restart: identity.restart.clone(),
            restart_words: restarted(&identity.restart),
            clock: ClockSource::of(identity),
            axes: axes(identity, registers),
            registers_refused,
            state: health.map(|(_, health)| State::of(&health, identity.timer_hz)),
            pulse: pulse.map(|pulse| PulseInfo::of(&pulse, identity.timer_hz)),
        })
    }
}

fn axes(identity: &Identity, registers: Option<[[u8; REGISTERS]; AXES]>) -> [AxisInfo; AXES] {
    std::array::from_fn(|axis| {
        let registers = registers.map(|all| all[axis]);
        AxisInfo {
            name: AXIS_NAMES[axis],
            converter_id: identity.converters[axis],
            registers,
            calibration: registers.as_ref().map(Calibration::of),
        }
    })
}

impl Calibration {
    /// What the registers of one converter hold.
    fn of(registers: &[u8; REGISTERS]) -> Self {
        let word = |at: usize| {
            let bytes = [registers[at], registers[at + 1], registers[at + 2], 0];
            u32::from_le_bytes(bytes)
        };
        Self {
            // Sign-extended from 24 bits.
            offset: (word(OFFSET_WORD) << 8).cast_signed() >> 8,
            gain: f64::from(word(GAIN_WORD)) / f64::from(FSC_UNITY),
        }
    }
}

impl State {
    fn of(health: &Health, timer_hz: u32) -> Self {
        Self {
            up_s: health.stamp as f64 / f64::from(timer_hz.max(1)),
            streaming: health.streaming,
            mcu_celsius: health
                .mcu_centi_celsius
                .map(|centi| f64::from(centi) / 100.0),
            supply_v: health.supply_mv.map(|mv| f64::from(mv) / 1000.0),
            stack_used: health.stack_used,
            stack_size: health.stack_size,
            axes: health.axes,
            link: health.link,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calibration_words_are_read_lowest_byte_first_and_with_their_sign() {
        let mut registers = [0; REGISTERS];
        registers[5..8].copy_from_slice(&[0xFE, 0xFF, 0xFF]);
        registers[8..11].copy_from_slice(&[0x00, 0x00, 0x60]);
        let found = Calibration::of(&registers);
        assert_eq!(
            found,
            Calibration {
                offset: -2,
                gain: 1.5
            }
        );
        registers[5..8].copy_from_slice(&[0x00, 0x01, 0x00]);
        assert_eq!(Calibration::of(&registers).offset, 256);
    }
}
