//! In plain words: how far a coefficient can be trusted.

use super::number::significant;
use crate::analyse::{AxisAnalysis, PublishedValue, WeightedValue};

/// Half widths of the interval, relative to the value, up to which a coefficient counts as
/// well known and as roughly known.
const WELL: f64 = 0.1;
const ROUGHLY: f64 = 0.5;

/// Share of points outside of their intervals from which the five terms do not describe a curve.
/// One in twenty lies outside by chance, but neighbours err together.
const MISFIT: f64 = 0.25;

/// Degrees of freedom from which a point counts in that.
const MISFIT_EDF: f64 = 10.0;

/// A warning where the weighted fit runs past more points than chance explains.
pub fn misfit(axis: &AxisAnalysis) -> Option<String> {
    let compared: Vec<_> = axis
        .allan
        .iter()
        .zip(&axis.curves)
        .filter(|(point, _)| point.edf >= MISFIT_EDF)
        .filter_map(|(point, model)| model.weighted.map(|expected| (point, expected)))
        .collect();
    let outside: Vec<_> = compared
        .iter()
        .filter(|(point, expected)| !(point.lo..=point.hi).contains(expected))
        .collect();
    let (point, expected) = outside
        .iter()
        .max_by(|a, b| off(a).abs().total_cmp(&off(b).abs()))?;
    if (outside.len() as f64) < MISFIT * compared.len() as f64 {
        return None;
    }
    Some(format!(
        "The five terms do not describe this record: {} of {} points lie outside of their \
         intervals, worst at {} s by {} %. The coefficients above hold only as far as the terms do.",
        outside.len(),
        compared.len(),
        significant(point.tau_s, 3),
        significant(100.0 * off(&(point, *expected)), 2),
    ))
}

/// Measured over expected, minus one.
fn off((point, expected): &(&crate::analyse::CurvePoint, f64)) -> f64 {
    point.adev / expected - 1.0
}

/// How far a coefficient is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trust {
    /// Within ten percent.
    Well,
    /// Within fifty percent.
    Roughly,
    /// Not zero, but little more.
    Barely,
    /// Not told from zero: only the bound means something.
    Bound,
}

/// How far the weighted fit knows a coefficient.
pub fn trust(value: &WeightedValue) -> Trust {
    match relative_half_width(value) {
        _ if value.lo <= 0.0 => Trust::Bound,
        Some(width) if width <= WELL => Trust::Well,
        Some(width) if width <= ROUGHLY => Trust::Roughly,
        _ => Trust::Barely,
    }
}

fn relative_half_width(value: &WeightedValue) -> Option<f64> {
    value
        .value
        .filter(|&mid| mid > 0.0)
        .map(|mid| 0.5 * (value.hi - value.lo) / mid)
}

/// The same as a sentence.
pub fn sentence(value: &WeightedValue) -> String {
    let percent = relative_half_width(value).map_or(f64::NAN, |width| 100.0 * width);
    match trust(value) {
        Trust::Well => format!("trust it: known to {} %", significant(percent, 2)),
        Trust::Roughly => format!("known to {} %", significant(percent, 2)),
        Trust::Barely => format!(
            "a rough size only, {} to {}",
            significant(value.lo, 2),
            significant(value.hi, 2)
        ),
        Trust::Bound => format!("not told from zero; below {}", significant(value.hi, 2)),
    }
}

/// What to say of the published fit's value beside the weighted one's; `None` if it agrees.
pub fn published(published: &PublishedValue, weighted: &WeightedValue) -> Option<String> {
    match published.value {
        None => Some("published fit: negative square".to_owned()),
        Some(value) if value > weighted.hi => Some(match weighted.value {
            Some(mid) if mid > 0.0 && weighted.lo > 0.0 => {
                format!("published fit: {} times this", significant(value / mid, 2))
            }
            _ => "published fit: above the bound".to_owned(),
        }),
        Some(value) if value < weighted.lo => Some(match weighted.value {
            Some(mid) if value > 0.0 => {
                format!("published fit: {} times this", significant(value / mid, 2))
            }
            _ => "published fit: zero".to_owned(),
        }),
        Some(_) => None,
    }
}
