//! A record in half-waves of a cosine, and the likelihood that part of it is a smooth course.
//!
//! The coefficient of `sqrt(2/T) cos(w_j t)`, `w_j = pi j / T`, is `c_j`. Its even continuation has no seam, so that
//! nothing leaks: of stationary noise and of a walk `c_j` are independent, with the two-sided density `S(w_j)` as their
//! variance. A course whose second derivative is white of density `d`, the least that smooth can mean, has by partial
//! integration
//!
//! ```text
//! c_j = sqrt(2/T) ((-1)^j x'(T) - x'(0)) / w_j^2 + normal of variance d / w_j^4
//! ```
//!
//! its slopes at both ends being free. Without it both slopes are one, the ramp's. `ln L` is as large as it gets over
//! walk, flicker and slopes in either case, and over `d`; by its prior the course pays for every wave it takes (G. Wahba,
//! J. R. Stat. Soc. B 40, 1978: the mean of what is left to it is the smoothing spline).

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use realfft::num_complex::Complex64;

use crate::diagnosis::axis::AxisState;
use crate::fft::phasor::Phasor;
use crate::fit::likelihood::Data;
use crate::fit::likelihood::scoring::{Range, greatest_beside};
use crate::numeric::mixture::add_mixture;

/// Half-waves, at most: at the last a walk has a millionth of the density that it has at the first, a course of the
/// steepness sought here a billionth of a thousandth.
const MOST: usize = 1024;

/// Share of the half-waves that a record of its means holds, up to which they are used: further up a mean of a block
/// has lost more than a tenth of their power.
const SHARE: usize = 4;

/// Half-waves that count one by one; beyond, those of a sixteenth of an octave count together. A choice: at the thirty-third
/// a sixteenth holds more than one.
const SINGLE: usize = 32;

/// Share of the density that is no walk and no flicker, at least: above zero, and worth a thousandth of a nat a half-wave.
const LEAST: f64 = 1e-3;

/// Turns of fitting slopes and densities, each with the other held: a choice. The slopes hardly depend on the densities
/// that they are weighted with.
const TURNS: usize = 6;

/// Half-waves at which a course is made as strong as the noise, to begin with: the likelihood has several tops. Each is
/// some two and a half times the one before, a choice.
const BEGINNINGS: [usize; 4] = [3, 8, 20, 50];

/// The half-wave at which walk and flicker are made as strong as the rest, to begin with: a choice. Where they end hardly
/// depends on it.
const BEGUN: usize = 8;

/// The coefficients of a record and the noise in them.
pub struct Cosines {
    /// Length of the record, seconds.
    pub duration_s: f64,
    /// `c_j` for `j` from 1.
    pub coefficients: Vec<f64>,
    /// Whether a coefficient counts; those of excluded bands do not.
    counts: Vec<bool>,
    /// Density without walk and flicker, and of walk, flicker and a course of size 1.
    rest: Vec<f64>,
    shapes: [Vec<f64>; 3],
    /// What slopes of 1 at the beginning and at the end come to.
    slopes: [Vec<f64>; 2],
}

/// A fit of noise and slopes, with a course or without.
pub struct Fitted {
    /// Log-likelihood, nats.
    pub nats: f64,
    /// Density of the noise at each half-wave.
    pub noise: Vec<f64>,
    /// Density of the course at each half-wave; zero without one.
    pub course: Vec<f64>,
    /// What the slopes come to.
    pub fixed: Vec<f64>,
    /// Covariance of the two slopes.
    pub slopes_covariance: DMatrix<f64>,
}

