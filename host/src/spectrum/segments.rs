//! One level of the cascade: samples to tapered, half-overlapped segments to power sums.
//!
//! Segments of [`LEN`] samples start at multiples of [`HOP`] of the absolute index at the level's
//! rate, so that the segments of all axes coincide and a gap costs exactly those that it touches.
//! Two neighbours, `a` and `b`, share one complex transform, `z = a + i b`: since
//! `|A_k|^2 + |B_k|^2 = (|Z_k|^2 + |Z_{N-k}|^2) / 2`, their power sums need no separation. The
//! straight line that fits each best under the taper's weights is taken out first, so that no
//! constant and no ramp leaks.

use super::window::Window;
use pulp::{Arch, Simd, WithSimd};
use rustfft::{Fft, num_complex::Complex64};
use std::sync::Arc;

/// Samples of a segment.
pub const LEN: usize = 1024;

/// Samples from one segment to the next.
pub const HOP: usize = LEN / 2;

/// Two neighbouring segments after the transform.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'a> {
    /// Level of the cascade; the rate is the sample rate over `8^level`.
    pub level: usize,
    /// The pair starts at sample `LEN * index` of the level.
    pub index: u64,
    /// Which of the two segments are whole; the others are zero.
    pub whole: [bool; 2],
    /// Transform of `a + i b`, not scaled.
    pub transform: &'a [Complex64],
}

/// Receives the transforms as they are made; `()` ignores them.
pub trait PairSink {
    /// One transform of two neighbouring segments.
    fn pair(&mut self, pair: Pair<'_>);
}

impl PairSink for () {
    fn pair(&mut self, _: Pair<'_>) {}
}

/// Taper and transform that all levels and axes share.
#[derive(Clone)]
pub struct Plan {
    arch: Arch,
    pub(super) window: Arc<Window>,
    fft: Arc<dyn Fft<f64>>,
}

impl std::fmt::Debug for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Plan").finish_non_exhaustive()
    }
}

impl Plan {
    /// Prepares the transform of [`LEN`] points for this processor.
    pub fn new() -> Self {
        Self {
            arch: Arch::new(),
            window: Arc::new(Window::new(LEN)),
            fft: crate::fft::forward(LEN),
        }
    }

    /// The processor's vector instructions, chosen when the plan was made.
    pub(super) fn arch(&self) -> Arch {
        self.arch
    }
}

impl Default for Plan {
    fn default() -> Self {
        Self::new()
    }
}

/// Power sums of one level.
#[derive(Debug, Clone)]
pub struct Power {
    /// `|Z_k|^2` for `k = 0..LEN`, summed.
    sums: Vec<f64>,
    /// Whole segments in the sums.
    pub segments: u64,
    /// How many of them directly follow another one.
    pub neighbours: u64,
    last: Option<u64>,
}

impl Power {
    fn new() -> Self {
        Self {
            sums: vec![0.0; LEN],
            segments: 0,
            neighbours: 0,
            last: None,
        }
    }

    /// Sum of `|X_k|^2` over the segments at bin `k`, `1..=LEN / 2`.
    pub fn at(&self, k: usize) -> f64 {
        0.5 * (self.sums[k] + self.sums[LEN - k])
    }

    fn count(&mut self, segment: u64) {
        self.segments += 1;
        if segment
            .checked_sub(1)
            .is_some_and(|before| self.last == Some(before))
        {
            self.neighbours += 1;
        }
        self.last = Some(segment);
    }
}

