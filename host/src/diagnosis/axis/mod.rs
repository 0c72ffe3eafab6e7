//! One axis on its way: mended record, spectrum, laws, and what whitens it.

mod density;
mod whitening;

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::chain::Chain;
use crate::diagnosis::detect::burst::{self, Powers};
use crate::diagnosis::detect::outliers::Outlier;
use crate::diagnosis::detect::steps::Jump;
use crate::diagnosis::laws::{self, Law, search};
use crate::diagnosis::record::bins::Frame;
use crate::diagnosis::record::residual::{Mended, bridge};
use crate::diagnosis::statistic::matched_filter::{Transformer, Whole};
use crate::fit::likelihood::{Data, Fit};
use crate::spectrum::{Line, record_lines};

/// Samples on either side of a bridge or a mask that tests of single moments leave out, at least
/// and at most.
const GUARD: [usize; 2] = [256, 1 << 14];

/// Time constants of the whitening filter for which it remembers where noise was cut.
const MEMORY: f64 = 5.0;

/// The least behind a converter's filter, which ties samples further apart together.
const FILTERED_GUARD: usize = 2048;

/// Samples at both ends of the record that they leave out: the ring closes there.
const SEAM: usize = 1024;

/// Samples over which a converter's filter spreads a jump, on either side: those of the ADS1281
/// settle within 63 conversions.
const SPREAD: usize = 64;

/// Power of the chain below which a frequency is shut out: what is left there says nothing of the
/// sensor, and falls too fast to be whitened.
const SHUT_OUT: f64 = 1e-3;

/// One axis with what is known about it so far.
pub struct AxisState {
    /// Samples a second.
    pub rate_hz: f64,
    /// Declared signal chain.
    pub chain: Option<Chain>,
    /// The record.
    pub mended: Mended,
    /// Bins and expectations.
    pub frame: Frame,
    /// Bands that no steady law speaks for, hertz: neither fits nor tests look at them.
    pub apart: Vec<Range<f64>>,
    /// Laws beside the five terms.
    pub laws: Vec<Law>,
    /// Spectrum of the mended record.
    pub data: Data,
    /// Fit of the five terms and the laws.
    pub fit: Fit,
    /// The mended record, bridged.
    pub filled: Arc<Vec<f64>>,
    /// Ranges that tests of single moments leave out, ascending and disjoint.
    unusable: Vec<Range<usize>>,
    /// What the bins are made for: ranges that are left out of the record.
    left_out: Vec<Range<usize>>,
    fast: Transformer,
    seen: OnceLock<Arc<Seen>>,
    powers: OnceLock<Arc<Powers>>,
    starts: OnceLock<Option<Arc<search::Starts>>>,
    lines: OnceLock<Vec<Line>>,
}

/// The mended record's transform, closed into a ring, and the densities that whiten it.
pub struct Seen {
    /// Transform.
    pub whole: Whole,
    /// Density at every ordinate.
    pub density: Vec<f64>,
    /// Ordinates below what the converter's filter shuts out.
    pub top: usize,
}

impl AxisState {
    /// An axis with nothing known. `None` where the record is too short, or all the same.
    pub fn new(measured: Arc<Vec<f64>>, rate_hz: f64, chain: Option<&Chain>) -> Option<Self> {
        let frame = Frame::new(&measured, rate_hz, chain)?;
        let fast = Transformer::new(measured.len());
        let data = frame.first();
        let fit = laws::fit(&frame, &data, &[])?;
        let mut state = Self {
            rate_hz,
            chain: chain.cloned(),
            mended: Mended::new(Arc::clone(&measured)),
            frame,
            apart: Vec::new(),
            laws: Vec::new(),
            data,
            fit,
            filled: Arc::default(),
            unusable: Vec::new(),
            left_out: Vec::new(),
            fast,
            seen: OnceLock::new(),
            powers: OnceLock::new(),
            starts: OnceLock::new(),
            lines: OnceLock::new(),
        };
        state.settle(measured);
        Some(state)
    }

    /// The record, all else given up.
    pub fn into_mended(self) -> Mended {
        self.mended
    }

    /// Brings spectrum and fit up to date after the record was mended or a law was added.
    pub fn refresh(&mut self) -> Option<()> {
        self.forget_whole();
        let values = self.mended.values();
        self.powers = OnceLock::new();
        let left_out: Vec<Range<usize>> = self.mended.left_out().cloned().collect();
        if self.left_out == left_out {
            self.frame.leave_out(&self.apart);
            self.data = self.frame.measure(&values);
        } else {
            self.starts = OnceLock::new();
            self.frame = Frame::new(&values, self.rate_hz, self.chain.as_ref())?;
            self.frame.leave_out(&self.apart);
            self.data = self.frame.first();
            self.left_out = left_out;
        }
        self.fit = search::polish(&self.frame, &self.data, &mut self.laws, 0, 0.05)?;
        self.settle(values);
        Some(())
    }

