//! Parameters and intervals where the strength of the wander is not known: averages over all strengths that the
//! misfits leave likely.
//!
//! A few misfits tell a strength badly. Intervals at the likeliest one are too short, and those with the
//! freedom of its estimate (Satterthwaite) too long where there are three misfits. Here each strength has the weight
//! of its restricted likelihood (Patterson and Thompson, Biometrika 58, 1971), with the parameters' normal law at
//! that strength; what is told is of the mixture (Harville, Biometrika 61, 1974).

use nalgebra::SVector;
use statrs::function::erf::erf;

use super::PARAMETERS;
use super::drift::Drift;
use super::weighted::{Linear, Solved};

/// What the intervals hold.
const LEVEL: f64 = 0.95;

/// Strengths looked through, as multiples of the one at which the wander is as large as the noise of a stretch:
/// from one that no session shows to one that would be some g.
const LEAST: f64 = 1e-2;
const MOST: f64 = 1e5;

/// Number of strengths, evenly in the logarithm: 1.6 times the one before, and the likelihood of a dozen
/// misfits is three times as wide.
const STRENGTHS: usize = 36;

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
    step: SVector<f64, PARAMETERS>,
}

/// All strengths with their weights, at some parameters.
pub(super) struct Average {
    strengths: Vec<Strength>,
}

impl Average {
    /// `None` where the positions allow no solution.
    pub(super) fn new(noise: &Drift, linear: &Linear) -> Option<Self> {
        let balance = noise.balance();
        let mut strengths = Vec::with_capacity(STRENGTHS);
        for number in 0..STRENGTHS {
            let share = number as f64 / (STRENGTHS - 1) as f64;
            let times = LEAST * (MOST / LEAST).powf(share);
            let solved = Solved::new(&noise.covariance(times * balance), &linear.slopes)?;
            strengths.push(Strength {
                factor: times * balance,
                // Ahead of any misfit no strength beyond the noise is likelier than another in the logarithm,
                // and below it none than another.
                weight: (times / (1.0 + times)).ln() + solved.log_likelihood(&linear.misfits),
                step: solved.step(&linear.misfits),
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
    pub(super) fn step(&self) -> SVector<f64, PARAMETERS> {
        self.strengths.iter().map(|one| one.weight * one.step).sum()
    }

    /// Half the 95 % interval of a parameter about the mean.
    pub(super) fn half_width(&self, at: usize) -> f64 {
        let mean = self.step()[at];
        let inside = |half: f64| -> f64 {
            let shares = self.strengths.iter().map(|one| {
                let reach = (2.0 * one.solved.covariance[(at, at)]).sqrt();
                let off = one.step[at] - mean;
                one.weight * 0.5 * (erf((half - off) / reach) + erf((half + off) / reach))
            });
            shares.sum()
        };
        let mut high = 0.0_f64;
        for one in &self.strengths {
            let deviation = one.solved.covariance[(at, at)].sqrt();
            // Every law of the mixture has all but 1e-6 of itself inside.
            high = high.max((one.step[at] - mean).abs() + 5.0 * deviation);
        }
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
