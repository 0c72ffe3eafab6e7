//! The signal chain of a simulation, as a filter at the data rate.
//!
//! A term's generator makes the sampled process; behind a converter the samples are those of the
//! continuous process through the chain. Since a converter's filter keeps out what lies above
//! half the rate, the one follows from the other by a filter with the response
//!
//! ```text
//! H(f) sqrt(S_ahead(f) / S_sampled(f)),    |f| <= rate / 2
//! ```
//!
//! `H` being the converter's filter and the poles in their true phase. It is realised as one
//! recursive section a pole and a finite impulse response for the rest, found by the inverse
//! Fourier transform on 4096 points and cut where less than 1e-6 of its absolute sum is
//! left. Behind a converter power is within 1e-4 of the pass band's peak everywhere. Poles without
//! a converter have no phase of their own here, and are within 1 % of their power up to half the
//! rate.

use std::f64::consts::TAU;

use pulp::Arch;
use realfft::RealFftPlanner;
use rustfft::num_complex::Complex;

use crate::chain::Chain;
use crate::model::Term;
use crate::model::random::Generator;

/// Points of the transform.
const GRID: usize = 4096;

/// Part of the impulse response's absolute sum that is cut off.
const CUT: f64 = 1e-6;

/// Longest impulse response: what falls slowly (a kink at half the rate, of poles without a
/// converter) is cut here.
const LONGEST: usize = 1024;

/// Part of the start-up that is left when the first sample is taken.
const SETTLED: f64 = 1e-9;

/// Longest start-up that is waited for, samples.
const LONGEST_START: usize = 1 << 22;

/// Samples that pass the sections at a time.
const BLOCK: usize = 512;

/// A chain at a data rate, ready to shape terms.
pub struct Shaper<'a> {
    chain: &'a Chain,
    rate_hz: f64,
    /// `1 - a` of each recursive section `(1 - a) / (1 - a/z)`, one a pole.
    sections: Vec<f64>,
    /// Response of the chain over that of the sections, on the grid.
    rest: Vec<Complex<f64>>,
}

impl<'a> Shaper<'a> {
    /// `chain` at `rate_hz` samples a second.
    pub fn new(chain: &'a Chain, rate_hz: f64) -> Self {
        let sections: Vec<f64> = chain
            .poles_hz
            .iter()
            .map(|pole_hz| -(-TAU * pole_hz / rate_hz).exp_m1())
            .collect();
        let rest = |bin| {
            let f_hz = grid_hz(bin, rate_hz);
            let recursive = recursive(&sections, f_hz, rate_hz);
            if chain.converter.is_some() {
                chain.response(f_hz, rate_hz) / recursive
            } else {
                Complex::from(chain.power(f_hz, rate_hz).sqrt() / recursive.norm())
            }
        };
        Self {
            chain,
            rate_hz,
            rest: (0..=GRID / 2).map(rest).collect(),
            sections,
        }
    }

    /// What the chain does to `term`.
    pub fn shape(&self, term: &dyn Term) -> Shape {
        let ratio = |f_hz: f64| {
            let sampled = term.spectrum(f_hz, self.rate_hz);
            if self.chain.converter.is_none() || sampled == 0.0 {
                return 1.0;
            }
            (term.spectrum_ahead(f_hz, self.rate_hz) / sampled).sqrt()
        };
        let response = self
            .rest
            .iter()
            .enumerate()
            .map(|(bin, rest)| rest * ratio(grid_hz(bin, self.rate_hz)));
        Shape {
            taps: impulse_response(response),
            sections: self.sections.clone(),
        }
    }
}

/// Frequency of a point of the grid. At zero itself the ratio of a drifting term's spectra is
/// that of two infinities.
fn grid_hz(bin: usize, rate_hz: f64) -> f64 {
    (bin as f64).max(1e-3) / GRID as f64 * rate_hz
}

/// Response of recursive sections at `f_hz`.
fn recursive(sections: &[f64], f_hz: f64, rate_hz: f64) -> Complex<f64> {
    let turn = Complex::from_polar(1.0, -TAU * f_hz / rate_hz);
    sections
        .iter()
        .map(|&section| Complex::from(section) / (Complex::from(1.0) - turn * (1.0 - section)))
        .product()
}

/// The shape that the chain gives to one term.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    taps: Vec<f64>,
    sections: Vec<f64>,
}

impl Shape {
    /// Filters what `generators` make together. The start-up is over at the first sample.
    pub fn shaped(self, generators: Vec<Box<dyn Generator>>) -> Box<dyn Generator> {
        let slowest = self.sections.iter().copied().fold(1.0, f64::min);
        let start = if slowest < 1.0 {
            (SETTLED.ln() / (-slowest).ln_1p()).ceil() as usize
        } else {
            0
        };
        let mut shaped = Shaped {
            generators,
            history: vec![0.0; self.taps.len() - 1],
            outputs: Vec::with_capacity(BLOCK),
            states: vec![0.0; self.sections.len()],
            shape: self,
        };
        let mut waste = [0.0; BLOCK];
        let mut left = (start + shaped.history.len()).min(LONGEST_START);
        while left > 0 {
            let count = left.min(BLOCK);
            shaped.add_to(&mut waste[..count]);
            left -= count;
        }
        Box::new(shaped)
    }
}