impl Cosines {
    /// Of `means` of the record, which last `mean_s` seconds each, in the noise of an axis. Of as short a record as is
    /// diagnosed there are 4096 means or more, so that there are [`MOST`] half-waves.
    pub fn new(axis: &AxisState, means: &[f64], mean_s: f64) -> Self {
        let duration_s = means.len() as f64 * mean_s;
        let count = MOST.min(means.len() / SHARE);
        let f_hz = |j: usize| 0.5 * j as f64 / duration_s;
        let numbers = (1..=count).into_par_iter();
        let coefficients = numbers.map(|j| coefficient(means, mean_s, j)).collect();
        let excluded_hz = axis.excluded_hz();
        let is_excluded = |j: usize| excluded_hz.iter().any(|band| band.contains(&f_hz(j)));
        let unit = |term: usize| -> Vec<f64> {
            (1..=count)
                .map(|j| axis.component_density(term, f_hz(j)))
                .collect()
        };
        let (walk, flicker) = (unit(0), unit(1));
        let fitted = &axis.fit.squared;
        let rest = (1..=count).map(|j| {
            let all = axis.density(f_hz(j));
            (all - fitted[0] * walk[j - 1] - fitted[1] * flicker[j - 1]).max(LEAST * all)
        });
        let steep = |j: usize| (PI * j as f64 / duration_s).powi(-2);
        let slope = |j: usize| (2.0 / duration_s).sqrt() * steep(j);
        let sign = |j: usize| if j.is_multiple_of(2) { 1.0 } else { -1.0 };
        Self {
            duration_s,
            coefficients,
            counts: (1..=count).map(|j| !is_excluded(j)).collect(),
            rest: rest.collect(),
            shapes: [
                walk,
                flicker,
                (1..=count).map(|j| steep(j).powi(2)).collect(),
            ],
            slopes: [
                (1..=count).map(|j| -slope(j)).collect(),
                (1..=count).map(|j| sign(j) * slope(j)).collect(),
            ],
        }
    }

    /// Frequency of number `j`, from 1, hertz.
    pub fn f_hz(&self, j: usize) -> f64 {
        0.5 * j as f64 / self.duration_s
    }

    /// The likeliest noise without a course: its slope is the same at both ends.
    pub fn without(&self) -> Option<Fitted> {
        let both = self.slopes[0].iter().zip(&self.slopes[1]);
        let ramp: Vec<f64> = both.map(|(begin, end)| begin + end).collect();
        self.likeliest(&[&ramp], None)
    }

    /// The likeliest noise with a course.
    pub fn with(&self) -> Option<Fitted> {
        let waves = [self.slopes[0].as_slice(), &self.slopes[1]];
        let last = self.coefficients.len();
        let level = self.rest[last / 2..].iter().sum::<f64>() / (last - last / 2) as f64;
        let starts = BEGINNINGS.iter().map(|j| level / self.shapes[2][j - 1]);
        let fits = starts.filter_map(|start| self.likeliest(&waves, Some(start)));
        fits.max_by(|a, b| a.nats.total_cmp(&b.nats))
    }

    /// The likeliest densities and sizes of `waves`, with a course from a start of its density or without.
    fn likeliest(&self, waves: &[&[f64]], course: Option<f64>) -> Option<Fitted> {
        let shapes = &self.shapes[..if course.is_some() { 3 } else { 2 }];
        let first = self.rest.iter().sum::<f64>() / self.rest.len() as f64;
        let walk_and_flicker = self.shapes[..2].iter();
        let mut squared: Vec<f64> = walk_and_flicker
            .map(|shape| first / shape[BEGUN - 1])
            .collect();
        squared.extend(course);
        let mut nats = f64::NEG_INFINITY;
        let mut linear = None;
        for _ in 0..TURNS {
            let density = self.density(shapes, &squared);
            let fitted = self.sizes(waves, &density)?;
            let grouped = Grouped::new(self, &fitted.0)?;
            let parts: Vec<Vec<f64>> = shapes.iter().map(|shape| grouped.mean(shape)).collect();
            let rest = grouped.mean(&self.rest);
            let start = Some(squared.as_slice());
            (squared, nats) =
                greatest_beside(&grouped.data, &parts, &rest, start, Range::NonNegative)?;
            linear = Some(fitted);
        }
        let (fixed, slopes_covariance) = linear?;
        let course = squared.get(2).copied().unwrap_or(0.0);
        Some(Fitted {
            nats,
            noise: self.density(&shapes[..2], &squared),
            course: self.shapes[2].iter().map(|shape| course * shape).collect(),
            fixed,
            slopes_covariance,
        })
    }

