//! Which moments of an axis tests may judge by themselves: those that no bridge, cut or seam is near.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::beyond;
use crate::diagnosis::record::bridge::bridge;
use crate::diagnosis::record::drawn::{Drawn, Noise};
use crate::diagnosis::record::long_gaps;
use crate::diagnosis::record::short_gaps::ShortGaps;

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

/// Samples of the longest record of which long gaps are filled by the law: a choice, 17 min at 2000/s. What is drawn
/// costs some twenty transforms of the record each time that something is found; in longer ones straight lines stand.
const LONGEST_FILLED: usize = 1 << 21;

impl AxisState {
    /// Takes over what is left of the record, bridged where it is missing.
    pub(super) fn settle(&mut self, mut values: Arc<Vec<f64>>) {
        let mut gaps = if values.iter().all(|value| value.is_finite()) {
            Vec::new()
        } else {
            self.fill_long(Arc::make_mut(&mut values).as_mut_slice())
        };
        self.bridged.clone_from(&gaps);
        self.filled_with_hz = self.tones_hz();
        gaps.extend(self.residual.about_jumps(0));
        let guard = self.guard();
        let widened = |gap: &Range<usize>| {
            gap.start.saturating_sub(guard)..(gap.end + guard).min(values.len())
        };
        let mut all: Vec<Range<usize>> = gaps.iter().map(widened).collect();
        // What fills these goes on as their neighbours do. Beside a rail the samples that stayed below it are the smaller ones:
        // only with those beyond it are they as loud as the others.
        let short = self.short_gaps().map_or(&[][..], ShortGaps::places);
        let beyond = beyond::limits(self.residual.waves(), &values);
        let is_beyond = |n: &usize| beyond.binary_search_by_key(n, |one| one.index).is_ok();
        let others = short.iter().filter(|n| !is_beyond(n));
        all.extend(others.map(|&n| n..n + 1));
        all.sort_by_key(|gap| gap.start);
        self.unusable.clear();
        for wide in all {
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

    /// Fills what is missing of `values`, and says where: as it was filled if they are the same otherwise, or else as the
    /// law that is fitted has it.
    fn fill_long(&self, values: &mut [f64]) -> Vec<Range<usize>> {
        let gaps = bridge(values);
        if values.len() > LONGEST_FILLED {
            return gaps;
        }
        let is_same = |n: &usize| self.filled.get(*n) == values.get(*n);
        let starts = [0].into_iter().chain(gaps.iter().map(|gap| gap.end));
        let ends = gaps.iter().map(|gap| gap.start).chain([values.len()]);
        let mut there = starts.zip(ends);
        // A tone without a name was in no law that one could draw by, and what it left there is a cut at either end.
        let knows_the_same = self.filled_with_hz == self.tones_hz();
        if knows_the_same
            && self.bridged == gaps
            && there.all(|(start, end)| (start..end).all(|n| is_same(&n)))
        {
            for gap in &gaps {
                values[gap.clone()].copy_from_slice(&self.filled[gap.clone()]);
            }
            return gaps;
        }
        // What a filter makes of many jumps may be most of a record: its law would draw the jumps anew.
        let spread = self.residual.spread();
        let is_of_jump = |gap: &Range<usize>| {
            spread
                .iter()
                .any(|one| one.start < gap.end && gap.start < one.end)
        };
        let others: Vec<Range<usize>> = gaps
            .iter()
            .filter(|gap| !is_of_jump(gap))
            .cloned()
            .collect();
        if !others.is_empty() {
            let drawn = Drawn::of(self.residual.measured());
            let density = self.law_densities(drawn.ring_len());
            let spacing_hz = self.rate_hz / drawn.ring_len() as f64;
            let noise = Noise {
                rate_hz: self.rate_hz,
                density: &density,
                strength: &self.strength_between(&(1..density.len()), spacing_hz),
            };
            long_gaps::fill(&drawn, values, &others, &noise);
        }
        gaps
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

    /// What is missing of the residual on end and was filled, ascending.
    pub fn bridged(&self) -> &[Range<usize>] {
        &self.bridged
    }

    /// Share of the record that was not filled so: a line goes through no more of it, unless the law by which it was knows the line.
    pub fn unbridged_share(&self) -> f64 {
        let bridged: usize = self.bridged.iter().map(Range::len).sum();
        1.0 - bridged as f64 / self.filled.len() as f64
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

    /// Share of a stretch of samples that tests of single moments may look at.
    pub fn usable_share(&self, samples: &Range<usize>) -> f64 {
        let mut from = samples.start.max(SEAM);
        let end = samples.end.min(self.fast.len().saturating_sub(SEAM));
        let mut usable = 0;
        // They overlap where one was added: no more than two can reach a sample.
        let after = self.unusable.partition_point(|range| range.start <= from);
        for range in &self.unusable[after.saturating_sub(2)..] {
            if range.start >= end {
                break;
            }
            usable += range.start.saturating_sub(from);
            from = from.max(range.end);
        }
        usable += end.saturating_sub(from);
        usable as f64 / samples.len().max(1) as f64
    }

    /// Share of the samples that were measured: of every so many, in long records.
    pub fn measured_share(&self) -> f64 {
        /// Samples that are asked, about: a share is then known to a thousandth.
        const ASKED: usize = 1 << 18;
        let measured = self.residual.measured();
        let asked = measured.iter().step_by((measured.len() / ASKED).max(1));
        let count = asked.len().max(1);
        asked.filter(|value| value.is_finite()).count() as f64 / count as f64
    }
}
