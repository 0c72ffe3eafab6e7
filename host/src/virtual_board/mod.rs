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

pub mod hide;
mod port;
mod shaken;

use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use inm_emulator::channel::{self, Channel};
use inm_emulator::sensor::Sensor;
use inm_emulator::{Bench, Converter, Fault};
use inm_firmware::emulated::{VirtualBoard, VirtualLink, describe};
use inm_firmware::{Board, Instrument};
use inm_protocol::{AXES, Restart};

pub use shaken::Hidden;

use self::port::VirtualPort;
use self::shaken::Shaken;
use crate::link::{Clock, Connect, LinkError, Port};

/// Transmit queue of the board, bytes; that of the image.
const QUEUE: usize = 4096;

/// Steps of the instrument after which a parcel leaves, empty or not: 50 ms of a board at rest, of
/// one that streams some 100 conversions. Much work compared with handing it over, and no long wait.
const STEPS: u32 = 200;

/// What a parcel counts as for who waits for the board: the time of one at rest.
const PARCEL: Duration = Duration::from_millis(50);

/// Parcels that the board is ahead of the host. Enough that neither thread waits for the other
/// where both are as fast; a command waits 0.4 s of a board at rest, well inside the patience for
/// its reply where the board keeps real time.
const AHEAD: usize = 8;

/// Words that the converters produced, X Y Z, as witnessed at their pins.
pub type Witness = Arc<Mutex<Vec<[u32; AXES]>>>;

/// The same, a list an axis: a converter that was reset has made fewer than the others.
pub type AxisWitness = Arc<Mutex<[Vec<u32>; AXES]>>;

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
    /// What else acts on a sensor.
    pub hidden: Option<Hidden>,
    /// Where the converters' words are noted down, if anywhere.
    pub witness: Option<Witness>,
    /// The same, for each axis by itself.
    pub axis_witness: Option<AxisWitness>,
    /// The board's time as its host sees it: with every parcel that it reads.
    pub clock: Clock,
}

impl VirtualConnect {
    /// The board of the published experiment; `seed` is that of its noise.
    pub fn published(seed: u64, speed: f64) -> Self {
        Self {
            channels: [0, 1, 2].map(|axis| channel::published(axis, seed)),
            speed,
            serial: [0; 3],
            baud: 921_600,
            faults: Vec::new(),
            restarts: Vec::new(),
            hidden: None,
            witness: None,
            axis_witness: None,
            clock: Clock::counted(),
        }
    }

    /// The sensors with all that acts on them.
    fn sensors(&self) -> [Shaken; AXES] {
        let mut axis = 0;
        self.channels.clone().map(|channel| {
            let sensor = &Sensor::PUBLISHED[axis];
            let hidden = self.hidden.as_ref().filter(|hidden| hidden.axis == axis);
            axis += 1;
            Shaken::new(channel, sensor, hidden)
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
        let mut line = Line {
            to_host,
            from_host,
            ahead: 0,
        };
        thread::spawn(move || power_on(&plan, &mut line));
        Ok(Box::new(VirtualPort::new(
            from_board,
            to_board,
            self.clock.clone(),
        )))
    }
}

/// The board's end of the line between the threads.
struct Line {
    to_host: Sender<Vec<u8>>,
    /// What the host wrote, once for every parcel that it asked for.
    from_host: Receiver<Vec<u8>>,
    /// Parcels that the host has not asked for, up to [`AHEAD`].
    ahead: usize,
}

impl Line {
    /// Sends a parcel; what the host wrote, or `None` if it is gone.
    fn exchange(&mut self, parcel: Vec<u8>) -> Option<Vec<u8>> {
        self.to_host.send(parcel).ok()?;
        if self.ahead < AHEAD {
            self.ahead += 1;
            return Some(Vec::new());
        }
        self.from_host.recv().ok()
    }
}

/// Runs the board until the host is gone.
fn power_on(plan: &VirtualConnect, line: &mut Line) {
    let mut restart = Restart::Power;
    let mut misfortunes = plan.restarts.iter();
    loop {
        let bench = Bench::new(plan.sensors().map(Converter::new));
        let board = Board {
            restart,
            serial: plan.serial,
            ..describe("virtual")
        };
        let instrument = VirtualBoard::instrument(&bench, VirtualLink::new(Some(plan.baud)), board);
        let misfortune = misfortunes.as_slice().first();
        restart = match run(instrument, plan, misfortune, line) {
            Some(End::Command) => Restart::Command,
            Some(End::Misfortune(Misfortune { cause, dark, .. })) => {
                misfortunes.next();
                stay_dark(*dark, &plan.clock);
                cause.clone()
            }
            None => return,
        };
    }
}

/// Nothing comes through the port for so long.
fn stay_dark(dark: Duration, clock: &Clock) {
    let until = Instant::now() + dark;
    while Instant::now() < until {
        thread::sleep(PARCEL);
        clock.pass(PARCEL);
    }
}

type Running<'b> = Instrument<VirtualBoard<'b, Shaken, VirtualLink<QUEUE>>>;

/// How a life of the board ended.
enum End<'p> {
    /// The host asked for it.
    Command,
    /// Nobody did.
    Misfortune(&'p Misfortune),
}

/// Runs one life of the board: until it restarts, or the host is gone (`None`).
fn run<'p>(
    mut instrument: Running<'_>,
    plan: &VirtualConnect,
    misfortune: Option<&'p Misfortune>,
    line: &mut Line,
) -> Option<End<'p>> {
    let started = Instant::now();
    let mut parcel = Vec::new();
    let mut steps = 0;
    let mut words = 0;
    let mut noted = [0; AXES];
    let mut faults = &plan.faults[..];
    let mut streams_from = None;
    loop {
        instrument.step();
        steps += 1;
        let bench = instrument.platform().bench();
        if !faults.is_empty() && instrument.is_streaming() {
            for &(axis, word, fault) in std::mem::take(&mut faults) {
                bench.inject_at(axis, bench.sent(axis).words() + word, fault);
            }
        }
        if let Some(misfortune) = misfortune.filter(|_| instrument.is_streaming()) {
            let words = bench.sent(0).words();
            if words - *streams_from.get_or_insert(words) >= misfortune.words {
                return Some(End::Misfortune(misfortune));
            }
        }
        if let Some(witness) = &plan.witness {
            note_words(bench, &mut words, witness);
        }
        if let Some(witness) = &plan.axis_witness {
            note_by_axis(bench, &mut noted, witness);
        }
        let now_ps = bench.now_ps();
        let link = instrument.platform_mut().environment_mut();
        link.take(now_ps, |byte| parcel.push(byte));
        if link.restarts() > 0 {
            return Some(End::Command);
        }
        if steps < STEPS {
            continue;
        }
        steps = 0;
        link.send(&line.exchange(std::mem::take(&mut parcel))?);
        keep_pace(started, now_ps, plan.speed);
    }
}

