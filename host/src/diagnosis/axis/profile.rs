//! Waveforms in noise whose slow part is fitted anew together with them.
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
//! density is known well from higher frequencies. What is free at the ring's seam
//! ([`Seam`](crate::diagnosis::statistic::matched_filter::Seam)) is so in both. Where few ordinates decide, twice the gain is not
//! chi-squared but what Student's law makes of it.

use nalgebra::{DMatrix, DVector};
use realfft::num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::statistic::matched_filter::Transform;

/// Ordinates, from the lowest, whose density is fitted anew: at the last of them a walk has a
/// millionth of the density that it has at the first, flicker a thousandth.
const LOW: usize = 1024;

/// Steps of the fit: a choice, the same for all waveforms that are compared. Each costs one pass
/// over the [`LOW`] ordinates.
const STEPS: usize = 40;

/// Share of the density that is no walk and no flicker, at least: above zero, and worth a
/// thousandth of a nat an ordinate.
const LEAST: f64 = 1e-3;

/// Size of a term that was not resolved from zero to begin with, as a share of the lowest density:
/// steps multiply, and would never leave zero. A tenth is a choice.
const BEGINNING: f64 = 0.1;

/// What a waveform is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// The noise that was fitted without it.
    Fitted,
    /// Noise whose walk and flicker are fitted anew together with it, where that is needed to see it.
    Anew,
}

/// A record on its ring, and what whitens it.
pub struct Profile<'a> {
    record: &'a Transform,
    density: &'a [f64],
    /// Numbers of the low ordinates that count.
    low: Vec<usize>,
    /// Their density without walk and flicker.
    rest: Vec<f64>,
    /// That of walk and of flicker of size 1.
    shapes: [Vec<f64>; 2],
    /// What is free at the seam.
    seam: Vec<Transform>,
    /// Squares of walk and flicker without a waveform.
    squares: [f64; 2],
    /// Log-likelihood of the record without a waveform, nats.
    null: f64,
}

/// A waveform together with walk and flicker.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Size over standard deviation that is as rare with all of the density known.
    pub z: f64,
    /// Gain in log-likelihood, nats.
    pub nats: f64,
    /// Squares of walk and flicker.
    squares: [f64; 2],
}

/// What is linear in the record, as it fits best.
struct Linear {
    /// Products of the waveforms among themselves and with the record.
    gram: DMatrix<f64>,
    products: DVector<f64>,
}

/// A fit of walk, flicker and waveforms together.
struct Best {
    squares: [f64; 2],
    sizes: DVector<f64>,
    nats: f64,
}

impl<'a> Profile<'a> {
    /// Of a `record` of an axis whitened by `density`.
    pub fn new(axis: &AxisState, record: &'a Transform, density: &'a [f64]) -> Self {
        let last = LOW.min(density.len() - 2);
        let low: Vec<usize> = (1..=last).filter(|&k| density[k].is_finite()).collect();
        let shapes = [0, 1].map(|term| -> Vec<f64> {
            let at = |k: &usize| axis.component_density(term, record.frequency(*k));
            low.iter().map(at).collect()
        });
        let fitted = [0, 1].map(|term| axis.fit.squared[term]);
        let rest = low.iter().enumerate().map(|(place, &k)| {
            let slow = fitted[0] * shapes[0][place] + fitted[1] * shapes[1][place];
            (density[k] - slow).max(LEAST * density[k])
        });
        let begun = [0, 1].map(|term| {
            let first = low.first().map_or(0.0, |&k| density[k] / shapes[term][0]);
            f64::max(fitted[term], BEGINNING * first)
        });
        let mut profile = Self {
            record,
            density,
            rest: rest.collect(),
            low,
            shapes,
            seam: axis.seam(record.rate_hz()).waveforms(record),
            squares: begun,
            null: 0.0,
        };
        let seam: Vec<&Transform> = profile.seam.iter().collect();
        let null = profile.best(&seam);
        (profile.squares, profile.null) = (null.squares, null.nats);
        profile
    }

    /// A waveform of any size, whose transform is `wave`.
    pub fn fit(&self, wave: &Transform) -> Joint {
        let waves: Vec<&Transform> = std::iter::once(wave).chain(&self.seam).collect();
        let best = self.best(&waves);
        let nats = (best.nats - self.null).max(0.0);
        let size = best.sizes[0];
        Joint {
            nats,
            z: size.signum() * as_normal(2.0 * nats, 2.0 * self.deciding(wave, best.squares)),
            squares: best.squares,
        }
    }

