//! The thread of an artist: a slow fit or a stopped terminal costs views, never samples.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::{Snapshot, Strip};
use crate::bins::record::Record;
use crate::inspect::self_test::SelfTest;
use crate::signal::Signal;

/// How long the end of a recording waits for its last picture, which takes a fit or two of an axis;
/// a terminal that is stopped for longer does without.
const LAST: Duration = Duration::from_secs(5);

/// What a picture is made of.
#[derive(Clone)]
pub struct Scene {
    /// Counts the recordings: what was learned of one is not true of another.
    pub recording: usize,
    /// What the recording is of.
    pub signal: Signal,
    /// The state of the stream.
    pub snapshot: Snapshot,
    /// What has been recorded, where that is shown.
    pub record: Option<Arc<Record>>,
    /// The last seconds.
    pub strip: Strip,
    /// The recording has ended.
    pub last: bool,
    /// What there is to say of what the bench does now; may be empty.
    pub said: String,
    /// The last self-test of the board.
    pub tested: Option<Arc<SelfTest>>,
}

/// Who shows a recording while it goes on, on a thread of its own.
pub trait Artist: Send {
    /// Between two scenes.
    fn period(&self) -> Duration;

    /// Shows a scene; of what comes meanwhile only the end of a recording is shown.
    fn draw(&mut self, scene: Scene);

    /// Nothing more will come.
    fn close(self: Box<Self>) {}
}

/// The near end of the thread.
pub struct View {
    scenes: Option<Sender<Scene>>,
    /// A scene is being drawn.
    busy: Arc<AtomicBool>,
    artist: Option<JoinHandle<()>>,
    period: Duration,
    begun: Option<Instant>,
}

impl View {
    /// Has `artist` draw.
    pub fn new(artist: Box<dyn Artist>) -> Self {
        let period = artist.period();
        let (scenes, wanted) = mpsc::channel();
        let busy = Arc::new(AtomicBool::new(false));
        let drawing = Arc::clone(&busy);
        Self {
            scenes: Some(scenes),
            busy,
            artist: Some(thread::spawn(move || draw(artist, &wanted, &drawing))),
            period,
            begun: None,
        }
    }

    /// Whether it is time for another picture, and the last one is done.
    pub fn is_due(&self) -> bool {
        let due = self
            .begun
            .is_none_or(|begun| begun.elapsed() >= self.period);
        due && !self.busy.load(Ordering::Acquire)
    }

    /// Has a scene drawn.
    pub fn show(&mut self, scene: Scene) {
        self.begun = Some(Instant::now());
        self.busy.store(true, Ordering::Release);
        if let Some(scenes) = &self.scenes {
            // A thread that is gone draws nothing more, which costs no sample.
            let _ = scenes.send(scene);
        }
    }

    /// Waits until the last scene is drawn, but not for ever.
    pub fn close(mut self) {
        self.scenes = None;
        let Some(artist) = self.artist.take() else {
            return;
        };
        let deadline = Instant::now() + LAST;
        while !artist.is_finished() && Instant::now() < deadline {
            thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Draws each scene, until no more will come.
fn draw(mut artist: Box<dyn Artist>, scenes: &Receiver<Scene>, busy: &AtomicBool) {
    while let Ok(scene) = scenes.recv() {
        artist.draw(scene);
        busy.store(false, Ordering::Release);
    }
    artist.close();
}
