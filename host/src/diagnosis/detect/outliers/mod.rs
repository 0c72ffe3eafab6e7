//! Single samples that do not belong: the matched filter for one sample, at every moment.
//!
//! The filter `1/S` measures how far a sample lies from what all others predict for it, in
//! standard deviations of that prediction (the interpolation error; A. N. Kolmogorov 1941). In
//! differenced noise it is far smaller than the noise itself.

mod pursuit;

use statrs::distribution::{Continuous, ContinuousCDF, Normal};

use self::pursuit::Pursuit;
use crate::diagnosis::statistic::matched_filter::{Impulse, Whole, matched};
use crate::diagnosis::statistic::p_value;

/// Largest number of outliers that are looked for; beyond it is another kind of record.
const MOST: usize = 1 << 14;

/// Outliers from which their law is looked for.
const FEW: usize = 5;

/// Samples to either side that an outlier's own answer of the filter is taken out of, at most: where
/// the density rises with the frequency the filter sums up, and remembers long.
const REACH: usize = 1 << 14;

/// Share of the answer's peak that does not matter any more.
const NOTHING: f64 = 1e-3;

/// A sample that does not belong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Its index.
    pub index: usize,
    /// How much it is too large, in the unit of the record.
    pub size: f64,
    /// Standard deviation of that.
    pub size_sd: f64,
}

/// The outliers of a record, ascending, and the p-value of the largest.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outliers {
    /// All beyond the threshold.
    pub found: Vec<Outlier>,
    /// Probability that noise has a sample as far out anywhere.
    pub p_value: f64,
    /// Size from which one is seen.
    pub threshold: f64,
    /// Gain in log-likelihood on ordinates that the sizes were not fitted to.
    pub nats: f64,
}

/// Looks for outliers at a family-wise `level`, in noise of the densities `density` at the
/// ordinates of `whole`; `usable` tells samples that count, `local` the deviation of the noise about
/// a sample over that of the record.
///
/// The filter's output is measured in units of its own middle spread where that is wider than the
/// model says, so that a model that is wrong elsewhere makes no outliers.
pub fn outliers(
    whole: &Whole,
    density: &[f64],
    level: f64,
    usable: impl Fn(usize) -> bool,
    local: impl Fn(usize) -> f64,
) -> Outliers {
    let filter = matched(whole, density, &Impulse);
    let middle = middle_spread(&filter.z).max(1.0);
    let spread = |index: usize| middle * local(index);
    let threshold = p_value::threshold(level, whole.len(), f64::INFINITY);
    let z = &filter.z;
    let mut candidates: Vec<usize> = (0..z.len())
        .filter(|&index| z[index].abs() > threshold * spread(index) && usable(index))
        .collect();
    let highest = candidates
        .iter()
        .map(|&index| z[index].abs() / spread(index))
        .fold(0.0, f64::max);
    candidates.sort_by(|&a, &b| z[b].abs().total_cmp(&z[a].abs()));
    let size_sd = filter.size_sd;
    // One record's worth of memory at a time: the output is made again beside the short answer.
    drop(filter);
    if candidates.is_empty() {
        return Outliers {
            found: Vec::new(),
            p_value: 1.0,
            threshold: threshold * middle * size_sd,
            nats: 0.0,
        };
    }
    let answer = answer(whole, density);
    let filter = matched(whole, density, &Impulse);
    let mut pursuit = Pursuit::new(filter.z, answer);
    // Largest first; each takes its own tails out of its neighbours.
    for index in candidates.into_iter().take(4 * MOST) {
        if pursuit.left()[index].abs() > threshold * spread(index) && pursuit.len() < MOST {
            pursuit.take(index, &usable);
        }
    }
    pursuit.settle();
    let outlier = |(index, height): (usize, f64)| Outlier {
        index,
        size: height * size_sd,
        size_sd: size_sd * spread(index),
    };
    // One that was moved aside may have nothing left to explain.
    let found: Vec<Outlier> = pursuit
        .heights()
        .filter(|&(index, height)| height.abs() > threshold * spread(index))
        .map(outlier)
        .collect();
    drop(pursuit);
    let nats = if found.is_empty() {
        0.0
    } else {
        let filter = matched(whole, density, &Impulse);
        let gain = |one: &Outlier| {
            let [even, odd] = filter.halves(one.index);
            odd.gain(even.size())
        };
        found.iter().map(gain).sum()
    };
    Outliers {
        p_value: p_value::highest(highest, whole.len(), f64::INFINITY),
        threshold: threshold * middle * size_sd,
        nats,
        found,
    }
}

/// Probability that as many outliers stand close to one another as do, if each came by itself:
/// what rings, or a tone that is switched on, goes beyond the threshold several times.
pub fn together(found: &[Outlier], len: usize) -> f64 {
    /// Samples that count as close.
    const CLOSE: usize = 64;
    let close = found
        .windows(2)
        .filter(|pair| pair[1].index - pair[0].index <= CLOSE);
    let count = found.len() as f64;
    p_value::poisson(
        close.count() as u64,
        count * count * CLOSE as f64 / len as f64,
    )
}