    /// What whitens the record together with the waveform of a fit.
    pub fn density(&self, joint: &Joint) -> Vec<f64> {
        let mut density = self.density.to_vec();
        for (&k, low) in self.low.iter().zip(self.densities(joint.squares)) {
            density[k] = low;
        }
        density
    }

    /// Walk, flicker and the sizes of `waves` that are likeliest together.
    fn best(&self, waves: &[&Transform]) -> Best {
        let after = self.low.last().map_or(1, |last| last + 1);
        let mut high = Linear::new(waves.len());
        let above = (after..self.density.len()).map(|k| (k, self.density[k]));
        high.add(self.record, waves, above);
        let fit = |squares: [f64; 2]| {
            let mut all = Linear {
                gram: high.gram.clone(),
                products: high.products.clone(),
            };
            let low = self.low.iter().copied().zip(self.densities(squares));
            all.add(self.record, waves, low);
            all.sizes()
        };
        let left = |sizes: &DVector<f64>, place: usize| {
            let k = self.low[place];
            let waves = waves.iter().zip(sizes.iter());
            let taken: Complex64 = waves.map(|(wave, size)| wave.ordinates()[k] * size).sum();
            self.record.ordinates()[k] - taken
        };
        let mut squares = self.squares;
        let mut sizes = fit(squares);
        for _ in 0..STEPS {
            squares = self.step(squares, |place| left(&sizes, place));
            sizes = fit(squares);
        }
        let power = self.record.power();
        let low = self.densities(squares).enumerate().map(|(place, density)| {
            -density.ln() - left(&sizes, place).norm_sqr() / (density * power)
        });
        let quadratic = sizes.dot(&(&high.gram * &sizes));
        Best {
            nats: low.sum::<f64>() + 2.0 * sizes.dot(&high.products) - quadratic,
            squares,
            sizes,
        }
    }

    fn densities(&self, squares: [f64; 2]) -> impl Iterator<Item = f64> {
        let slow = self.shapes[0].iter().zip(&self.shapes[1]);
        let both = self.rest.iter().zip(slow);
        both.map(move |(rest, (walk, flicker))| rest + squares[0] * walk + squares[1] * flicker)
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

    /// Ordinates that decide about a waveform.
    fn deciding(&self, wave: &Transform, squares: [f64; 2]) -> f64 {
        let after = self.low.last().map_or(1, |last| last + 1);
        let above = (after..self.density.len()).map(|k| (k, self.density[k]));
        let low = self.low.iter().copied().zip(self.densities(squares));
        let (sum, square) = low
            .chain(above)
            .fold((0.0, 0.0), |(sum, square), (k, density)| {
                let share = wave.ordinates()[k].norm_sqr() / density;
                (sum + share, square + share * share)
            });
        sum * sum / square
    }
}

impl Linear {
    fn new(count: usize) -> Self {
        Self {
            gram: DMatrix::zeros(count, count),
            products: DVector::zeros(count),
        }
    }

    /// Adds ordinates with their densities.
    fn add(
        &mut self,
        record: &Transform,
        waves: &[&Transform],
        ordinates: impl Iterator<Item = (usize, f64)>,
    ) {
        for (k, density) in ordinates {
            let weight = (density * record.power()).recip();
            for (row, one) in waves.iter().enumerate() {
                let one = one.ordinates()[k].conj() * weight;
                self.products[row] += (record.ordinates()[k] * one).re;
                for (column, other) in waves[..=row].iter().enumerate() {
                    self.gram[(row, column)] += (other.ordinates()[k] * one).re;
                }
            }
        }
        for row in 0..waves.len() {
            for column in 0..row {
                self.gram[(column, row)] = self.gram[(row, column)];
            }
        }
    }

    /// Sizes that fit best; none where the data cannot distinguish them.
    fn sizes(self) -> DVector<f64> {
        let count = self.products.len();
        let factors = self.gram.cholesky();
        factors.map_or_else(
            || DVector::zeros(count),
            |factors| factors.solve(&self.products),
        )
    }
}

/// Standard normal size as rare as twice the gain in log-likelihood of one size, where `freedom`
/// degrees determine the noise.
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
