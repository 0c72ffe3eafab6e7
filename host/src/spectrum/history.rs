//! The samples of a level while they are few: what the lowest frequencies are estimated from.
//!
//! A level keeps up to [`CAPACITY`] samples in their gap-free runs; once there are more, the next
//! level has an eighth of them and serves instead, and the level forgets its own.

/// Most samples that a level keeps.
pub const CAPACITY: usize = 8192;

/// Runs shorter than this say nothing about frequencies that the segments do not know better.
pub const SHORTEST: usize = 32;

/// A gap-free run of a level.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SlowRun {
    /// Absolute index of the first sample, at the level's rate.
    pub first: u64,
    /// The samples, relative to the first good sample of the record.
    pub samples: Vec<f64>,
}

/// Gap-free runs of a level from the record's start, as long as they fit.
#[derive(Debug, Clone, Default)]
pub struct History {
    runs: Vec<SlowRun>,
    /// Whether the last run may still grow.
    open: bool,
    total: usize,
    overflown: bool,
}

impl History {
    /// The runs, if the whole record is in them.
    pub fn runs(&self) -> Option<&[SlowRun]> {
        (!self.overflown).then_some(&self.runs[..])
    }

    /// Takes the next samples of the present run, `first` being the index of the first of them.
    pub fn push(&mut self, first: u64, samples: &[f64]) {
        if self.overflown || samples.is_empty() {
            return;
        }
        self.total += samples.len();
        if self.total > CAPACITY {
            *self = Self {
                overflown: true,
                ..Self::default()
            };
            return;
        }
        match self.runs.last_mut() {
            Some(run) if self.open => run.samples.extend_from_slice(samples),
            _ => self.runs.push(SlowRun {
                first,
                samples: samples.to_vec(),
            }),
        }
        self.open = true;
    }

    /// Ends the present run; one too short to be of use is dropped.
    pub fn finish_run(&mut self) {
        if self.open
            && self
                .runs
                .last()
                .is_some_and(|run| run.samples.len() < SHORTEST)
        {
            self.runs.pop();
        }
        self.open = false;
    }
}