/// Law of all outliers, those too small to be seen included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeLaw {
    /// Outliers in the record.
    pub count: f64,
    /// Standard deviation of the logarithm of their number.
    pub count_log_sd: f64,
    /// Root mean square of their sizes.
    pub size: f64,
    /// Standard deviation of its logarithm.
    pub size_log_sd: f64,
}

/// Normal sizes, seen from `threshold` up: the mean square of those seen gives the law's variance,
/// and that the share which is seen (A. C. Cohen, *Truncated and Censored Samples*, 1991, ch. 2).
pub fn law_of(seen: &[Outlier], threshold: f64) -> SizeLaw {
    let normal = Normal::standard();
    let count = seen.len() as f64;
    let square = seen.iter().map(|one| one.size * one.size).sum::<f64>() / count;
    let own = seen
        .iter()
        .map(|one| one.size_sd * one.size_sd)
        .sum::<f64>()
        / count;
    // Too few to tell how many more there are below the threshold.
    if seen.len() < FEW {
        return SizeLaw {
            count,
            count_log_sd: count.sqrt().recip(),
            size: square.sqrt(),
            size_log_sd: (2.0 * count).sqrt().recip(),
        };
    }
    // Mean square beyond the threshold for a variance.
    let beyond = |variance: f64| {
        let t = threshold / variance.sqrt();
        variance * (1.0 + t * normal.pdf(t) / normal.sf(t).max(f64::MIN_POSITIVE))
    };
    let (mut low, mut high) = ((0.1 * threshold).powi(2), square);
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if beyond(middle) > square {
            high = middle;
        } else {
            low = middle;
        }
    }
    let variance = (low * high).sqrt();
    let share = |variance: f64| 2.0 * normal.sf(threshold / variance.sqrt());
    let step = 1.01_f64;
    let slope = (beyond(variance * step) / beyond(variance / step)).ln() / (2.0 * step.ln());
    let fourth = seen.iter().map(|one| one.size.powi(4)).sum::<f64>() / count;
    let square_log_sd = ((fourth / (square * square) - 1.0).max(0.1) / count).sqrt();
    let variance_log_sd = square_log_sd / slope.max(0.05);
    let share_slope = (share(variance * step) / share(variance / step)).ln() / (2.0 * step.ln());
    SizeLaw {
        count: count / share(variance),
        count_log_sd: count.sqrt().recip().hypot(share_slope * variance_log_sd),
        size: (variance - own).max(0.01 * variance).sqrt(),
        size_log_sd: 0.5 * variance_log_sd,
    }
}

/// How much the samples at `indices` differ from what all others predict for them.
pub fn sizes_at(whole: &Whole, density: &[f64], indices: &[usize]) -> Vec<Outlier> {
    /// Rounds in which neighbours settle what is whose.
    const ROUNDS: usize = 4;
    /// Samples to either side that count as such.
    const NEIGHBOURS: usize = 512;
    let mut answer = answer(whole, density);
    answer.truncate(NEIGHBOURS);
    let filter = matched(whole, density, &Impulse);
    let mut heights = vec![0.0; indices.len()];
    for _ in 0..ROUNDS {
        for (number, &index) in indices.iter().enumerate() {
            let mut height = filter.z[index];
            let before = indices[..number].iter().zip(&heights).rev();
            let after = indices[number + 1..].iter().zip(&heights[number + 1..]);
            let near = |(other, height): (&usize, &f64)| {
                Some(height * answer.get(index.abs_diff(*other))?)
            };
            height -= before.map_while(near).sum::<f64>();
            height -= after.map_while(near).sum::<f64>();
            heights[number] = height;
        }
    }
    indices
        .iter()
        .zip(heights)
        .map(|(&index, height)| Outlier {
            index,
            size: height * filter.size_sd,
            size_sd: filter.size_sd,
        })
        .collect()
}

/// The filter's answer to one sample of size one, from that moment on, over its peak, as far as it
/// matters.
fn answer(whole: &Whole, density: &[f64]) -> Vec<f64> {
    let answer = whole.answer(|k| density[k].recip());
    let peak = answer[0];
    let mut answer = answer[..REACH.min(answer.len() / 2)].to_vec();
    let matters = |value: &f64| value.abs() > NOTHING * peak;
    let end = answer.iter().rposition(matters).map_or(0, |last| last + 1);
    answer.truncate(end);
    answer.iter_mut().for_each(|value| *value /= peak);
    answer
}

/// Spread of the middle half of `values`, as a standard deviation of normal numbers.
pub fn middle_spread(values: &[f64]) -> f64 {
    // A sixteenth of a long series tells it well enough.
    let stride = (values.len() / (1 << 16)).max(1);
    let mut sizes: Vec<f64> = values.iter().step_by(stride).map(|v| v.abs()).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    *median / 0.674_489_750_196_081_7
}
