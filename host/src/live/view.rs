//! The thread that fits, and hands what came of it to the screen: a slow fit or a stopped terminal costs
//! views, never samples.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::noise::Noises;
use super::table::table;
use super::{Screen, Snapshot, give_terminal_back};
use crate::bins::record::Record;
use crate::signal::Signal;

/// How long the end of a recording waits for its last picture, which takes a fit or two of an axis;
/// a terminal that is stopped for longer does without.
const LAST: Duration = Duration::from_secs(5);

/// What a picture is made of.
pub struct Scene {
    /// The state of the stream.
    pub snapshot: Snapshot,
    /// What has been recorded, where that is shown.
    pub record: Option<Record>,
    /// Whether the coefficients are fitted anew in any case.
    pub last: bool,
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
    /// Draws on `screen` what comes of a record described by `signal`.
    pub fn new(screen: Screen, signal: Signal) -> Self {
        let period = screen.period();
        let (scenes, wanted) = mpsc::channel();
        let busy = Arc::new(AtomicBool::new(false));
        let drawing = Arc::clone(&busy);
        let artist = thread::spawn(move || draw(screen, &signal, &wanted, &drawing));
        Self {
            scenes: Some(scenes),
            busy,
            artist: Some(artist),
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

    /// Has the last scene drawn and waits for it, but not for ever.
    pub fn finish(mut self, scene: Scene) {
        self.show(scene);
        self.scenes = None;
        let Some(artist) = self.artist.take() else {
            return;
        };
        let deadline = Instant::now() + LAST;
        while !artist.is_finished() && Instant::now() < deadline {
            thread::sleep(Duration::from_millis(5));
        }
        // What follows is printed where the terminal was before.
        give_terminal_back();
    }
}

/// Draws each scene, until no more will come.
fn draw(mut screen: Screen, signal: &Signal, scenes: &Receiver<Scene>, busy: &AtomicBool) {
    let mut noise = Noises::default();
    while let Ok(scene) = scenes.recv() {
        let Scene {
            mut snapshot,
            record,
            last,
        } = scene;
        if let Some(record) = &record {
            if last || noise.is_due() {
                noise.fit(signal, record);
            }
            snapshot.table = table(signal, record);
            snapshot.noise.clone_from(&noise.rows);
        }
        screen.show(snapshot);
        busy.store(false, Ordering::Release);
    }
    screen.close();
}
