//! Narrow lines of a recorded file: the transform of the whole record, in bounded passes.
//!
//! The record is replayed a fixed number of times. The first replay yields trend and noise floor
//! ([`floor`](super::floor)). The next ones fold the record so that one short transform gives every
//! `R`-th frequency of the long one (decimation in frequency; Cooley and Tukey 1965): for
//! `k = R q + r`, `N = R L`,
//! `X_k = sum_{n<L} e^{-2 pi i q n / L} [ e^{-2 pi i r n / N} sum_{m<R} x_{n + L m} e^{-2 pi i r m / R} ]`,
//! exactly, whatever the record's length. `N` is at least 1.5 times the length; what comes near
//! the threshold is evaluated between the grid's points in a last replay.
//!
//! **Level.** Family-wise over continuous frequency between the lowest searched and half the
//! rate: by Rice's formula the power over the floor exceeds `z` somewhere with probability at
//! most `2 sqrt(z lambda / 2 pi) e^{-z}` times the band, `lambda` = half the variance of
//! `2 pi t` over the record (for the untapered: `T sqrt(pi z / 3) e^{-z}` a hertz), averaged over
//! the floor's own error; a tenth of the level belongs to slow lines (`slow_floor`), down to 64
//! cycles a record. The ends are tapered over 5 % each so that wander does not leak,
//! which costs 1.9 % of amplitude.

use super::{
    fill::{Filler, Piece},
    floor::{Floor, LongSegments, SEGMENT},
    fold::Folded,
    slow_floor::{Blocks, SlowFloor},
};
use crate::fft::phasor::Phasor;
use crate::numeric::{bisect::bisect, top::climb};
use rustfft::num_complex::Complex64;
use std::{f64::consts::PI, ops::Range};

/// Points of one short transform, at most.
const POINTS: usize = 1 << 18;

/// Residues that one replay serves: each needs an accumulator of [`POINTS`], and two replays run next to
/// one another.
const RESIDUES: usize = 8;

/// Grid points for each `1 / T`, at least.
const PADDING: f64 = 1.5;

/// What scalloping between the grid's points leaves of a line's power, at least.
const SCALLOPING: f64 = 0.68;

/// Share of the record that each end's taper takes.
const TAPER: f64 = 0.05;

/// Candidates that are evaluated between the grid's points; the strongest if there are more.
const CANDIDATES: usize = 64;

/// Share of the level that slow lines have, whose frequencies are few.
const SLOW_SHARE: f64 = 0.1;

/// Blocks that a candidate's demodulated record is kept in.
const BLOCKS: usize = 1024;

/// A line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Frequency, hertz.
    pub frequency_hz: f64,
    /// One standard deviation of it, hertz.
    pub frequency_sd_hz: f64,
    /// Amplitude `A` of `A cos(2 pi f t + p)`, in the unit of the samples.
    pub amplitude: f64,
    /// Power over the floor.
    pub ratio: f64,
    /// Family-wise probability of a line as strong anywhere without one.
    pub false_alarm: f64,
}

/// Something that yields the same samples each time: blocks with the absolute index of their
/// first sample, ascending.
pub trait Replay: Sync {
    /// Why a replay failed.
    type Error: Send;

    /// Hands every block to `visit`.
    ///
    /// # Errors
    /// Whatever keeps the record from being read.
    fn replay(&self, visit: &mut dyn FnMut(u64, &[f64])) -> Result<(), Self::Error>;
}

/// Samples in memory.
impl Replay for [f64] {
    type Error = std::convert::Infallible;

    fn replay(&self, visit: &mut dyn FnMut(u64, &[f64])) -> Result<(), Self::Error> {
        for (index, block) in self.chunks(1 << 14).enumerate() {
            visit((index as u64) << 14, block);
        }
        Ok(())
    }
}

/// Codes in memory.
impl Replay for [i32] {
    type Error = std::convert::Infallible;

    fn replay(&self, visit: &mut dyn FnMut(u64, &[f64])) -> Result<(), Self::Error> {
        let mut values = Vec::with_capacity(1 << 14);
        for (index, block) in self.chunks(1 << 14).enumerate() {
            values.clear();
            values.extend(block.iter().map(|&code| f64::from(code)));
            visit((index as u64) << 14, &values);
        }
        Ok(())
    }
}

