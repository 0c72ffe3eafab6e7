//! Draws the page of a bench, as long as someone looks.

use std::io;
use std::net::TcpListener;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::bench;
use super::hub::Hub;
use super::look::{Looker, Seen};
use super::parts::{self, Part};
use super::server::Server;
use crate::analyse::{AnalysisOptions, summarise};
use crate::bins::record::Record;
use crate::live::{Artist, Controls, Scene};
use crate::signal::Signal;

/// Between two states of the page: often enough to see it move.
const PERIOD: Duration = Duration::from_millis(500);

/// Between two analyses at least.
const ANALYSIS_PERIOD: Duration = Duration::from_secs(2);

/// Pause after an analysis, as a multiple of the time that it took: receiving goes first.
const PAUSE: u32 = 10;

/// The page, and its server.
pub struct PageArtist {
    // Ahead of the hub: it ends first.
    server: Server,
    hub: Arc<Hub>,
    recorded: Recorded,
}

/// What is shown of a recording.
struct Recorded {
    /// Its number.
    recording: usize,
    /// When it is time for another analysis.
    due: Option<Instant>,
    /// The analysis is that of the whole recording.
    done: bool,
    /// Who diagnoses it, or why nobody does.
    looker: Result<Looker, String>,
    seen: Option<Seen>,
}

impl PageArtist {
    /// Serves a page at `listener`, whose tabs may do what `controls` allow.
    ///
    /// # Errors
    /// If the system gives no thread, or no randomness.
    pub fn start(listener: TcpListener, controls: Controls) -> io::Result<Self> {
        let hub = Arc::new(Hub::default());
        Ok(Self {
            server: Server::start(listener, Arc::clone(&hub), controls)?,
            hub,
            recorded: Recorded {
                recording: 0,
                due: None,
                done: false,
                looker: Err("no recording has begun".to_owned()),
                seen: None,
            },
        })
    }

    /// The address for the browser, with its token.
    pub fn url(&self) -> &str {
        self.server.url()
    }
}

impl Recorded {
    /// Of the recording of `scene`, of which nothing is known yet.
    fn of(scene: &Scene) -> Self {
        let looker = match &scene.snapshot.capture {
            Some(path) => Looker::new(path).map_err(|error| format!("not possible: {error}")),
            None => Err(
                "nothing is recorded in a file (--no-record), so there is nothing to diagnose"
                    .to_owned(),
            ),
        };
        Self {
            recording: scene.recording,
            due: None,
            done: false,
            looker,
            seen: None,
        }
    }

    /// The pictures and the coefficients, where it is time for them.
    fn analysis(&mut self, signal: &Signal, record: &Record, last: bool) -> Vec<Part> {
        let due = last || self.due.is_none_or(|due| Instant::now() >= due);
        if !due || self.done {
            return Vec::new();
        }
        let begin = Instant::now();
        let analysis = summarise(signal, record, &AnalysisOptions::default());
        let axes = analysis.axes.iter().enumerate();
        let pictures = axes.filter_map(|(number, axis)| parts::axis(number, axis));
        let mut new: Vec<Part> = pictures.flatten().collect();
        new.push(parts::coefficients(&analysis));
        self.due = Some(begin + ANALYSIS_PERIOD.max(PAUSE * begin.elapsed()));
        self.done = last;
        new
    }

    /// What the diagnosis sees, with its age.
    fn diagnosis(&mut self, samples: u64) -> Vec<Part> {
        let looker = match &mut self.looker {
            Ok(looker) => looker,
            Err(words) => return vec![parts::diagnosis_age(words)],
        };
        let mut new = Vec::new();
        if let Some(seen) = looker.go_on(samples) {
            new.push(parts::diagnosis(&seen.text));
            self.seen = Some(seen);
        }
        let age = self.seen.as_ref().map_or_else(
            || "the first look is under way, or waits for half a minute of samples".to_owned(),
            |Seen { of_s, at, .. }| {
                format!(
                    "of the samples from {:.0} s to {:.0} s, seen {} s ago",
                    of_s.0,
                    of_s.1,
                    at.elapsed().as_secs()
                )
            },
        );
        new.push(parts::diagnosis_age(&age));
        new
    }
}

impl Artist for PageArtist {
    fn period(&self) -> Duration {
        PERIOD
    }

    fn draw(&mut self, scene: Scene) {
        // Nobody looks: who comes next has the newest after a period.
        if self.hub.tabs() == 0 {
            return;
        }
        if self.recorded.recording != scene.recording {
            self.recorded = Recorded::of(&scene);
            self.hub.put(parts::empty(&scene.signal));
        }
        self.hub.put(bench::parts(&scene));
        self.hub.put(parts::state(&scene.snapshot));
        self.hub
            .put(self.recorded.diagnosis(scene.snapshot.samples));
        self.hub.put(parts::strips(&scene.strip));
        if let Some(record) = &scene.record {
            let new = self.recorded.analysis(&scene.signal, record, scene.last);
            self.hub.put(new);
        }
    }
}
