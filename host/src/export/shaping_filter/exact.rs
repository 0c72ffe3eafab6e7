//! Noises and signals that a linear system makes exactly, each as a system of its own.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use crate::export::state_space::StateSpace;
use crate::model::Line;
use crate::model::markov::Markov;
use crate::model::quantisation::Quantisation;
use crate::model::white::White;

pub(super) fn white_block(white: White, rate_hz: f64) -> StateSpace {
    let variance = white.root_density.powi(2) * rate_hz;
    StateSpace::first_order("white", 0.0, variance, variance)
}

/// Differenced white noise: the last two of a white sequence are the states.
pub(super) fn quantisation_block(quantisation: Quantisation, rate_hz: f64) -> StateSpace {
    let variance = (quantisation.step * rate_hz).powi(2);
    StateSpace {
        f: DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 1.0, 0.0]),
        g: DMatrix::from_row_slice(2, 1, &[1.0, 0.0]),
        h: DVector::from_row_slice(&[1.0, -1.0]),
        q: DVector::from_element(1, variance),
        x0: DVector::zeros(2),
        p0: DMatrix::from_diagonal_element(2, 2, variance),
        names: vec![
            "quantisation".to_owned(),
            "quantisation, one sample before".to_owned(),
        ],
    }
}

/// A walk from zero with steps of variance `q`. How far the sections lag behind it is stationary,
/// though the walk is not.
pub(super) fn walk(q: f64, sections: &[f64]) -> StateSpace {
    let mut system = StateSpace::first_order("walk", 1.0, q, 0.0).cascade(sections);
    let n = sections.len();
    if n == 0 {
        return system;
    }
    // In the lags s - x, which the walk x drives by its steps alone, the sections are stable.
    let mut to_lags = DMatrix::identity(n + 1, n + 1);
    let mut from_lags = to_lags.clone();
    for k in 1..=n {
        to_lags[(k, 0)] = -1.0;
        from_lags[(k, 0)] = 1.0;
    }
    let (f, g) = (&to_lags * &system.f * from_lags, &to_lags * &system.g);
    let lags = StateSpace {
        f: f.view((1, 1), (n, n)).into_owned(),
        g: g.rows(1, n).into_owned(),
        h: DVector::zeros(n),
        q: system.q.clone(),
        x0: DVector::zeros(n),
        p0: DMatrix::zeros(n, n),
        names: Vec::new(),
    };
    system
        .p0
        .view_mut((1, 1), (n, n))
        .copy_from(&lags.settled().p0);
    system
}

pub(super) fn markov_block(name: &str, markov: Markov, rate_hz: f64) -> StateSpace {
    let decay = 1.0 / (markov.time_s * rate_hz);
    let variance = markov.deviation.powi(2);
    let innovation = -variance * (-2.0 * decay).exp_m1();
    StateSpace::first_order(name, (-decay).exp(), innovation, variance)
}

/// A level that grows by a constant each sample.
pub(super) fn ramp(slope_per_sample: f64) -> StateSpace {
    StateSpace {
        f: DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.0, 1.0]),
        g: DMatrix::zeros(2, 0),
        h: DVector::from_row_slice(&[1.0, 0.0]),
        q: DVector::zeros(0),
        x0: DVector::from_row_slice(&[0.0, slope_per_sample]),
        p0: DMatrix::zeros(2, 2),
        names: vec!["ramp".to_owned(), "ramp, change a sample".to_owned()],
    }
}

/// A rotation that nothing drives; its phase is any.
pub(super) fn sinusoid(line: Line, passed: f64, rate_hz: f64) -> StateSpace {
    let (sine, cosine) = (TAU * line.f_hz / rate_hz).sin_cos();
    let name = format!("sinusoid of {} Hz", line.f_hz);
    StateSpace {
        f: DMatrix::from_row_slice(2, 2, &[cosine, -sine, sine, cosine]),
        g: DMatrix::zeros(2, 0),
        h: DVector::from_row_slice(&[1.0, 0.0]),
        q: DVector::zeros(0),
        x0: DVector::zeros(2),
        p0: DMatrix::from_diagonal_element(2, 2, line.power * passed),
        names: vec![name.clone(), format!("{name}, a quarter period before")],
    }
}
