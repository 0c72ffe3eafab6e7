//! The far end of the port: a virtual board that loses its power, restarts, has faulty converters, and
//! a cable that is pulled out.

use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use inm_emulator::{Fault, Slip};
use inm_host::internals::link::{Connect, Port};
use inm_host::internals::virtual_board::{AxisWitness, Misfortune, VirtualConnect};
use inm_protocol::{AXES, Restart};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serialport::{SerialPort, TTYPort};

use super::truth::Noted;

/// Words of a converter in a second.
const RATE: u64 = 4000;

/// Faults that a virtual board takes on, an axis.
const FAULTS: usize = 8;

/// Longest that a cable is out or a board dark, real time. With what it takes to start again, far
/// within `--reconnect`.
const LONGEST_AWAY_MS: u64 = 1500;

/// How often things happen, and how fast time passes.
#[derive(Debug, Clone, Copy)]
pub struct Weather {
    /// Seconds of board time in a second.
    pub speed: f64,
    /// Board time between two cables out, on average, seconds.
    pub cable_s: f64,
    /// Board time between two losses of power, on average, seconds; between two of them the board
    /// restarts once by itself, and every axis has eight faults, twice.
    pub power_s: f64,
    /// Whether bits slip, too.
    pub slips: bool,
}

/// What happened.
#[derive(Debug, Clone, Copy, Default)]
pub struct Happened {
    /// Times that the cable was out.
    pub cables_out: u64,
    /// Times that the board lost its power.
    pub power_losses: u64,
    /// Restarts of the board by itself that were due.
    pub restarts: u64,
    /// Faults of converters that were due.
    pub faults: u64,
}

/// The far end, at work until it is powered off.
pub struct FarEnd {
    off: Arc<AtomicBool>,
    work: JoinHandle<io::Result<Happened>>,
}

impl FarEnd {
    /// Powers a board on behind the port `port`, and notes its words down in `folder`.
    pub fn power_on(port: &Path, folder: &Path, seed: u64, weather: Weather) -> io::Result<Self> {
        let cable = Cable::plug(port)?;
        let noted = Noted::create(folder)?;
        let off = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&off);
        let work = thread::spawn(move || {
            let mut bench = FarBench {
                random: Pcg64::seed_from_u64(seed),
                weather,
                witness: AxisWitness::default(),
                noted,
                happened: Happened::default(),
            };
            bench.work(cable, &ended)?;
            bench.noted.finish()?;
            Ok(bench.happened)
        });
        Ok(Self { off, work })
    }

    /// Ends it; what had happened.
    pub fn power_off(self) -> io::Result<Happened> {
        self.off.store(true, Ordering::Relaxed);
        self.work.join().unwrap_or(Err(ErrorKind::Other.into()))
    }
}

struct FarBench {
    random: Pcg64,
    weather: Weather,
    witness: AxisWitness,
    noted: Noted,
    happened: Happened,
}

impl FarBench {
    fn work(&mut self, mut cable: Cable, off: &AtomicBool) -> io::Result<()> {
        let mut board = self.board()?;
        // Board time, by the words of X.
        let mut words = 0;
        let (mut out_at, mut dead_at) = (self.after(self.weather.cable_s), self.life());
        while !off.load(Ordering::Relaxed) {
            for command in cable.commands.try_iter() {
                board.write_all(&command)?;
            }
            self.carry(board.as_mut(), &mut cable, off)?;
            words += self.note()?;
            let now = words as f64 / RATE as f64;
            if now > out_at {
                self.happened.cables_out += 1;
                let path = cable.path.clone();
                drop(cable);
                self.send_unheard(board.as_mut())?;
                cable = Cable::plug(&path)?;
                out_at = now + self.after(self.weather.cable_s);
            }
            if now > dead_at {
                self.happened.power_losses += 1;
                board = self.board()?;
                dead_at = now + self.life();
            }
        }
        Ok(())
    }

    /// A board with faults to come.
    fn board(&mut self) -> io::Result<Box<dyn Port>> {
        let mut board = VirtualConnect::published(self.random.random(), self.weather.speed);
        board.axis_witness = Some(Arc::clone(&self.witness));
        // All of them within the half of a life that is as short as any.
        let most = (0.2 * self.weather.power_s * RATE as f64) as u64;
        for axis in 0..AXES {
            for _ in 0..FAULTS {
                let word = self.random.random_range(0..most);
                let fault = self.fault();
                board.faults.push((axis, word, fault));
            }
        }
        let causes = [
            Restart::Watchdog,
            Restart::ClockFallback,
            Restart::Panic {
                line: 1,
                file: b"night".iter().copied().collect(),
            },
        ];
        board.restarts.push(Misfortune {
            words: self.random.random_range(most / 2..2 * most),
            cause: causes[self.random.random_range(0..causes.len())].clone(),
            dark: self.away(),
        });
        self.happened.faults += (AXES * FAULTS) as u64;
        self.happened.restarts += 1;
        board.open().map_err(io::Error::other)
    }

