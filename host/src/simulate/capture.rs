//! Writes a simulation as a capture: integer codes in the frames that a board would send.

use std::path::Path;

use inm_emulator::word::fir_word;
use inm_firmware::emulated::{TIMER_HZ, describe};
use inm_protocol::{
    AXES, BATCH_LEN, Batch, Code, Filter, Flag, Flags, Identity, MAX_FRAME, Note, Phase, REGISTERS,
    Rate, Settings, ToHost, encode,
};
use jiff::Timestamp;

use super::source::Simulation;
use crate::capture::{Header, RegistersOf, Writer};
use crate::signal::{Signal, Unit};
use crate::source::Source;

/// Clock of an ADS1281, hertz.
const CONVERTER_CLOCK_HZ: u32 = 4_096_000;

/// Conversions that are encoded at a time.
const CONVERSIONS: usize = 256 * BATCH_LEN;

/// Writes `simulation` as a new capture at `path`; the scale of the codes is that of the board
/// (MMA7331L in the 4 g range, reference of 5 V). A word that clips is marked as such.
///
/// # Errors
/// If the simulation is not one of three axes in m/s^2 at a rate of the converter, or the file
/// exists or cannot be written.
pub fn write_capture(simulation: &mut Simulation, path: &Path) -> anyhow::Result<()> {
    let header = header(simulation)?;
    let mut writer = Writer::create(path, &header)?;
    let mut batches = Batches {
        header: &header,
        rate_hz: simulation.true_rate_hz(),
        batch: Batch::default(),
        next: 0,
        frames: Vec::new(),
    };
    loop {
        let columns = simulation.next_columns(CONVERSIONS);
        let count = columns.first().map_or(0, Vec::len);
        let mut axes = columns.iter().map(|column| column.iter().copied());
        let mut next = || axes.next().into_iter().flatten();
        let rows = next().zip(next()).zip(next());
        for ((x, y), z) in rows {
            batches.push([x, y, z])?;
        }
        if count == 0 {
            batches.send()?;
        }
        writer.append(&batches.frames)?;
        batches.frames.clear();
        if count == 0 {
            let unix_ms = Timestamp::now().as_millisecond();
            writer.note(Note::End { unix_ms })?;
            return Ok(writer.sync()?);
        }
    }
}

/// What the capture says of itself.
fn header(simulation: &Simulation) -> anyhow::Result<Header> {
    let signal = simulation.signal();
    let identity = identity(converter_rate(signal)?, signal);
    let created = Timestamp::now().to_string();
    let mut header = Header::new(
        &identity,
        ([[0; REGISTERS]; AXES], RegistersOf::BeforeTheStart),
        created,
    );
    for (axis, described) in header.axes.iter_mut().zip(&signal.axes) {
        axis.name.clone_from(&described.name);
        axis.chain = described
            .chain
            .as_ref()
            .map_or(String::new(), ToString::to_string);
    }
    Ok(header)
}

/// The converter's rate that a signal has, where a capture can hold it.
fn converter_rate(signal: &Signal) -> anyhow::Result<Rate> {
    anyhow::ensure!(
        signal.axes.len() == AXES,
        "a capture has {AXES} axes, the model has {}; write .npy or .csv instead",
        signal.axes.len()
    );
    if let Some(axis) = signal
        .axes
        .iter()
        .find(|axis| axis.unit != Unit::MetrePerSecondSquared)
    {
        anyhow::bail!(
            "a capture is in m/s^2, axis {} of the model in {}; write .npy or .csv instead",
            axis.name,
            axis.unit
        );
    }
    let rate = Rate::ALL
        .into_iter()
        .find(|rate| f64::from(rate.hz()) == signal.rate_hz);
    rate.ok_or_else(|| {
        anyhow::anyhow!(
            "the converter has no rate of {}/s; --rate 250, 500, 1000, 2000 or 4000, or write \
             .npy or .csv instead",
            signal.rate_hz
        )
    })
}

