//! Runs a recording to its end while showing how it goes.

use std::collections::VecDeque;

use super::view::{Scene, View};
use super::{Observed, Screen};
use crate::bins::record::Record;
use crate::source::{Chunk, SourceError};

/// News that can be looked back at: some screens full, and 20 kB.
const NEWS: usize = 200;

/// Runs `source` to its end: every chunk goes to `record`, if there is one, and `screen` shows
/// the state now and then. What is slow about that, a thread of its own does.
///
/// # Errors
/// What ends the source early; `record` holds everything up to there.
pub fn watch(
    source: &mut dyn Observed,
    mut record: Option<&mut Record>,
    screen: Screen,
) -> Result<(), SourceError> {
    let mut news = VecDeque::new();
    let mut view = View::new(screen, source.signal().clone());
    let result = loop {
        let chunk = match source.next_chunk() {
            Ok(Some(chunk)) => chunk,
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        };
        match &chunk {
            Chunk::Samples(_) => {}
            Chunk::Gap(gap) => note(
                &mut news,
                format!("gap after sample {}: {}", gap.from, gap.cause),
            ),
            Chunk::News(text) => note(&mut news, text.clone()),
        }
        if let Some(record) = &mut record {
            record.push(chunk);
        }
        if view.is_due() {
            view.show(scene(source, record.as_deref(), &news, false));
        }
    };
    if let Some(record) = &mut record {
        record.enter_rate(source.measured_rate_hz());
    }
    view.finish(scene(source, record.as_deref(), &news, true));
    result
}

fn note(news: &mut VecDeque<String>, text: String) {
    if news.len() == NEWS {
        news.pop_front();
    }
    news.push_back(text);
}

/// The state of the recording now.
fn scene(
    source: &dyn Observed,
    record: Option<&Record>,
    news: &VecDeque<String>,
    last: bool,
) -> Scene {
    let mut snapshot = source.snapshot();
    snapshot.news = news.iter().cloned().collect();
    let axes = &source.signal().axes;
    snapshot.axes = axes
        .iter()
        .map(|axis| format!("{}, {}", axis.name, axis.unit))
        .collect();
    Scene {
        snapshot,
        record: record.cloned(),
        last,
    }
}
