//! What is made of an axis when it is first asked for, and then kept.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::diagnosis::axis::{AxisState, Whitened};
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::laws::search;
use crate::diagnosis::record::envelope::{Envelope, of_share};
use crate::diagnosis::record::powers::{self, Powers};
use crate::diagnosis::record::wave::Outlier;
use crate::diagnosis::statistic::matched_filter::Transform;
use crate::spectrum::{Line, record_lines};

/// Power of the chain below which a frequency is shut out: what is left there says nothing of the
/// sensor, and falls too fast to be whitened. 30 dB are a choice.
pub const SHUT_OUT: f64 = 1e-3;

/// What is made once, and can be given up before its owner changes.
pub(super) struct Made<T>(Mutex<Arc<OnceLock<T>>>);

impl<T> Default for Made<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Clone> Clone for Made<T> {
    fn clone(&self) -> Self {
        Self(Mutex::new(self.cell()))
    }
}

impl<T> Made<T> {
    fn cell(&self) -> Arc<OnceLock<T>> {
        Arc::clone(&self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn forget(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Arc::default();
    }
}

/// A density, infinite from the ordinate `top` on, where the chain shuts all out: what is there, codes that were rounded
/// behind it, is of another strength.
fn without_shut_out(density: &[f64], top: usize) -> Cow<'_, [f64]> {
    if top >= density.len() {
        return Cow::Borrowed(density);
    }
    let mut density = density.to_vec();
    density[top..].fill(f64::INFINITY);
    Cow::Owned(density)
}

impl AxisState {
    /// Transform of the residual and what whitens it; made once for each state.
    pub fn whitened(&self) -> Arc<Whitened> {
        let cell = self.seen.cell();
        let seen = cell.get_or_init(|| {
            let mut transform = self.fast.transform(&self.filled, self.rate_hz);
            let density = self.densities(&transform);
            transform.close(&density, &self.seam(self.rate_hz));
            let buried = self.buried(&transform, &density);
            let top = self.shut_out(&transform).min(buried);
            Arc::new(Whitened {
                transform,
                density,
                top,
            })
        });
        Arc::clone(seen)
    }

    /// The first ordinate that the chain shuts out, or how many there are.
    fn shut_out(&self, whole: &Transform) -> usize {
        /// Steps over the band in which its response is followed.
        const STEPS: usize = 4096;
        let count = whole.ordinates().len();
        let passes = |k: usize| self.bins.chain_power(whole.frequency(k)) >= SHUT_OUT;
        let stride = count.div_ceil(STEPS);
        let mut steps = (1..count).step_by(stride).chain([count - 1]);
        let Some(beyond) = steps.find(|&k| !passes(k)) else {
            return count;
        };
        (beyond.saturating_sub(stride).max(1)..=beyond)
            .find(|&k| !passes(k))
            .unwrap_or(beyond)
    }

    /// Gives up the transform until it is asked for again: a long record has no room for two.
    pub fn forget_whitened(&self) {
        self.seen.forget();
    }

    /// Samples of the ring that transforms look at: a few of the last ones may be left over.
    pub fn ring_len(&self) -> usize {
        self.fast.len()
    }

    /// Transform of the record with `outliers` put back, for noise of the `density` that it has without
    /// them.
    pub fn with(&self, outliers: &[Outlier], density: &[f64]) -> Transform {
        let mut series = self.fast.series(&self.filled);
        for one in outliers {
            // The last few samples may be left over.
            if let Some(value) = series.get_mut(one.index) {
                *value += one.size;
            }
        }
        let mut whole = self.fast.transform_in_place(series, self.rate_hz);
        whole.close(density, &self.seam(self.rate_hz));
        whole
    }

    /// What the explanations say of the strength of the noise over time.
    fn envelopes(&self) -> impl Iterator<Item = &Envelope> {
        self.explanations.iter().filter_map(Explanation::envelope)
    }

    /// Whether any of them says that it moves.
    pub fn has_envelope(&self) -> bool {
        self.envelopes().next().is_some()
    }