/// Lines of a record sampled at `rate_hz`, by frequency, at a family-wise `level`. None in a
/// record of fewer than 16384 samples: it has no floor to compare with.
///
/// # Errors
/// What a replay fails with.
pub fn search<R: Replay + ?Sized>(
    record: &R,
    rate_hz: f64,
    level: f64,
) -> Result<Vec<Line>, R::Error> {
    let Some(mut survey) = Survey::take(record, rate_hz)? else {
        return Ok(Vec::new());
    };
    survey.look_slow(record)?;
    let threshold = survey.threshold(level);
    let mut candidates = survey.grid(record, threshold * SCALLOPING)?;
    candidates.sort_by(|one, other| other.1.total_cmp(&one.1));
    candidates.truncate(CANDIDATES);
    let mut lines = survey.refine(record, &candidates)?;
    lines.retain(|line| line.false_alarm < level);
    lines.sort_by(|one, other| other.amplitude.total_cmp(&one.amplitude));
    let mut kept: Vec<Line> = Vec::new();
    for line in lines {
        let hidden = kept.iter().any(|strong| {
            let distance = (line.frequency_hz - strong.frequency_hz).abs() * survey.duration_s();
            let share = (line.amplitude / strong.amplitude).powi(2);
            distance < 1.5 || share < 4.0 * (side_lobe(distance) + survey.missing * survey.missing)
        });
        if !hidden {
            kept.push(line);
        }
    }
    kept.sort_by(|one, other| one.frequency_hz.total_cmp(&other.frequency_hz));
    Ok(kept)
}

/// What the first replay shows.
struct Survey {
    first: u64,
    len: u64,
    rate_hz: f64,
    /// Share of the samples that is missing: a strong line looks as wide as the gaps are short,
    /// that much below its peak.
    missing: f64,
    /// Straight line through the record: value at its middle and slope per sample.
    middle: f64,
    slope: f64,
    floor: Floor,
    /// Below the lowest frequency of `floor`.
    slow: Option<SlowFloor>,
}

impl Survey {
    fn take<R: Replay + ?Sized>(record: &R, rate_hz: f64) -> Result<Option<Self>, R::Error> {
        let (mut first, mut end) = (None, 0);
        record.replay(&mut |at, values| {
            first.get_or_insert(at);
            end = at + values.len() as u64;
        })?;
        let Some(first) = first else { return Ok(None) };
        let len = end - first;
        if len < 1 << 14 {
            return Ok(None);
        }
        let mut segments = LongSegments::new(SEGMENT.min(1 << (len / 8).ilog2()));
        let mut reference = None;
        let [mut n, mut t, mut tt, mut x, mut tx] = [0.0_f64; 5];
        let middle = 0.5 * (len - 1) as f64;
        record.replay(&mut |at, values| {
            // A block out of order is left out everywhere alike.
            if segments.push(at, values).is_err() {
                return;
            }
            for (index, &value) in values.iter().enumerate().filter(|(_, x)| x.is_finite()) {
                let value = value - *reference.get_or_insert(value);
                let time = (at - first) as f64 + index as f64 - middle;
                n += 1.0;
                t += time;
                tt += time * time;
                x += value;
                tx += time * value;
            }
        })?;
        let (Some(floor), Some(reference)) = (segments.floor(rate_hz), reference) else {
            return Ok(None);
        };
        let slope = (tx - t * x / n) / (tt - t * t / n).max(1.0);
        Ok(Some(Self {
            first,
            len,
            rate_hz,
            missing: 1.0 - n / len as f64,
            middle: reference + (x - slope * t) / n,
            slope,
            floor,
            slow: None,
        }))
    }

    /// Measures the floor below what segments resolve.
    fn look_slow<R: Replay + ?Sized>(&mut self, record: &R) -> Result<(), R::Error> {
        let highest = (self.floor.lowest_hz() * self.duration_s()).ceil() as usize;
        let Some(mut blocks) = Blocks::new(self.len as usize, highest) else {
            return Ok(());
        };
        self.tapered(record, |at, values| blocks.push(at, values))?;
        self.slow = Some(blocks.floor(self.taper_energy() * self.rate_hz));
        Ok(())
    }

    /// The floor at frequencies that only the whole record resolves.
    fn slow_at(&self, f_hz: f64) -> Option<&SlowFloor> {
        self.slow.as_ref().filter(|_| f_hz < self.floor.lowest_hz())
    }

    /// Lowest frequency that is searched, hertz.
    fn lowest_hz(&self) -> f64 {
        match self.slow {
            Some(_) => SlowFloor::lowest() / self.duration_s(),
            None => self.floor.lowest_hz(),
        }
    }

    fn duration_s(&self) -> f64 {
        self.len as f64 / self.rate_hz
    }

