//! One axis on its way: its explanations, and what follows from them: residual, spectrum, laws, and what
//! whitens the record.

mod density;
pub mod profile;
pub mod ramp;
mod whitening;

use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::chain::Chain;
use crate::diagnosis::explanation::{Candidate, Change, Explanation, Snapshot};
use crate::diagnosis::laws::{self, Law, search};
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::record::bridge::bridge;
use crate::diagnosis::record::powers::{self, Powers};
use crate::diagnosis::record::residual::{Residual, TakenOut};
use crate::diagnosis::record::wave::{Outlier, Wave};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::statistic::matched_filter::{Transform, Transformer};
use crate::fit::likelihood::{Data, Fit};
use crate::model::kind::Kind;
use crate::spectrum::Line;
use crate::spectrum::record_lines;

/// Samples on either side of a bridge or a mask that tests of single moments leave out, at least
/// and at most: choices. Between them what [`MEMORY`] asks.
const GUARD: [usize; 2] = [256, 1 << 14];

/// Time constants of the whitening filter for which it remembers where noise was cut: `e^-5` is
/// left, 0.7 %.
const MEMORY: f64 = 5.0;

/// The least behind a converter's filter, which correlates samples that are further from each
/// other: a choice.
const FILTERED_GUARD: usize = 2048;

/// Samples at both ends of the record that they leave out, for the ring closes there: a choice,
/// four times what the line through the ends rests on.
const SEAM: usize = 1024;

/// Samples over which a converter's filter spreads a jump, on either side: those of the ADS1281
/// settle within 63 conversions.
pub const SPREAD: usize = 64;

/// Power of the chain below which a frequency is shut out: what is left there says nothing of the
/// sensor, and falls too fast to be whitened. 30 dB are a choice.
const SHUT_OUT: f64 = 1e-3;

/// No mix of the five terms and the laws fits a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoFit;

/// A band that no steady law speaks for: neither fits nor tests look at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Excluded {
    /// The band, hertz.
    pub band_hz: Range<f64>,
    /// What there is to say of it.
    pub remark: Remark,
}

impl Excluded {
    /// Extends it by another band.
    fn join(&mut self, band_hz: &Range<f64>) {
        let all = union(&self.band_hz, band_hz);
        if let Place::Band { ends_hz, .. } = &mut self.remark.place
            && *ends_hz == [self.band_hz.start, self.band_hz.end]
        {
            *ends_hz = [all.start, all.end];
        }
        self.band_hz = all;
    }
}

/// The band that two bands span.
fn union(one: &Range<f64>, other: &Range<f64>) -> Range<f64> {
    one.start.min(other.start)..one.end.max(other.end)
}

/// One axis with what is known about it so far.
#[derive(Clone)]
pub struct AxisState {
    /// Samples a second.
    pub rate_hz: f64,
    /// Declared signal chain.
    pub chain: Option<Chain>,
    /// What its model holds beyond the five terms, in the order in which it was found.
    explanations: Vec<Explanation>,
    /// Bands that are excluded.
    excluded: Vec<Excluded>,
    /// What is left of the record.
    pub residual: Residual,
    /// Bins and expectations.
    pub bins: SpectralBins,
    /// The laws among the explanations.
    pub laws: Vec<Law>,
    /// Spectrum of the residual.
    pub data: Data,
    /// Fit of the five terms and the laws.
    pub fit: Fit,
    /// The residual, bridged.
    pub filled: Arc<Vec<f64>>,
    /// Ranges excluded from tests of single moments, ascending and disjoint.
    unusable: Vec<Range<usize>>,
    /// What the bins are made for: ranges that are excluded from the record.
    left_out: Vec<Range<usize>>,
    fast: Arc<Transformer>,
    seen: Made<Arc<Whitened>>,
    powers: OnceLock<Arc<Powers>>,
    starts: OnceLock<Option<Arc<search::Starts>>>,
    lines: OnceLock<Vec<Line>>,
}

/// What is made once, and can be given up before its owner changes.
struct Made<T>(Mutex<Arc<OnceLock<T>>>);

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

/// The residual's transform, closed into a ring, and the densities that whiten it.
pub struct Whitened {
    /// Transform of the residual.
    pub transform: Transform,
    /// Density at every ordinate.
    pub density: Vec<f64>,
    /// Ordinates below what the converter's filter shuts out.
    pub top: usize,
}