    fn fault(&mut self) -> Fault {
        let kinds = if self.weather.slips { 8 } else { 7 };
        match self.random.random_range(0..kinds) {
            0 => Fault::DrdyStops,
            1 => Fault::BusStuck {
                high: self.random.random(),
                conversions: None,
            },
            2 => Fault::BusStuck {
                high: self.random.random(),
                conversions: Some(self.random.random_range(1..50)),
            },
            3 => Fault::Overload {
                input: if self.random.random() {
                    3 << 29
                } else {
                    -(3 << 29)
                },
                conversions: self.random.random_range(1..200),
            },
            4 => Fault::BrownOut,
            5 => Fault::LateRead {
                bits: self.random.random_range(1..32),
            },
            6 => Fault::BusError,
            _ => Fault::Slip(if self.random.random() {
                Slip::Early
            } else {
                Slip::Late
            }),
        }
    }

    /// Takes what the board has sent to the host.
    fn carry(
        &mut self,
        board: &mut dyn Port,
        cable: &mut Cable,
        off: &AtomicBool,
    ) -> io::Result<()> {
        let mut buf = [0; 1 << 14];
        match board.read(&mut buf) {
            Ok(length) => cable.send(&buf[..length], off),
            Err(error) if error.kind() == ErrorKind::TimedOut => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// What the board sends while the cable is out.
    fn send_unheard(&mut self, board: &mut dyn Port) -> io::Result<()> {
        let until = Instant::now() + self.away();
        let mut buf = [0; 1 << 14];
        while Instant::now() < until {
            match board.read(&mut buf) {
                Err(error) if error.kind() != ErrorKind::TimedOut => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }

    /// Words of X since the last time.
    fn note(&mut self) -> io::Result<u64> {
        let Ok(mut lists) = self.witness.lock() else {
            return Err(ErrorKind::Other.into());
        };
        let words = lists[0].len() as u64;
        self.noted.note(&mut lists)?;
        Ok(words)
    }

    fn away(&mut self) -> Duration {
        Duration::from_millis(self.random.random_range(0..LONGEST_AWAY_MS))
    }

    /// Without a memory: any moment is as likely as any other.
    fn after(&mut self, mean_s: f64) -> f64 {
        -mean_s * (1.0 - self.random.random::<f64>()).ln()
    }

    /// From half to one and a half of the mean.
    fn life(&mut self) -> f64 {
        self.weather.power_s * (0.5 + self.random.random::<f64>())
    }
}

/// A cable that is plugged in.
struct Cable {
    path: PathBuf,
    near: TTYPort,
    /// Held open here, the terminal outlives a program that closes its end.
    _far: TTYPort,
    /// What the host writes.
    commands: Receiver<Vec<u8>>,
}

impl Cable {
    /// A new port under the name `path`.
    fn plug(path: &Path) -> io::Result<Self> {
        let (near, far) = TTYPort::pair()?;
        let name = far.name().ok_or(ErrorKind::NotFound)?;
        let _ = fs::remove_file(path);
        symlink(name, path)?;
        let mut reader = near.try_clone_native()?;
        reader.set_timeout(Duration::from_millis(100))?;
        let (to_board, commands) = mpsc::channel();
        thread::spawn(move || {
            let mut buf = [0; 4096];
            loop {
                match reader.read(&mut buf) {
                    Ok(length) if to_board.send(buf[..length].to_vec()).is_err() => return,
                    Err(error) if error.kind() != ErrorKind::TimedOut => return,
                    // Ends with the receiver, though nothing more comes.
                    Err(_) if to_board.send(Vec::new()).is_err() => return,
                    _ => {}
                }
            }
        });
        Ok(Self {
            path: path.to_owned(),
            near,
            _far: far,
            commands,
        })
    }

    /// Waits for who reads: here the time of the board is not that of the wall.
    fn send(&mut self, mut bytes: &[u8], off: &AtomicBool) -> io::Result<()> {
        while !bytes.is_empty() && !off.load(Ordering::Relaxed) {
            match self.near.write(bytes) {
                Ok(length) => bytes = &bytes[length..],
                Err(error) if error.kind() == ErrorKind::TimedOut => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}
