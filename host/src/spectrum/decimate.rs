//! Decimation by eight between the levels of the cascade: three half-band filters.
//!
//! Each halves the rate with a symmetric low-pass of odd length whose even taps vanish but the
//! centre one (Crochiere and Rabiner 1983, section 5.4); windowed-sinc design with a Kaiser taper.
//! The first two may have wide transitions since later ones remove what they leave. Output `m`
//! is centred on input `8 m`: no delay, and the grid is that of the absolute sample index, the
//! same for every axis and after every gap. The response is real, known exactly and flat to
//! 3e-5 dB up to [`PASS`] of the output rate; what folds onto that band is below -115 dB.

use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::PI;

/// Input samples for each output sample.
pub const FACTOR: u64 = 8;

/// End of the passband as a fraction of the output rate.
pub const PASS: f64 = 0.4;

/// Half-lengths (taps at odd distances on one side) and Kaiser shapes of the three filters,
/// first to last. Transition bands, as fractions of each filter's input rate, are
/// `0.5 - 2 * edge` wide with edges 0.05, 0.1 and 0.2.
const STAGES: [usize; 3] = [6, 8, 22];

/// Shape of the Kaiser taper for 120 dB: `0.1102 (A - 8.7)` (Kaiser 1974).
const KAISER_BETA: f64 = 12.27;

/// One half-band filter: `y[m] = x[2m] / 2 + sum_i taps[i] (x[2m + 2i + 1] + x[2m - 2i - 1])`.
#[derive(Debug, Clone)]
struct HalfBand {
    taps: Vec<f64>,
    /// Samples with even and odd absolute index, from index `2 * base` on.
    even: Vec<f64>,
    odd: Vec<f64>,
    base: u64,
}

impl HalfBand {
    fn new(half_length: usize) -> Self {
        let reach = (2 * half_length) as f64;
        let mut taps: Vec<f64> = (0..half_length)
            .map(|i| {
                let distance = (2 * i + 1) as f64;
                let ideal = (0.5 * PI * distance).sin() / (PI * distance);
                let ratio = distance / reach;
                ideal * bessel_i0(KAISER_BETA * (1.0 - ratio * ratio).sqrt())
            })
            .collect();
        // The side taps add up to one half, so that a constant passes unchanged.
        let total = 2.0 * taps.iter().sum::<f64>();
        for tap in &mut taps {
            *tap *= 0.5 / total;
        }
        Self {
            taps,
            even: Vec::new(),
            odd: Vec::new(),
            base: 0,
        }
    }

    /// Response at `cycles` per input sample; real, as the filter is symmetric.
    fn response(&self, cycles: f64) -> f64 {
        let side: f64 = self
            .taps
            .iter()
            .enumerate()
            .map(|(i, tap)| tap * (2.0 * PI * cycles * (2 * i + 1) as f64).cos())
            .sum();
        0.5 + 2.0 * side
    }

    fn reset(&mut self) {
        self.even.clear();
        self.odd.clear();
    }

    /// Takes the next samples of a run (`first` is the absolute index of the first), appends
    /// what they complete to `out` and returns the absolute index of the first of these.
    fn process(&mut self, arch: Arch, first: u64, input: &[f64], out: &mut Vec<f64>) -> u64 {
        let mut input = input;
        if self.even.is_empty() && self.odd.is_empty() {
            self.base = first.div_ceil(2);
            // A run that starts on an odd index gives its first sample up.
            input = &input[((first & 1) as usize).min(input.len())..];
        }
        let mut rest = input;
        if self.even.len() > self.odd.len()
            && let Some((&value, tail)) = rest.split_first()
        {
            self.odd.push(value);
            rest = tail;
        }
        let (even, odd) = (&mut self.even, &mut self.odd);
        arch.dispatch(|| deinterleave(rest, even, odd));
        // Output `base + reach + j` needs odd[j .. j + 2 reach] and even[j + reach].
        let reach = self.taps.len();
        let count = (self.odd.len() + 1).saturating_sub(2 * reach);
        let count = count.min(self.even.len().saturating_sub(reach));
        let first_out = self.base + reach as u64;
        if count > 0 {
            let start = out.len();
            out.resize(start + count, 0.0);
            let (even, odd, taps) = (&self.even[reach..], &self.odd[..], &self.taps[..]);
            arch.dispatch(Convolve {
                even,
                odd,
                taps,
                out: &mut out[start..],
            });
            self.even.drain(..count);
            self.odd.drain(..count);
            self.base += count as u64;
        }
        first_out
    }
}

/// A call of [`convolve`]. A type of its own rather than a closure: large closures are not
/// inlined into the code that the vector instructions are enabled for.
struct Convolve<'a> {
    even: &'a [f64],
    odd: &'a [f64],
    taps: &'a [f64],
    out: &'a mut [f64],
}

impl WithSimd for Convolve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        convolve(self.even, self.odd, self.taps, self.out);
    }
}

/// Appends alternate values of `input` to `even` and `odd`.
#[inline(always)]
fn deinterleave(input: &[f64], even: &mut Vec<f64>, odd: &mut Vec<f64>) {
    let pairs = input.chunks_exact(2);
    even.extend(pairs.clone().map(|pair| pair[0]));
    even.extend_from_slice(pairs.remainder());
    odd.extend(pairs.map(|pair| pair[1]));
}

