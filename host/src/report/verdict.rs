//! In plain words: how far a coefficient can be trusted.

use crate::analyse::{AxisAnalysis, LikelihoodFit, LikelihoodValue, PublishedValue};
use crate::chain::Chain;
use crate::data_sheet;
use crate::model::Coefficient;
use crate::navigate::{ALIGNMENT_S, Growth};
use crate::numeric::written::{duration, significant};

/// Half widths of the interval, relative to the value, up to which a coefficient counts as
/// well known and as roughly known.
const WELL: f64 = 0.1;
const ROUGHLY: f64 = 0.5;

/// Relative difference of the published fit that is worth a word.
const WORTH_SAYING: f64 = 0.05;

/// Degrees of freedom from which a point may be named as the worst.
const MISFIT_EDF: f64 = 10.0;

/// Frequencies of bins left out that are named at most.
const MOST_LEFT_OUT: usize = 5;

/// A warning where the record does not follow the five terms.
pub fn misfit(axis: &AxisAnalysis) -> Option<String> {
    let Some(fit) = &axis.fits.likelihood else {
        return misfit_of_weighted(axis);
    };
    let mut said = Vec::new();
    if fit.allowance_percent > 0.0 {
        let worst = worst(axis).map_or(String::new(), |(tau_s, percent)| {
            format!(
                " (the Allan deviation most at {} s, by {percent:+.0} %)",
                significant(tau_s, 3)
            )
        });
        said.push(format!(
            "the spectrum departs from them by some {} %, far more than chance explains{worst}; the \
             intervals allow for that",
            significant(2.0 * fit.allowance_percent, 2)
        ));
    }
    if !fit.left_out_hz.is_empty() {
        said.push(left_out(fit));
    }
    if said.is_empty() {
        return None;
    }
    Some(format!(
        "The five terms do not describe this record: {}. The coefficients hold only as far as the \
         terms do; `inm diagnose` looks for the rest.",
        said.join("; ")
    ))
}

/// Neighbouring bins left out, as ranges of frequency.
fn left_out(fit: &LikelihoodFit) -> String {
    let mut ranges: Vec<(f64, f64)> = Vec::new();
    for &f_hz in &fit.left_out_hz {
        match ranges.last_mut() {
            Some(last) if f_hz < 1.1 * last.1 => last.1 = f_hz,
            _ => ranges.push((f_hz, f_hz)),
        }
    }
    let text = |&(from, to): &(f64, f64)| {
        if from == to {
            significant(from, 3)
        } else {
            format!("{} to {}", significant(from, 3), significant(to, 3))
        }
    };
    let named: Vec<String> = ranges.iter().take(MOST_LEFT_OUT).map(text).collect();
    let more = match ranges.len().saturating_sub(MOST_LEFT_OUT) {
        0 => String::new(),
        more => format!(" and {more} more places"),
    };
    format!(
        "no chance explains its power at {} Hz{more}, left out of the fit",
        named.join(", ")
    )
}

fn misfit_of_weighted(axis: &AxisAnalysis) -> Option<String> {
    let allowance = axis
        .fits
        .weighted_allowance_percent
        .filter(|&percent| percent > 0.0)?;
    let (tau_s, percent) = worst(axis)?;
    Some(format!(
        "The five terms do not describe this record: the curve departs from them by some {} %, \
         far more than chance explains (most at {} s, by {percent:+.0} %). The intervals allow for \
         that; the coefficients hold only as far as the terms do.",
        significant(allowance, 2),
        significant(tau_s, 3),
    ))
}

