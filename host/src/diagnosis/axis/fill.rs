//! Fills the short gaps of an axis by the law that is fitted to it, and fits the law to what is filled.

use std::sync::Arc;

use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::explanation::Change;
use crate::diagnosis::laws::search;
use crate::diagnosis::record::beyond;
use crate::diagnosis::record::drawn::Noise;
use crate::diagnosis::record::short_gaps::ShortGaps;

/// Nats by which a law may still move from one fill to the next when it is taken for the record's own: a choice.
const AGREED: f64 = 0.1;

/// Fills of a record at most, and those where nothing was filled before: a choice. A third of a record of quantisation noise
/// missing takes half as many.
pub(super) const AT_FIRST: usize = 20;

/// Fills where the record was filled before and little has changed: a choice. A law that has a floor near zero
/// tends there ever more slowly, and each fill of a million samples takes a second.
pub(super) const AGAIN: usize = 4;

/// Nats by which a law may still move after these: a choice, below what any test takes for significant. A strong tone that is
/// taken out leaves gaps that were drawn with its power, of which each fill keeps the share that is missing.
const UNSEEN: f64 = 3.0;

/// Nats by which the first fill moves a law from which what stood in the gaps is another record's: a choice. Outliers a thousand
/// deviations large leave gaps that were drawn as loud as they are.
const ANOTHER: f64 = 1e3;

/// The part of what a law is off by that one fill leaves at most, as far as it is trusted to go on so: a choice.
const SLOWEST: f64 = 0.75;

/// The furthest that a density is moved on so, in logarithms: a choice, a tenth. What tends to nothing by more in each fill needs no
/// help, and moved on by as much again it would leave a fill no law at all.
const FURTHEST: f64 = std::f64::consts::LN_10;

impl AxisState {
    /// Gaps of which the record misses few samples each.
    pub(super) fn short_gaps(&self) -> Option<&ShortGaps> {
        self.short_gaps.as_deref()
    }

    /// Samples that stand in the place of missing ones.
    pub fn filled_samples(&self) -> usize {
        self.short_gaps().map_or(0, |gaps| gaps.places().len())
    }

    /// Their share of the samples that are there or stand there.
    pub fn filled_share(&self) -> f64 {
        self.short_gaps().map_or(0.0, ShortGaps::share)
    }

    /// Share of the record that was measured, or drawn where it was not.
    pub fn present_share(&self) -> f64 {
        (self.measured_share() / (1.0 - self.filled_share())).min(1.0)
    }

    /// Whether a sample that was filled lies no more than so many samples from this one.
    pub fn is_beside_filled(&self, index: usize, samples: usize) -> bool {
        let places = self.short_gaps().map_or(&[][..], ShortGaps::places);
        let from = places.partition_point(|place| place + samples < index);
        places
            .get(from)
            .is_some_and(|place| *place <= index + samples)
    }

    /// Fills the short gaps by the law as it is fitted and fits it anew, until the two agree: as often as is
    /// `usual`, up to twice as often where a test would see what still moves, and as often as at first where nothing of what stood there is
    /// of use. Leaves an axis that has none as it is.
    ///
    /// # Errors
    /// [`NoFit`] where what is filled cannot be fitted.
    pub(super) fn fill(&mut self, usual: usize) -> Result<(), NoFit> {
        let Some(gaps) = self.short_gaps.clone() else {
            return Ok(());
        };
        let mut course: Vec<Vec<f64>> = Vec::new();
        let mut most = 2 * usual;
        for n in 0..AT_FIRST {
            let expected = self.fit.expected.clone();
            let density = match n {
                // What was drawn before by another law is gone with this; what then lies beside the law was measured.
                0 => self.law_densities(gaps.ring_len()),
                _ => self.seen_densities(gaps.ring_len()),
            };
            self.fill_once(&gaps, density, &mut course)?;
            let nats = self.nats_from(&expected);
            if n == 0 && nats > ANOTHER {
                most = AT_FIRST;
            }
            let is_enough = n + 1 >= usual && (nats < UNSEEN || n + 1 == most);
            if nats < AGREED || is_enough {
                break;
            }
        }
        Ok(())
    }

    /// Takes over the gaps that there are since other samples count as no measurement than those at `before`; whether there are
    /// others.
    pub(super) fn has_other_gaps(&mut self, before: &[usize]) -> bool {
        if self.residual.replaced() == before {
            return false;
        }
        self.short_gaps = self.residual.short_gaps().map(Arc::new);
        self.residual.fill_only(self.short_gaps.as_deref());
        true
    }

    /// Keeps what was drawn in the place of samples that are no measurement with what says so.
    pub(super) fn keep_replaced(&mut self) {
        let mut drawn = self
            .residual
            .waves()
            .iter()
            .filter(|wave| wave.replaced().is_some());
        let changes = self.explanations.iter_mut().map(|one| &mut one.change);
        let waves = changes.filter_map(|change| match change {
            Change::Waves(waves) | Change::Happened { waves, .. } => Some(waves),
            _ => None,
        });
        for wave in waves.flatten().filter(|wave| wave.replaced().is_some()) {
            if let Some(drawn) = drawn.next() {
                wave.clone_from(drawn);
            }
        }
    }

    /// Fills the gaps once and fits anew. `course` has the densities of up to two fills before.
    fn fill_once(
        &mut self,
        gaps: &ShortGaps,
        mut density: Vec<f64>,
        course: &mut Vec<Vec<f64>>,
    ) -> Result<(), NoFit> {
        self.forget_whitened();
        go_on(course, &mut density);
        let mut left = std::mem::take(&mut self.filled);
        let values = Arc::make_mut(&mut left).as_mut_slice();
        let limits = beyond::limits(self.residual.waves(), values);
        let spacing_hz = self.rate_hz / gaps.ring_len() as f64;
        gaps.fill(
            values,
            &limits,
            &Noise {
                rate_hz: self.rate_hz,
                density: &density,
                strength: &self.strength_between(&(1..density.len()), spacing_hz),
            },
        );
        self.residual.refill(gaps.places(), &left);
        drop(left);
        let values = self.residual.values();
        self.data = self.bins.measure(&values);
        let fit = search::polish(&self.bins, &self.data, &mut self.laws, 0, 0.05);
        self.fit = fit.ok_or(NoFit)?;
        self.settle(values);
        Ok(())
    }

    /// What bins of another expectation would lose on average by this one.
    fn nats_from(&self, before: &[f64]) -> f64 {
        let pairs = before.iter().zip(&self.fit.expected);
        let of_bin =
            |((before, now), dof): ((&f64, &f64), &f64)| 0.25 * dof * (now / before).ln().powi(2);
        pairs.zip(&self.data.dof).map(of_bin).sum()
    }
}

/// Moves every third density on to where its `course` tends: each ordinate by itself, as a series whose steps shrink by
/// one factor does (A. C. Aitken, Proc. R. Soc. Edinburgh 46 (1926) 289), in logarithms.
fn go_on(course: &mut Vec<Vec<f64>>, density: &mut [f64]) {
    let [before, then] = &course[..] else {
        course.push(density.to_vec());
        return;
    };
    for ((before, then), now) in before.iter().zip(then).zip(density) {
        let [first, second] = [then / before, *now / then].map(f64::ln);
        let left = (second / first).min(SLOWEST);
        if left > 0.0 {
            let by = second * left / (1.0 - left);
            *now *= by.clamp(-FURTHEST, FURTHEST).exp();
        }
    }
    course.clear();
}

#[cfg(test)]
mod tests;
