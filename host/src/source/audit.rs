//! Proof, not hope, that the chain lost nothing: the board's digests against our own.
//!
//! ```text
//!   batches --> bins of our own --+
//!                                 +--> Proof
//!   health  --> the board's mark -+
//! ```
//!
//! [`Audit`] is fed by [`Frames`](super::frames::Frames) with what arrived intact, in order, and
//! keeps the bins that the board keeps ([`ProofBins`]). When a batch was lost on the link there
//! is nothing to compare until the board has begun its bins anew at a conversion that its answer
//! names; the answer stands in the stream, so a capture is proven the way it was proven live.

mod state;

use inm_firmware::proof::{ProofBins, good_runs};
use inm_protocol::{AXES, Batch, Health};

pub use state::{Proof, State};

/// Words an axis that are gathered before they enter the bins.
const RUN: usize = 4096;

/// Compares a stream with what the board says of it.
#[derive(Debug, Default)]
pub struct Audit {
    bins: Box<ProofBins>,
    /// Good words by axis that are still to enter the bins.
    runs: [Run; AXES],
    /// Stream, sequence number and end of the last batch.
    last: Option<(u16, u32, u64)>,
    /// Whether the bins hold everything since their beginning.
    complete: bool,
    /// Where the board will begin anew.
    pending: Option<u64>,
    /// From the board's count to that of the record.
    offset: u64,
    /// Conversions proven before the bins began.
    proven_before: u64,
    /// Where the comparison broke, in the count of the record.
    unproven_since: u64,
    proof: Proof,
}

/// Consecutive good words of one axis.
#[derive(Debug, Clone, Default)]
struct Run {
    first: u64,
    codes: Vec<i32>,
}

impl Run {
    fn end(&self) -> u64 {
        self.first.wrapping_add(self.codes.len() as u64)
    }
}

impl Audit {
    /// Takes the next batch that arrived intact. `offset` leads from its index to that of the
    /// record. Returns the state if it became one worth telling.
    pub fn batch(&mut self, batch: &Batch, offset: u64) -> Option<State> {
        let this = (batch.stream, batch.seq, batch.end());
        let before = self.last.replace(this);
        let follows = before.is_some_and(|(stream, seq, end)| {
            batch.stream == stream && batch.seq == seq.wrapping_add(1) && batch.first >= end
        });
        self.offset = offset;
        let mut told = None;
        if !follows && batch.seq == 0 {
            self.begin(0);
        } else if !follows {
            told = self.lose(before.map_or(0, |(_, _, end)| end));
        }
        if let Some(epoch) = self.pending.filter(|&epoch| batch.end() > epoch) {
            self.pending = None;
            // The board's bins begin there in any case; were ours there in time?
            if follows || batch.first <= epoch {
                self.begin(epoch);
            } else {
                told = self.lose(epoch).or(told);
            }
        }
        if self.complete {
            self.gather(batch);
        }
        told
    }

    /// Takes a health record. Returns the state if it became one worth telling.
    pub fn health(&mut self, health: &Health) -> Option<State> {
        let mark = health.bins.filter(|_| self.complete)?;
        let (stream, _, end) = self.last?;
        // Of another stream the first batch is still to come, and says so.
        if health.stream != stream {
            return None;
        }
        if mark.epoch != self.bins.epoch() || mark.index != end {
            return self.lose(end);
        }
        self.enter_all();
        let was = self.proof.state;
        let index = self.in_record(mark.index);
        if self.bins.mark(mark.index) == Some(mark) {
            let epoch = self.in_record(mark.epoch);
            self.proof.state = State::Proven { epoch, index };
            self.proof.proven = self.proven_before + mark.index.saturating_sub(mark.epoch);
            let again = mark.epoch > 0 && !matches!(was, State::Proven { .. });
            again.then_some(self.proof.state)
        } else {
            self.complete = false;
            self.proof.disagreements += 1;
            self.unproven_since = index;
            self.proof.state = State::Disagrees { index };
            Some(self.proof.state)
        }
    }

    /// Takes the board's answer to a request to begin anew: with conversion `epoch`. Returns the
    /// state if it became one worth telling.
    pub fn begins_anew(&mut self, epoch: u64) -> Option<State> {
        let (_, _, end) = self.last?;
        if epoch < end {
            // The answer was late, the board has begun without us.
            return self.lose(end);
        }
        self.pending = Some(epoch);
        if self.complete {
            return None;
        }
        self.proof.state = State::Waiting {
            epoch: self.in_record(epoch),
        };
        Some(self.proof.state)
    }

    /// Whether nothing can be compared until the board begins anew, and it has not said where.
    pub fn wants_new_beginning(&self) -> bool {
        self.last.is_some() && !self.complete && self.pending.is_none()
    }

    /// What is proven so far.
    pub fn proof(&self) -> Proof {
        self.proof
    }

    /// From the board's count to that of the record. Indices are numbers from the wire: whatever
    /// they are, nothing panics.
    fn in_record(&self, index: u64) -> u64 {
        index.wrapping_add(self.offset)
    }

    fn begin(&mut self, epoch: u64) {
        self.bins.begin(epoch);
        for run in &mut self.runs {
            run.codes.clear();
        }
        self.complete = true;
        self.pending = None;
        self.proven_before = self.proof.proven;
        self.proof.state = State::Waiting {
            epoch: self.in_record(epoch),
        };
    }

    /// The bins lack what the link lost from `index` on.
    fn lose(&mut self, index: u64) -> Option<State> {
        let breaks = self.complete || self.proof.state == State::Unheard;
        if breaks {
            self.proof.breaks += 1;
            self.unproven_since = self.in_record(index);
        }
        self.complete = false;
        self.proof.state = match self.pending {
            Some(epoch) => State::Waiting {
                epoch: self.in_record(epoch),
            },
            None => State::Lost {
                index: self.unproven_since,
            },
        };
        breaks.then_some(self.proof.state)
    }

    /// Gathers the good words of a batch.
    fn gather(&mut self, batch: &Batch) {
        for axis in 0..AXES {
            for range in good_runs(batch, axis as u8) {
                let first = batch.first.wrapping_add(range.start as u64);
                let run = &self.runs[axis];
                if run.end() != first || run.codes.len() >= RUN {
                    self.enter(axis);
                    self.runs[axis].first = first;
                }
                let codes = batch.codes[range].iter().map(|codes| codes[axis].0);
                self.runs[axis].codes.extend(codes);
            }
        }
    }

    /// Puts the words gathered of one axis into its bins.
    fn enter(&mut self, axis: usize) {
        let run = &mut self.runs[axis];
        self.bins.run(axis, run.first, &run.codes);
        run.first = run.end();
        run.codes.clear();
    }

    fn enter_all(&mut self) {
        for axis in 0..AXES {
            self.enter(axis);
        }
    }
}

#[cfg(test)]
mod tests;
