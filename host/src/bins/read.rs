//! A whole source into a record, each axis on a thread of its own.
//!
//! ```text
//!   source: read, decode, compare with the board's bins --> columns of X --> bins, spectrum of X
//!                                                       --> columns of Y --> ...
//! ```
//!
//! The source stays on the caller's thread, which it may be bound to.

use std::panic::resume_unwind;
use std::sync::mpsc::sync_channel;
use std::thread::{self, ScopedJoinHandle};

use super::record::{AxisRecord, Overlap, Record};
use crate::source::{Source, SourceError};

/// Columns of an axis that may wait: 16 KiB each from a capture.
const WAITING: usize = 16;

/// Reads `source` to its end. `progress` is called with the samples read so far.
///
/// # Errors
/// Whatever ends the source early.
pub fn read(
    source: &mut dyn Source,
    overlap: Overlap,
    mut progress: impl FnMut(u64),
) -> Result<Record, SourceError> {
    let mut record = Record::new(source.signal().axes.len(), overlap);
    let axes = std::mem::take(record.axes_mut());
    let axes = thread::scope(|scope| {
        let start = |mut axis: AxisRecord| {
            let (sender, columns) = sync_channel(WAITING);
            let thread = scope.spawn(move || {
                for (missing, column) in columns {
                    axis.pass_over(missing);
                    if let Some(column) = column {
                        axis.push(&column);
                    }
                }
                axis
            });
            (sender, thread)
        };
        let (senders, threads): (Vec<_>, Vec<_>) = axes.into_iter().map(start).unzip();
        while let Some(chunk) = source.next_chunk()? {
            let (missing, columns) = record.enter(chunk);
            let mut columns = columns.into_iter();
            for sender in &senders {
                // Fails if the thread panics; joining it says so.
                let _ = sender.send((missing, columns.next()));
            }
            progress(record.account().samples);
        }
        drop(senders);
        let joined = threads.into_iter().map(ScopedJoinHandle::join);
        let axes = joined.map(|axis| axis.unwrap_or_else(|panic| resume_unwind(panic)));
        Ok::<_, SourceError>(axes.collect())
    })?;
    *record.axes_mut() = axes;
    record.enter_clocks(source.clocks());
    Ok(record)
}
