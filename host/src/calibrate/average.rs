//! Parameters and intervals where the strength of the wander is not known: averages over all strengths that the
//! misfits leave likely.
//!
//! A few misfits tell a strength badly. Intervals at the likeliest one are too short, and those with the
//! freedom of its estimate (Satterthwaite) too long where there are three misfits. Here each strength has the weight
//! of its restricted likelihood (Patterson and Thompson, Biometrika 58, 1971), with the parameters' normal law at
//! that strength; what is told is of the mixture (Harville, Biometrika 61, 1974).

use nalgebra::{DMatrix, DVector};
use statrs::function::erf::erf;

use super::drift::Drift;
use super::weighted::Solved;

/// What the intervals hold.
const LEVEL: f64 = 0.95;

/// Strengths looked through, as multiples of the one about which they are: from one that no session shows to one
/// that would be some g.
const LEAST: f64 = 1e-2;
const MOST: f64 = 1e5;

/// Number of strengths, evenly in the logarithm: 1.6 times the one before, and the likelihood of a dozen
/// misfits is three times as wide; what is expected of sensors like the published ones has a deviation of two thirds of a step,
/// which sums to the same as an integral to 2e-4.
const STRENGTHS: usize = 36;

/// By how much of itself the wander of a sensor of the published make differs from the published one, where the misfits
/// do not tell, as the spread of its logarithm. Assumed, not measured: a seventh, so that an interval is a few hundredths
/// wider than by the published wander itself.
const LIKE_PUBLISHED: f64 = 0.15;

/// Halvings of the interval in which a half width is looked for: to a millionth of it.
const HALVINGS: usize = 24;

/// One strength of the wander.
struct Strength {
    /// Times the published wander.
    factor: f64,
    /// Share in the mixture.
    weight: f64,
    solved: Solved,
    /// Change of the parameters that the misfits ask for.
    step: DVector<f64>,
}

/// What is known of the strength ahead of any misfit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Expected {
    /// Nothing: beyond the noise of a stretch none is likelier than another in the logarithm, and below it none than
    /// another.
    Anything,
    /// That of the published sensors, and by [`LIKE_PUBLISHED`] about it.
    Published,
}

impl Expected {
    /// The strength about which they are looked through.
    fn about(self, noise: &Drift) -> f64 {
        match self {
            Self::Anything => noise.balance(),
            Self::Published => 1.0,
        }
    }

    /// Weight of so many times that strength, in the logarithm.
    fn log_weight(self, times: f64) -> f64 {
        match self {
            Self::Anything => (times / (1.0 + times)).ln(),
            // The factor is of the variance, the spread of the wander itself.
            Self::Published => -0.5 * (0.5 * times.ln() / LIKE_PUBLISHED).powi(2),
        }
    }
}

/// All strengths with their weights, at some parameters.
pub(super) struct Average {
    strengths: Vec<Strength>,
}

impl Average {
    /// `None` where the positions allow no solution.
    pub(super) fn new(
        noise: &Drift,
        slopes: &DMatrix<f64>,
        misfits: &DVector<f64>,
        expected: Expected,
    ) -> Option<Self> {
        let about = expected.about(noise);
        let mut strengths = Vec::with_capacity(STRENGTHS);
        for number in 0..STRENGTHS {
            let share = number as f64 / (STRENGTHS - 1) as f64;
            let times = LEAST * (MOST / LEAST).powf(share);
            let solved = Solved::new(&noise.covariance(times * about), slopes)?;
            strengths.push(Strength {
                factor: times * about,
                weight: expected.log_weight(times) + solved.log_likelihood(misfits),
                step: solved.step(misfits),
                solved,
            });
        }
        let most = strengths
            .iter()
            .fold(f64::NEG_INFINITY, |most, one| most.max(one.weight));
        let mut whole = 0.0;
        for one in &mut strengths {
            one.weight = (one.weight - most).exp();
            whole += one.weight;
        }
        for one in &mut strengths {
            one.weight /= whole;
        }
        whole.is_finite().then_some(Self { strengths })
    }

    /// Mean change of the parameters that the misfits ask for.
    pub(super) fn step(&self) -> DVector<f64> {
        let mut mean = DVector::zeros(self.strengths[0].step.len());
        for one in &self.strengths {
            mean += one.weight * &one.step;
        }
        mean
    }

    /// Half the 95 % interval of a parameter about the mean.
    pub(super) fn half_width(&self, at: usize) -> f64 {
        let number = self.strengths[0].step.len();
        self.half_width_along(&DVector::from_fn(number, |row, _| {
            f64::from(u8::from(row == at))
        }))
    }

    /// The same of so much of each parameter, added.
    pub(super) fn half_width_along(&self, shares: &DVector<f64>) -> f64 {
        let mean = self.step().dot(shares);
        let laws = self.strengths.iter().map(|one| {
            let variance = shares.dot(&(&one.solved.covariance * shares));
            (one.weight, one.step.dot(shares) - mean, variance.sqrt())
        });
        let laws: Vec<(f64, f64, f64)> = laws.collect();
        let inside = |half: f64| -> f64 {
            let shares = laws.iter().map(|&(weight, off, deviation)| {
                let reach = std::f64::consts::SQRT_2 * deviation;
                weight * 0.5 * (erf((half - off) / reach) + erf((half + off) / reach))
            });
            shares.sum()
        };
        // Every law of the mixture has all but 1e-6 of itself inside.
        let reaches = laws
            .iter()
            .map(|&(_, off, deviation)| off.abs() + 5.0 * deviation);
        let mut high = reaches.fold(0.0_f64, f64::max);
        let mut low = 0.0;
        for _ in 0..HALVINGS {
            let half = 0.5 * (low + high);
            if inside(half) < LEVEL {
                low = half;
            } else {
                high = half;
            }
        }
        high
    }

    /// Mean of the factor's root: how many times as far as the published zeros these wander.
    pub(super) fn times(&self) -> f64 {
        self.strengths
            .iter()
            .map(|one| one.weight * one.factor.sqrt())
            .sum()
    }

    /// The solution at the likeliest strength.
    pub(super) fn likeliest(&self) -> Option<&Solved> {
        self.strengths
            .iter()
            .max_by(|one, other| one.weight.total_cmp(&other.weight))
            .map(|one| &one.solved)
    }
}
