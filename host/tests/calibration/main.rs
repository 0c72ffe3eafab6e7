//! Calibrations of sensors whose truth is known: by the estimator alone on readings of the virtual board's
//! sensors ahead of its converters, which add nothing at the time of a block; and by the whole program.

#[path = "../pty/mod.rs"]
mod pty;

mod bench;
mod cube;
mod program;
mod told;

use inm_emulator::Signal;
use inm_emulator::channel::Channel;
use inm_emulator::filter::DECIMATION;
use inm_emulator::sensor::{Coefficients, GRAVITY_M_S2, Sensor};
use inm_host::internals::calibrate::{BLOCK_S, NAMES, PARAMETERS, Position, Stretch, doubts, fit};
use inm_host::internals::virtual_board::{Hand, Truth, Turned};
use inm_protocol::SensorRange;

/// Conversions a second: a slow rate, since the sensors' noise is the same at any, with five to a block.
const RATE: u32 = 500;

/// Conversions of a block.
const BLOCK: u32 = (BLOCK_S * RATE as f64) as u32;

/// Positions, seconds of each, and seconds that a hand takes to turn the block.
const STRETCH_S: f64 = 5.0;
const TURN_S: f64 = 5.0;

/// What a session found and what is true.
struct Session {
    positions: Vec<Position>,
    truth: [f64; PARAMETERS],
    end_s: f64,
}

/// A sensor's readings, ahead of the converter.
struct Bench {
    block: Turned,
    channels: [Channel; 3],
    /// The same channels at rest and without white noise, so that their output is the zero of the moment: what is
    /// slow comes from random numbers of its own, the same in both.
    quiet: [Channel; 3],
    /// Zeros over the last mean, m/s^2 by the nominal scale.
    zero: [f64; 3],
    steps_per_m_s2: [f64; 3],
    nominal: f64,
}

impl Bench {
    /// Sensors of a truth with this noise on a block.
    fn new(truth: &Truth, noise: [Coefficients; 3], seed: u64) -> Self {
        let range = SensorRange::G4;
        let channels = |truth: &Truth| truth.channels(range, seed).expect("noise that fits");
        let quiet = noise.map(|noise| Coefficients {
            white: 0.0,
            quantisation: 0.0,
            ..noise
        });
        let mut bench = Self {
            block: truth.block(),
            channels: channels(truth),
            quiet: channels(&Truth::draw(quiet, seed)),
            zero: [0.0; 3],
            steps_per_m_s2: truth.steps_per_m_s2(range),
            nominal: Sensor::XY.steps_per_m_s2(),
        };
        for channel in bench.channels.iter_mut().chain(&mut bench.quiet) {
            channel.set_rate(RATE * DECIMATION as u32);
        }
        bench
    }

    /// Means of the readings of so many conversions, by the nominal scale.
    fn mean(&mut self, conversions: u32) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let felt = self.steps_per_m_s2[axis] * self.block.along(axis);
            self.zero[axis] = inputs(&mut self.quiet[axis], 0.0, conversions) / self.nominal;
            inputs(&mut self.channels[axis], felt, conversions) / self.nominal
        })
    }

    /// The zeros over so many seconds from now on, m/s^2 by the nominal scale.
    fn zeros(&mut self, seconds: f64) -> [f64; 3] {
        let mut whole = [0.0; 3];
        let blocks = (seconds / BLOCK_S) as usize;
        for _ in 0..blocks {
            let _ = self.mean(BLOCK);
            for (sum, zero) in whole.iter_mut().zip(self.zero) {
                *sum += zero / blocks as f64;
            }
        }
        whole
    }
}

/// Mean of the inputs of so many conversions, steps of the code, with so much acting.
fn inputs(channel: &mut Channel, felt: f64, conversions: u32) -> f64 {
    let mut inputs = [0; DECIMATION];
    let mut sum = 0_i64;
    for _ in 0..conversions {
        channel.act((felt * (1_u64 << 32) as f64) as i64);
        channel.fill(&mut inputs);
        sum += inputs.iter().map(|&input| i64::from(input)).sum::<i64>();
    }
    sum as f64 / (f64::from(conversions) * DECIMATION as f64)
}