    /// Replays the record without gaps and trend, tapered: index from 0 and values.
    fn tapered<R: Replay + ?Sized>(
        &self,
        record: &R,
        mut visit: impl FnMut(usize, &[f64]),
    ) -> Result<(), R::Error> {
        let (mut filler, mut at) = (Filler::default(), 0);
        let mut values = Vec::new();
        let centre = 0.5 * (self.len - 1) as f64;
        let edge = TAPER * self.len as f64;
        // Half a turn of a cosine over each end.
        let rise = Phasor::new(0.5 / edge);
        record.replay(&mut |first, block| {
            filler.push(first, block, u64::MAX, &mut |piece| match piece {
                Piece::Break(index) => at = (index - self.first) as usize,
                Piece::Measured(piece) | Piece::Bridge(piece) => {
                    values.clear();
                    values.extend(piece.iter().enumerate().map(|(n, x)| {
                        let place = (at + n) as f64;
                        x - self.middle - self.slope * (place - centre)
                    }));
                    taper(at, self.len as usize, edge, &rise, &mut values);
                    visit(at, &values);
                    at += piece.len();
                }
            });
        })
    }

    /// Sum of the squared taper.
    fn taper_energy(&self) -> f64 {
        self.len as f64 * (1.0 - 2.0 * TAPER * (1.0 - 0.375))
    }

    /// Sum of the taper.
    fn taper_sum(&self) -> f64 {
        self.len as f64 * (1.0 - TAPER)
    }

    /// Power over the floor of a squared transform at `f_hz`.
    fn ratio(&self, power: f64, f_hz: f64) -> f64 {
        let floor = self.slow_at(f_hz).map_or_else(
            || self.floor.at(f_hz),
            |slow| slow.at(f_hz * self.duration_s()),
        );
        power / (self.taper_energy() * self.rate_hz * floor)
    }

    /// Probability that the power at a slow line's frequency exceeds `ratio` at any slow one.
    fn slow_false_alarm(&self, ratio: f64, f_hz: f64) -> f64 {
        let band = (self.floor.lowest_hz() - self.lowest_hz()) * self.duration_s();
        let tail = SlowFloor::tail(f_hz * self.duration_s(), ratio);
        band * (PI * ratio / 3.0).sqrt() * tail / SLOW_SHARE
    }

    /// Probability that the power exceeds `ratio` anywhere without a line.
    fn false_alarm(&self, ratio: f64, floor_sd: f64) -> f64 {
        let band_hz = 0.5 * self.rate_hz - self.floor.lowest_hz();
        let crossings = |z: f64| band_hz * self.duration_s() * (PI * z / 3.0).sqrt() * (-z).exp();
        0.5 * (crossings(ratio * (1.0 - floor_sd)) + crossings(ratio * (1.0 + floor_sd)))
            / (1.0 - SLOW_SHARE)
    }

    /// Ratio whose false alarm is `level`, for a floor that is well known.
    fn threshold(&self, level: f64) -> f64 {
        bisect(1.0, 1000.0, 50, |ratio| {
            self.false_alarm(ratio, 0.0) > level
        })
    }

    /// Local peaks of the grid above `ratio`: frequency in cycles per sample and ratio.
    fn grid<R: Replay + ?Sized>(
        &self,
        record: &R,
        ratio: f64,
    ) -> Result<Vec<(f64, f64)>, R::Error> {
        let wanted = (PADDING * self.len as f64) as usize;
        let points = POINTS.min(wanted.next_power_of_two());
        let folds = wanted.div_ceil(points);
        let total = (points * folds) as f64;
        // Two at a time, whatever the number of processors: each needs its accumulators.
        let (low, high) = (0..folds / 4 + 1, folds / 4 + 1..folds / 2 + 1);
        let part = |residues| self.residues(record, points, folds, residues, ratio);
        let (low, high) = rayon::join(|| part(low), || part(high));
        let mut high = [low?, high?].concat();
        high.sort_by_key(|point| point.0);
        high.dedup_by_key(|point| point.0);
        let peak = |index: usize| {
            let (k, seen) = high[index];
            let beaten = |other: Option<&(usize, f64)>| {
                other.is_some_and(|&(l, value)| k.abs_diff(l) <= 2 && value > seen)
            };
            !beaten(index.checked_sub(1).and_then(|before| high.get(before)))
                && !beaten(high.get(index + 1))
        };
        Ok((0..high.len())
            .filter(|&index| peak(index))
            .map(|index| (high[index].0 as f64 / total, high[index].1))
            .collect())
    }

