//! What whitens an axis's record, and slow copies of it.

use std::ops::Range;

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::bridge::block_means;
use crate::diagnosis::statistic::matched_filter::{Seam, Transform, Transformer};
use crate::model::markov::{self, Markov};

/// Points of the table of densities: over 20 octaves two of them differ by 0.007 in `ln f`, and the
/// line between them is off by 6e-6 for each unit of curvature of `ln S` over `ln f`.
const TABLE: usize = 2048;

/// Samples of the slow copy of a record, at most: a choice between time and place. An hour and a
/// half at 2000/s is averaged over 42 samples each.
const SLOW: usize = 1 << 18;

/// Samples of its copy for what takes a good part of the record, at most: a choice, an eighth of
/// [`SLOW`], for each time constant that is tried costs a transform.
const DRIFT: usize = 1 << 15;

/// Degrees of freedom from which a bin's own ratio to the model counts rather than the model. The
/// logarithm of a ratio has the variance `2 / dof`; drawn to a model that is wrong by the variance
/// `2 / 40`, a deviation of 22 %, it keeps the share `dof / (dof + 40)`. The 22 % are a choice.
const OWN_RATIO: f64 = 40.0;

/// Ordinates whose densities lie on a straight line: a choice; how far off that is, see
/// [`ONE_BY_ONE`].
const RUN: usize = 64;

/// Ordinates from which they do: for a density `f^s` the line is off by `s^2 (RUN / k)^2 / 8` of it at
/// ordinate `k`, 5e-7 for the steepest of the five terms.
const ONE_BY_ONE: usize = 1 << 16;

/// Runs that are worth a thread of their own: a choice, 16 384 ordinates.
const SHARED: usize = 256;

/// Least density that whitens, over that in the middle of the band: what lies further below is
/// hidden by the ends' own leakage. How far is a choice.
const LEAST_SHARE: f64 = 1e-5;

impl AxisState {
    /// Measured over expected power of the bins, drawn towards 1 where it rests on little.
    fn ratio(&self, f_hz: f64) -> f64 {
        self.between_bins(f_hz, |log, dof| log * dof / (dof + OWN_RATIO))
    }

    /// Measured over expected power at a frequency, of each bin what `takes` makes of its logarithm and its degrees of
    /// freedom.
    pub(super) fn between_bins(&self, f_hz: f64, takes: impl Fn(f64, f64) -> f64) -> f64 {
        let place = self.data.f_hz.partition_point(|&f| f < f_hz);
        let at = |bin: usize| {
            let log = (self.data.psd[bin] / self.fit.expected[bin]).ln();
            takes(log, self.bins.dof()[bin])
        };
        let last = self.data.len() - 1;
        let log = match place {
            0 => at(0),
            _ if place > last => at(last),
            _ => {
                let (low, high) = (self.data.f_hz[place - 1].ln(), self.data.f_hz[place].ln());
                let share = (f_hz.ln() - low) / (high - low);
                at(place - 1) * (1.0 - share) + at(place) * share
            }
        };
        log.exp()
    }

    /// Densities that whiten `whole`: the model's, drawn to the measured bins where these are sure,
    /// so that a test of moments does not suffer from a model that is still wrong in frequency.
    /// What a converter's filter shuts out does not count.
    pub(crate) fn densities(&self, whole: &Transform) -> Vec<f64> {
        let density = |f_hz: f64| self.density(f_hz) * self.ratio(f_hz);
        let mut densities = tabulate(whole.len(), whole.rate_hz(), density);
        self.leave_out(whole, &mut densities);
        densities
    }

    /// The first ordinate of `whole` from which on all that is left lies below the least density that whitens, or how many
    /// there are: behind a filter that is so steep there is nothing but what the ends leak. A converter's stop band is its own.
    pub(super) fn buried(&self, whole: &Transform, densities: &[f64]) -> usize {
        if self.is_filtered() {
            return densities.len();
        }
        /// What a sum of logarithms may be off by.
        const ROUNDING: f64 = 1e-9;
        let middle_hz = 0.2 * whole.frequency(densities.len() - 1);
        let least = least(self.density(middle_hz) * self.ratio(middle_hz));
        let is_buried = |density: &&f64| **density <= least * (1.0 + ROUNDING);
        densities.len() - densities.iter().rev().take_while(is_buried).count()
    }

