//! `inm calibrate`: scale, misalignment and zero of the accelerometers from gravity, kept on the board.

mod faces;
mod guide;
mod text;

use std::process::ExitCode;

use anyhow::{bail, ensure};
use clap::Args;
use inm_firmware::mma7331l::STANDARD_GRAVITY;
use inm_protocol::{Identity, Request, SensorCalibration, SensorRange};
use jiff::Timestamp;
use serde::Serialize;

use super::board::which::{Found as Board, Which};
use super::board::{JsonOption, status};
use super::recording::{parse_positive, parse_range};
use crate::calibrate::{
    Circumstances, FACES, FEWEST, Face, Found, Position, alike_deg, doubts, fit, fit_cube,
};
use crate::inspect::gravity::Readings;
use crate::inspect::serial;
use crate::source::SourceError;
use crate::virtual_board::VirtualConnect;
use guide::{Guide, Lies};

/// Arguments of `inm calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateCommand {
    #[command(flatten)]
    which: Which,
    /// Range of the accelerometers, g: 4 or 12.
    #[arg(long, value_name = "G", default_value = "4", value_parser = parse_range)]
    range: SensorRange,
    /// Positions to put the board into; 12 at least.
    #[arg(long, value_name = "N", default_value_t = 18, value_parser = parse_positions)]
    positions: usize,
    /// Six positions on the faces of a levelled cube, in place of many on anything: all nine numbers of the matrix, in the
    /// frame of its faces.
    #[arg(long, conflicts_with = "positions")]
    cube: bool,
    /// How far off level the cube's faces are when they are up, mrad (mm in a metre): table and cube together, a standard
    /// deviation in two directions.
    #[arg(long, value_name = "MRAD", default_value_t = 1.0, value_parser = parse_tilt, requires = "cube")]
    tilt: f64,
    /// How long to read in each position.
    #[arg(long, value_name = "S", default_value_t = 5.0, value_parser = parse_seconds)]
    seconds: f64,
    /// Local gravity, m/s^2; scales are as good as this is.
    #[arg(long, value_name = "M_S2", default_value_t = STANDARD_GRAVITY, value_parser = parse_gravity)]
    gravity: f64,
    /// Say what was found, and keep it nowhere.
    #[arg(long)]
    dry_run: bool,
    /// Show what the board keeps for this range, and do nothing else.
    #[arg(long, conflicts_with_all = ["erase", "dry_run"])]
    show: bool,
    /// Make the board keep nothing for this range any more.
    #[arg(long, conflicts_with = "dry_run")]
    erase: bool,
    /// Virtual board only: seed of its noise, of the truth of its sensors and of the hand that turns it.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    json: JsonOption,
}

/// What was read.
enum Read {
    Anyhow(Vec<Position>),
    OnCube(Vec<(Face, Position)>),
}

/// What a board keeps for a range.
#[derive(Debug, Serialize)]
struct Kept {
    /// Unique number of its microcontroller, 24 hexadecimal digits.
    serial: String,
    range: SensorRange,
    /// `None` where it keeps nothing.
    calibration: Option<SensorCalibration>,
}