impl AxisState {
    /// An axis with nothing known. `None` where the record is too short, or all the same.
    pub fn new(measured: Arc<Vec<f64>>, rate_hz: f64, chain: Option<&Chain>) -> Option<Self> {
        let bins = SpectralBins::new(&measured, rate_hz, chain)?;
        let fast = Transformer::new(measured.len());
        let data = bins.first();
        let fit = laws::fit(&bins, &data, &[])?;
        let mut state = Self {
            rate_hz,
            chain: chain.cloned(),
            explanations: Vec::new(),
            excluded: Vec::new(),
            residual: Residual::new(Arc::clone(&measured)),
            bins,
            laws: Vec::new(),
            data,
            fit,
            filled: Arc::default(),
            unusable: Vec::new(),
            left_out: Vec::new(),
            fast: Arc::new(fast),
            seen: Made::default(),
            powers: OnceLock::new(),
            starts: OnceLock::new(),
            lines: OnceLock::new(),
        };
        state.settle(measured);
        Some(state)
    }

    /// What is left of the record, all else given up.
    pub fn into_residual(self) -> Residual {
        self.residual
    }

    /// What its model holds beyond the five terms, in the order in which it was found.
    pub fn explanations(&self) -> &[Explanation] {
        &self.explanations
    }

    /// The first explanation of a kind.
    pub fn explanation(&self, kind: Kind) -> Option<&Explanation> {
        self.explanations.iter().find(|one| one.kind() == kind)
    }

    /// Whether it has an explanation of a kind.
    pub fn has(&self, kind: Kind) -> bool {
        self.explanation(kind).is_some()
    }

    /// Number of an explanation's law among the laws; `None` for one that is no law.
    pub fn law_number(&self, explanation: &Explanation) -> Option<usize> {
        let mut laws = self.explanations.iter().filter(|one| one.law().is_some());
        laws.position(|one| std::ptr::eq(one, explanation))
    }