    /// Takes over what is left of the record, bridged where it is missing.
    fn settle(&mut self, mut values: Arc<Vec<f64>>) {
        let mut gaps = if values.iter().all(|value| value.is_finite()) {
            Vec::new()
        } else {
            bridge(Arc::make_mut(&mut values).as_mut_slice())
        };
        gaps.extend(self.mended.about_jumps(0));
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

    /// Keeps tests of single moments off what a converter's filter makes of a jump, until all is
    /// brought up to date.
    pub fn set_aside(&mut self, jump: &Jump) {
        self.lines = OnceLock::new();
        if self.is_filtered() {
            let range = jump.index.saturating_sub(SPREAD)..jump.index + SPREAD;
            let place = self.unusable.partition_point(|one| one.start < range.start);
            self.unusable.insert(place, range);
        }
    }

    /// Whether a converter's filter stands before the samples.
    fn is_filtered(&self) -> bool {
        let chain = self.chain.as_ref();
        chain.is_some_and(|chain| chain.converter.is_some())
    }

    /// Leaves out what a converter's filter makes of the jumps, and brings all up to date.
    pub fn refresh_jumps(&mut self) -> Option<()> {
        if self.is_filtered() {
            self.mended.spread = self.mended.about_jumps(SPREAD).collect();
        }
        self.refresh()
    }

    /// Samples that what whitens the record remembers a cut for. Noise whose density rises with the
    /// frequency (quantisation) is summed up, back to where it rises from.
    fn guard(&self) -> usize {
        const POINTS: i32 = 256;
        let (low, high) = (8.0 / self.mended.len() as f64, 0.49_f64);
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

    /// Transform of the mended record and what whitens it; made once for each state.
    pub fn whole(&self) -> Arc<Seen> {
        let seen = self.seen.get_or_init(|| {
            let mut whole = self.fast.transform(&self.filled, self.rate_hz);
            let density = self.whitening(&whole);
            whole.close(&density);
            let top = self.shut_out(&whole);
            Arc::new(Seen {
                whole,
                density,
                top,
            })
        });
        Arc::clone(seen)
    }

    /// The first ordinate that the chain shuts out, or how many there are.
    fn shut_out(&self, whole: &Whole) -> usize {
        /// Steps over the band in which its response is followed.
        const STEPS: usize = 4096;
        let count = whole.ordinates().len();
        let passes = |k: usize| self.frame.chain_power(whole.frequency(k)) >= SHUT_OUT;
        let stride = count.div_ceil(STEPS);
        let mut steps = (1..count).step_by(stride).chain([count - 1]);
        let Some(beyond) = steps.find(|&k| !passes(k)) else {
            return count;
        };
        (beyond.saturating_sub(stride).max(1)..=beyond)
            .find(|&k| !passes(k))
            .unwrap_or(beyond)
    }

    /// Gives up the transform until it is asked for again.
    pub fn forget_whole(&mut self) {
        self.seen = OnceLock::new();
    }

    /// Transform of the record with `outliers` put back, for noise of the `density` that it has without
    /// them.
    pub fn with(&self, outliers: &[Outlier], density: &[f64]) -> Whole {
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
            let seen = self.whole();
            let powers = burst::powers(&seen.whole, &seen.density, |n| self.usable(n));
            Arc::new(powers)
        });
        Arc::clone(powers)
    }

    /// Makes what a round looks at, two things at a time. No two of these wait for a third that is made
    /// once: one that waits may be given the other to do.
    pub fn prepare(&self, level: f64) {
        rayon::join(|| self.lines(level), || self.powers());
    }

    /// Lines of the mended record at a family-wise `level`, the same for each of its states.
    pub fn lines(&self, level: f64) -> &[Line] {
        self.lines.get_or_init(|| {
            let Ok(found) = record_lines::search(self.filled.as_slice(), self.rate_hz, level);
            found
        })
    }

    /// Where searches for laws begin; `None` without bins.
    pub fn starts(&self) -> Option<Arc<search::Starts>> {
        let made = || search::Starts::new(&self.frame).map(Arc::new);
        self.starts.get_or_init(made).clone()
    }
}
