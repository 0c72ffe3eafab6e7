//! A receiver's pulse a second at the input of a board without hardware, and clocks that are off, so that there is
//! something to measure.

use rand_distr::{Distribution, Normal, Uniform};
use rand_pcg::Pcg64;

use super::{ClocksOff, VirtualConnect};
use crate::model::Seed;
use crate::model::random::random;

/// Stream of random numbers, another than those of noise, of what is hidden, of truth, hand and cube.
const PULSES: u64 = 6 << 48;

/// How far each crystal is off at most, parts in a million: a sound one.
const CRYSTAL_PPM: f64 = 50.0;

/// Jitter of a receiver, seconds, from and to: from what one says of itself to what a poor antenna makes of it. The
/// board's timer has a tick of a microsecond here, which hides what is less than the first.
const JITTER_S: [f64; 2] = [2e-7, 2e-5];

/// Share of the pulses that are missing: one in a hundred, so that a minute has one or so.
const MISSING: f64 = 0.01;

/// A receiver.
#[derive(Debug, Clone, Copy)]
pub struct Receiver {
    /// Standard deviation of the time of a pulse, seconds.
    pub jitter_s: f64,
    /// Share of the pulses that do not come, 0 to 1.
    pub missing: f64,
    /// Seed of both.
    pub seed: u64,
}

impl VirtualConnect {
    /// The same with a pulse a second at its input, whose jitter is drawn from the seed, as are what its own crystal and
    /// that of the converters are off by.
    #[must_use]
    pub fn with_pulses(self, seed: u64) -> Self {
        let stream = PULSES;
        let mut random = random(Seed { seed, stream });
        let mut within =
            |from: f64, to: f64| Uniform::new(from, to).map_or(from, |law| law.sample(&mut random));
        let off = ClocksOff {
            converters_ppm: within(-CRYSTAL_PPM, CRYSTAL_PPM),
            crystal_ppm: within(-CRYSTAL_PPM, CRYSTAL_PPM),
        };
        let [from, to] = JITTER_S.map(f64::ln);
        let receiver = Receiver {
            jitter_s: within(from, to).exp(),
            missing: MISSING,
            seed,
        };
        Self {
            off,
            receiver: Some(receiver),
            ..self
        }
    }
}

/// The pulses of one life of the board.
pub(super) struct Pulses {
    receiver: Receiver,
    /// Seconds of virtual time in a true one.
    pace: f64,
    random: Pcg64,
    /// When the first second begins, true seconds.
    phase_s: f64,
    second: u64,
    next_ps: u64,
}

impl Pulses {
    pub(super) fn new(receiver: Receiver, pace: f64) -> Self {
        let mut random = random(Seed {
            seed: receiver.seed,
            stream: PULSES + 1,
        });
        let phase_s = Uniform::new(0.1, 1.0).map_or(0.5, |law| law.sample(&mut random));
        let mut pulses = Self {
            receiver,
            pace,
            random,
            phase_s,
            second: 0,
            next_ps: 0,
        };
        pulses.draw();
        pulses
    }

    /// The next pulse, if it has come by this instant of virtual time, picoseconds.
    pub(super) fn due(&mut self, now_ps: u64) -> Option<u64> {
        let at_ps = self.next_ps;
        (at_ps <= now_ps).then(|| {
            self.draw();
            at_ps
        })
    }

    /// Draws the next second that has a pulse.
    fn draw(&mut self) {
        let Self {
            receiver, random, ..
        } = self;
        let late = Normal::new(0.0, receiver.jitter_s);
        let mut share =
            || Uniform::new(0.0, 1.0).map_or(1.0, |law: Uniform<f64>| law.sample(random));
        // A receiver that says nothing for a day says nothing any more.
        let missing = (0..86_400).take_while(|_| share() < receiver.missing);
        self.second += missing.count() as u64;
        let late_s = late.map_or(0.0, |law| law.sample(random));
        let true_s = self.phase_s + self.second as f64 + late_s;
        self.next_ps = (true_s * self.pace * 1e12) as u64;
        self.second += 1;
    }
}