impl CalibrateCommand {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the port or the board says; positions that make no calibration. The board then keeps what
    /// it kept before.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        self.json.check()?;
        let (guide, mut board) = match self.which.is_virtual() {
            true => {
                let (guide, mut connect) = self.on_virtual()?;
                (guide, Which::open_virtual(&mut connect)?)
            }
            false => (Guide::of_a_person(self.number()), self.which.find()?),
        };
        if self.erase {
            let erase = Request::EraseSensorCalibration(self.range);
            let () = board.session.ask(erase).map_err(SourceError::from)?;
        }
        if self.erase || self.show {
            let kept = kept(&mut board, self.range)?;
            self.json.write(&kept, &text::kept(&kept))?;
            return Ok(ExitCode::SUCCESS);
        }
        let mut found = self.find(&mut board, guide)?;
        if found.doubts.is_empty() && !self.dry_run {
            store(&mut board, &found.record)?;
            found.stored = true;
        }
        self.json.write(&found, &text::found(&found))?;
        Ok(status(found.doubts.is_empty()))
    }

    /// Positions to read.
    fn number(&self) -> usize {
        if self.cube { FACES } else { self.positions }
    }

    /// A board without hardware, and a hand that turns it.
    fn on_virtual(&self) -> anyhow::Result<(Guide, VirtualConnect)> {
        let lies = match self.cube {
            true => Lies::OnCube {
                tilt_rad: 1e-3 * self.tilt,
            },
            false => Lies::Anyhow,
        };
        Guide::on_virtual(self.number(), lies, self.gravity, self.seed)
    }

    /// Reads all positions, and what they come to.
    fn find(&self, board: &mut Board, mut guide: Guide) -> anyhow::Result<Found> {
        let health = board.session.health(crate::inspect::info::NEXT_HEALTH);
        let health = health.map_err(SourceError::from)?;
        let identity: Identity = board.identity.clone();
        let before = kept(board, self.range)?.calibration;
        let begun = Readings::begin(
            &mut board.session,
            board.port.clone(),
            &identity,
            self.range,
        );
        let (mut readings, corrected) = begun.map_err(SourceError::from)?;
        ensure!(
            !corrected,
            "{}: a converter corrects its words by a calibration of its own, which is gone when the board \
             restarts: restart it first (`inm board reset`)",
            board.port
        );
        let read = match self.cube {
            true => Read::OnCube(faces::read(self.seconds, &mut readings, &mut guide)?),
            false => Read::Anyhow(self.read(&mut readings, &mut guide)?),
        };
        let end_s = readings.end_s();
        let of = Circumstances {
            range: self.range,
            gravity_m_s2: self.gravity,
            centi_celsius: health.and_then(|(_, health)| health.mcu_centi_celsius),
            session_s: end_s,
            unix_s: Timestamp::now().as_second(),
            before,
        };
        // The zeros of the seconds behind the last position, as many as one takes.
        let zeros_s = end_s + 0.5 * self.seconds;
        let scaling = readings.scaling();
        Ok(match read {
            Read::Anyhow(positions) => {
                let fit = fit(&positions, self.gravity, zeros_s)?;
                Found::new(&fit, doubts(&fit), scaling, of)
            }
            Read::OnCube(faces) => {
                let fit = fit_cube(&faces, self.gravity, 1e-3 * self.tilt, zeros_s)?;
                Found::on_cube(fit, self.tilt, scaling, of)
            }
        })
    }

    /// Reads one position after the other; one that is none is asked for again.
    fn read(
        &self,
        readings: &mut Readings<'_>,
        guide: &mut Guide,
    ) -> anyhow::Result<Vec<Position>> {
        let mut positions: Vec<Position> = Vec::new();
        let mut quiet = None;
        while positions.len() < self.positions {
            guide.next(positions.len())?;
            let stretch = readings.stretch(self.seconds).map_err(SourceError::from)?;
            let position = match stretch.position(quiet) {
                Ok(position) => position,
                Err(unsteady) => {
                    guide.again(&unsteady.to_string())?;
                    continue;
                }
            };
            if let Some((before, angle_deg)) = alike_deg(&positions, &position) {
                guide.again(&format!(
                    "this is position {before} once more, {angle_deg:.0} degrees from it"
                ))?;
                continue;
            }
            quiet.get_or_insert(stretch.scatter());
            positions.push(position);
        }
        Ok(positions)
    }
}

/// What the board keeps for a range.
fn kept(board: &mut Board, range: SensorRange) -> anyhow::Result<Kept> {
    let calibration = board.session.ask(Request::ReadSensorCalibration(range));
    Ok(Kept {
        serial: serial(&board.identity),
        range,
        calibration: calibration.map_err(SourceError::from)?,
    })
}

/// Has the board keep a calibration, and looks whether it does.
fn store(board: &mut Board, record: &SensorCalibration) -> anyhow::Result<()> {
    let write = Request::WriteSensorCalibration(*record);
    let () = board.session.ask(write).map_err(SourceError::from)?;
    if kept(board, record.range)?.calibration != Some(*record) {
        bail!(
            "{}: the board keeps another calibration than it was given",
            board.port
        );
    }
    Ok(())
}

/// Most positions: a person's day.
const MOST: usize = 100;

fn parse_positions(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(number) if (FEWEST..=MOST).contains(&number) => Ok(number),
        _ => Err(format!(
            "a number of positions from {FEWEST} to {MOST} is expected: nine parameters, and a check"
        )),
    }
}

/// Shortest and longest time in a position, seconds: twenty blocks, and what wanders anyway.
const SECONDS: std::ops::RangeInclusive<f64> = 2.0..=600.0;

fn parse_seconds(text: &str) -> Result<f64, String> {
    parse_positive(text)
        .ok()
        .filter(|seconds| SECONDS.contains(seconds))
        .ok_or_else(|| "a number of seconds from 2 to 600 is expected".to_owned())
}

/// Angles that a cube may be off level by, mrad: from a granite table's to half a degree, beyond which nobody calls it
/// levelled and six positions tell less than many on anything.
const TILT_MRAD: std::ops::RangeInclusive<f64> = 0.01..=10.0;

fn parse_tilt(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(tilt) if TILT_MRAD.contains(&tilt) => Ok(tilt),
        _ => Err("an angle from 0.01 to 10 mrad is expected".to_owned()),
    }
}

/// Gravity on the ground of the Earth, m/s^2, with room.
const GRAVITY: std::ops::RangeInclusive<f64> = 9.7..=9.9;

fn parse_gravity(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(gravity) if GRAVITY.contains(&gravity) => Ok(gravity),
        _ => Err("local gravity from 9.7 to 9.9 m/s^2 is expected".to_owned()),
    }
}

/// Says something to who turns the block, on the error stream, so that JSON on the other stays whole.
fn tell(text: &str) {
    eprintln!("{}", crate::plain::on_a_line(text));
}
