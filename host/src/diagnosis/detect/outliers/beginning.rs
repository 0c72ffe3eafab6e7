//! The samples that a record of means begins with.

use std::sync::Arc;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::wave::Outlier;
use crate::diagnosis::statistic::p_value;

/// The samples that a record of means begins with: the first is one sample, the next a mean of two, until there are all.
pub struct Beginning {
    /// How many there are before the first that is one like all others.
    means: usize,
}

impl Beginning {
    /// By the laws that are known.
    pub fn of(axis: &AxisState) -> Self {
        let others = axis.laws.iter().filter_map(|law| axis.begins_with(law));
        let means = others.map(|some| some.end).max().unwrap_or(0);
        Self { means }
    }

    /// Whether what was found at a sample is more than that it is a mean over fewer: white noise is larger there, by the square
    /// root of what is missing.
    pub fn is_beyond(&self, found: &Outlier, level: f64) -> bool {
        if found.index >= self.means {
            return true;
        }
        let wider = ((self.means + 1) as f64 / (found.index + 1) as f64).sqrt();
        found.size.abs()
            > wider * found.size_sd * p_value::threshold(level, self.means, f64::INFINITY)
    }

    /// Puts these samples, which no fit looks at, into `values`, unless something else excludes them.
    pub fn put_back(&self, axis: &AxisState, values: &mut Arc<Vec<f64>>) {
        let own = 0..self.means;
        let mut excluded = axis.residual.left_out();
        if self.means > 0 && excluded.all(|one| *one == own || one.start >= own.end) {
            let all = axis.residual.everywhere();
            Arc::make_mut(values)[own.clone()].copy_from_slice(&all[own]);
        }
    }
}
