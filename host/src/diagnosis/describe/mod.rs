//! What is reported of an explained axis: models before and after, findings with their gains, views.

mod ahead;
mod coefficients;
mod effects;
mod judged;
mod to_share;
mod unnamed;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::describe::coefficients::{coefficients, even_density, of_ramp};
use crate::diagnosis::describe::effects::all_effects;
use crate::diagnosis::describe::judged::{Judge, Judged, JudgedAxis, last_ramp};
use crate::diagnosis::describe::unnamed::without_name;
use crate::diagnosis::explain::{Explained, slope};
use crate::diagnosis::family::level_of_one_test;
use crate::diagnosis::held_out;
use crate::diagnosis::held_out::allan::HeldCurve;
use crate::diagnosis::options::Options;
use crate::diagnosis::refused::Refused;
use crate::diagnosis::result::finding::{AxisDiagnosis, Base, Final, Finding, Remark};
use crate::diagnosis::result::verdict::Verdict;
use crate::diagnosis::result::views::Views;
use crate::diagnosis::suspect::suspicions;
use crate::diagnosis::unnamed::long_times;
use crate::diagnosis::views::{self, Models};
use crate::fit::likelihood::components::SEEN;
use crate::fit::likelihood::ramp::Ramp;
use crate::model::axis::ModelAxis;
use crate::model::{Coefficient as Letter, PerCoefficient};
use crate::signal::Axis;

/// Diagnosis of an axis, and what is left of its record: NaN where missing or masked.
pub(crate) fn describe(
    signal: &Axis,
    explained: Explained,
    options: &Options,
) -> (AxisDiagnosis, Vec<f32>) {
    let Explained {
        mut axis,
        mean,
        recognised,
        base: bare,
        unexplained,
        unnamed,
        squares_sd,
        held_out_nats,
    } = explained;
    let level = level_of_one_test(options);
    let held = HeldCurve::new(&axis);
    let ramp = last_ramp(&axis);
    let judged = |axis: &AxisState| {
        let judge = Judge {
            signal,
            axis,
            mean,
            held: &held,
        };
        JudgedAxis::new(&judge, &bare, ramp, &held_out_nats)
    };
    let first = judged(&axis);
    let covariate = options.covariate.as_deref();
    let is_simulated_so = |first: &JudgedAxis| {
        let whole = last(&axis, &first.noise, ramp, &first.findings, &squares_sd).model;
        let mut points = first.allan.clone();
        views::add_simulated(&mut points, &axis, &whole, covariate);
        long_times::is_simulated_so(&points)
    };
    let spectrum = || views::densities(&axis, &bare.fit, &first.findings);
    let lacking = long_times::lacking(&first.allan, axis.rate_hz, level, spectrum);
    let lacking = lacking.filter(|_| is_simulated_so(&first));
    let last_judged = match &lacking {
        Some(lacking) => {
            lacking.add_to(&mut axis);
            judged(&axis)
        }
        None => first,
    };
    let at_long_times = lacking.map(|one| one.p_value);
    let unnamed = unnamed.into_iter().chain(at_long_times).reduce(f64::min);
    let JudgedAxis {
        base,
        noise,
        findings,
        allan,
    } = last_judged;
    let last = last(&axis, &noise, ramp, &findings, &squares_sd);
    let models = Models {
        base: &base.model,
        noise: &noise.model,
        whole: &last.model,
    };
    let verdict = Verdict::new(&allan);
    let unnamed = unnamed.map(|p_value| without_name(p_value, &noise.model, axis.rate_hz, &allan));
    let views = bare.before.map(|before| Views {
        held_out: held.beside(&base.expected, &noise.expected),
        ..Views::new(&axis, before, (models, allan), &findings, covariate)
    });
    let filled_samples = axis.filled_samples();
    let suspicions = suspicions(&axis, &options.suspects, level);
    let residual = to_share::left(axis);
    let diagnosis = AxisDiagnosis {
        name: signal.name.clone(),
        unit: signal.unit,
        base: described_base(base, bare.discrepancies),
        refused: None,
        recognised_chain: recognised,
        filled_samples,
        unexplained,
        unnamed,
        suspicions,
        last,
        verdict,
        findings,
        views: views.unwrap_or_default(),
    };
    (diagnosis, residual)
}

/// The five terms alone, and where they fail.
fn described_base(base: Judged, discrepancies: Vec<Remark>) -> Base {
    Base {
        model: base.model,
        discrepancies,
        allan_error_percent: base.error_percent,
        allan_error_sampling_percent: base.sampling_percent,
    }
}

/// What there is to say of an axis that cannot be diagnosed, beside others that can.
pub(crate) fn undiagnosed(signal: &Axis, refused: &Refused) -> AxisDiagnosis {
    let model = ModelAxis {
        name: signal.name.clone(),
        unit: signal.unit,
        mean: 0.0,
        chain: signal.chain.clone(),
        coefficients: PerCoefficient::default(),
        effects: Vec::new(),
    };
    AxisDiagnosis {
        name: signal.name.clone(),
        unit: signal.unit,
        refused: Some(refused.to_string()),
        recognised_chain: None,
        filled_samples: 0,
        base: Base {
            model: model.clone(),
            discrepancies: Vec::new(),
            allan_error_percent: None,
            allan_error_sampling_percent: None,
        },
        findings: Vec::new(),
        unexplained: Vec::new(),
        unnamed: None,
        suspicions: Vec::new(),
        last: Final {
            model,
            coefficients: PerCoefficient::default(),
            allan_error_percent: None,
            allan_error_sampling_percent: None,
        },
        verdict: Verdict::default(),
        views: Views::default(),
    }
}

/// The last model of an axis: its noise less what belongs to effects, and all findings.
fn last(
    axis: &AxisState,
    noise: &Judged,
    last_ramp: Option<Ramp>,
    findings: &[Finding],
    squares_sd: &[f64],
) -> Final {
    let (squares, squares_sd) = own_squares(axis, squares_sd);
    let model = ModelAxis {
        coefficients: PerCoefficient {
            r: slope(last_ramp),
            ..held_out::coefficients(&squares)
        },
        effects: all_effects(findings, &noise.model),
        ..noise.model.clone()
    };
    Final {
        model,
        coefficients: PerCoefficient {
            r: last_ramp.as_ref().map(of_ramp).unwrap_or_default(),
            ..coefficients(&squares, &squares_sd)
        },
        allan_error_percent: noise.error_percent,
        allan_error_sampling_percent: noise.sampling_percent,
    }
}

/// Squares of the five terms' components and their deviations, less what belongs to effects whose
/// noise is as white.
fn own_squares(axis: &AxisState, squares_sd: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut squares, mut squares_sd) = (axis.fit.squared.clone(), squares_sd.to_vec());
    if let Some(white) = SEEN.iter().position(|one| *one == Letter::N) {
        let [even, even_sd] = even_density(axis);
        squares[white] = (squares[white] - even).max(0.0);
        squares_sd[white] = squares_sd[white].hypot(even_sd);
    }
    (squares, squares_sd)
}
