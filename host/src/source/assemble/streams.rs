//! Which stream a batch or a notice belongs to, and where the present one stands in the record.

use inm_protocol::Batch;

use super::line::Line;

/// The present stream and the one before it.
#[derive(Debug, Default)]
pub(super) struct Streams {
    /// Added to the board's index, so that the count goes on after a restart.
    offset: u64,
    present: Option<Line>,
    /// The one before, if it had another number.
    former: Option<Line>,
}

impl Streams {
    /// What leads from the board's index to that of the record.
    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// The sample of the record that has this index on the board.
    pub(super) fn place(&self, index: u64) -> u64 {
        index.wrapping_add(self.offset)
    }

    /// Whether what says that it is of `stream` is of another than the present one.
    pub(super) fn is_another(&self, stream: u16) -> bool {
        self.present.is_some_and(|line| !line.is_of(stream))
    }

    /// The record goes on with this batch; true if a stream begins with it.
    pub(super) fn begin_or_extend(&mut self, batch: &Batch) -> bool {
        match &mut self.present {
            Some(line) => {
                line.extend(batch);
                false
            }
            None => {
                self.present = Some(Line::new(batch));
                true
            }
        }
    }

    /// Has a stream begin with this batch, the next, as sample `first` of the record; returns that.
    pub(super) fn anew(&mut self, batch: &Batch, first: u64) -> u64 {
        self.offset = first.wrapping_sub(batch.first);
        let before = self.present.take();
        let other = before.filter(|line| !line.is_of(batch.stream));
        self.former = other.map(Line::over).or(self.former);
        first
    }

    /// What comes next may be of a new stream.
    pub(super) fn announce(&mut self) {
        if let Some(line) = &mut self.present {
            line.announce();
        }
    }

    /// Whether a batch was there already, or comes too late: it is one of the former stream, or of the
    /// present one and not `later` than what has come.
    pub(super) fn hold(&self, batch: &Batch, later: bool) -> bool {
        let holds = |line: Option<Line>| line.is_some_and(|line| line.holds(batch));
        holds(self.former) || (holds(self.present) && !later)
    }
}
