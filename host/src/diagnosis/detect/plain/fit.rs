//! Least squares of a course among the means of a record.

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, DVector};
use realfft::num_complex::Complex64;

use super::means::Means;
use crate::fft::phasor::Phasor;
use crate::numeric::product::dot;

/// Multiples of a cycle that are fitted together: a choice. What the record's ends have of a turn mixes the strong ones.
const TOGETHER: usize = 32;

/// What a level does: settles from the start, goes round and round.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Course {
    /// Time constants of settlings, samples.
    pub settlings: Vec<f64>,
    /// What comes again and again.
    pub cycle: Option<Cycle>,
}

/// A part of a course.
#[derive(Debug, Clone)]
pub struct Part {
    /// The course without it.
    pub without: Course,
    /// Its time constant or period, samples.
    pub samples: f64,
}

/// A cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Its frequency, cycles a sample.
    pub cycles: f64,
    /// How many of its multiples it has, itself the first.
    pub multiples: usize,
}

impl Cycle {
    /// Frequency of its highest multiple, cycles a sample.
    pub fn highest(self) -> f64 {
        self.multiples as f64 * self.cycles
    }

    /// What cosine and sine of each multiple come to in the means, one after the other.
    fn columns(self, means: &Means) -> impl Iterator<Item = Vec<f64>> {
        let factor = means.factor as f64;
        let middle = factor - 1.0;
        let begin = Complex64::cis(TAU * self.cycles * middle);
        let mut base = vec![Complex64::ZERO; means.len()];
        let places = base.iter_mut().zip(&means.measured);
        Phasor::new(self.cycles * factor).zip(0, places, begin, |(base, known), turned| {
            *base = if *known { turned } else { Complex64::ZERO };
        });
        let mut turned: Vec<Complex64> = base.clone();
        (1..=self.multiples).flat_map(move |multiple| {
            let cycles = multiple as f64 * self.cycles;
            let mean = (PI * cycles * factor).sin() / (factor * (PI * cycles).sin());
            let cosines = turned.iter().map(|one| mean * mean * one.re).collect();
            let sines = turned.iter().map(|one| mean * mean * one.im).collect();
            let both = turned.iter_mut().zip(&base);
            both.for_each(|(turned, base)| *turned *= base);
            [cosines, sines]
        })
    }
}

impl Course {
    /// Numbers that it has, sizes among them.
    pub fn freedom(&self) -> f64 {
        let of_cycle = self.cycle.map_or(0, |cycle| 1 + 2 * cycle.multiples);
        (2 * self.settlings.len() + of_cycle) as f64
    }

    /// Its shortest time constant or period, samples.
    pub fn quickest(&self) -> f64 {
        let settlings = self.settlings.iter().copied();
        let period = self.cycle.map(|cycle| cycle.cycles.recip());
        settlings.chain(period).fold(f64::INFINITY, f64::min)
    }

    /// Its parts: every settling, and the cycle.
    pub fn parts(&self) -> Vec<Part> {
        let settlings = self.settlings.iter().enumerate();
        let settlings = settlings.map(|(number, &samples)| {
            let mut without = self.clone();
            without.settlings.remove(number);
            Part { without, samples }
        });
        let cycle = self.cycle.map(|cycle| Part {
            without: Self {
                cycle: None,
                ..self.clone()
            },
            samples: cycle.cycles.recip(),
        });
        settlings.chain(cycle).collect()
    }

    /// Place of a settling's size among those of a fit, behind the constant.
    pub fn place_of(number: usize) -> usize {
        1 + number
    }

    /// Place of the cosine of a multiple, from 1, with its sine behind it.
    pub fn place_of_multiple(&self, multiple: usize) -> usize {
        1 + self.settlings.len() + 2 * (multiple - 1)
    }

    /// How many of its sizes are fitted together. Those of higher multiples are each fitted to what these leave: over whole turns they
    /// have nothing in common.
    fn together(&self) -> usize {
        let multiples = self.cycle.map_or(0, |cycle| cycle.multiples);
        self.place_of_multiple(1 + multiples.min(TOGETHER))
    }

    /// What sizes of 1 come to in the means, the constant first: one after the other, for those of all multiples are many times the means.
    fn columns(&self, means: &Means) -> impl Iterator<Item = Vec<f64>> {
        let column = |value: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let firsts = (0..means.len()).map(|block| (block * means.factor) as f64);
            let both = firsts.zip(&means.measured);
            both.map(|(first, known)| if *known { value(first) } else { 0.0 })
                .collect()
        };
        let mut columns = vec![column(&|_| 1.0)];
        let factor = means.factor as f64;
        for &samples in &self.settlings {
            let mean =
                (1.0 - (-factor / samples).exp()) / (factor * (1.0 - (-1.0 / samples).exp()));
            columns.push(column(&|first| mean * mean * (-first / samples).exp()));
        }
        let of_cycle = self.cycle.map(|cycle| cycle.columns(means));
        columns.into_iter().chain(of_cycle.into_iter().flatten())
    }

    /// What its means become by a small change of each number that is no size, at some `sizes`: those of the logarithms of
    /// the time constants, then of the cycle's frequency.
    fn slopes(&self, means: &Means, sizes: &[f64]) -> Vec<Vec<f64>> {
        /// Small beside whatever is told of either.
        const STEP: f64 = 1e-5;
        let at = |course: &Self| course.total(means, sizes);
        let by = |less: Self, more: Self, step: f64| -> Vec<f64> {
            let both = at(&more).into_iter().zip(at(&less));
            both.map(|(more, less)| (more - less) / (2.0 * step))
                .collect()
        };
        let mut slopes = Vec::new();
        for number in 0..self.settlings.len() {
            let moved = |by: f64| {
                let mut course = self.clone();
                course.settlings[number] *= by.exp();
                course
            };
            slopes.push(by(moved(-STEP), moved(STEP), STEP));
        }
        if let Some(cycle) = self.cycle {
            let step = STEP / (means.len() * means.factor) as f64;
            let moved = |by: f64| Self {
                cycle: Some(Cycle {
                    cycles: cycle.cycles + by,
                    ..cycle
                }),
                ..self.clone()
            };
            slopes.push(by(moved(-step), moved(step), step));
        }
        slopes
    }

    /// Its means with some sizes.
    pub fn total(&self, means: &Means, sizes: &[f64]) -> Vec<f64> {
        let mut total = vec![0.0; means.len()];
        for (column, size) in self.columns(means).zip(sizes) {
            let pairs = total.iter_mut().zip(&column);
            pairs.for_each(|(total, one)| *total += size * one);
        }
        total
    }
}

