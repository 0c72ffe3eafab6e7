//! The fit: nine parameters by which every position has gravity's magnitude.
//!
//! Gauss and Newton's steps with the covariance of the magnitudes as weights. That has two parts: the
//! noise that each stretch shows, and the wander of the zeros between the positions, which no stretch
//! shows ([`super::drift`]), of a strength over which is averaged ([`super::average`]).

use nalgebra::{DMatrix, SVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::average::{Average, Expected};
use super::drift::{Drift, published_walk};
use super::weighted::{Linear, Solved, linear};
use super::{FEWEST, PARAMETERS, Position};

/// Steps after which there is no hope: from sensors within a tenth of their sheets five do.
const MOST_STEPS: usize = 40;

/// A step below this, of scales near one and zeros near 1 m/s^2, changes nothing any more.
const SMALL: f64 = 1e-11;

/// Ratio of the weakest to the strongest direction among the parameters, columns scaled alike, below which
/// the positions are too much alike. Twelve well spread ones have some 0.2, positions about one axis none.
const SPREAD: f64 = 0.02;

/// What was found.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The parameters, in the order of [`super::NAMES`]: without a unit, zeros in m/s^2.
    pub values: [f64; PARAMETERS],
    /// Half the 95 % interval of each.
    pub half_widths: [f64; PARAMETERS],
    /// Wander of the zeros, m/s^2 per root second.
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
    /// Not a position on each of a cube's faces.
    #[error("{have} positions, and one on each of the six faces of the cube is needed")]
    Faces {
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

/// Fits the parameters to positions, `gravity_m_s2` being what each should have; zeros are means about
/// `end_s` on the clock of the positions, over as long as one of these.
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
    for _ in 0..MOST_STEPS {
        let linear = linear(positions, &values, gravity_m_s2);
        spread(&linear.slopes)?;
        let noise = Drift::new(positions, &linear.directions, end_s);
        let average = average(&noise, &linear)?;
        let change = average.step();
        values += SVector::<f64, PARAMETERS>::from_fn(|at, _| change[at]);
        if !values.iter().all(|value| value.is_finite()) {
            return Err(Unfit::NoFit);
        }
        if change.amax() < SMALL * (1.0 + values.amax()) {
            return finish(positions, values, gravity_m_s2, end_s);
        }
    }
    Err(Unfit::NoFit)
}

fn average(noise: &Drift, linear: &Linear) -> Result<Average, Unfit> {
    let (slopes, misfits) = (&linear.slopes, &linear.misfits);
    Average::new(noise, slopes, misfits, Expected::Anything).ok_or(Unfit::NoFit)
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

/// Intervals and misfits at the parameters that were found.
fn finish(
    positions: &[Position],
    values: SVector<f64, PARAMETERS>,
    gravity_m_s2: f64,
    end_s: f64,
) -> Result<Fit, Unfit> {
    if [0, 2, 5].iter().any(|&diagonal| values[diagonal] <= 0.0) {
        return Err(Unfit::NoFit);
    }
    let linear = linear(positions, &values, gravity_m_s2);
    let noise = Drift::new(positions, &linear.directions, end_s);
    let average = average(&noise, &linear)?;
    let likeliest = average.likeliest().ok_or(Unfit::NoFit)?;
    let projector = likeliest.projector();
    let freedom = (positions.len() - PARAMETERS) as f64;
    let alone = Solved::new(noise.own(), &linear.slopes).ok_or(Unfit::NoFit)?;
    let chi_squared = (linear.misfits.transpose() * alone.projector() * &linear.misfits)[(0, 0)];
    let weighted = &projector * &linear.misfits;
    let whole = linear.misfits.dot(&weighted);
    let scaled = (0..positions.len()).map(|at| weighted[at] / projector[(at, at)].sqrt());
    Ok(Fit {
        values: values.into(),
        half_widths: std::array::from_fn(|at| average.half_width(at)),
        drift: average.times() * published_walk(),
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
