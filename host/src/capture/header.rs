//! What a capture says about itself.

use std::path::Path;

use inm_firmware::mma7331l::Scaling;
use inm_protocol::image::BOARD;
use inm_protocol::{
    AXES, Filter, Identity, REGISTERS, Restart, SensorCalibration, SensorRange, Settings, VERSION,
};
use serde::{Deserialize, Serialize};

use super::CaptureError;
use crate::chain::Chain;
use crate::signal::{Axis, Signal, Unit};

/// The second line of a capture, one JSON object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Protocol version of the frames.
    pub protocol: u8,
    /// Release of the program that wrote the file.
    pub inm: String,
    /// Wall clock when streaming was started, RFC 3339.
    pub created: String,
    /// Samples a second.
    pub rate_hz: f64,
    /// Who recorded.
    pub board: BoardHeader,
    /// How the converters were set up.
    pub settings: Settings,
    /// Registers 00h to 0Ah of each converter.
    pub registers: [[u8; REGISTERS]; AXES],
    /// What they are of.
    #[serde(default)]
    pub registers_of: RegistersOf,
    /// What the board keeps of its accelerometers on this range, if the axes are by it: their scale is the
    /// diagonal of its rows and their zero its own. `None` where they are by the data sheets.
    #[serde(default)]
    pub calibration: Option<SensorCalibration>,
    /// The axes in the order of the codes.
    pub axes: Vec<AxisHeader>,
}

/// What the registers of a header are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RegistersOf {
    /// The record: read back behind its start, which writes the settings.
    Record,
    /// The time before its start, whose settings they may not hold: firmware that does not tell them
    /// while it streams, and captures from before this was asked.
    #[default]
    BeforeTheStart,
}

/// What the board's own clock runs on, by which its stamps are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClockSource {
    /// Its crystal, good to some 50 parts in a million.
    Crystal,
    /// The oscillator inside the microcontroller, good to 1 %: the crystal did not start.
    Internal,
    /// An emulated board, whose time is exact.
    Emulated,
    /// Captures from before this was asked.
    #[default]
    Unknown,
}

impl ClockSource {
    /// What the board says of itself.
    pub(crate) fn of(identity: &Identity) -> Self {
        match identity.restart {
            Restart::ClockFallback
            | Restart::CommandClockFallback
            | Restart::WatchdogClockFallback
            | Restart::PanicClockFallback { .. } => Self::Internal,
            _ if identity.platform == BOARD => Self::Crystal,
            _ => Self::Emulated,
        }
    }

    /// What there is to say of it to who reads the record, in words.
    pub fn warning(self) -> Option<&'static str> {
        (self == Self::Internal).then_some(
            "the board's crystal did not start: it ran on its internal oscillator, and rates by its \
             stamps are good to 1 % only",
        )
    }
}

/// The board that recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoardHeader {
    /// Unique number of its microcontroller, hexadecimal.
    pub serial: String,
    /// What the image was built for.
    pub platform: String,
    /// Release of its firmware.
    pub firmware: String,
    /// ID registers of the converters; null where one did not answer.
    pub converters: [Option<u8>; AXES],
    /// Ticks a second of the stamps in the batches.
    pub timer_hz: u32,
    /// Clock of the converters, hertz.
    pub converter_clock_hz: u32,
    /// Reference of the converters, volts.
    pub reference_v: f64,
    /// Range of the accelerometers.
    pub range: SensorRange,
    /// Nominal supply of the accelerometers, volts.
    pub sensor_supply_v: f64,
    /// Why the board had last started; `None` in captures from before this was asked.
    #[serde(default)]
    pub restart: Option<Restart>,
    /// What its clock runs on.
    #[serde(default)]
    pub clock: ClockSource,
}

/// One axis: `value = scale * (code - zero)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AxisHeader {
    /// X, Y or Z.
    pub name: String,
    /// Unit of the value.
    pub unit: Unit,
    /// Units per count of the 32-bit word.
    pub scale: f64,
    /// Word at zero signal.
    pub zero: f64,
    /// What lies between acceleration and word, as for `--chain`; empty for nothing.
    pub chain: String,
}

/// First of the registers of a converter's own offset and gain (OFC, FSC), and what they hold where it
/// corrects nothing.
const CORRECTION: usize = 5;
const NO_CORRECTION: [u8; REGISTERS - CORRECTION] = [0, 0, 0, 0, 0, 0x40];

