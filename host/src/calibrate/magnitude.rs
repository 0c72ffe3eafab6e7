//! The fit: nine parameters by which every position has gravity's magnitude.
//!
//! Gauss and Newton's steps with the covariance of the magnitudes as weights. That has two parts: the
//! noise that each stretch shows, and the wander of the zeros between the positions, which no stretch
//! shows, of a strength that the magnitudes themselves tell ([`super::drift`]).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SMatrix, SVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

use super::drift::{Drift, strength};
use super::{FEWEST, PARAMETERS, Position};

/// Steps after which there is no hope: from sensors within a tenth of their sheets five do.
const MOST_STEPS: usize = 40;

/// A step below this, of scales near one and zeros near 1 m/s^2, changes nothing any more.
const SMALL: f64 = 1e-11;

/// Ratio of the weakest to the strongest direction among the parameters, columns scaled alike, below which
/// the positions are too much alike. Twelve well spread ones have some 0.2, positions about one axis none.
const SPREAD: f64 = 0.02;

/// What the intervals hold.
const LEVEL: f64 = 0.95;

/// What was found.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The parameters, in the order of [`super::NAMES`]: without a unit, zeros in m/s^2.
    pub values: [f64; PARAMETERS],
    /// Half the 95 % interval of each.
    pub half_widths: [f64; PARAMETERS],
    /// Wander of the zeros, m/s^2 per root second; 0 where the stretches' own noise explains all.
    pub drift: f64,
    /// Sum of the squared misfits by the stretches' own noise alone, and the chance of a larger one if
    /// nothing wandered.
    pub chi_squared: f64,
    /// See `chi_squared`.
    pub p_value: f64,
    /// Misfit of each position's magnitude, m/s^2.
    pub misfits_m_s2: Vec<f64>,
    /// The same over what it would be without the position, standard deviations of a Student's t.
    pub(super) studentised: Vec<f64>,
    /// Degrees of freedom of these.
    pub(super) freedom: f64,
}

/// Why there is no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// Too few positions.
    #[error("{have} positions, and {FEWEST} are needed")]
    Few {
        /// Positions that there are.
        have: usize,
    },
    /// Positions that do not differ enough.
    #[error(
        "the positions are too much alike to tell nine parameters apart: put the block on each of its \
         faces, and on edges and corners between them"
    )]
    Alike,
    /// No parameters make them gravity.
    #[error(
        "no scale, zero and misalignment make the positions equal: were the sensors at rest, and is it \
         the range that the board has?"
    )]
    NoFit,
}

/// Magnitudes and what they depend on, at some parameters.
pub(super) struct Linear {
    /// Misfits: gravity less magnitude, m/s^2.
    pub misfits: DVector<f64>,
    /// By position and parameter.
    pub slopes: DMatrix<f64>,
    /// What 1 m/s^2 of each reading adds to the magnitude, by position.
    pub directions: Vec<SVector<f64, 3>>,
}

/// Fits the parameters to positions, `gravity_m_s2` being what each should have; the session ends at
/// `end_s` on the clock of the positions.
///
/// # Errors
/// [`Unfit`].
pub fn fit(positions: &[Position], gravity_m_s2: f64, end_s: f64) -> Result<Fit, Unfit> {
    if positions.len() < FEWEST {
        return Err(Unfit::Few {
            have: positions.len(),
        });
    }
    let mut values = SVector::<f64, PARAMETERS>::zeros();
    for diagonal in [0, 2, 5] {
        values[diagonal] = 1.0;
    }
    let mut drift = 0.0;
    for step in 0..MOST_STEPS {
        let linear = linear(positions, &values, gravity_m_s2);
        spread(&linear.slopes)?;
        let noise = Drift::new(positions, &linear.directions, end_s);
        // Far from the answer the misfits are no noise.
        if step > 2 {
            drift = strength(&noise, &linear);
        }
        let solved = Solved::new(&noise.covariance(drift), &linear.slopes).ok_or(Unfit::NoFit)?;
        let change = solved.step(&linear.misfits);
        values += &change;
        if !values.iter().all(|value| value.is_finite()) {
            return Err(Unfit::NoFit);
        }
        if step > 3 && change.amax() < SMALL * (1.0 + values.amax()) {
            return finish(positions, values, drift, gravity_m_s2, end_s);
        }
    }
    Err(Unfit::NoFit)
}

/// Readings as parameters make them, their magnitudes and slopes.
pub(super) fn linear(
    positions: &[Position],
    values: &SVector<f64, PARAMETERS>,
    gravity_m_s2: f64,
) -> Linear {
    let matrix = matrix(values);
    let zero = SVector::<f64, 3>::new(values[6], values[7], values[8]);
    let mut misfits = DVector::zeros(positions.len());
    let mut slopes = DMatrix::zeros(positions.len(), PARAMETERS);
    let mut directions = Vec::with_capacity(positions.len());
    for (at, position) in positions.iter().enumerate() {
        let reading = SVector::from(position.mean_m_s2) - zero;
        let acceleration = matrix * reading;
        let magnitude = acceleration.norm();
        let unit = acceleration / magnitude.max(f64::MIN_POSITIVE);
        misfits[at] = gravity_m_s2 - magnitude;
        for (column, (row, of)) in [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)]
            .into_iter()
            .enumerate()
        {
            slopes[(at, column)] = unit[row] * reading[of];
        }
        let direction = matrix.transpose() * unit;
        for axis in 0..3 {
            slopes[(at, 6 + axis)] = -direction[axis];
        }
        directions.push(direction);
    }
    Linear {
        misfits,
        slopes,
        directions,
    }
}