    /// Points of the grid above `ratio` whose numbers leave one of the `residues` over `folds`.
    fn residues<R: Replay + ?Sized>(
        &self,
        record: &R,
        points: usize,
        folds: usize,
        residues: Range<usize>,
        ratio: f64,
    ) -> Result<Vec<(usize, f64)>, R::Error> {
        let total = (points * folds) as f64;
        let fft = crate::fft::forward(points);
        let mut scratch = vec![Complex64::default(); fft.get_inplace_scratch_len()];
        let mut folded = Folded::new(points, folds, RESIDUES.min(residues.len()));
        let mut high = Vec::new();
        let lowest = self.lowest_hz() / self.rate_hz;
        let Range { start, end } = residues;
        for first in (start..end).step_by(RESIDUES) {
            folded.begin(first);
            self.tapered(record, |at, values| folded.push(at, values))?;
            for (sums, r) in folded.residues().zip(first..end) {
                let phasor = Phasor::new(-(r as f64) / total);
                phasor.zip(0, sums.iter_mut(), 1.0.into(), |z, turn| *z *= turn);
                fft.process_with_scratch(sums, &mut scratch);
                for (q, z) in sums.iter().enumerate() {
                    let k = folds * q + r;
                    let mirrored = k.min(points * folds - k);
                    let cycles = mirrored as f64 / total;
                    if cycles < lowest {
                        continue;
                    }
                    let seen = self.ratio(z.norm_sqr(), cycles * self.rate_hz);
                    if seen > ratio {
                        high.push((mirrored, seen));
                    }
                }
            }
        }
        Ok(high)
    }

    /// Evaluates candidates between the grid's points: the record is demodulated into blocks,
    /// whose sum at nearby frequencies follows without another replay.
    fn refine<R: Replay + ?Sized>(
        &self,
        record: &R,
        candidates: &[(f64, f64)],
    ) -> Result<Vec<Line>, R::Error> {
        if candidates.is_empty() {
            return Ok(Vec::new());
        }
        let block = (self.len as usize).div_ceil(BLOCKS);
        let mut sums = vec![vec![Complex64::default(); BLOCKS]; candidates.len()];
        self.tapered(record, |at, values| {
            for (sums, &(cycles, _)) in sums.iter_mut().zip(candidates) {
                let turn = Complex64::from_polar(1.0, -2.0 * PI * cycles);
                let mut start = 0;
                while start < values.len() {
                    let index = at + start;
                    let end = values
                        .len()
                        .min(start + block - index % block)
                        .min(start + 256);
                    let turns = (cycles * index as f64).fract();
                    let mut phasor = Complex64::from_polar(1.0, -2.0 * PI * turns);
                    let mut sum = Complex64::default();
                    for &x in &values[start..end] {
                        sum += phasor * x;
                        phasor *= turn;
                    }
                    sums[index / block] += sum;
                    start = end;
                }
            }
        })?;
        Ok(candidates
            .iter()
            .zip(&sums)
            .map(|(&(cycles, _), sums)| self.line(cycles, block, sums))
            .collect())
    }

    /// Highest point within a bin of a candidate.
    fn line(&self, cycles: f64, block: usize, sums: &[Complex64]) -> Line {
        let power = |offset_bins: f64| {
            let step = -2.0 * PI * offset_bins * block as f64 / self.len as f64;
            let total: Complex64 = sums
                .iter()
                .enumerate()
                .map(|(index, sum)| sum * Complex64::from_polar(1.0, step * index as f64))
                .sum();
            total.norm_sqr()
        };
        let (offset, height) = climb(0.0, 0.25, 1e-4, power);
        let frequency_hz = (cycles + offset / self.len as f64) * self.rate_hz;
        let ratio = self.ratio(height, frequency_hz);
        let false_alarm = if self.slow_at(frequency_hz).is_some() {
            self.slow_false_alarm(ratio, frequency_hz)
        } else {
            self.false_alarm(ratio, self.floor.relative_sd_at(frequency_hz))
        };
        Line {
            frequency_hz,
            // Cramer-Rao bound of a single tone (Rife and Boorstyn 1974, eq. 16).
            frequency_sd_hz: (1.5 / (PI * PI * ratio)).sqrt() / self.duration_s(),
            amplitude: 2.0 * height.sqrt() / self.taper_sum(),
            ratio,
            false_alarm: false_alarm.min(1.0),
        }
    }
}

/// Tapers `values` from index `at` of `len` on, by `rise` over `edge` samples of each end.
fn taper(at: usize, len: usize, edge: f64, rise: &Phasor, values: &mut [f64]) {
    let half = Complex64::cis(0.5 * PI / edge);
    let last = at + values.len();
    let within = (edge - 0.5).ceil() as usize;
    let start = values.len().min(within.saturating_sub(at));
    rise.zip(at, &mut values[..start], half, |value, turn| {
        *value *= 0.5 - 0.5 * turn.re;
    });
    let end = values.len() - values.len().min(last.saturating_sub(len - within));
    let from_end = values[end..].iter_mut().rev();
    rise.zip(len - last, from_end, half, |value, turn| {
        *value *= 0.5 - 0.5 * turn.re;
    });
}

/// Power of the taper's side lobes at a distance in `1 / T`, relative to its peak, from above:
/// those of the untapered window until the taper of the ends takes over.
fn side_lobe(distance: f64) -> f64 {
    let untapered = (PI * distance).powi(-2);
    let knee = 1.0 / TAPER;
    untapered * (knee / distance).min(1.0).powi(4)
}