    fn density(&self, shapes: &[Vec<f64>], squared: &[f64]) -> Vec<f64> {
        let mut density = self.rest.clone();
        add_mixture(&mut density, shapes, squared);
        density
    }

    /// What `waves` come to at their likeliest sizes, and the covariance of these.
    fn sizes(&self, waves: &[&[f64]], density: &[f64]) -> Option<(Vec<f64>, DMatrix<f64>)> {
        let size = waves.len();
        let (mut gram, mut products) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for j in (0..density.len()).filter(|&j| self.counts[j]) {
            for (row, one) in waves.iter().enumerate() {
                products[row] += one[j] * self.coefficients[j] / density[j];
                for (column, other) in waves.iter().enumerate() {
                    gram[(row, column)] += one[j] * other[j] / density[j];
                }
            }
        }
        let factors = gram.cholesky()?;
        let sizes = factors.solve(&products);
        let mut fixed = vec![0.0; density.len()];
        for (wave, size) in waves.iter().zip(sizes.iter()) {
            let pairs = fixed.iter_mut().zip(*wave);
            pairs.for_each(|(fixed, one)| *fixed += size * one);
        }
        Some((fixed, factors.inverse()))
    }

    /// What slopes of 1 at the two ends come to at number `j`, from 1.
    pub fn slopes(&self, j: usize) -> DVector<f64> {
        DVector::from_vec(self.slopes.iter().map(|one| one[j - 1]).collect())
    }
}

/// The coefficient of number `j`, from 1, of means that last `mean_s` each.
fn coefficient(means: &[f64], mean_s: f64, j: usize) -> f64 {
    let cycles = 0.5 * j as f64 / means.len() as f64;
    // In the middle of each mean.
    let begin = Complex64::cis(PI * cycles);
    let mut sum = 0.0;
    Phasor::new(cycles).zip(0, means, begin, |mean, turned| sum += mean * turned.re);
    sum * mean_s * (2.0 / (means.len() as f64 * mean_s)).sqrt()
}

/// Coefficients without what is fixed, those of a sixteenth of an octave together.
struct Grouped {
    data: Data,
    groups: Vec<Vec<usize>>,
}

impl Grouped {
    fn new(cosines: &Cosines, fixed: &[f64]) -> Option<Self> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut last = None;
        for j in (0..fixed.len()).filter(|&j| cosines.counts[j]) {
            let number = match j + 1 {
                one if one <= SINGLE => one as i64,
                more => SINGLE as i64 + (16.0 * (more as f64 / SINGLE as f64).log2()) as i64 + 1,
            };
            match groups.last_mut() {
                Some(group) if last == Some(number) => group.push(j),
                _ => groups.push(vec![j]),
            }
            last = Some(number);
        }
        let psd = |group: &Vec<usize>| {
            let left = group
                .iter()
                .map(|&j| (cosines.coefficients[j] - fixed[j]).powi(2));
            left.sum::<f64>() / group.len() as f64
        };
        let f_hz = |group: &Vec<usize>| cosines.f_hz(group[0] + 1);
        let dof: Vec<f64> = groups.iter().map(|group| group.len() as f64).collect();
        let (f_hz, psd) = (
            groups.iter().map(f_hz).collect(),
            groups.iter().map(psd).collect(),
        );
        let data = Data {
            // The same for all that are compared.
            unit: cosines.rest[0],
            ..Data::independent(f_hz, psd, &dof)?
        };
        Some(Self { data, groups })
    }

    fn mean(&self, all: &[f64]) -> Vec<f64> {
        let mean =
            |group: &Vec<usize>| group.iter().map(|&j| all[j]).sum::<f64>() / group.len() as f64;
        self.groups.iter().map(mean).collect()
    }
}