/// `out[j] = even[j] / 2 + sum_i taps[i] (odd[reach + j + i] + odd[reach + j - 1 - i])`, in
/// blocks small enough to stay in registers.
#[inline(always)]
fn convolve(even: &[f64], odd: &[f64], taps: &[f64], out: &mut [f64]) {
    const BLOCK: usize = 16;
    let reach = taps.len();
    let mut blocks = out.chunks_exact_mut(BLOCK);
    let mut at = 0;
    for block in &mut blocks {
        let mut sums = [0.0; BLOCK];
        for (sum, value) in sums.iter_mut().zip(&even[at..at + BLOCK]) {
            *sum = 0.5 * value;
        }
        for (i, &tap) in taps.iter().enumerate() {
            let after = &odd[at + reach + i..][..BLOCK];
            let before = &odd[at + reach - 1 - i..][..BLOCK];
            for j in 0..BLOCK {
                sums[j] += tap * (after[j] + before[j]);
            }
        }
        block.copy_from_slice(&sums);
        at += BLOCK;
    }
    for value in blocks.into_remainder() {
        let mut sum = 0.5 * even[at];
        for (i, &tap) in taps.iter().enumerate() {
            sum += tap * (odd[at + reach + i] + odd[at + reach - 1 - i]);
        }
        *value = sum;
        at += 1;
    }
}

/// Modified Bessel function of the first kind and order zero, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 1.0);
    while term > 1e-17 * sum {
        term *= quarter / (k * k);
        sum += term;
        k += 1.0;
    }
    sum
}

/// Decimator by [`FACTOR`]: three half-band filters in a row.
#[derive(Debug, Clone)]
pub struct Decimator {
    stages: [HalfBand; 3],
    scratch: [Vec<f64>; 2],
}

impl Default for Decimator {
    fn default() -> Self {
        Self {
            stages: STAGES.map(HalfBand::new),
            scratch: [Vec::new(), Vec::new()],
        }
    }
}

impl Decimator {
    /// Forgets the run: the next samples follow a gap.
    pub fn reset(&mut self) {
        for stage in &mut self.stages {
            stage.reset();
        }
    }

    /// Takes the next samples of a run (`first`: absolute index of the first, at the input rate),
    /// replaces `out` by the output that they complete and returns the absolute index of its
    /// first sample at the output rate.
    pub fn process(&mut self, arch: Arch, first: u64, input: &[f64], out: &mut Vec<f64>) -> u64 {
        let [one, two, three] = &mut self.stages;
        let [halved, quartered] = &mut self.scratch;
        halved.clear();
        quartered.clear();
        out.clear();
        let at = one.process(arch, first, input, halved);
        if halved.is_empty() {
            return at;
        }
        let at = two.process(arch, at, halved, quartered);
        if quartered.is_empty() {
            return at;
        }
        three.process(arch, at, quartered, out)
    }

    /// Amplitude response at `cycles` per input sample; real.
    pub fn response(&self, cycles: f64) -> f64 {
        let [one, two, three] = &self.stages;
        one.response(cycles) * two.response(2.0 * cycles) * three.response(4.0 * cycles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passband_is_flat_and_aliases_are_gone() {
        let decimator = Decimator::default();
        let pass = PASS / FACTOR as f64;
        let (mut ripple, mut alias) = (0.0_f64, 0.0_f64);
        for i in 0..=20_000 {
            let cycles = 0.5 * f64::from(i) / 20_000.0;
            let gain = decimator.response(cycles).abs();
            let folded = (cycles * FACTOR as f64 - (cycles * FACTOR as f64).round()).abs();
            if cycles <= pass {
                ripple = ripple.max((20.0 * gain.log10()).abs());
            } else if folded <= PASS && cycles > 0.5 / FACTOR as f64 {
                alias = alias.max(gain);
            }
        }
        assert!(ripple < 3e-5, "ripple {ripple:e} dB");
        assert!(
            20.0 * alias.log10() < -115.0,
            "alias {:.1} dB",
            20.0 * alias.log10()
        );
    }

    #[test]
    fn a_constant_and_a_tone_pass_in_place_whatever_the_chunks() {
        let cycles = 0.3 / FACTOR as f64;
        let wave = |n: f64| 2.6e8 + (2.0 * PI * cycles * n + 0.4).cos();
        let input: Vec<f64> = (0..6000).map(|n| wave(f64::from(n + 1003))).collect();
        let mut whole = Vec::new();
        let at = Decimator::default().process(Arch::new(), 1003, &input, &mut whole);
        let gain = Decimator::default().response(cycles);
        for (m, value) in whole.iter().enumerate() {
            let centre = ((at + m as u64) * FACTOR) as f64;
            let expected = 2.6e8 + gain * (wave(centre) - 2.6e8);
            assert!((value - expected).abs() < 5e-7, "{m}: {value} {expected}");
        }
        let mut decimator = Decimator::default();
        let (mut pieces, mut first, mut chunk) = (Vec::new(), 1003, 1);
        let mut rest = &input[..];
        let mut out = Vec::new();
        while !rest.is_empty() {
            let (head, tail) = rest.split_at(chunk.min(rest.len()));
            let start = decimator.process(Arch::new(), first, head, &mut out);
            if !out.is_empty() {
                assert_eq!(start, at + pieces.len() as u64);
            }
            pieces.extend_from_slice(&out);
            first += head.len() as u64;
            rest = tail;
            chunk = (chunk * 7 + 3) % 501;
        }
        assert_eq!(pieces, whole);
    }
}