/// Sleeps until real time has come to where virtual time is.
fn keep_pace(started: Instant, now_ps: u64, speed: f64) {
    if speed > 0.0 {
        let due = Duration::from_secs_f64(now_ps as f64 * 1e-12 / speed);
        thread::sleep(due.saturating_sub(started.elapsed()));
    }
}

/// Notes down the words that all three converters have made since the last time.
fn note_words(bench: &Bench<Shaken>, words: &mut u64, witness: &Witness) {
    let made = (0..AXES)
        .map(|axis| bench.sent(axis).words())
        .min()
        .unwrap_or(0);
    if made == *words {
        return;
    }
    let Ok(mut list) = witness.lock() else { return };
    for index in *words..made {
        list.push([0, 1, 2].map(|axis| bench.word(axis, index).unwrap_or(0)));
    }
    *words = made;
}

/// Notes down the words that each converter has made since the last time.
fn note_by_axis(bench: &Bench<Shaken>, noted: &mut [u64; AXES], witness: &AxisWitness) {
    let made = [0, 1, 2].map(|axis| bench.sent(axis).words());
    if made == *noted {
        return;
    }
    let Ok(mut lists) = witness.lock() else {
        return;
    };
    for (axis, list) in lists.iter_mut().enumerate() {
        let new = noted[axis]..made[axis];
        list.extend(new.map(|index| bench.word(axis, index).unwrap_or(0)));
    }
    *noted = made;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::board::{BoardSource, Plan, Stop};
    use crate::source::{Chunk, Source};

    const SEED: u64 = 5;

    /// A record of a second by a host that rests for so long after every chunk.
    fn record(rest: Duration) -> Vec<Chunk> {
        record_of(VirtualConnect::published(SEED, 0.0), rest)
    }

    fn record_of(connect: VirtualConnect, rest: Duration) -> Vec<Chunk> {
        let plan = Plan {
            samples: Some(2000),
            ..Plan::default()
        };
        let connect = Box::new(connect);
        let mut source =
            BoardSource::start(connect, plan, None, Stop::default()).expect("a virtual board");
        let mut chunks = Vec::new();
        while let Some(chunk) = source.next_chunk().expect("no loss") {
            chunks.push(chunk);
            thread::sleep(rest);
        }
        chunks
    }

    #[test]
    fn a_slow_host_records_what_a_fast_one_does() {
        let [fast, slow] = [0, 20].map(|rest_ms| record(Duration::from_millis(rest_ms)));
        let count = |chunks: &[Chunk]| -> usize {
            let samples = chunks.iter().map(|chunk| match chunk {
                Chunk::Samples(block) => block.len(),
                _ => 0,
            });
            samples.sum()
        };
        let counts = [count(&fast), count(&slow)];
        assert!(counts[0] >= 2000, "seed {SEED}: {counts:?} samples");
        // To the last sample: when the board stops follows from what the host had read.
        assert!(fast == slow, "seed {SEED}: {counts:?} samples");
    }

    /// A machine that left the board's thread no time for longer than the host is patient made the
    /// board silent: it was asked again, and started again.
    #[test]
    fn a_board_that_gets_no_time_records_what_a_fast_one_does() {
        /// Longer than the silence that a host bears, and than three waits for a reply.
        const HELD_UP: Duration = Duration::from_millis(4700);
        let witness = Witness::default();
        let (held, holds) = mpsc::channel();
        let holder = Arc::clone(&witness);
        let holding = thread::spawn(move || {
            let words = holder.lock();
            held.send(()).expect("awaited");
            thread::sleep(HELD_UP);
            drop(words);
        });
        holds.recv().expect("held");
        // The thread stands still at its first word.
        let board = VirtualConnect {
            witness: Some(witness),
            ..VirtualConnect::published(SEED, 0.0)
        };
        let slow = record_of(board, Duration::ZERO);
        holding.join().expect("no panic");
        assert!(slow == record(Duration::ZERO), "seed {SEED}");
    }
}
