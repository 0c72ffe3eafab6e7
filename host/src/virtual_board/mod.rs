//! A board without hardware: the firmware's own code on emulated converters, in a thread of its
//! own, at the far end of a port.
//!
//! The thread is the other machine: it shares nothing with the host but the bytes of the link,
//! whose speed is kept in virtual time. Where the host reads slower than the board sends, virtual
//! time waits; nothing is lost that a real host of unlimited speed would have received.
//!
//! What the host writes reaches the board at an instant of virtual time that follows from what the
//! host had read by then, never from how fast either thread ran: a record with the same seed and
//! the same commands is the same on any machine, to the sample at which it ends. That holds for the
//! host's patience, too: it counts parcels, so that a machine that leaves the board's thread no time does
//! not make the board silent.
//!
//! ```text
//!   board   parcel 0 .. parcel 7 | parcel 8 | parcel 9 ..
//!                                ^          ^
//!   host            asks for 0 --+  for 1 --+    each with what it wrote since it last asked
//! ```

pub mod cube;
pub mod hand;
pub mod hide;
mod life;
mod line;
mod loading;
mod port;
mod pulses;
mod shaken;
pub mod turned;
mod witness;

use std::sync::{Arc, Mutex, mpsc};
use std::thread;
use std::time::Duration;

use inm_emulator::Fault;
use inm_emulator::channel::{self, Channel};
use inm_emulator::sensor::{Sensor, Unfit};
use inm_firmware::emulated::VirtualFlash;
use inm_protocol::{AXES, Restart, SensorRange};

pub use loading::ProgramFlash;
pub use pulses::Receiver;
pub use shaken::Hidden;
pub use witness::{AxisWitness, Witness};

use self::line::Line;
use self::port::VirtualPort;
use self::shaken::{Pins, Shaken};
use self::turned::{Truth, Turned};
use crate::link::{Clock, Connect, LinkError, Port};

/// Typical step of a sound sensor's self-test, g (the MMA7331L's sheet as remembered, `data_sheet.rs`).
const SELF_TEST_G: [f64; AXES] = [-0.1, -0.1, 1.0];

/// A restart that nobody asked for: the board says no word of it, and what it had still to send is
/// lost.
#[derive(Debug, Clone)]
pub struct Misfortune {
    /// Words of X since the stream began.
    pub words: u64,
    /// What the board says of it afterwards.
    pub cause: Restart,
    /// How long nothing comes through the port, in real time.
    pub dark: Duration,
}

/// Builds virtual boards.
#[derive(Debug, Clone)]
pub struct VirtualConnect {
    /// The accelerometers in front of the converters X, Y, Z, with their noise.
    pub channels: [Channel; AXES],
    /// The same on their coarse range.
    pub coarse: [Channel; AXES],
    /// Steps of the code in 1 m/s^2 of X, Y, Z, on the fine range and on the coarse one.
    pub steps_per_m_s2: [[f64; AXES]; 2],
    /// Seconds of board time in a second; 0 for as fast as it goes.
    pub speed: f64,
    /// Unique number of the microcontroller.
    pub serial: [u32; 3],
    /// Speed of the link in virtual time, bit/s.
    pub baud: u32,
    /// Faults to come: axis, number of the converter's word since the first stream began, what
    /// happens; at most eight an axis. The time before it depends on the host.
    pub faults: Vec<(usize, u64, Fault)>,
    /// Restarts to come, one a stream.
    pub restarts: Vec<Misfortune>,
    /// What the sensors X, Y, Z move by while their self-test pin is driven, g.
    pub self_test_g: [f64; AXES],
    /// What else acts on a sensor.
    pub hidden: Option<Hidden>,
    /// The block that the sensors are on, if it is turned.
    pub block: Option<Turned>,
    /// What is kept while the board is off, whoever opens it again.
    pub kept: Arc<Mutex<VirtualFlash>>,
    /// The flash that holds its programs, whoever opens it again.
    pub programs: Arc<Mutex<ProgramFlash>>,
    /// Where the converters' words are noted down, if anywhere.
    pub witness: Option<Witness>,
    /// The same, for each axis by itself.
    pub axis_witness: Option<AxisWitness>,
    /// The board's time as its host sees it: with every parcel that it reads.
    pub clock: Clock,
    /// By how much its own clocks are off.
    pub off: ClocksOff,
    /// What is at its input for a pulse a second.
    pub receiver: Option<Receiver>,
    /// Slot whose program hangs at its start, before it understands anybody.
    pub hangs: Option<usize>,
}

