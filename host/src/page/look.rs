//! The diagnosis of what is recorded so far, again and again, on a thread of its own.
//!
//! It reads the capture as any other program would, so the recording knows nothing of it.

use std::path::Path;
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::thread;
use std::time::{Duration, Instant};

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::face::diagnose::{DiagnosisError, DiagnosisOptions, diagnose};
use crate::report::Report;
use crate::source::capture::CaptureSource;
use crate::source::part::Part;
use crate::source::{Source, SourceError};

/// Samples an axis that are looked at, the last ones: nine minutes at 2000/s, and with some forty bytes
/// each a bounded memory of some hundred megabytes.
const MOST: u64 = 1 << 20;

/// Samples an axis before the first look: with less there is little to say.
const LEAST: u64 = 1 << 16;

/// Pause after a look, as a multiple of the time that it took: receiving goes first.
const PAUSE: u32 = 3;

/// Between two looks at least.
const PERIOD: Duration = Duration::from_secs(30);

/// What a look has seen.
pub struct Seen {
    /// The text of the diagnosis, or why there is none.
    pub text: String,
    /// The seconds of the record that were looked at.
    pub of_s: (f64, f64),
    /// When it was seen.
    pub at: Instant,
}

/// The near end of the thread.
pub struct Looker {
    ask: SyncSender<u64>,
    seen: Receiver<Seen>,
    due: Instant,
    /// A look goes on since then.
    since: Option<Instant>,
    /// Samples that the last look was asked for.
    of: u64,
}

impl Looker {
    /// For the capture at `path`.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(path: &Path) -> std::io::Result<Self> {
        let (ask, asked) = mpsc::sync_channel(1);
        let (tell, seen) = mpsc::channel();
        let path = path.to_owned();
        // One thread, so that the fits of the recording find another.
        let pool = ThreadPoolBuilder::new().num_threads(1).build();
        let pool = pool.map_err(std::io::Error::other)?;
        thread::Builder::new().spawn(move || look_on(&path, &pool, &asked, &tell))?;
        Ok(Self {
            ask,
            seen,
            due: Instant::now(),
            since: None,
            of: 0,
        })
    }

    /// Begins another look at a record of `samples` samples an axis, if it is time for one and there are
    /// new ones. What the last one has seen, once.
    pub fn go_on(&mut self, samples: u64) -> Option<Seen> {
        let seen = self.seen.try_recv().ok();
        if seen.is_some() {
            let took = self
                .since
                .take()
                .map_or(Duration::ZERO, |since| since.elapsed());
            self.due = Instant::now() + PERIOD.max(PAUSE * took);
        }
        let new = samples >= LEAST && samples > self.of;
        let due = new && self.since.is_none() && Instant::now() >= self.due;
        if due && self.ask.try_send(samples).is_ok() {
            self.since = Some(Instant::now());
            self.of = samples;
        }
        seen
    }
}

/// Looks as often as it is asked to, until nobody will ask.
fn look_on(path: &Path, pool: &ThreadPool, asked: &Receiver<u64>, tell: &Sender<Seen>) {
    while let Ok(samples) = asked.recv() {
        if tell.send(pool.install(|| look(path, samples))).is_err() {
            return;
        }
    }
}

/// One look at the last of `samples` samples an axis.
fn look(path: &Path, samples: u64) -> Seen {
    let mut of_s = (0.0, 0.0);
    let text = diagnosed(path, samples, &mut of_s).unwrap_or_else(|error| format!("{error}\n"));
    Seen {
        text,
        of_s,
        at: Instant::now(),
    }
}

fn diagnosed(path: &Path, samples: u64, of_s: &mut (f64, f64)) -> Result<String, DiagnosisError> {
    let source = CaptureSource::open(path).map_err(SourceError::from)?;
    let rate_hz = source.signal().rate_hz;
    let first = samples.saturating_sub(MOST);
    *of_s = (first as f64 / rate_hz, samples as f64 / rate_hz);
    let mut part = Part::new(source, &[], Some(of_s.0), Some(of_s.1))?;
    let options = DiagnosisOptions {
        views: false,
        ..DiagnosisOptions::default()
    };
    Ok(diagnose(&mut part, options, &|_, _| {})?.text())
}
