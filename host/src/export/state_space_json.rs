//! The shaping filter as JSON.

use nalgebra::DMatrix;
use serde::Serialize;

use super::input::Input;
use super::shaping_filter::{Accuracy, ShapingFilter};
use crate::chain::Chain;
use crate::signal::Unit;

/// Version of the file.
const SCHEMA: u32 = 1;

/// What the matrices mean, for whoever opens the file.
const EQUATIONS: [&str; 4] = [
    "x[k+1] = F x[k] + G w[k]",
    "y[k] = mean + H x[k]",
    "w[k]: independent Gaussian, mean 0, covariance Q; one step is 1 / rate_hz seconds",
    "x[0]: Gaussian, mean x0, covariance P0",
];

#[derive(Serialize)]
struct File<'a> {
    schema: u32,
    model: &'a str,
    rate_hz: f64,
    equations: [&'static str; 4],
    axes: Vec<Axis<'a>>,
    /// Between the inputs of the same name of different axes.
    correlation: Option<&'a Vec<Vec<f64>>>,
}

#[derive(Serialize)]
struct Axis<'a> {
    name: &'a str,
    /// Of y, mean and the outputs of all states.
    unit: Unit,
    mean: f64,
    /// Already in the filter.
    chain: Option<&'a Chain>,
    states: Vec<String>,
    #[serde(rename = "F")]
    f: Vec<Vec<f64>>,
    #[serde(rename = "G")]
    g: Vec<Vec<f64>>,
    #[serde(rename = "H")]
    h: Vec<f64>,
    #[serde(rename = "Q")]
    q: Vec<Vec<f64>>,
    x0: Vec<f64>,
    #[serde(rename = "P0")]
    p0: Vec<Vec<f64>>,
    /// Of the Allan deviation, against the model without what is left out.
    accuracy: Accuracy,
    left_out: Vec<&'static str>,
}

/// The file.
///
/// # Errors
/// None in practice: if a number is not finite.
pub fn render(input: &Input) -> anyhow::Result<String> {
    let rate_hz = input.model.rate_hz;
    let axes = input.model.axes.iter().map(|axis| {
        let ShapingFilter {
            system,
            accuracy,
            left_out,
        } = ShapingFilter::new(axis, rate_hz, input.longest_s);
        Axis {
            name: &axis.name,
            unit: axis.unit,
            mean: axis.mean,
            chain: axis.chain.as_ref(),
            f: rows(&system.f),
            g: rows(&system.g),
            h: system.h.iter().copied().collect(),
            q: rows(&DMatrix::from_diagonal(&system.q)),
            x0: system.x0.iter().copied().collect(),
            p0: rows(&system.p0),
            states: system.names,
            accuracy,
            left_out,
        }
    });
    let file = File {
        schema: SCHEMA,
        model: &input.name,
        rate_hz,
        equations: EQUATIONS,
        axes: axes.collect(),
        correlation: input.model.correlation.as_ref(),
    };
    Ok(serde_json::to_string(&file)? + "\n")
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix
        .row_iter()
        .map(|row| row.iter().copied().collect())
        .collect()
}
