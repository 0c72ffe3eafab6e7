//! A record of three axes on a desk, and what happens there.

use std::io;
use std::path::Path;

use super::table::Everyday;
use crate::hidden::axis::Axis;
use crate::hidden::case::Files;
use crate::hidden::draw::Draw;
use crate::hidden::noise::base::Base;
use crate::hidden::noise::chain::Chain;
use crate::hidden::npy;
use crate::hidden::scene::Scene;

/// Axes of a record.
pub const AXES: usize = 3;

/// Lengths, samples: the shortest and the longest.
const SAMPLES: (f64, f64) = (65_536.0, 524_288.0);

/// Rates of loggers, samples a second.
const RATES_HZ: [f64; 6] = [50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0];

/// The place in which something happens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// Samples.
    pub samples: usize,
    /// Samples a second.
    pub rate_hz: f64,
    /// Deviation of the short-term noise of the quietest axis.
    pub deviation: f64,
}

impl Room {
    /// Length, seconds.
    pub fn duration_s(&self) -> f64 {
        self.samples as f64 / self.rate_hz
    }

    /// When an event of this length begins: anywhere; in one record of five at an end.
    pub fn moment_s(&self, length_s: f64, draw: &mut Draw) -> f64 {
        let last_s = self.duration_s() - length_s;
        match draw.index(10) {
            0 => 0.0,
            1 => last_s,
            _ => draw.uniform(0.0, last_s),
        }
    }
}

/// What a logger makes of the finished samples of an axis.
pub type Logger = Box<dyn Fn(&mut [f64])>;

/// What happens.
#[derive(Default)]
pub struct Disturbance {
    /// From when to when, seconds; none for what goes on all the time.
    pub event_s: Option<(f64, f64)>,
    /// What is added to the first axis, sample by sample; empty for nothing.
    pub wave: Vec<f64>,
    /// How much of it each axis has.
    pub gains: [f64; AXES],
    /// What is done to the samples in the end.
    pub logger: Option<Logger>,
}

/// A record with one disturbance in it.
pub struct Record {
    /// What is in it.
    pub everyday: &'static Everyday,
    /// What settles it.
    pub seed: u64,
    /// Its place.
    pub room: Room,
    /// From when to when, seconds.
    pub event_s: Option<(f64, f64)>,
    /// The axis that shows it most.
    pub plainest: usize,
    /// Samples, a column an axis.
    pub columns: Vec<Vec<f64>>,
}

impl Record {
    /// That of a seed, of at most `longest` samples.
    pub fn draw(everyday: &'static Everyday, seed: u64, longest: usize) -> Self {
        let mut draw = Draw::new(seed, &format!("everyday {}", everyday.name));
        let fast = RATES_HZ
            .into_iter()
            .filter(|rate_hz| *rate_hz >= everyday.rate_hz);
        let rate_hz = draw.pick(&fast.collect::<Vec<_>>());
        let samples = draw.log_uniform(
            SAMPLES.0,
            SAMPLES.1.min(longest as f64).max(SAMPLES.0 + 1.0),
        );
        let scene = Scene {
            rate_hz,
            samples: samples as usize,
            axes: (0..AXES).map(|_| Base::draw(&mut draw)).collect(),
            target: 0,
            chain: Chain::None,
            declared: true,
            relative: true,
            missing: 0.0,
            code: 0.0,
            measured: None,
        };
        let variance = |axis| {
            let points = 512;
            let spacing_hz = 0.5 * rate_hz / f64::from(points);
            let short = |i| scene.short_density(axis, (f64::from(i) + 0.5) * spacing_hz);
            2.0 * spacing_hz * (0..points).map(short).sum::<f64>()
        };
        let room = Room {
            samples: scene.samples,
            rate_hz,
            deviation: (0..AXES).map(variance).fold(0.0, f64::max).sqrt(),
        };
        let happens = (everyday.draw)(&room, &mut draw);
        let name = format!("everyday {}", everyday.name);
        let columns = (0..AXES).map(|axis| {
            let (mut samples, _) = Axis::new(&scene, axis, &[], seed, &name).samples();
            for (sample, wave) in samples.iter_mut().zip(&happens.wave) {
                *sample += happens.gains[axis] * wave;
            }
            if let Some(logger) = &happens.logger {
                logger(&mut samples);
            }
            samples
        });
        let columns = columns.collect();
        let by_size = |one: &usize, other: &usize| {
            happens.gains[*one]
                .abs()
                .total_cmp(&happens.gains[*other].abs())
        };
        Self {
            everyday,
            seed,
            room,
            event_s: happens.event_s,
            plainest: (0..AXES).max_by(by_size).unwrap_or(0),
            columns,
        }
    }

    /// Writes it under a name that tells nothing.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<Files> {
        let record = folder.join("record.npy");
        let columns: Vec<&[f64]> = self.columns.iter().map(Vec::as_slice).collect();
        npy::write(&record, &columns)?;
        let rate = self.room.rate_hz.to_string();
        let arguments = ["--rate", &rate, "--unit", "m/s^2"].map(str::to_owned);
        Ok(Files {
            record,
            arguments: arguments.to_vec(),
        })
    }
}

/// Gains of three axes: one of them all of it, the others some.
pub fn gains(draw: &mut Draw) -> [f64; AXES] {
    let mut gains = [0.0; AXES].map(|_: f64| draw.sign() * draw.uniform(0.2, 0.8));
    gains[draw.index(AXES)] = 1.0;
    gains
}
