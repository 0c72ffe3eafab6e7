//! Waveforms in noise whose slow part is fitted anew beside them.
//!
//! A jump or a settling lifts the lowest ordinates, and a fit without it takes it for walk and
//! flicker: whitened by that fit the waveform hides itself. The ratio of two likelihoods, each with
//! walk and flicker of its own, sees it. With ordinates `X` of expected square `S P`,
//!
//! ```text
//! ln L = -sum (ln S + |X - a g|^2 / (S P)),    S = rest + k W + b F
//! ```
//!
//! is made as large as it gets over `k` and `b`, with `a` and without (P. Whittle 1953); all else of the
//! density is known well from higher frequencies. Where few ordinates decide, twice the gain is not
//! chi-squared but what Student's law makes of it.

use realfft::num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use super::axis::AxisState;
use super::whole::Whole;

/// Ordinates, from the lowest, whose density is fitted anew.
const LOW: usize = 1024;

/// Steps of the fit.
const STEPS: usize = 40;

/// Size of a term that was not told from zero to begin with, as a share of the lowest density.
const BEGINNING: f64 = 0.1;

/// What a waveform is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// The noise that was fitted without it.
    Fitted,
    /// Noise whose walk and flicker are fitted anew beside it, where that is needed to see it.
    Anew,
}

/// A record on its ring, and what whitens it.
pub struct Profile<'a> {
    record: &'a Whole,
    density: &'a [f64],
    /// Numbers of the low ordinates that count.
    low: Vec<usize>,
    /// Their density without walk and flicker.
    rest: Vec<f64>,
    /// That of walk and of flicker of size 1.
    shapes: [Vec<f64>; 2],
    /// Squares of walk and flicker without a waveform.
    squares: [f64; 2],
    /// Log-likelihood of the low ordinates with these.
    null: f64,
}

/// A waveform beside walk and flicker.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Its size.
    pub size: f64,
    /// Standard deviation of it, for the density of the fit.
    pub size_sd: f64,
    /// Size over standard deviation that is as rare with all of the density known.
    pub z: f64,
    /// Squares of walk and flicker.
    squares: [f64; 2],
}

impl<'a> Profile<'a> {
    /// Of a `record` of an axis whitened by `density`.
    pub fn new(axis: &AxisState, record: &'a Whole, density: &'a [f64]) -> Self {
        let last = LOW.min(density.len() - 2);
        let low: Vec<usize> = (1..=last).filter(|&k| density[k].is_finite()).collect();
        let shapes = [0, 1].map(|term| -> Vec<f64> {
            let at = |k: &usize| axis.term_density(term, record.frequency(*k));
            low.iter().map(at).collect()
        });
        let fitted = [0, 1].map(|term| axis.fit.squared[term]);
        let rest = low.iter().enumerate().map(|(place, &k)| {
            let slow = fitted[0] * shapes[0][place] + fitted[1] * shapes[1][place];
            (density[k] - slow).max(1e-3 * density[k])
        });
        let rest = rest.collect();
        let mut profile = Self {
            record,
            density,
            low,
            rest,
            shapes,
            squares: fitted,
            null: 0.0,
        };
        for term in 0..2 {
            let least = profile.low.first().map_or(0.0, |&first| {
                BEGINNING * density[first] / profile.shapes[term][0]
            });
            profile.squares[term] = profile.squares[term].max(least);
        }
        let without = |place: usize| record.ordinates()[profile.low[place]];
        for _ in 0..STEPS {
            profile.squares = profile.step(profile.squares, without);
        }
        profile.null = profile.likelihood(profile.squares, without);
        profile
    }

    fn densities(&self, squares: [f64; 2]) -> impl Iterator<Item = f64> {
        let slow = self.shapes[0].iter().zip(&self.shapes[1]);
        let both = self.rest.iter().zip(slow);
        both.map(move |(rest, (walk, flicker))| rest + squares[0] * walk + squares[1] * flicker)
    }

    fn likelihood(&self, squares: [f64; 2], left: impl Fn(usize) -> Complex64) -> f64 {
        let power = self.record.power();
        let nats = self
            .densities(squares)
            .enumerate()
            .map(|(place, density)| -density.ln() - left(place).norm_sqr() / (density * power));
        nats.sum()
    }

    /// Squares that are likelier, by multiplication (C. Fevotte, N. Bertin and J.-L. Durrieu, Neural
    /// Comput. 21 (2009) 793, section 4).
    fn step(&self, squares: [f64; 2], left: impl Fn(usize) -> Complex64) -> [f64; 2] {
        let power = self.record.power();
        let mut sums = [[0.0; 2]; 2];
        for (place, density) in self.densities(squares).enumerate() {
            let measured = left(place).norm_sqr() / power;
            for (sums, shape) in sums.iter_mut().zip(&self.shapes) {
                sums[0] += shape[place] * measured / (density * density);
                sums[1] += shape[place] / density;
            }
        }
        [0, 1].map(|term| squares[term] * sums[term][0] / sums[term][1])
    }

    /// A waveform of any size, whose transform is `wave`.
    pub fn fit(&self, wave: &Whole) -> Joint {
        let (record, wave) = (self.record.ordinates(), wave.ordinates());
        let power = self.record.power();
        let product = |k: usize| (record[k] * wave[k].conj()).re / power;
        let energy = |k: usize| wave[k].norm_sqr() / power;
        let after = self.low.last().map_or(1, |last| last + 1);
        let (mut high, mut high_energy, mut high_square) = (0.0, 0.0, 0.0);
        for k in after..self.density.len() {
            high += product(k) / self.density[k];
            let share = energy(k) / self.density[k];
            high_energy += share;
            high_square += share * share;
        }
        let of = |squares: [f64; 2]| {
            let start = (high, high_energy, high_square);
            let low = self.low.iter().zip(self.densities(squares));
            low.fold(start, |(sum, energies, square), (&k, density)| {
                let share = energy(k) / density;
                (
                    sum + product(k) / density,
                    energies + share,
                    square + share * share,
                )
            })
        };
        let mut squares = self.squares;
        let mut size = 0.0;
        for _ in 0..STEPS {
            let (sum, energies, _) = of(squares);
            size = sum / energies;
            let left = |place: usize| record[self.low[place]] - size * wave[self.low[place]];
            squares = self.step(squares, left);
        }
        let left = |place: usize| record[self.low[place]] - size * wave[self.low[place]];
        let (_, energies, square) = of(squares);
        let gain =
            self.likelihood(squares, left) - self.null + size * (2.0 * high - size * high_energy);
        Joint {
            size,
            size_sd: (2.0 * energies).sqrt().recip(),
            z: size.signum() * as_normal(2.0 * gain.max(0.0), 2.0 * energies * energies / square),
            squares,
        }
    }

    /// What whitens the record beside the waveform of a fit.
    pub fn density(&self, joint: &Joint) -> Vec<f64> {
        let mut density = self.density.to_vec();
        for (&k, low) in self.low.iter().zip(self.densities(joint.squares)) {
            density[k] = low;
        }
        density
    }
}

/// Standard normal size as rare as twice the gain in log-likelihood of one size, where `freedom`
/// degrees tell the noise.
fn as_normal(twice: f64, freedom: f64) -> f64 {
    let freedom = freedom.max(2.0);
    let t = (freedom * (twice / (freedom + 1.0)).exp_m1()).sqrt();
    let Ok(student) = StudentsT::new(0.0, 1.0, freedom) else {
        return 0.0;
    };
    let tail = student.sf(t);
    if tail > 1e-300 {
        -Normal::standard().inverse_cdf(tail)
    } else {
        twice.sqrt()
    }
}
