//! One axis: searched until nothing is left that has a name, without what gains too little.

use std::sync::Arc;

use crate::chain::Chain;
use crate::diagnosis::attempts::{Attempt, without_losers};
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::depth;
use crate::diagnosis::decision::Decision;
use crate::diagnosis::detect::look::Context;
use crate::diagnosis::detect::{coarse_grid, telegraph};
use crate::diagnosis::doubt;
use crate::diagnosis::family::level_of_one_test;
use crate::diagnosis::laws::departure::departure;
use crate::diagnosis::laws::spread::Spread;
use crate::diagnosis::options::Options;
use crate::diagnosis::progress::{Progress, Step};
use crate::diagnosis::recognised;
use crate::diagnosis::record::reading::Reading;
use crate::diagnosis::record::samples::AxisSamples;
use crate::diagnosis::refused::{LEAST, Refused};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::search::{self, Spoilt};
use crate::diagnosis::unnamed;
use crate::diagnosis::values::ValueFindings;
use crate::diagnosis::views::Before;
use crate::fit::likelihood::Fit;
use crate::fit::likelihood::components::SEEN;
use crate::fit::likelihood::ramp::Ramp;
use crate::fit::likelihood::terms::{self, LikelihoodFit};
use crate::model::PerCoefficient;
use crate::numeric::mixture::add_mixture;
use crate::signal::Axis;
use crate::source::Values;

/// An axis whose effects are found, and how it came to that.
pub struct Explained {
    /// What is left, with its model.
    pub axis: AxisState,
    /// Mean of the record, in the unit of the signal.
    pub mean: f64,
    /// The signal chain that it shows, where none is declared.
    pub recognised: Option<Chain>,
    /// What was noted of it before anything was explained.
    pub base: Bare,
    /// What no effect of the catalogue explains.
    pub unexplained: Vec<Remark>,
    /// Probability of what has no name, in data of the model without it; `None` where there is nothing.
    pub unnamed: Option<f64>,
    /// Standard deviations of the squares of the base components.
    pub squares_sd: Vec<f64>,
    /// Gain of each explanation in log-likelihood on data that it was not fitted to, nats.
    pub held_out_nats: Vec<Option<f64>>,
}

/// An axis before anything was explained.
#[derive(Clone)]
pub struct Bare {
    /// Fit of the five terms alone, as `inm analyze` makes it.
    pub fit: Fit,
    /// What the five terms get wrong.
    pub discrepancies: Vec<Remark>,
    /// What pictures need of it, where views are wanted.
    pub before: Option<Before>,
    /// Its slope, where it has one; unit of the signal a second.
    pub slope: f64,
}

/// White noise that is known to join behind all filters.
struct Floors {
    /// Step of the grid that all values lie on.
    rounded_to: Option<f64>,
    /// Density of what hides the [depth](depth) of the spectrum.
    hidden: f64,
    /// Level of one test.
    level: f64,
}

impl Floors {
    /// An axis that knows of it.
    fn known_to(&self, mut axis: AxisState) -> AxisState {
        let of_rounding = |step| coarse_grid::floor(&axis, step, self.level);
        let floor = self.hidden + self.rounded_to.map_or(0.0, of_rounding);
        axis.bins.know_floor(floor);
        axis
    }
}

/// Refuses a record that holds too little for any finding.
fn long_enough(signal: &Axis, measured: &[f64]) -> Result<(), Refused> {
    let good = measured.iter().filter(|value| value.is_finite()).count();
    if good < LEAST {
        return Err(Refused::TooShort {
            axis: signal.name.clone(),
            samples: good,
        });
    }
    Ok(())
}