/// The matrix of the first six parameters.
pub(super) fn matrix(values: &SVector<f64, PARAMETERS>) -> SMatrix<f64, 3, 3> {
    SMatrix::<f64, 3, 3>::new(
        values[0], 0.0, 0.0, values[1], values[2], 0.0, values[3], values[4], values[5],
    )
}

/// Refuses positions that do not tell the parameters apart.
fn spread(slopes: &DMatrix<f64>) -> Result<(), Unfit> {
    let mut scaled = slopes.clone();
    for mut column in scaled.column_iter_mut() {
        let norm = column.norm();
        if norm > 0.0 {
            column /= norm;
        }
    }
    let singular = scaled.singular_values();
    let told = singular.min() > SPREAD * singular.max();
    if told { Ok(()) } else { Err(Unfit::Alike) }
}

/// A weighted least-squares problem, solved.
pub(super) struct Solved {
    pub inverse: DMatrix<f64>,
    pub log_determinant: f64,
    /// Of the parameters.
    pub covariance: DMatrix<f64>,
    pub log_information: f64,
    /// Slopes times the inverse.
    weighted: DMatrix<f64>,
}

impl Solved {
    /// `None` where a matrix is not positive definite.
    pub(super) fn new(covariance: &DMatrix<f64>, slopes: &DMatrix<f64>) -> Option<Self> {
        let whole = Cholesky::new(covariance.clone())?;
        let inverse = whole.inverse();
        let weighted = slopes.transpose() * &inverse;
        let information = Cholesky::new(&weighted * slopes)?;
        Some(Self {
            inverse,
            log_determinant: log_determinant(&whole),
            covariance: information.inverse(),
            log_information: log_determinant(&information),
            weighted,
        })
    }

    /// Change of the parameters that these misfits ask for.
    fn step(&self, misfits: &DVector<f64>) -> SVector<f64, PARAMETERS> {
        let change = &self.covariance * (&self.weighted * misfits);
        SVector::from_fn(|at, _| change[at])
    }

    /// What takes the fitted part out of misfits and weights the rest.
    pub(super) fn projector(&self) -> DMatrix<f64> {
        &self.inverse - self.weighted.transpose() * &self.covariance * &self.weighted
    }

    /// How the covariance of the parameters grows with a part of that of the magnitudes.
    fn grows_with(&self, part: &DMatrix<f64>) -> DMatrix<f64> {
        let gain = &self.covariance * &self.weighted;
        &gain * part * gain.transpose()
    }
}

fn log_determinant(whole: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * whole.l_dirty().diagonal().map(f64::ln).sum()
}

/// Intervals and misfits at the parameters that were found.
fn finish(
    positions: &[Position],
    values: SVector<f64, PARAMETERS>,
    drift: f64,
    gravity_m_s2: f64,
    end_s: f64,
) -> Result<Fit, Unfit> {
    if [0, 2, 5].iter().any(|&diagonal| values[diagonal] <= 0.0) {
        return Err(Unfit::NoFit);
    }
    let linear = linear(positions, &values, gravity_m_s2);
    let noise = Drift::new(positions, &linear.directions, end_s);
    let solved = Solved::new(&noise.covariance(drift), &linear.slopes).ok_or(Unfit::NoFit)?;
    let projector = solved.projector();
    // How well the strength of the drift is known (Fisher information of the restricted likelihood).
    let moved = &projector * &noise.wander;
    let information = 0.5 * (&moved * &moved).trace();
    let grows = solved.grows_with(&noise.wander);
    let half_widths = std::array::from_fn(|at| {
        let variance = solved.covariance[(at, at)];
        let spread = grows[(at, at)].powi(2) / information;
        // Satterthwaite: the freedom of a variance that is known so well.
        let freedom = (2.0 * variance * variance / spread).clamp(1.0, 1e6);
        quantile(freedom) * variance.sqrt()
    });
    let freedom = (positions.len() - PARAMETERS) as f64;
    let alone = Solved::new(&noise.own, &linear.slopes).ok_or(Unfit::NoFit)?;
    let chi_squared = (linear.misfits.transpose() * alone.projector() * &linear.misfits)[(0, 0)];
    let weighted = &projector * &linear.misfits;
    let whole = linear.misfits.dot(&weighted);
    let scaled = (0..positions.len()).map(|at| weighted[at] / projector[(at, at)].sqrt());
    Ok(Fit {
        values: values.into(),
        half_widths,
        drift: drift.sqrt(),
        chi_squared,
        p_value: ChiSquared::new(freedom).map_or(f64::NAN, |law| law.sf(chi_squared)),
        studentised: scaled.map(|one| studentised(one, whole, freedom)).collect(),
        misfits_m_s2: linear.misfits.iter().copied().collect(),
        freedom: freedom - 1.0,
    })
}

/// A misfit over its deviation, by what is left of the sum of all weighted squares (`whole`) without it: in
/// units of the covariance as it was found, which it has enlarged, one that is wrong would never stand out.
fn studentised(scaled: f64, whole: f64, freedom: f64) -> f64 {
    let left = (whole - scaled * scaled).max(f64::MIN_POSITIVE);
    scaled * ((freedom - 1.0) / left).sqrt()
}

/// Half the interval over the deviation.
fn quantile(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom)
        .map_or(f64::INFINITY, |law| law.inverse_cdf(0.5 + 0.5 * LEVEL))
}