/// The board that would have sent the signal.
fn identity(rate: Rate, signal: &Signal) -> Identity {
    let phase = signal.axes[0]
        .chain
        .as_ref()
        .and_then(|chain| chain.converter)
        .unwrap_or(Phase::Linear);
    let board = describe("simulation");
    let text = |text: &str| text.try_into().unwrap_or_default();
    Identity {
        serial: board.serial,
        firmware: text(env!("CARGO_PKG_VERSION")),
        platform: text(board.platform),
        timer_hz: TIMER_HZ,
        converter_clock_hz: CONVERTER_CLOCK_HZ,
        baud: board.baud,
        range: board.range,
        reference_uv: board.reference_uv,
        sensor_supply_uv: board.sensor_supply_uv,
        converters: [None; AXES],
        settings: Settings {
            rate,
            filter: Filter::Fir {
                phase,
                high_pass: None,
            },
        },
        restart: board.restart,
    }
}

/// Conversions on their way into frames.
struct Batches<'a> {
    header: &'a Header,
    /// Conversions a second by the clock of the stamps, which is right.
    rate_hz: f64,
    batch: Batch,
    next: u64,
    frames: Vec<u8>,
}

impl Batches<'_> {
    fn push(&mut self, values: [f64; AXES]) -> anyhow::Result<()> {
        let place = self.batch.codes.len();
        if place == 0 {
            self.batch.first = self.next;
            let ticks = self.next as f64 / self.rate_hz * f64::from(TIMER_HZ);
            self.batch.stamp = ticks.round() as u64;
        }
        let mut codes = [Code(0); AXES];
        for (axis, value) in values.into_iter().enumerate() {
            let Word { word, clipped } = convert(value, self.header, axis);
            codes[axis] = Code(word);
            if clipped {
                // There is room for a flag on every word.
                let _ = self.batch.flags.push(Flag {
                    conversion: place as u8,
                    axis: axis as u8,
                    flags: Flags::OVER_RANGE,
                });
            }
        }
        // A full batch is sent at once.
        let _ = self.batch.codes.push(codes);
        self.next += 1;
        if self.batch.codes.is_full() {
            self.send()?;
        }
        Ok(())
    }

    fn send(&mut self) -> anyhow::Result<()> {
        if self.batch.codes.is_empty() {
            return Ok(());
        }
        let seq = self.batch.seq.wrapping_add(1);
        let batch = std::mem::take(&mut self.batch);
        let mut frame = [0; MAX_FRAME];
        let len = encode(&ToHost::Samples(batch), &mut frame).map_err(std::io::Error::other)?;
        self.frames.extend(&frame[..len]);
        self.batch.seq = seq;
        Ok(())
    }
}

/// A word as the converter would have sent it.
struct Word {
    word: i32,
    clipped: bool,
}

fn convert(value: f64, header: &Header, axis: usize) -> Word {
    let axis = &header.axes[axis];
    // The scale is that of the 32-bit word, whose value is in its upper 31 bits.
    let code = ((value / axis.scale + axis.zero) / 2.0).round() as i64;
    let word = fir_word(code) as i32;
    Word {
        word,
        clipped: i64::from(word >> 1) != code,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::whole::Model;
    use crate::source::capture::CaptureSource;

    /// The stamps are by a clock that is right, so that a wrong data rate shows in them.
    #[test]
    fn a_wrong_clock_of_the_converters_shows_in_the_stamps() {
        let rate_hz = |effects: &str| {
            let axis = |name: &str| {
                format!(
                    r#"{{ "name": "{name}", "unit": "m/s^2", "coefficients": {{ "N": 1e-3 }},
                          "effects": [{effects}] }}"#
                )
            };
            let axes = ["X", "Y", "Z"].map(axis).join(", ");
            let model = format!(r#"{{ "schema": 1, "rate_hz": 250, "axes": [{axes}] }}"#);
            let model = Model::from_json(&model).expect("a model");
            let mut simulation = Simulation::new(&model, 2000, 1).expect("a simulation");
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("made.inmcap");
            write_capture(&mut simulation, &path).expect("written");
            let mut source = CaptureSource::open(&path).expect("a capture");
            while source.next_chunk().expect("whole").is_some() {}
            let clocks = source.clocks().expect("stamps");
            assert_eq!(clocks.rate_by_host_hz, None);
            clocks.rate_by_board_hz.value
        };
        // A microsecond at either end of eight seconds.
        assert!((rate_hz("") / 250.0 - 1.0).abs() < 2.5e-7);
        let off = r#"{ "effect": "timebase", "parameters": { "ratio": 1.02 } }"#;
        assert!((rate_hz(off) / 255.0 - 1.0).abs() < 2.5e-7);
    }
}