/// Explains the record of an axis.
///
/// # Errors
/// [`Refused`] where it holds too little.
pub fn explain(
    signal: &Axis,
    record: AxisSamples,
    rate_hz: f64,
    options: &Options,
    progress: &Progress<'_>,
) -> Result<Explained, Refused> {
    let declared = matches!(record.raw(), Values::Codes(_)).then_some(signal.scale);
    let (measured, mean) = record.centred(signal.scale);
    long_enough(signal, &measured)?;
    let level = level_of_one_test(options);
    let mut measured = Arc::new(measured);
    let of = |measured: &Arc<Vec<f64>>, chain: Option<&Chain>| {
        let axis = AxisState::new(Arc::clone(measured), rate_hz, chain);
        axis.ok_or_else(|| refusal(signal, measured))
    };
    let own_mean = mean - signal.zero * signal.scale;
    let (values, first) = rayon::join(
        || ValueFindings::new(declared, level, &measured, own_mean),
        || of(&measured, signal.chain.as_ref()),
    );
    let mut first = first?;
    let mut hidden = 0.0;
    if let Some(shallow) = depth::shallow(&measured, &first) {
        (measured, hidden) = (Arc::new(shallow.measured), shallow.floor);
        first = of(&measured, signal.chain.as_ref())?;
    }
    let floors = Floors {
        rounded_to: values.rounded_to,
        hidden,
        level,
    };
    first = floors.known_to(first);
    let begin_with = |chain: Option<&Chain>| Ok(floors.known_to(of(&measured, chain)?));
    let covariate = options.covariate.as_deref().map(Reading::of);
    let decided = |decision| progress(&signal.name, Step::Decided(decision));
    let from = |first: AxisState, chain: Option<&Chain>| {
        let base = Bare::of(&first, level, options);
        let begin = || begin_with(chain);
        let explained = without_losers(&signal.name, first, begin, |axis, refused| {
            if !refused.is_empty() {
                decided(Decision::Anew(refused.to_vec()));
            }
            let context = Context {
                level,
                covariate: covariate.as_ref(),
                values: &values,
                refused,
                decided: &decided,
            };
            attempt(axis, &context)
        });
        explained.map(|explained| (base, explained))
    };
    let without_events = |mut axis: AxisState| {
        let context = Context {
            level,
            covariate: None,
            values: &values,
            refused: &[],
            decided: &|_| (),
        };
        search::take_events_out(&mut axis, &context).ok()?;
        Some(axis)
    };
    let behind = |chain: &Chain| without_events(begin_with(Some(chain)).ok()?);
    let seen = |axis: &AxisState| recognised::chain(axis, behind);
    let is_declared = first.chain.is_some();
    let bare = (!is_declared)
        .then(|| without_events(first.clone()))
        .flatten();
    let mut recognised = bare.as_ref().and_then(seen);
    drop(bare);
    if let Some(chain) = &recognised {
        first = begin_with(Some(chain))?;
    }
    let (mut base, mut explained) = from(first, recognised.as_ref().or(signal.chain.as_ref()))?;
    if recognised.is_none()
        && let Some(chain) = seen(&explained.0)
    {
        // What stood ahead of it had a name.
        (base, explained) = from(begin_with(Some(&chain))?, Some(&chain))?;
        recognised = Some(chain);
    }
    let (mut axis, unexplained, mut held_out_nats) = explained;
    let before = axis.kinds();
    let completed = unnamed::complete(&mut axis, level);
    let why = "noise without a name explains as much, or leaves it unknown";
    if let Some(withdrawn) = Decision::withdrawn(&before, axis.explanations(), why) {
        decided(withdrawn);
    }
    for number in completed.withdrawn {
        held_out_nats.remove(number);
    }
    let squares_sd = with_intervals(&mut axis);
    Ok(Explained {
        axis,
        mean: own_mean,
        recognised,
        base,
        unexplained,
        unnamed: completed.p_value,
        squares_sd,
        held_out_nats,
    })
}

impl Bare {
    /// Of an axis as it begins. What the search looks at first is made on the way.
    fn of(axis: &AxisState, level: f64, options: &Options) -> Self {
        let look = || {
            let measured = axis.residual.whole();
            let five = terms::fit_values(measured, axis.rate_hz, axis.chain.as_ref());
            axis.powers();
            five
        };
        let (_, five) = rayon::join(|| axis.lines(level), look);
        let squares = five.as_ref().map(LikelihoodFit::squares);
        let fit = squares.map_or_else(|| axis.fit.clone(), |squares| of_squares(axis, &squares));
        let departure = departure(&axis.data, &fit.expected);
        let departure = departure.filter(|one| one.p_value < level);
        Self {
            discrepancies: departure
                .iter()
                .map(doubt::left_over::spectrum_remark)
                .collect(),
            before: Before::new(axis, &fit, options),
            slope: squares.map_or(0.0, |squares| squares.r.sqrt()),
            fit,
        }
    }
}

/// An axis's fit with these squares in place of its own.
fn of_squares(axis: &AxisState, squares: &PerCoefficient<f64>) -> Fit {
    let mut fit = axis.fit.clone();
    fit.squared.fill(0.0);
    for (squared, letter) in fit.squared.iter_mut().zip(SEEN) {
        *squared = *squares.get(letter);
    }
    fit.expected.fill(0.0);
    add_mixture(&mut fit.expected, axis.bins.units(), &fit.squared);
    fit
}

/// What no effect explains, once all that has a name is found, and the courses among it that turned out to be none.
fn attempt(axis: &mut AxisState, context: &Context<'_>) -> Result<Attempt<Vec<Remark>>, Spoilt> {
    let (character, latest) = search::search(axis, context)?;
    let heard = doubt::hear(axis, context, &character).map_err(|_| Spoilt { latest })?;
    Ok(Attempt {
        done: heard.remarks,
        loser: heard.no_course,
    })
}

/// Gives the laws of an axis the parameters of the last fit, with their intervals; standard deviations of the
/// squares of the base components.
fn with_intervals(axis: &mut AxisState) -> Vec<f64> {
    let spread = Spread::new(&axis.bins, &axis.data, &axis.laws, &axis.fit);
    let laws = 0..axis.laws.len();
    let values: Vec<Vec<Value>> = laws.map(|which| spread.values(which)).collect();
    let units = 0..axis.bins.units().len();
    let squares_sd = units.map(|component| spread.square_sd(component)).collect();
    drop(spread);
    axis.set_laws(|which, one| {
        if one.kind() == crate::model::telegraph::KIND {
            telegraph::of_law(&values[which])
        } else {
            Estimate::new(one.kind(), values[which].iter().copied())
        }
    });
    squares_sd
}

/// Why there is no spectrum of these samples.
fn refusal(signal: &Axis, measured: &[f64]) -> Refused {
    let axis = signal.name.clone();
    let mut there = measured.iter().filter(|value| value.is_finite());
    let first = there.next();
    if there.all(|value| Some(value) == first) {
        Refused::Constant { axis }
    } else {
        Refused::Broken { axis }
    }
}

/// Slope of a ramp that was resolved from none.
pub fn slope(ramp: Option<Ramp>) -> f64 {
    let told = ramp.filter(Ramp::identified);
    told.map_or(0.0, |ramp| ramp.per_s.abs())
}

#[cfg(test)]
mod tests;
