//! Runs a recording to its end while showing how it goes.

use std::collections::VecDeque;

use super::view::{Artist, Scene, View};
use super::{Observed, Strip, give_terminal_back};
use crate::bins::record::Record;
use crate::source::{Chunk, SourceError};

/// News that can be looked back at: some screens full, and 20 kB.
const NEWS: usize = 200;

/// Runs `source` to its end: every chunk goes to `record`, if there is one, and each of `artists` shows
/// the state now and then. What is slow about that, threads of their own do.
///
/// # Errors
/// What ends the source early; `record` holds everything up to there.
pub fn watch(
    source: &mut dyn Observed,
    mut record: Option<&mut Record>,
    artists: Vec<Box<dyn Artist>>,
) -> Result<(), SourceError> {
    let mut news = VecDeque::new();
    let mut strip = Strip::new(source.signal());
    let mut views: Vec<View> = artists.into_iter().map(View::new).collect();
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
        for view in views.iter_mut().filter(|view| view.is_due()) {
            view.show(scene(source, record.as_deref(), &strip, &news, false));
        }
    };
    if let Some(record) = &mut record {
        record.enter_rate(source.measured_rate_hz());
    }
    for view in views {
        view.finish(scene(source, record.as_deref(), &strip, &news, true));
    }
    // What follows is printed where the terminal was before.
    give_terminal_back();
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
        snapshot,
        record: record.cloned(),
        strip: strip.clone(),
        last,
    }
}