    /// Amplitude that the signal chain and the laws which filter let through of what happens to the level, at the ordinates of
    /// `whole`; `None` where nothing filters.
    pub fn passed(&self, whole: &Transform) -> Option<Vec<f64>> {
        let any = self.chain.is_some() || self.filters_level();
        any.then(|| {
            tabulate(whole.len(), whole.rate_hz(), |f_hz| {
                (self.bins.chain_power(f_hz) * self.level_filters(f_hz)).sqrt()
            })
        })
    }

    /// Leaves the bands that are excluded out of `densities`, and in a slow copy of the record what tones are folded to.
    fn leave_out(&self, whole: &Transform, densities: &mut [f64]) {
        let bands = self.excluded_hz().into_iter();
        for band in bands.chain(self.tones_seen_hz(whole.rate_hz())) {
            let count = densities.len();
            let of = |f_hz: f64| (f_hz / whole.frequency(1)).ceil().max(0.0) as usize;
            let (start, end) = (of(band.start).min(count), of(band.end).min(count));
            densities[start..end.max(start)].fill(f64::INFINITY);
        }
    }

    /// What is free where a copy of the record at `rate_hz` closes into a ring.
    pub fn seam(&self, rate_hz: f64) -> Seam {
        let laws = self.laws.iter().filter(|law| law.effect == markov::KIND);
        let samples = laws.map(|law| Markov::of(&law.values).time_s * rate_hz);
        let tones = self.tones_seen_hz(rate_hz);
        Seam {
            // What lasts for less than a sample is white.
            memories: samples.filter(|samples| *samples > 1.0).collect(),
            tones: tones
                .map(|band| 0.5 * (band.start + band.end) / rate_hz)
                .collect(),
        }
    }

    /// Bands of the tones that are left out, where a copy at `rate_hz` shows them, hertz: above half of its rate folded back.
    fn tones_seen_hz(&self, rate_hz: f64) -> impl Iterator<Item = Range<f64>> {
        /// Part of all of a copy's ordinates that a folded band has, at most: a choice. What wanders further than that is thin
        /// there, and mains would leave a copy of a long record next to none.
        const WIDEST: f64 = 0.1;
        let tones = self.tones_hz().into_iter();
        tones.filter_map(move |band| {
            let is_below = band.start + band.end < rate_hz;
            let is_narrow = band.end - band.start < WIDEST * 0.5 * rate_hz;
            (is_below || is_narrow).then(|| folded(&band, rate_hz))
        })
    }

    /// Samples that one sample of the slow copy stands for.
    pub fn slow_factor(&self) -> usize {
        self.residual.len().div_ceil(SLOW).max(1)
    }

    /// Samples that one sample of a copy stands for that holds nothing but drift.
    pub fn drift_factor(&self) -> usize {
        self.residual.len().div_ceil(DRIFT).max(1)
    }

    /// `values` in means over `factor` samples: their transform, and what whitens it.
    pub fn slow(&self, values: &[f64], factor: usize) -> (Transform, Vec<f64>) {
        let means = block_means(values, factor);
        let rate_hz = self.rate_hz / factor as f64;
        let mut whole = Transformer::new(means.len()).transform(&means, rate_hz);
        let mut density = self.slow_densities(&whole, factor);
        self.leave_out(&whole, &mut density);
        whole.close(&density, &self.seam(rate_hz));
        (whole, density)
    }

