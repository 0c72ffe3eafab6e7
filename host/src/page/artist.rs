//! Draws the page of a recording, as long as someone looks.

use std::io;
use std::net::TcpListener;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::hub::Hub;
use super::look::{Looker, Seen};
use super::parts;
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
    signal: Signal,
    due: Option<Instant>,
    looker: Option<Looker>,
    seen: Option<Seen>,
}

impl PageArtist {
    /// Serves, at `listener`, a page about a record described by `signal`, and looks into its capture, if
    /// there is one.
    ///
    /// # Errors
    /// If the system gives no thread, or no randomness.
    pub fn start(
        listener: TcpListener,
        controls: Controls,
        signal: &Signal,
        capture: Option<&Path>,
    ) -> io::Result<Self> {
        let hub = Arc::new(Hub::new());
        // The places of the pictures, in their order.
        hub.put((0..signal.axes.len()).flat_map(parts::places));
        Ok(Self {
            server: Server::start(listener, Arc::clone(&hub), controls)?,
            hub,
            signal: signal.clone(),
            due: None,
            looker: capture.map(Looker::new).transpose()?,
            seen: None,
        })
    }

    /// The address for the browser, with its token.
    pub fn url(&self) -> &str {
        self.server.url()
    }

    /// The pictures and the coefficients, where it is time for them.
    fn analysis(&mut self, record: &Record, last: bool) {
        if !last && self.due.is_some_and(|due| Instant::now() < due) {
            return;
        }
        let begin = Instant::now();
        let analysis = summarise(&self.signal, record, &AnalysisOptions::default());
        let axes = analysis.axes.iter().enumerate();
        let pictures = axes.filter_map(|(number, axis)| parts::axis(number, axis));
        self.hub
            .put(pictures.flatten().chain([parts::coefficients(&analysis)]));
        self.due = Some(begin + ANALYSIS_PERIOD.max(PAUSE * begin.elapsed()));
    }

    /// What the diagnosis sees, with its age.
    fn diagnosis(&mut self, samples: u64) {
        let Some(looker) = &mut self.looker else {
            let words = "nothing is recorded in a file (-o), so there is nothing to diagnose";
            return self.hub.put([parts::diagnosis_age(words)]);
        };
        if let Some(seen) = looker.go_on(samples) {
            self.hub.put([parts::diagnosis(&seen.text)]);
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
        self.hub.put([parts::diagnosis_age(&age)]);
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
        self.diagnosis(scene.snapshot.samples);
        self.hub.put(parts::state(&scene.snapshot));
        self.hub.put(parts::strips(&scene.strip));
        if let Some(record) = &scene.record {
            self.analysis(record, scene.last);
        }
    }
}