/// Cuts a level's samples into segments and sums their power.
#[derive(Debug, Clone)]
pub struct Segments {
    level: usize,
    plan: Plan,
    power: Power,
    /// Samples of the present run that later pairs still need, from index `start` on.
    pending: Vec<f64>,
    start: u64,
    tapered: Vec<Complex64>,
    transform: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Segments {
    /// An empty level.
    pub fn new(level: usize, plan: &Plan) -> Self {
        Self {
            level,
            power: Power::new(),
            pending: Vec::with_capacity(4 * LEN),
            start: 0,
            tapered: vec![Complex64::default(); LEN],
            transform: vec![Complex64::default(); LEN],
            scratch: vec![Complex64::default(); plan.fft.get_outofplace_scratch_len()],
            plan: plan.clone(),
        }
    }

    /// The sums over all whole segments, with those that a pair is still waiting to share.
    pub fn power(&self) -> Power {
        let mut end = self.clone();
        end.finish_run(&mut ());
        end.power
    }

    /// Takes the next samples of a run; `first` is the absolute index of the first.
    pub fn push(&mut self, first: u64, samples: &[f64], sink: &mut impl PairSink) {
        if self.pending.is_empty() {
            self.start = first;
        }
        self.pending.extend_from_slice(samples);
        let end = self.start + self.pending.len() as u64;
        let mut index = self.start / LEN as u64;
        while (index + 1) * LEN as u64 + HOP as u64 <= end {
            let from = index * LEN as u64;
            self.pair(
                index,
                from >= self.start,
                from + HOP as u64 >= self.start,
                sink,
            );
            index += 1;
        }
        let used = (index * LEN as u64).saturating_sub(self.start) as usize;
        self.pending.drain(..used);
        self.start += used as u64;
    }

    /// Ends the run: a pair of which only the first segment is whole is transformed alone.
    pub fn finish_run(&mut self, sink: &mut impl PairSink) {
        let end = self.start + self.pending.len() as u64;
        let index = self.start / LEN as u64;
        if index * LEN as u64 >= self.start && (index + 1) * LEN as u64 <= end {
            self.pair(index, true, false, sink);
        }
        self.pending.clear();
    }

    fn pair(&mut self, index: u64, a: bool, b: bool, sink: &mut impl PairSink) {
        if !a && !b {
            return;
        }
        let offset = index as i64 * LEN as i64 - self.start as i64;
        let segment = |whole: bool, shift: i64| {
            whole.then(|| {
                let from = (offset + shift) as usize;
                &self.pending[from..from + LEN]
            })
        };
        let (first, second) = (segment(a, 0), segment(b, HOP as i64));
        let (window, out) = (&self.plan.window, &mut self.tapered);
        self.plan.arch.dispatch(Taper {
            window,
            first,
            second,
            out,
        });
        self.plan
            .fft
            .process_outofplace_with_scratch(out, &mut self.transform, &mut self.scratch);
        let (sums, transform) = (&mut self.power.sums, &self.transform);
        self.plan.arch.dispatch(|| {
            for (sum, z) in sums.iter_mut().zip(transform) {
                *sum += z.re * z.re + z.im * z.im;
            }
        });
        for (whole, segment) in [(a, 2 * index), (b, 2 * index + 1)] {
            if whole {
                self.power.count(segment);
            }
        }
        sink.pair(Pair {
            level: self.level,
            index,
            whole: [a, b],
            transform: &self.transform,
        });
    }
}

/// A call of [`taper`], as a type so that it is inlined where vector instructions are enabled.
struct Taper<'a> {
    window: &'a Window,
    first: Option<&'a [f64]>,
    second: Option<&'a [f64]>,
    out: &'a mut [Complex64],
}

impl WithSimd for Taper<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        taper(self.window, self.first, self.second, self.out);
    }
}

/// `out = w (a - line_a) + i w (b - line_b)`, each line fitted with the weights `w`; an absent
/// segment is zero.
#[inline(always)]
fn taper(window: &Window, a: Option<&[f64]>, b: Option<&[f64]>, out: &mut [Complex64]) {
    let (weights, lines) = (window.values(), window.line());
    let fit = |x: &[f64]| {
        let [sum, tilt] = dots(weights, lines, x);
        [sum / window.sum(), tilt / window.sum_of_line()]
    };
    match (a, b) {
        (Some(a), Some(b)) => {
            let ([mean_a, slope_a], [mean_b, slope_b]) = (fit(a), fit(b));
            let weights = weights.iter().zip(lines);
            for (((z, (w, l)), a), b) in out.iter_mut().zip(weights).zip(a).zip(b) {
                *z = Complex64::new(
                    w * (a - mean_a) - l * slope_a,
                    w * (b - mean_b) - l * slope_b,
                );
            }
        }
        (Some(x), None) | (None, Some(x)) => {
            let [mean, slope] = fit(x);
            let unit = if a.is_some() {
                Complex64::ONE
            } else {
                Complex64::I
            };
            for ((z, (w, l)), x) in out.iter_mut().zip(weights.iter().zip(lines)).zip(x) {
                *z = unit * (w * (x - mean) - l * slope);
            }
        }
        (None, None) => out.fill(Complex64::default()),
    }
}

/// Scalar products with `x`, each in eight partial sums, so that they can be vectorised.
#[inline(always)]
fn dots(one: &[f64], other: &[f64], x: &[f64]) -> [f64; 2] {
    let mut sums = [[0.0; 8]; 2];
    let pairs = one.chunks_exact(8).zip(other.chunks_exact(8));
    for ((one, other), x) in pairs.zip(x.chunks_exact(8)) {
        for i in 0..8 {
            sums[0][i] += one[i] * x[i];
            sums[1][i] += other[i] * x[i];
        }
    }
    sums.map(|sums| sums.iter().sum())
}
