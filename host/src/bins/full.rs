//! A record in memory, for full overlap at any averaging time.

use inm_allan::{Estimate, Statistic, full};

/// Samples of one axis between gaps, in counts.
#[derive(Debug, Clone, Default)]
pub struct Segments {
    samples: Samples,
    /// Whether the last segment goes on with the next sample.
    open: bool,
}

#[derive(Debug, Clone)]
enum Samples {
    Codes(Vec<Vec<i32>>),
    Floats(Vec<Vec<f64>>),
}

impl Default for Samples {
    fn default() -> Self {
        Self::Codes(Vec::new())
    }
}

impl Segments {
    /// Ends the segment: the next sample does not follow.
    pub fn end(&mut self) {
        self.open = false;
    }

    /// Adds integer samples.
    pub fn push_codes(&mut self, run: &[i32]) {
        match &mut self.samples {
            Samples::Codes(segments) => extend(segments, run, &mut self.open),
            Samples::Floats(_) => {
                self.push_floats(&run.iter().copied().map(f64::from).collect::<Vec<_>>());
            }
        }
    }

    /// Adds floating-point samples; integer ones before them become floats.
    pub fn push_floats(&mut self, run: &[f64]) {
        if let Samples::Codes(segments) = &self.samples {
            let wider = |codes: &Vec<i32>| codes.iter().copied().map(f64::from).collect();
            self.samples = Samples::Floats(segments.iter().map(wider).collect());
        }
        if let Samples::Floats(segments) = &mut self.samples {
            extend(segments, run, &mut self.open);
        }
    }

    /// Samples of the longest segment.
    pub fn longest(&self) -> u64 {
        fn longest<T>(segments: &[Vec<T>]) -> usize {
            segments.iter().map(Vec::len).max().unwrap_or(0)
        }
        match &self.samples {
            Samples::Codes(segments) => longest(segments) as u64,
            Samples::Floats(segments) => longest(segments) as u64,
        }
    }

    /// The estimates at those of `factors` that a segment is long enough for.
    pub fn estimates(&self, statistic: Statistic, factors: &[u64]) -> Vec<Estimate> {
        match &self.samples {
            Samples::Codes(segments) => {
                let segments: Vec<&[i32]> = segments.iter().map(Vec::as_slice).collect();
                let one = |&m: &u64| full::integers(statistic, &segments, m);
                factors.iter().filter_map(one).collect()
            }
            Samples::Floats(segments) => {
                let segments: Vec<&[f64]> = segments.iter().map(Vec::as_slice).collect();
                let one = |&m: &u64| full::floats(statistic, &segments, m);
                factors.iter().filter_map(one).collect()
            }
        }
    }
}

fn extend<T: Copy>(segments: &mut Vec<Vec<T>>, run: &[T], open: &mut bool) {
    match segments.last_mut() {
        Some(segment) if *open => segment.extend_from_slice(run),
        _ => segments.push(run.to_vec()),
    }
    *open = true;
}