fn session(number: usize, noise: [Coefficients; 3], seed: u64) -> Session {
    let truth = Truth::draw(noise, seed);
    let mut bench = Bench::new(&truth, noise, seed);
    let mut hand = bench.block.hand(number, GRAVITY_M_S2, seed);
    let (positions, end_s) = read(&mut bench, &mut hand, seed);
    let mut parameters = truth.parameters(SensorRange::G4);
    parameters[6..].copy_from_slice(&bench.zeros(STRETCH_S));
    Session {
        positions,
        truth: parameters,
        end_s,
    }
}

/// All positions of a hand, and the middle of the seconds behind them, over which zeros are.
fn read(bench: &mut Bench, hand: &mut Hand, seed: u64) -> (Vec<Position>, f64) {
    let mut positions = Vec::new();
    let mut time_s = 0.0;
    while hand.turn() {
        let _ = bench.mean((TURN_S * f64::from(RATE)) as u32);
        time_s += TURN_S;
        let blocks = (0..(STRETCH_S / BLOCK_S) as usize).map(|_| bench.mean(BLOCK));
        let stretch = Stretch {
            blocks: blocks.collect(),
            time_s: time_s + 0.5 * STRETCH_S,
        };
        time_s += STRETCH_S;
        let position = stretch.position(None);
        positions.push(position.unwrap_or_else(|error| panic!("seed {seed}: {error}")));
    }
    (positions, time_s + 0.5 * STRETCH_S)
}

/// Shares of the sessions whose interval holds the truth, by parameter, and of those with a doubt.
fn coverage(number: usize, noise: [Coefficients; 3], runs: u64) -> ([f64; PARAMETERS], f64) {
    let (mut inside, mut doubted) = ([0_u32; PARAMETERS], 0_u32);
    for seed in 1..=runs {
        let session = session(number, noise, seed);
        let found = fit(&session.positions, GRAVITY_M_S2, session.end_s);
        let found = found.unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        for (at, inside) in inside.iter_mut().enumerate() {
            let miss = (found.values[at] - session.truth[at]).abs();
            *inside += u32::from(miss <= found.half_widths[at]);
        }
        doubted += u32::from(!doubts(&found).is_empty());
    }
    let runs = runs as f64;
    (
        inside.map(|inside| f64::from(inside) / runs),
        f64::from(doubted) / runs,
    )
}

/// Sessions with all noise that is published, their zeros wandering while the block is turned.
#[test]
fn intervals_hold_the_truth_of_wandering_zeros() {
    const RUNS: u64 = 100;
    let (inside, doubted) = coverage(14, Coefficients::PUBLISHED, RUNS);
    // Four standard errors of a share, for each of nine parameters; the study has more sessions.
    let least = 0.95 - 4.0 * (0.95 * 0.05 / RUNS as f64).sqrt();
    for (name, share) in NAMES.iter().zip(inside) {
        assert!(share > least, "seeds 1 to {RUNS}: {name} inside in {share}");
    }
    let most = 0.01 + 5.0 * (0.01 / RUNS as f64).sqrt();
    assert!(doubted < most, "seeds 1 to {RUNS}: {doubted} doubted");
}

/// The study: `cargo test -p inm-host --test calibration -- --ignored --nocapture`. Last, sensors that wander in other
/// proportions than the published ones: X as the quiet Y, and Y as X.
#[test]
#[ignore = "a study: a quarter of an hour of processor time"]
fn coverage_of_two_thousand_sessions() {
    let published = Coefficients::PUBLISHED;
    let [x, y, z] = published;
    for (number, of, noise) in [
        (12, "the published sensors", published),
        (18, "the published sensors", published),
        (24, "the published sensors", published),
        (18, "X and Y exchanged", [y, x, z]),
    ] {
        let (inside, doubted) = coverage(number, noise, 2000);
        let shares = inside.map(|inside| format!("{:.1}", 100.0 * inside));
        println!(
            "{number} positions, {of}, seeds 1 to 2000, % inside, % doubted {:.2}",
            100.0 * doubted
        );
        for (name, share) in NAMES.iter().zip(shares) {
            println!("    {name:<8}{share:>6}");
        }
    }
}