    /// Standard deviation of the power of the whitened record that they explain, over its mean.
    pub fn known_movement(&self) -> f64 {
        let squares: f64 = self.envelopes().map(|one| one.power_sd().powi(2)).sum();
        if squares == 0.0 {
            return 0.0;
        }
        let seen = self.whitened();
        squares.sqrt() * self.mean_short_share(&(1..seen.top), seen.transform.frequency(1))
    }

    /// Factor on the standard deviation of the noise at a sample that they explain.
    pub fn envelope(&self, index: usize) -> f64 {
        let factors = self.envelopes().map(|one| one.factor(index));
        factors.product()
    }

    /// Its square as a band shows it whose moments have so many `samples` each.
    pub fn square_over(&self, sample: f64, samples: f64) -> f64 {
        let squares = self.envelopes().map(|one| one.square_over(sample, samples));
        squares.product()
    }

    /// That factor for noise of which a `share` is [without a memory](Self::short_share), and swings.
    pub fn strength(&self, index: usize, share: f64) -> f64 {
        let squares = self.envelopes().map(|one| one.factor(index).powi(2));
        squares
            .map(|square| of_share(share, square))
            .product::<f64>()
            .sqrt()
    }

    /// The same for the noise at some ordinates of a transform with so many hertz between two.
    pub fn strength_between(
        &self,
        ordinates: &Range<usize>,
        spacing_hz: f64,
    ) -> impl Fn(usize) -> f64 + Sync + '_ {
        let share = match self.has_envelope() {
            true => self.mean_short_share(ordinates, spacing_hz),
            // Nothing swings.
            false => 0.0,
        };
        move |n| self.strength(n, share)
    }

    /// Power of the whitened record over time, over what is known of it; made once for each state.
    pub fn powers(&self) -> Arc<Powers> {
        let powers = self
            .powers
            .get_or_init(|| Arc::new(self.powers_by(&self.whitened().density, |_| 1.0)));
        Arc::clone(powers)
    }

    /// The same whitened by this `density`, infinite at what is left out, and over one more `factor` on the deviation of
    /// each sample.
    pub fn powers_by(&self, density: &[f64], factor: impl Fn(usize) -> f64 + Sync) -> Powers {
        let seen = self.whitened();
        let density = without_shut_out(density, seen.top);
        let known = self.strength_between(&(1..seen.top), seen.transform.frequency(1));
        let strength = |n| factor(n) * known(n);
        powers::powers(&seen.transform, &density, |n| self.usable(n), strength)
    }

    /// The same as if nothing were known of the strength.
    pub fn powers_as_measured(&self, density: &[f64]) -> Powers {
        let seen = self.whitened();
        let density = without_shut_out(density, seen.top);
        powers::powers(&seen.transform, &density, |n| self.usable(n), |_| 1.0)
    }

    /// Makes what a round looks at, two things at a time. No two of these wait for a third that is made
    /// once: one that waits may be given the other to do.
    pub fn prepare(&self, level: f64) {
        rayon::join(|| self.lines(level), || self.powers());
    }

    /// Lines of the residual at a family-wise `level`, the same for each of its states.
    pub fn lines(&self, level: f64) -> &[Line] {
        self.lines.get_or_init(|| {
            let Ok(found) = record_lines::search(self.filled.as_slice(), self.rate_hz, level);
            found
        })
    }

    /// Where searches for laws begin; `None` without bins.
    pub fn starts(&self) -> Option<Arc<search::Starts>> {
        let made = || search::Starts::new(&self.bins).map(Arc::new);
        self.starts.get_or_init(made).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_chain_shuts_out_counts_nowhere() {
        assert_eq!(
            *without_shut_out(&[1.0, 2.0, 1e-9], 2),
            [1.0, 2.0, f64::INFINITY]
        );
        assert_eq!(*without_shut_out(&[1.0, 2.0], 2), [1.0, 2.0]);
    }
}