    /// Its spectrum with the laws that were fitted to it.
    pub fn fitted(&self) -> search::Fitted<'_> {
        search::Fitted {
            bins: &self.bins,
            data: &self.data,
            laws: &self.laws,
            fit: &self.fit,
        }
    }

    /// Bands that are excluded, with what there is to say of each.
    pub fn excluded(&self) -> &[Excluded] {
        &self.excluded
    }

    /// The same as frequencies alone, hertz.
    pub fn excluded_hz(&self) -> Vec<Range<f64>> {
        let bands = self.excluded.iter().map(|one| one.band_hz.clone());
        bands.collect()
    }

    /// Takes a candidate in and brings everything up to date.
    ///
    /// # Errors
    /// [`NoFit`] where what is left cannot be fitted any more.
    pub fn accept(&mut self, candidate: Candidate) -> Result<(), NoFit> {
        let is_superseded = |one: &Explanation| candidate.supersedes.contains(&one.kind());
        // What is amended moves up as others before it go.
        let amends = candidate.amends.map(|place| {
            let gone = self.explanations[..place]
                .iter()
                .filter(|one| is_superseded(one));
            place - gone.count()
        });
        self.withdraw_where(is_superseded);
        let Candidate {
            effect,
            p_value,
            rivals,
            freedom,
            held_out_nats,
            change,
            reopens,
            ..
        } = candidate;
        let place = if let Some(place) = amends {
            let one = &mut self.explanations[place];
            (one.effect, one.freedom, one.change) = (effect, freedom, change);
            one.held_out_nats = held_out_nats;
            place
        } else {
            let now = Snapshot::of(&self.explanations);
            self.explanations.push(Explanation {
                effect,
                p_value,
                rivals,
                freedom,
                held_out_nats,
                change,
                before: self.fit.clone(),
                after: self.fit.clone(),
                with: Snapshot::default(),
                without: now,
            });
            self.explanations.len() - 1
        };
        // A statement about values leaves record and noise as they are.
        if !matches!(self.explanations[place].change, Change::Grid { .. }) {
            self.refresh()?;
        }
        let now = Snapshot::of(&self.explanations);
        let one = &mut self.explanations[place];
        (one.after, one.with) = (self.fit.clone(), now);
        let withdrawn = reopens.iter().filter(|kind| self.withdraw(**kind)).count();
        if withdrawn > 0 {
            self.refresh()?;
        }
        Ok(())
    }

    /// Takes the explanations of a kind off the list; whether there were any. What follows from the list is
    /// brought up to date by [`Self::refresh`].
    pub fn withdraw(&mut self, kind: Kind) -> bool {
        self.withdraw_where(|one| one.kind() == kind)
    }

    /// The same for all explanations of which `is_gone` is true.
    pub fn withdraw_where(&mut self, is_gone: impl Fn(&Explanation) -> bool) -> bool {
        let gone: Vec<Kind> = self
            .explanations
            .iter()
            .filter(|one| is_gone(one))
            .map(Explanation::kind)
            .collect();
        self.explanations.retain(|one| !is_gone(one));
        for one in &mut self.explanations {
            for &kind in &gone {
                one.with.forget(kind);
                one.without.forget(kind);
            }
        }
        !gone.is_empty()
    }

    /// Takes the explanations off the list whose laws have these `numbers`.
    pub fn withdraw_laws(&mut self, numbers: &[usize]) {
        let mut number = 0;
        self.explanations.retain(|one| {
            let is_law = one.law().is_some();
            number += usize::from(is_law);
            !(is_law && numbers.contains(&(number - 1)))
        });
    }

    /// Leaves out of an explanation's waveforms those of which `is_gone` is true, and the explanation with its last
    /// one; whether there were any.
    pub fn withdraw_waves(&mut self, is_gone: impl Fn(&Wave) -> bool) -> bool {
        let mut any = false;
        for one in &mut self.explanations {
            if let Change::Waves(waves) = &mut one.change {
                let before = waves.len();
                waves.retain(|wave| !is_gone(wave));
                any |= waves.len() < before;
            }
        }
        let is_empty =
            |one: &Explanation| matches!(&one.change, Change::Waves(waves) if waves.is_empty());
        self.explanations.retain(|one| !is_empty(one));
        any
    }

    /// Excludes a band, joined with an excluded one next to it.
    pub fn exclude(&mut self, new: Excluded) {
        match self.beside(&new.band_hz) {
            Some(place) => self.excluded[place].join(&new.band_hz),
            None => self.excluded.push(new),
        }
    }

    /// Excludes a line, by itself whatever is excluded next to it.
    pub fn exclude_line(&mut self, new: Excluded) {
        self.excluded.push(new);
    }

    /// The bands that would be excluded with a new one, hertz.
    pub fn excluded_with(&self, new_hz: &Range<f64>) -> Vec<Range<f64>> {
        let mut bands_hz = self.excluded_hz();
        match self.beside(new_hz) {
            Some(place) => bands_hz[place] = union(&bands_hz[place], new_hz),
            None => bands_hz.push(new_hz.clone()),
        }
        bands_hz
    }

    /// Number of the first excluded band that a new one lies next to, by no more than its own width.
    fn beside(&self, new_hz: &Range<f64>) -> Option<usize> {
        let width_hz = new_hz.end - new_hz.start;
        let mut bands = self.excluded.iter().map(|one| &one.band_hz);
        bands.position(|one| one.start < new_hz.end + width_hz && new_hz.start - width_hz < one.end)
    }

    /// Takes over what the last fit knows of the laws among the explanations.
    pub fn set_laws(&mut self, estimates: impl Fn(usize, &Explanation) -> Estimate) {
        let mut number = 0;
        for one in &mut self.explanations {
            if one.law().is_some() {
                one.effect = estimates(number, one);
                number += 1;
            }
        }
    }

    /// Brings residual, spectrum and fit up to date with the explanations.
    ///
    /// # Errors
    /// [`NoFit`] where what is left cannot be fitted any more.
    pub fn refresh(&mut self) -> Result<(), NoFit> {
        self.forget_whitened();
        self.powers = OnceLock::new();
        let spread = self.is_filtered().then_some(SPREAD);
        self.residual = self.residual.after(self.taken_out(), spread);
        let values = self.residual.values();
        let left_out: Vec<Range<usize>> = self.residual.left_out().cloned().collect();
        if self.left_out == left_out {
            self.bins.leave_out(&self.excluded_hz());
            self.data = self.bins.measure(&values);
        } else {
            self.starts = OnceLock::new();
            let bins = SpectralBins::new(&values, self.rate_hz, self.chain.as_ref());
            self.bins = bins.ok_or(NoFit)?;
            self.bins.leave_out(&self.excluded_hz());
            self.data = self.bins.first();
            self.left_out = left_out;
        }
        self.laws = Snapshot::of(&self.explanations).laws;
        let fit = search::polish(&self.bins, &self.data, &mut self.laws, 0, 0.05);
        self.fit = fit.ok_or(NoFit)?;
        let mut polished = self.laws.iter();
        for one in &mut self.explanations {
            if let Change::Law(law) = &mut one.change
                && let Some(polished) = polished.next()
            {
                law.clone_from(polished);
            }
        }
        self.settle(values);
        Ok(())
    }

    /// What the explanations do to the record.
    fn taken_out(&self) -> TakenOut {
        let mut taken = TakenOut::default();
        for one in &self.explanations {
            match &one.change {
                Change::Waves(waves) => taken.waves.extend_from_slice(waves),
                Change::Mask(stretches) => taken.masked.extend_from_slice(stretches),
                Change::Cut(moment) => taken.cut.push(moment.clone()),
                Change::Law(_) | Change::Grid { .. } => {}
            }
        }
        taken
    }

    /// Takes over what is left of the record, bridged where it is missing.
    fn settle(&mut self, mut values: Arc<Vec<f64>>) {
        let mut gaps = if values.iter().all(|value| value.is_finite()) {
            Vec::new()
        } else {
            bridge(Arc::make_mut(&mut values).as_mut_slice())
        };
        gaps.extend(self.residual.about_jumps(0));
        gaps.sort_by_key(|gap| gap.start);
        let guard = self.guard();
        self.unusable.clear();
        for gap in gaps {
            let wide = gap.start.saturating_sub(guard)..(gap.end + guard).min(values.len());
            match self.unusable.last_mut() {
                Some(last) if last.end >= wide.start => last.end = last.end.max(wide.end),
                _ => self.unusable.push(wide),
            }
        }
        // A new law leaves the record as it was.
        if self.filled != values {
            self.filled = values;
            self.lines = OnceLock::new();
        }
    }

    /// Whether a converter's filter stands before the samples.
    pub fn is_filtered(&self) -> bool {
        let chain = self.chain.as_ref();
        chain.is_some_and(|chain| chain.converter.is_some())
    }

    /// Samples that what whitens the record remembers a cut for. Noise whose density rises with the
    /// frequency (quantisation) is summed up, back to where it rises from.
    fn guard(&self) -> usize {
        const POINTS: i32 = 256;
        let (low, high) = (8.0 / self.residual.len() as f64, 0.49_f64);
        let (mut least, mut rises) = (f64::INFINITY, None);
        for point in 0..=POINTS {
            let cycles = low * (high / low).powf(f64::from(point) / f64::from(POINTS));
            let density = self.density(cycles * self.rate_hz);
            if density < least {
                (least, rises) = (density, None);
            } else if density > 2.0 * least && rises.is_none() {
                rises = Some(cycles);
            }
        }
        let samples = rises.map_or(0.0, |cycles| MEMORY / (std::f64::consts::TAU * cycles));
        let [least, most] = GUARD;
        let least = if self.is_filtered() {
            FILTERED_GUARD
        } else {
            least
        };
        (samples as usize).clamp(least, most)
    }

    /// Whether tests of single moments may look at a sample.
    pub fn usable(&self, index: usize) -> bool {
        if index < SEAM || index + SEAM >= self.fast.len() {
            return false;
        }
        // They overlap where one was added: no more than two can reach a sample.
        let after = self.unusable.partition_point(|range| range.start <= index);
        let near = self.unusable[..after].iter().rev().take(2);
        near.into_iter().all(|range| range.end <= index)
    }

    /// Transform of the residual and what whitens it; made once for each state.
    pub fn whitened(&self) -> Arc<Whitened> {
        let cell = self.seen.cell();
        let seen = cell.get_or_init(|| {
            let mut transform = self.fast.transform(&self.filled, self.rate_hz);
            let density = self.densities(&transform);
            transform.close(&density);
            let top = self.shut_out(&transform);
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
        /// Steps over the band in which its response is followed: a choice. The end is then looked
        /// for between two of them.
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
        whole.close(density);
        whole
    }

    /// Power of the whitened record over time; made once for each state.
    pub fn powers(&self) -> Arc<Powers> {
        let powers = self.powers.get_or_init(|| {
            let seen = self.whitened();
            let powers = powers::powers(&seen.transform, &seen.density, |n| self.usable(n));
            Arc::new(powers)
        });
        Arc::clone(powers)
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
mod tests;
