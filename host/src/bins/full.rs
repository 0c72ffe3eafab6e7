//! A record in memory, for full overlap at any averaging time.

use std::sync::OnceLock;

use inm_allan::fixed_point::FixedPoint;
use inm_allan::full::{Cumulated, cumulate};
use inm_allan::{Estimate, Statistic};

/// Samples of one axis between gaps, in counts. Eight bytes each, on top of the four or eight of the
/// sample itself, once estimates have been asked for.
#[derive(Debug, Clone, Default)]
pub struct Segments {
    samples: Samples,
    /// Whether the last segment goes on with the next sample.
    open: bool,
    /// What the samples so far sum up to.
    cumulative: OnceLock<Cumulative>,
}

#[derive(Debug, Clone)]
enum Samples {
    Codes(Vec<Vec<i32>>),
    Floats(Vec<Vec<f64>>),
}

/// Cumulative sums of the segments.
#[derive(Debug, Clone)]
struct Cumulative {
    sums: Vec<Vec<i64>>,
    /// Of floating-point samples; `None` for codes.
    grid: Option<FixedPoint>,
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
        self.cumulative.take();
        match &mut self.samples {
            Samples::Codes(segments) => extend(segments, run, &mut self.open),
            Samples::Floats(_) => {
                self.push_floats(&run.iter().copied().map(f64::from).collect::<Vec<_>>());
            }
        }
    }

    /// Adds floating-point samples, all of them finite; integer ones before them become floats.
    pub fn push_floats(&mut self, run: &[f64]) {
        self.cumulative.take();
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
        let cumulative = self.cumulative.get_or_init(|| self.samples.cumulate());
        let segments = cumulative.segments();
        let cumulated = Cumulated::new(&segments);
        let one = |&m: &u64| {
            let mut estimate = cumulated.estimate(statistic, m)?;
            if let Some(grid) = cumulative.grid {
                estimate.variance = grid.scale_variance(estimate.variance);
            }
            Some(estimate)
        };
        factors.iter().filter_map(one).collect()
    }
}

impl Cumulative {
    fn segments(&self) -> Vec<&[i64]> {
        self.sums.iter().map(Vec::as_slice).collect()
    }

    fn range(&self) -> u64 {
        Cumulated::new(&self.segments()).range()
    }
}

impl Samples {
    /// Sums that are quick to work with. For that the grid of floating-point samples is coarser
    /// than need be where they wander: by 2^5 in 10^7 samples of a walk.
    fn cumulate(&self) -> Cumulative {
        match self {
            Self::Codes(segments) => Cumulative {
                sums: sums(segments, |&code| i64::from(code)),
                grid: None,
            },
            Self::Floats(segments) => {
                let mut headroom = 1.0;
                loop {
                    let cumulative = cumulate_floats(segments, headroom);
                    let range = cumulative.range();
                    if range <= Cumulated::QUICK {
                        return cumulative;
                    }
                    headroom *= (range as f64 / Cumulated::QUICK as f64)
                        .log2()
                        .ceil()
                        .exp2();
                }
            }
        }
    }
}

/// On a grid that covers `headroom` times what the samples reach.
fn cumulate_floats(segments: &[Vec<f64>], headroom: f64) -> Cumulative {
    let grid = FixedPoint::covering(segments.iter().flatten().copied(), headroom);
    Cumulative {
        // Every finite sample has a code on a grid that covers them all.
        sums: sums(segments, |&sample| grid.code(sample).unwrap_or(0)),
        grid: Some(grid),
    }
}

/// The cumulative sums of each segment.
fn sums<T>(segments: &[Vec<T>], code: impl Fn(&T) -> i64) -> Vec<Vec<i64>> {
    let cumulated = |segment: &Vec<T>| {
        let total: i128 = segment.iter().map(|sample| i128::from(code(sample))).sum();
        // The mean of codes is one.
        let level = (total / (segment.len() as i128).max(1)) as i64;
        let mut sums = vec![0; segment.len() + 1];
        cumulate(segment.iter().map(&code), level, &mut sums);
        sums
    };
    segments.iter().map(cumulated).collect()
}

fn extend<T: Copy>(segments: &mut Vec<Vec<T>>, run: &[T], open: &mut bool) {
    match segments.last_mut() {
        Some(segment) if *open => segment.extend_from_slice(run),
        _ => segments.push(run.to_vec()),
    }
    *open = true;
}