/// A course with its likeliest sizes in white noise.
pub struct Fitted {
    /// The course.
    pub course: Course,
    /// Its sizes: the constant, those of settlings, cosine and sine of each multiple.
    pub sizes: Vec<f64>,
    /// What is left; zero where nothing was measured.
    pub left: Vec<f64>,
    /// Sum of its squares.
    pub energy: f64,
}

impl Fitted {
    /// A course among `means`; `None` where its parts cannot be told from each other.
    pub fn new(means: &Means, course: Course) -> Option<Self> {
        let mut columns = course.columns(means);
        let together: Vec<Vec<f64>> = columns.by_ref().take(course.together()).collect();
        let mut sizes = sizes(&together, &means.values)?;
        let mut left = means.values.clone();
        for (column, size) in together.iter().zip(&sizes) {
            take_out(&mut left, column, *size);
        }
        for column in columns {
            let size = dot(&column, &left) / dot(&column, &column);
            take_out(&mut left, &column, size);
            sizes.push(size);
        }
        Some(Self {
            energy: dot(&left, &left),
            sizes,
            left,
            course,
        })
    }

    /// The same at the likeliest time constants and frequency, by the steps of C. F. Gauss: each from the slopes where it stands.
    pub fn climbed(self, means: &Means) -> Self {
        /// Steps at most, and the gain that is worth one, nats: choices. From where a search ends two do.
        const STEPS: usize = 8;
        const WORTH: f64 = 0.01;
        let mut best = self;
        for _ in 0..STEPS {
            let better = best
                .moved(means)
                .and_then(|course| Self::new(means, course));
            match better.filter(|one| one.nats(means) > best.nats(means) + WORTH) {
                Some(better) => best = better,
                None => break,
            }
        }
        best
    }

    /// The course that what is left points to.
    fn moved(&self, means: &Means) -> Option<Course> {
        let steps = sizes(&self.columns(means), &self.left)?;
        let mut steps = steps[self.course.together()..].iter();
        let mut course = self.course.clone();
        for (samples, step) in course.settlings.iter_mut().zip(&mut steps) {
            *samples *= step.exp();
        }
        if let (Some(cycle), Some(step)) = (&mut course.cycle, steps.next()) {
            cycle.cycles += step;
        }
        Some(course)
    }

    /// Logarithm of its likelihood, nats.
    pub fn nats(&self, means: &Means) -> f64 {
        -0.5 * means.known() * self.energy.max(f64::MIN_POSITIVE).ln()
    }

    /// Columns of the sizes that are fitted together, and the slopes behind them.
    fn columns(&self, means: &Means) -> Vec<Vec<f64>> {
        let columns = self.course.columns(means);
        let mut columns: Vec<Vec<f64>> = columns.take(self.course.together()).collect();
        columns.extend(self.course.slopes(means, &self.sizes));
        columns
    }

    /// Covariance of its numbers in white noise of the square 1.
    pub fn covariance(&self, means: &Means) -> Option<Covariance> {
        let together = gram(&self.columns(means)).cholesky()?.inverse();
        Some(Covariance {
            first_slope: self.course.together(),
            together,
            further: 2.0 / means.known(),
        })
    }
}

/// What is known of a fit's numbers in white noise of the square 1.
pub struct Covariance {
    /// Of the sizes that were fitted together and of the slopes behind them.
    together: DMatrix<f64>,
    first_slope: usize,
    /// Of each further size.
    further: f64,
}

impl Covariance {
    /// Variance of the size at a place.
    pub fn of_size(&self, place: usize) -> f64 {
        if place < self.first_slope {
            self.together[(place, place)]
        } else {
            self.further
        }
    }

    /// Variance of a number that is no size: of the logarithms of time constants, then of the cycle's frequency.
    pub fn of_shape(&self, number: usize) -> f64 {
        let place = self.first_slope + number;
        self.together[(place, place)]
    }
}

fn take_out(values: &mut [f64], column: &[f64], size: f64) {
    let pairs = values.iter_mut().zip(column);
    pairs.for_each(|(value, one)| *value -= size * one);
}

fn gram(columns: &[Vec<f64>]) -> DMatrix<f64> {
    let size = columns.len();
    let mut gram = DMatrix::zeros(size, size);
    for row in 0..size {
        for column in 0..=row {
            let product = dot(&columns[row], &columns[column]);
            gram[(row, column)] = product;
            gram[(column, row)] = product;
        }
    }
    gram
}

fn sizes(columns: &[Vec<f64>], values: &[f64]) -> Option<Vec<f64>> {
    let products = columns.iter().map(|column| dot(column, values)).collect();
    let factors = gram(columns).cholesky()?;
    let sizes = factors.solve(&DVector::from_vec(products));
    let sizes: Vec<f64> = sizes.iter().copied().collect();
    sizes.iter().all(|size| size.is_finite()).then_some(sizes)
}