    /// Densities of the noise at the ordinates of `whole`, a copy in means over `factor` samples, in all bands.
    pub fn slow_densities(&self, whole: &Transform, factor: usize) -> Vec<f64> {
        let rate_hz = whole.rate_hz();
        tabulate(whole.len(), rate_hz, |f_hz| {
            // What folds back, through the mean's own response.
            (0..factor.div_ceil(2).min(8))
                .flat_map(|fold| {
                    let above = fold as f64 * rate_hz + f_hz;
                    let below = (fold + 1) as f64 * rate_hz - f_hz;
                    [above, below]
                })
                .filter(|&at| at < 0.5 * self.rate_hz * (1.0 + 1e-9))
                .map(|at| {
                    let x = std::f64::consts::PI * at / self.rate_hz;
                    let response = if x == 0.0 || factor == 1 {
                        1.0
                    } else {
                        ((factor as f64 * x).sin() / (factor as f64 * x.sin())).powi(2)
                    };
                    let at = at.min(0.5 * self.rate_hz * (1.0 - 1e-9));
                    response * self.density(at) * self.ratio(at)
                })
                .sum()
        })
    }
}

/// The least density that whitens, where that in the middle of the band is `middle`.
fn least(middle: f64) -> f64 {
    LEAST_SHARE * middle
}

/// Where a band is seen at `rate_hz`, hertz: above half of it, folded back.
fn folded(band_hz: &Range<f64>, rate_hz: f64) -> Range<f64> {
    let end = |f_hz: f64| {
        let beyond = f_hz.rem_euclid(rate_hz);
        beyond.min(rate_hz - beyond)
    };
    let middle_hz = end(0.5 * (band_hz.start + band_hz.end));
    let half_hz = 0.5 * (band_hz.end - band_hz.start);
    (middle_hz - half_hz).max(0.0)..(middle_hz + half_hz).min(0.5 * rate_hz)
}

/// Densities at the ordinates of `len` samples on a ring, from a table.
pub(super) fn tabulate(len: usize, rate_hz: f64, density: impl Fn(f64) -> f64) -> Vec<f64> {
    let count = len / 2 + 1;
    let frequency = |k: usize| k as f64 * rate_hz / len as f64;
    let (low, high) = (frequency(1).ln(), frequency(count - 1).ln());
    let table: Vec<f64> = (0..=TABLE)
        .map(|step| {
            let log = low + (high - low) * step as f64 / TABLE as f64;
            density(log.exp()).max(f64::MIN_POSITIVE).ln()
        })
        .collect();
    let floor = least(density(0.2 * frequency(count - 1)));
    let at = |k: usize| {
        let log = frequency(k).ln();
        let place = ((log - low) / (high - low) * TABLE as f64).clamp(0.0, TABLE as f64);
        let step = (place as usize).min(TABLE - 1);
        let share = place - step as f64;
        let log = table[step] * (1.0 - share) + table[step + 1] * share;
        log.exp().max(floor)
    };
    let mut densities = vec![0.0; count];
    let runs = densities.par_chunks_mut(RUN).with_min_len(SHARED);
    let runs = runs.enumerate();
    runs.for_each(|(run, densities)| {
        let first = run * RUN;
        if first < ONE_BY_ONE {
            let each = (first..).zip(densities);
            each.for_each(|(k, density)| *density = at(k.max(1)));
            return;
        }
        // So far up a run is a small part of an octave: straight from its begin to its end.
        let (begin, end) = (at(first), at(first + RUN));
        let slope = (end - begin) / RUN as f64;
        let each = densities.iter_mut().enumerate();
        each.for_each(|(n, density)| *density = begin + slope * n as f64);
    });
    densities
}

#[cfg(test)]
mod tests {
    use super::folded;

    #[test]
    fn a_band_is_seen_where_it_folds_back_to() {
        // At 40/s: as it is, about 20 Hz, and about 40 Hz.
        for (middle_hz, seen_hz) in [(7.5, 7.5), (25.0, 15.0), (38.0, 2.0), (43.0, 3.0)] {
            let band = folded(&(middle_hz - 0.5..middle_hz + 0.5), 40.0);
            assert_eq!(band, seen_hz - 0.5..seen_hz + 0.5, "{middle_hz} Hz");
        }
        assert_eq!(folded(&(19.5..20.5), 40.0), 19.5..20.0);
        assert_eq!(folded(&(39.5..40.5), 40.0), 0.0..0.5);
    }
}
