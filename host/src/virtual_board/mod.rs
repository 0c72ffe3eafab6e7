//! A board without hardware: the firmware's own code on emulated converters, in a thread of its
//! own, at the far end of a port.
//!
//! The thread is the other machine: it shares nothing with the host but the bytes of the link,
//! whose speed is kept in virtual time. Where the host reads slower than the board sends, virtual
//! time waits; nothing is lost that a real host of unlimited speed would have received.

mod shaken;

use std::io::{self, Read, Write};
use std::sync::mpsc::{
    self, Receiver, RecvTimeoutError, Sender, SyncSender, TryRecvError, sync_channel,
};
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

use self::shaken::Shaken;
use crate::link::{Connect, LinkError, Port};

/// Transmit queue of the board, bytes; that of the image.
const QUEUE: usize = 4096;

/// Bytes that are handed over at a time, while the board streams.
const PARCEL: usize = 1 << 14;

/// Parcels on their way to the host: 512 KiB at most.
const PARCELS: usize = 32;

/// Steps of the instrument after which a parcel leaves, full or not: a reply must not wait.
const STEPS: u32 = 2000;

/// How long one read waits for the board's thread.
const READ_TIMEOUT: Duration = Duration::from_millis(50);

/// Words that the converters produced, X Y Z, as witnessed at their pins.
pub type Witness = Arc<Mutex<Vec<[u32; AXES]>>>;

/// Builds virtual boards.
#[derive(Debug, Clone)]
pub struct VirtualConnect {
    /// The accelerometers in front of the converters X, Y, Z, with their noise.
    pub channels: [Channel; AXES],
    /// Seconds of board time in a second; 0 for as fast as it goes.
    pub speed: f64,
    /// Speed of the link in virtual time, bit/s.
    pub baud: u32,
    /// Faults to come: axis, number of the converter's word since the first stream began, what
    /// happens; at most eight an axis. The time before it depends on the host.
    pub faults: Vec<(usize, u64, Fault)>,
    /// What else acts on a sensor.
    pub hidden: Option<Hidden>,
    /// Where the converters' words are noted down, if anywhere.
    pub witness: Option<Witness>,
}

impl VirtualConnect {
    /// The board of the published experiment; `seed` is that of its noise.
    pub fn published(seed: u64, speed: f64) -> Self {
        Self {
            channels: [0, 1, 2].map(|axis| channel::published(axis, seed)),
            speed,
            baud: 921_600,
            faults: Vec::new(),
            hidden: None,
            witness: None,
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

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        let (to_host, from_board) = sync_channel(PARCELS);
        let (to_board, from_host) = mpsc::channel();
        let plan = self.clone();
        thread::spawn(move || power_on(&plan, &to_host, &from_host));
        Ok(Box::new(VirtualPort {
            from_board,
            to_board,
            parcel: Vec::new(),
            at: 0,
        }))
    }
}

/// Runs the board until the host is gone.
fn power_on(plan: &VirtualConnect, to_host: &SyncSender<Vec<u8>>, from_host: &Receiver<Vec<u8>>) {
    let mut restart = Restart::Power;
    loop {
        let bench = Bench::new(plan.sensors().map(Converter::new));
        let board = Board {
            restart,
            ..describe("virtual")
        };
        let instrument = VirtualBoard::instrument(&bench, VirtualLink::new(Some(plan.baud)), board);
        match run(instrument, plan, to_host, from_host) {
            Some(cause) => restart = cause,
            None => return,
        }
    }
}

type Running<'b> = Instrument<VirtualBoard<'b, Shaken, VirtualLink<QUEUE>>>;

/// Runs one life of the board: until it restarts, or the host is gone (`None`).
fn run(
    mut instrument: Running<'_>,
    plan: &VirtualConnect,
    to_host: &SyncSender<Vec<u8>>,
    from_host: &Receiver<Vec<u8>>,
) -> Option<Restart> {
    let started = Instant::now();
    let mut parcel = Vec::with_capacity(PARCEL);
    let mut steps = 0;
    let mut words = 0;
    let mut faults = &plan.faults[..];
    loop {
        instrument.step();
        steps += 1;
        let bench = instrument.platform().bench();
        if !faults.is_empty() && instrument.is_streaming() {
            for &(axis, word, fault) in std::mem::take(&mut faults) {
                bench.inject_at(axis, bench.sent(axis).words() + word, fault);
            }
        }
        if let Some(witness) = &plan.witness {
            note_words(bench, &mut words, witness);
        }
        let now_ps = bench.now_ps();
        let link = instrument.platform_mut().environment_mut();
        link.take(now_ps, |byte| parcel.push(byte));
        if link.restarts() > 0 {
            return Some(Restart::Command);
        }
        if parcel.len() < PARCEL && steps < STEPS {
            continue;
        }
        steps = 0;
        if !parcel.is_empty() {
            let full = std::mem::replace(&mut parcel, Vec::with_capacity(PARCEL));
            to_host.send(full).ok()?;
        }
        loop {
            match from_host.try_recv() {
                Ok(bytes) => link.send(&bytes),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return None,
            }
        }
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

/// The host's end of a virtual board's link.
struct VirtualPort {
    from_board: Receiver<Vec<u8>>,
    to_board: Sender<Vec<u8>>,
    parcel: Vec<u8>,
    at: usize,
}

impl Read for VirtualPort {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        if self.at == self.parcel.len() {
            self.parcel =
                self.from_board
                    .recv_timeout(READ_TIMEOUT)
                    .map_err(|error| match error {
                        RecvTimeoutError::Timeout => io::ErrorKind::TimedOut,
                        RecvTimeoutError::Disconnected => io::ErrorKind::BrokenPipe,
                    })?;
            self.at = 0;
        }
        let rest = &self.parcel[self.at..];
        let len = rest.len().min(buf.len());
        buf[..len].copy_from_slice(&rest[..len]);
        self.at += len;
        Ok(len)
    }
}

impl Write for VirtualPort {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        let gone = |_| io::ErrorKind::BrokenPipe;
        self.to_board.send(buf.to_vec()).map_err(gone)?;
        Ok(buf.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