/// The taps of a response on the grid, newest sample first, without what does not matter at
/// either end.
fn impulse_response(response: impl Iterator<Item = Complex<f64>>) -> Vec<f64> {
    let mut planner = RealFftPlanner::new();
    let inverse = planner.plan_fft_inverse(GRID);
    let mut spectrum = inverse.make_input_vec();
    for (value, response) in spectrum.iter_mut().zip(response) {
        *value = response / GRID as f64;
    }
    // Real at either end, as the spectrum of real numbers is.
    for end in [0, GRID / 2] {
        spectrum[end] = spectrum[end].re.into();
    }
    let mut taps = inverse.make_output_vec();
    inverse
        .process(&mut spectrum, &mut taps)
        .expect("the lengths are those of the plan");
    // Time zero to the middle, so that zero-phase responses are in one piece.
    taps.rotate_right(GRID / 2);
    let total: f64 = taps.iter().map(|tap| tap.abs()).sum();
    let (mut from, mut to, mut cut) = (0, taps.len(), 0.0);
    while to - from > 1 {
        let (first, last) = (taps[from].abs(), taps[to - 1].abs());
        let least = first.min(last);
        if cut + least > CUT * total && to - from <= LONGEST {
            break;
        }
        cut += least;
        if first <= last {
            from += 1;
        } else {
            to -= 1;
        }
    }
    taps[from..to].to_vec()
}

struct Shaped {
    generators: Vec<Box<dyn Generator>>,
    shape: Shape,
    /// The last inputs, one fewer than there are taps, oldest first.
    history: Vec<f64>,
    outputs: Vec<f64>,
    states: Vec<f64>,
}

impl Shaped {
    fn block(&mut self, samples: &mut [f64]) {
        let (kept, count) = (self.history.len(), samples.len());
        self.history.resize(kept + count, 0.0);
        for generator in &mut self.generators {
            generator.add_to(&mut self.history[kept..]);
        }
        self.outputs.clear();
        self.outputs.resize(count, 0.0);
        let (inputs, outputs, taps) = (&self.history, &mut self.outputs, &self.shape.taps);
        Arch::new().dispatch(|| convolve(inputs, taps, outputs));
        self.history.drain(..count);
        for (section, state) in self.shape.sections.iter().zip(&mut self.states) {
            for output in &mut self.outputs {
                *state += section * (*output - *state);
                *output = *state;
            }
        }
        for (sample, output) in samples.iter_mut().zip(&self.outputs) {
            *sample += output;
        }
    }
}

/// Tap by tap over all outputs, which vectorises; `taps[0]` weighs the newest input.
#[inline(always)]
fn convolve(inputs: &[f64], taps: &[f64], outputs: &mut [f64]) {
    for (lag, tap) in taps.iter().rev().enumerate() {
        for (output, input) in outputs.iter_mut().zip(&inputs[lag..]) {
            *output += tap * input;
        }
    }
}

impl Generator for Shaped {
    fn add_to(&mut self, samples: &mut [f64]) {
        samples
            .chunks_mut(BLOCK)
            .for_each(|block| self.block(block));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Coefficient;

    /// Power of the shape at `f_hz`.
    fn power(shape: &Shape, f_hz: f64, rate_hz: f64) -> f64 {
        let turn = Complex::from_polar(1.0, -TAU * f_hz / rate_hz);
        let finite = shape
            .taps
            .iter()
            .rev()
            .fold(Complex::from(0.0), |sum, &tap| sum * turn + tap);
        let recursive = recursive(&shape.sections, f_hz, rate_hz);
        (finite * recursive).norm_sqr()
    }

    #[test]
    fn shapes_have_the_power_of_the_chain() {
        for (chain, tolerance) in [
            ("ads1281:linear+400hz", 1e-4),
            ("ads1281:minimum+3hz", 1e-4),
            ("ads1281:linear+400hz+1507hz", 1e-4),
            ("ads1281:linear", 1e-4),
            ("400hz", 1e-2),
            ("40hz+5000hz", 1e-2),
        ] {
            let (chain, rate_hz) = (chain.parse::<Chain>().expect(chain), 2000.0);
            let shaper = Shaper::new(&chain, rate_hz);
            for coefficient in [Coefficient::N, Coefficient::Q, Coefficient::K] {
                let term = coefficient.term(1.0);
                let shape = shaper.shape(&*term);
                for step in 1..2000 {
                    let f_hz = f64::from(step) * 0.5;
                    let sampled = term.spectrum(f_hz, rate_hz);
                    let ahead = match chain.converter {
                        Some(_) => term.spectrum_ahead(f_hz, rate_hz),
                        None => sampled,
                    };
                    let expected = chain.power(f_hz, rate_hz) * ahead / sampled;
                    let error = (power(&shape, f_hz, rate_hz) - expected)
                        / if chain.converter.is_some() {
                            1.0
                        } else {
                            expected
                        };
                    assert!(
                        error.abs() < tolerance,
                        "{chain} {coefficient:?} at {f_hz} Hz: {error:e}, {} taps",
                        shape.taps.len()
                    );
                }
            }
        }
    }
}
