//! Runs a recording to its end while showing how it goes.

use std::collections::VecDeque;
use std::sync::Arc;

use super::view::{Artist, Scene};
use super::{Observed, Stage, Strip};
use crate::bins::record::Record;
use crate::source::{Chunk, SourceError};

/// News that can be looked back at: some screens full, and 20 kB.
const NEWS: usize = 200;

/// Runs `source` to its end: every chunk goes to `record`, if there is one, and `artist` shows the state now
/// and then.
///
/// # Errors
/// What ends the source early; `record` holds everything up to there.
pub fn watch(
    source: &mut dyn Observed,
    record: Option<&mut Record>,
    artist: Box<dyn Artist>,
) -> Result<(), SourceError> {
    let mut stage = Stage::new(vec![artist]);
    let result = watch_on(&mut stage, source, record);
    stage.close();
    result
}

/// The same on a `stage` that has shown others before, and is to show more. What is slow about that,
/// threads of their own do.
///
/// # Errors
/// As [`watch`].
pub fn watch_on(
    stage: &mut Stage,
    source: &mut dyn Observed,
    mut record: Option<&mut Record>,
) -> Result<(), SourceError> {
    let mut news = VecDeque::new();
    let mut strip = Strip::new(source.signal());
    stage.begin();
    let result = loop {
        let chunk = match source.next_chunk() {
            Ok(Some(chunk)) => chunk,
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        };
        match &chunk {
            Chunk::Samples(block) => strip.push(block),
            Chunk::Gap(gap) => note(
                &mut news,
                format!("gap after sample {}: {}", gap.from, gap.cause),
            ),
            Chunk::News(text) => note(&mut news, text.clone()),
        }
        if let Some(record) = &mut record {
            record.push(chunk);
        }
        stage.show(|| scene(source, record.as_deref(), &strip, &news, false));
    };
    if let Some(record) = &mut record {
        record.enter_clocks(source.clocks());
    }
    stage.end(scene(source, record.as_deref(), &strip, &news, true));
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
    strip: &Strip,
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
        recording: 0,
        signal: source.signal().clone(),
        snapshot,
        record: record.cloned().map(Arc::new),
        strip: strip.clone(),
        last,
        said: String::new(),
        tested: None,
    }
}