/// Averaging time at which the Allan deviation lies furthest from the fit, and by how many percent.
fn worst(axis: &AxisAnalysis) -> Option<(f64, f64)> {
    axis.allan
        .iter()
        .zip(&axis.curves)
        .filter(|(point, _)| point.edf >= MISFIT_EDF)
        .filter_map(|(point, model)| {
            Some((point.tau_s, 100.0 * (point.adev / model.fitted? - 1.0)))
        })
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// Pairs that the data cannot distinguish, in words.
pub fn tied(fit: &LikelihoodFit) -> Option<String> {
    let pairs: Vec<String> = fit
        .tied
        .iter()
        .map(|[one, other]| format!("{one} with {other}"))
        .collect();
    (!pairs.is_empty()).then(|| {
        format!(
            "Tied: {}; the data resolve their sum better than either.",
            pairs.join(", ")
        )
    })
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
    /// Not resolved from zero: only the bound means something.
    Bound,
}

/// How far the likelihood fit knows a coefficient.
pub fn trust(value: &LikelihoodValue) -> Trust {
    match relative_half_width(value) {
        _ if !value.identified => Trust::Bound,
        Some(width) if width <= WELL => Trust::Well,
        Some(width) if width <= ROUGHLY => Trust::Roughly,
        _ => Trust::Barely,
    }
}

fn relative_half_width(value: &LikelihoodValue) -> Option<f64> {
    Some(0.5 * (value.hi? - value.lo) / value.value?)
}

/// The same as a sentence.
pub fn sentence(value: &LikelihoodValue) -> String {
    let percent = relative_half_width(value).map_or(f64::NAN, |width| 100.0 * width);
    match trust(value) {
        Trust::Well => format!("trust it: known to {} %", significant(percent, 2)),
        Trust::Roughly => format!("known to {} %", significant(percent, 2)),
        Trust::Barely => format!(
            "a rough size only, {} to {}",
            significant(value.lo, 2),
            value.hi.map_or("unknown".into(), |hi| significant(hi, 2))
        ),
        Trust::Bound => {
            let Some(upper) = value.upper else {
                return "the record says nothing of it".into();
            };
            let longer = value.record_longer_by.map_or(String::new(), |factor| {
                format!(
                    "; if it is there, {} times this length would show it",
                    significant(factor, 2)
                )
            });
            format!(
                "not resolved from zero; below {}{longer}",
                significant(upper, 2)
            )
        }
    }
}

/// What to say of the published fit's value next to that of the likelihood; `None` if it agrees.
pub fn published(published: &PublishedValue, value: &LikelihoodValue) -> Option<String> {
    let most = value.upper.or(value.hi).unwrap_or(f64::INFINITY);
    let times = |published: f64, best: f64| {
        let ratio = published / best;
        ((ratio - 1.0).abs() > WORTH_SAYING)
            .then(|| format!("published fit: {} times this", significant(ratio, 2)))
    };
    match (published.value, value.value) {
        (None, _) => Some("published fit: negative square".to_owned()),
        (Some(0.0), Some(_)) => Some("published fit: zero".to_owned()),
        (Some(found), Some(best)) if found > most || found < value.lo => times(found, best),
        (Some(found), None) if found > most => Some("published fit: above the bound".to_owned()),
        _ => None,
    }
}

/// Why there is no likelihood fit although there is another.
pub const NO_SPECTRUM: &str = "No spectrum: gaps leave no stretch of 1024 samples, so there is no \
                               likelihood fit; the weighted one stands in. `inm diagnose` draws what is missing \
                               in short gaps, and has one.";

/// Whether a term of the likelihood fit is drawn: where it was resolved from zero.
pub fn drawn(axis: &AxisAnalysis, coefficient: Coefficient) -> Option<f64> {
    match (&axis.fits.likelihood, &axis.fits.weighted) {
        (Some(fit), _) => fit.coefficients.get(coefficient).value,
        (None, Some(fit)) => fit.get(coefficient).value,
        (None, None) => None,
    }
}

/// How the error of the integral grows, in a sentence; `None` without a fit.
pub fn velocity_error(axis: &AxisAnalysis) -> Option<String> {
    let growth = axis.velocity_error.as_ref().filter(|all| !all.is_empty())?;
    let at = |one: &Growth| {
        format!(
            "{} ({} to {}) after {}",
            significant(one.sigma, 2),
            significant(one.lo, 2),
            significant(one.hi, 2),
            duration(one.t_s)
        )
    };
    let parts: Vec<String> = growth.iter().map(at).collect();
    Some(format!(
        "Error of the integral, one sigma, {}*s, after {} of alignment: {}.",
        axis.unit,
        duration(ALIGNMENT_S),
        parts.join(", ")
    ))
}

/// What the data sheets of the known hardware say of the fitted N.
pub fn data_sheet(axis: &AxisAnalysis) -> Vec<String> {
    let chain: Option<Chain> = axis.chain.as_ref().and_then(|chain| chain.parse().ok());
    let white = axis
        .fits
        .likelihood
        .as_ref()
        .map(|fit| fit.coefficients.get(Coefficient::N));
    let Some((Some(n), Some(hi), lo)) = white.map(|n| (n.value, n.hi, n.lo)) else {
        return Vec::new();
    };
    data_sheet::lines(chain.as_ref(), axis.unit, n, lo, hi)
}