/// By how much the clocks of a board are off, parts in a million of a true one; the host's is true.
///
/// Virtual time is the converters' own, so that all that acts on a sensor has its times and frequencies by
/// their clock.
#[derive(Debug, Clone, Copy, Default)]
pub struct ClocksOff {
    /// How much faster the converters' clock goes.
    pub converters_ppm: f64,
    /// How much faster the timer of the stamps goes, to some millionth.
    pub crystal_ppm: f64,
}

impl ClocksOff {
    /// Seconds of virtual time in a true one.
    fn pace(self) -> f64 {
        1.0 + 1e-6 * self.converters_ppm
    }

    /// Ticks that the timer is said to have in a second; it has `ticks` in one of virtual time.
    fn said_hz(self, ticks: u32) -> u32 {
        (f64::from(ticks) * self.pace() / (1.0 + 1e-6 * self.crystal_ppm)).round() as u32
    }
}

impl VirtualConnect {
    /// The board of the published experiment; `seed` is that of its noise.
    pub fn published(seed: u64, speed: f64) -> Self {
        Self {
            channels: [0, 1, 2].map(|axis| channel::published(axis, seed)),
            coarse: [0, 1, 2].map(|axis| {
                let sensor = turned::at(&Sensor::PUBLISHED[axis], SensorRange::G12);
                // What fits on the fine range does on the coarse one.
                Channel::new(&sensor, seed, axis as u64)
                    .unwrap_or_else(|_| channel::published(axis, seed))
            }),
            steps_per_m_s2: [SensorRange::G4, SensorRange::G12].map(|range| {
                Sensor::PUBLISHED.map(|sensor| turned::at(&sensor, range).steps_per_m_s2())
            }),
            speed,
            serial: [0; 3],
            baud: 921_600,
            faults: Vec::new(),
            restarts: Vec::new(),
            self_test_g: SELF_TEST_G,
            hidden: None,
            block: None,
            kept: Arc::default(),
            programs: Arc::new(Mutex::new(loading::with_a_program())),
            witness: None,
            axis_witness: None,
            clock: Clock::counted(),
            off: ClocksOff::default(),
            receiver: None,
            hangs: None,
        }
    }

    /// The same with sensors of this truth on a block that is turned.
    ///
    /// # Errors
    /// [`Unfit`] if their noise is none that a channel can make.
    pub fn turning(self, truth: &Truth, seed: u64) -> Result<(Self, Turned), Unfit> {
        let block = truth.block();
        let ranges = [SensorRange::G4, SensorRange::G12];
        let turning = Self {
            channels: truth.channels(SensorRange::G4, seed)?,
            coarse: truth.channels(SensorRange::G12, seed)?,
            steps_per_m_s2: ranges.map(|range| truth.steps_per_m_s2(range)),
            block: Some(block.clone()),
            ..self
        };
        Ok((turning, block))
    }

    /// The sensors with all that acts on them, at these pins.
    fn sensors(&self, pins: &Arc<Pins>) -> [Shaken; AXES] {
        let mut axis = 0;
        self.channels.clone().map(|channel| {
            let [fine, coarse] = self.steps_per_m_s2.map(|steps| steps[axis]);
            let ranges = [(channel, fine), (self.coarse[axis].clone(), coarse)];
            let hidden = self.hidden.as_ref().filter(|hidden| hidden.axis == axis);
            let sensor = Shaken::new(ranges, hidden).at(pins, self.self_test_g[axis]);
            axis += 1;
            match &self.block {
                Some(block) => sensor.on(block.clone(), axis - 1),
                None => sensor,
            }
        })
    }
}

impl Connect for VirtualConnect {
    fn name(&self) -> String {
        "virtual".to_owned()
    }

    fn waits(&self) -> bool {
        true
    }

    fn clock(&self) -> Clock {
        self.clock.clone()
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        let (to_host, from_board) = mpsc::channel();
        let (to_board, from_host) = mpsc::channel();
        let plan = self.clone();
        let mut line = Line::new(to_host, from_host);
        thread::spawn(move || life::power_on(&plan, &mut line));
        Ok(Box::new(VirtualPort::new(
            from_board,
            to_board,
            self.clock.clone(),
            self.off.pace(),
        )))
    }
}

#[cfg(test)]
mod tests;