/// Whether a converter corrects its words by a calibration of its own.
pub(crate) fn corrects(registers: &[[u8; REGISTERS]; AXES]) -> bool {
    registers
        .iter()
        .any(|registers| registers[CORRECTION..] != NO_CORRECTION)
}

/// Corner of the MMA7331L's own low-pass, hertz (data sheet, typical: 400 in plane, 300 across).
const SENSOR_POLE_HZ: [f64; AXES] = [400.0, 400.0, 300.0];

impl Header {
    /// The header of a recording by this board, from now on.
    pub fn new(
        identity: &Identity,
        (registers, registers_of): ([[u8; REGISTERS]; AXES], RegistersOf),
        created: String,
    ) -> Self {
        let settings = identity.settings;
        let reference_v = f64::from(identity.reference_uv) * 1e-6;
        let supply_v = f64::from(identity.sensor_supply_uv) * 1e-6;
        let converter = match settings.filter {
            Filter::Fir { phase, .. } => Some(phase),
            Filter::Sinc | Filter::Modulator => None,
        };
        let scaling = Scaling::new(
            identity.reference_uv,
            identity.range,
            identity.sensor_supply_uv,
        );
        let axes = ["X", "Y", "Z"]
            .into_iter()
            .zip(SENSOR_POLE_HZ)
            .map(|(name, pole_hz)| AxisHeader {
                name: name.to_owned(),
                unit: Unit::MetrePerSecondSquared,
                scale: scaling.scale(),
                zero: scaling.zero(),
                chain: Chain {
                    converter,
                    poles_hz: vec![pole_hz],
                }
                .to_string(),
            });
        Self {
            protocol: VERSION,
            inm: env!("CARGO_PKG_VERSION").to_owned(),
            created,
            rate_hz: f64::from(settings.rate.hz()),
            board: BoardHeader {
                serial: identity.serial.map(|word| format!("{word:08x}")).concat(),
                platform: identity.platform.to_string(),
                firmware: identity.firmware.to_string(),
                converters: identity.converters,
                timer_hz: identity.timer_hz,
                converter_clock_hz: identity.converter_clock_hz,
                reference_v,
                range: identity.range,
                sensor_supply_v: supply_v,
                restart: Some(identity.restart.clone()),
                clock: ClockSource::of(identity),
            },
            settings,
            registers,
            registers_of,
            calibration: None,
            axes: axes.collect(),
        }
    }

    /// The same with axes by what the board keeps. A converter that corrects its words by a calibration of
    /// its own makes other codes than those that were calibrated: then all stays by the data sheets.
    #[must_use]
    pub fn calibrated(mut self, kept: Option<SensorCalibration>) -> Self {
        let fits = |kept: &SensorCalibration| {
            kept.is_sound() && kept.range == self.board.range && !corrects(&self.registers)
        };
        self.calibration = kept.filter(fits);
        if let Some(kept) = &self.calibration {
            let diagonal = SensorCalibration::DIAGONAL.map(|at| kept.rows[at]);
            for (axis, (row, zero)) in self.axes.iter_mut().zip(diagonal.iter().zip(kept.zero)) {
                axis.scale = f64::from(*row) * SensorCalibration::ROW_UNIT;
                axis.zero = f64::from(zero);
            }
        }
        self
    }

    /// The record that a capture with this header is one of.
    ///
    /// # Errors
    /// [`CaptureError::Chain`] if an axis names a signal chain that is not known.
    pub fn signal(&self, path: &Path) -> Result<Signal, CaptureError> {
        let axes = self.axes.iter().map(|axis| {
            let parse = |text: &str| {
                text.parse().map_err(|source| CaptureError::Chain {
                    path: path.to_owned(),
                    axis: axis.name.clone(),
                    source,
                })
            };
            // A simulation may have none.
            let chain = match axis.chain.as_str() {
                "" => None,
                text => Some(parse(text)?),
            };
            Ok(Axis {
                name: axis.name.clone(),
                unit: axis.unit,
                scale: axis.scale,
                zero: axis.zero,
                chain,
            })
        });
        Ok(Signal {
            name: path.display().to_string(),
            rate_hz: self.rate_hz,
            axes: axes.collect::<Result<_, _>>()?,
            start: Some(self.created.clone()),
        })
    }
}
