//! The values of laws that fit best.

use rayon::prelude::*;

use crate::diagnosis::laws::rise::Rise;
use crate::diagnosis::laws::{Law, component_of, component_through, components, passed};
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::statistic::p_value;
use crate::fit::likelihood::scoring::{Range, greatest_beside, maximise_beside};
use crate::fit::likelihood::{Data, Fit};
use crate::model::catalogue::CATALOGUE;
use crate::model::effect::Band;
use crate::model::kind::Kind;
use crate::numeric::mixture::add_mixture;

/// Smallest step in the logarithm of a shape: a choice, 0.2 %.
const FINEST: f64 = 2e-3;

/// Gain in log-likelihood that is worth a move: a thousandth of a nat, which no test sees.
const WORTH: f64 = 1e-3;

/// Gain in log-likelihood at the best start below which nothing significant is near: at one place
/// noise gains as much in a few of 100 records.
const PROMISING: f64 = 2.0;

/// Starts that are fitted, of those whose first rise is known: a choice, for each costs a fit.
const TRIED: usize = 16;

/// Components of some laws and the best squares for them.
struct Standing {
    components: Vec<Vec<f64>>,
    squared: Vec<f64>,
    value: f64,
}

/// Best squares of `components`, searched from `start`, with their log-likelihood.
fn greatest(
    data: &Data,
    components: &[Vec<f64>],
    start: Option<&[f64]>,
) -> Option<(Vec<f64>, f64)> {
    let nothing = vec![0.0; data.len()];
    greatest_beside(data, components, &nothing, start, Range::NonNegative)
}

/// Moves the shapes of the laws from number `from` on until the likelihood gains no more.
pub fn polish(
    bins: &SpectralBins,
    data: &Data,
    laws: &mut [Law],
    from: usize,
    first_step: f64,
) -> Option<Fit> {
    let all = components(bins, laws);
    let (squared, value) = greatest(data, &all, None)?;
    let mut best = Standing {
        components: all,
        squared,
        value,
    };
    let places: Vec<(usize, usize)> = (from..laws.len())
        .flat_map(|law| laws[law].shape().map(move |place| (law, place)))
        .collect();
    let mut step = first_step;
    while step > FINEST && !places.is_empty() {
        let mut gained = false;
        for &(law, place) in &places {
            for factor in [f64::exp(step), f64::exp(-step)] {
                let before = laws[law].values[place];
                laws[law].values[place] = before * factor;
                let sound = laws[law].is_sound(bins);
                match sound.then(|| moved(bins, data, laws, law, &best)).flatten() {
                    Some(next) if next.value > best.value + WORTH => {
                        best = next;
                        gained = true;
                        break;
                    }
                    _ => laws[law].values[place] = before,
                }
            }
        }
        if !gained {
            step *= 0.5;
        }
    }
    let nothing = vec![0.0; data.len()];
    maximise_beside(data, &best.components, &nothing, Some(&best.squared))
}

/// What stands after law number `which` was moved.
fn moved(
    bins: &SpectralBins,
    data: &Data,
    laws: &[Law],
    which: usize,
    from: &Standing,
) -> Option<Standing> {
    // A term that moves changes its own component alone, a filter all of them.
    let components = if laws[which].adds() {
        let mut components = from.components.clone();
        let power = passed(bins, laws);
        components[component_of(bins, laws, which)] = component_through(bins, &laws[which], power)?;
        components
    } else {
        components(bins, laws)
    };
    let (squared, value) = greatest(data, &components, Some(&from.squared))?;
    Some(Standing {
        components,
        squared,
        value,
    })
}

/// Where searches begin: every law of the catalogue at its starting values. Made once for a bins.
pub struct Starts {
    starts: Vec<Start>,
}

struct Start {
    law: Law,
    /// Its own component, where it adds one.
    component: Option<Vec<f64>>,
}

impl Starts {
    /// For the bins of a bins; `None` if it has none.
    pub fn new(bins: &SpectralBins) -> Option<Self> {
        let all = bins.all();
        let band = Band {
            from_hz: all.first()?.f_hz,
            to_hz: all.last()?.f_hz,
        };
        let laws = CATALOGUE.iter().flat_map(|&effect| {
            let values = effect.starts(&band);
            values.into_iter().map(move |values| Law { effect, values })
        });
        let laws: Vec<Law> = laws.collect();
        let starts = laws
            .into_par_iter()
            .map(|law| Start {
                component: component_through(bins, &law, |_| 1.0),
                law,
            })
            .collect();
        Some(Self { starts })
    }
}

impl Starts {
    /// The least of each value of an effect.
    fn lowest(&self, effect: Kind) -> Vec<f64> {
        let own = self.starts.iter();
        own.filter(|start| start.law.effect == effect)
            .map(|start| start.law.values.clone())
            .reduce(|a, b| a.iter().zip(&b).map(|(a, b)| a.min(*b)).collect())
            .unwrap_or_default()
    }

    /// What each of an effect's starts changes in the expectation of a fit with `laws`.
    fn directions(
        &self,
        bins: &SpectralBins,
        laws: &[Law],
        base: &Fit,
        effect: Kind,
    ) -> impl Iterator<Item = Vec<f64>> {
        let own = self.starts.iter();
        own.filter(move |start| start.law.effect == effect)
            .map(move |start| match &start.component {
                Some(component) => component.clone(),
                None => {
                    let mut all = laws.to_vec();
                    all.push(start.law.clone());
                    let mut change: Vec<f64> = base.expected.iter().map(|e| -e).collect();
                    add_mixture(&mut change, &components(bins, &all), &base.squared);
                    change
                }
            })
    }

    /// Those of an effect from which the likelihood rises most at first, together with `present`, with the
    /// fit `base`; all of them where that says little, as behind a filter.
    fn promising(
        &self,
        data: &Data,
        base: &Fit,
        present: &[Vec<f64>],
        effect: Kind,
        unfiltered: bool,
    ) -> Vec<&Start> {
        let own = self.starts.iter();
        let mut own: Vec<&Start> = own.filter(|start| start.law.effect == effect).collect();
        // Of a filter no first rise is known.
        let adds = own.iter().all(|start| start.component.is_some());
        if !unfiltered || !adds || own.len() <= TRIED {
            return own;
        }
        let Some(rise) = Rise::new(data, base, present) else {
            return own;
        };
        let rise = |start: &Start| start.component.as_ref().map_or(0.0, |one| rise.of(one));
        let mut rises: Vec<(f64, &Start)> = own.drain(..).map(|one| (rise(one), one)).collect();
        rises.sort_by(|a, b| b.0.total_cmp(&a.0));
        rises.truncate(TRIED);
        rises.into_iter().map(|(_, one)| one).collect()
    }
}

/// A law that was found, together with others.
pub struct Found {
    /// The law with the values that fit best, size 1.
    pub law: Law,
    /// Fit of the five terms, the laws that were there and this one.
    pub fit: Fit,
    /// Gain in log-likelihood over the fit without it.
    pub nats: f64,
    /// Probability of as large a gain where it is absent.
    pub p_value: f64,
}

/// A spectrum with the laws that were fitted to it.
#[derive(Clone, Copy)]
pub struct Fitted<'a> {
    /// Its bins.
    pub bins: &'a SpectralBins,
    /// What was measured in them.
    pub data: &'a Data,
    /// Laws beyond the five terms.
    pub laws: &'a [Law],
    /// Fit of all.
    pub fit: &'a Fit,
}

/// The best values of a kind of law beside those that are there.
pub fn search(present: Fitted<'_>, starts: &Starts, kind: Kind) -> Option<Found> {
    let Fitted {
        bins,
        data,
        laws,
        fit: base,
    } = present;
    let components = components(bins, laws);
    let (value, law) = best_start(present, &components, starts, kind)?;
    // What is nowhere near significant need not be polished.
    if value - base.log_likelihood < PROMISING {
        return None;
    }
    let directions = starts.directions(bins, laws, base, kind);
    let path = Rise::new(data, base, &components)?.path(directions);
    let mut all = laws.to_vec();
    all.push(law.clone());
    let fit = polish(bins, data, &mut all, laws.len(), 0.3)?;
    let nats = fit.log_likelihood - base.log_likelihood;
    let law = all.pop()?;
    // A filter that shuts out most of the band would make every law anew from white noise.
    let lowest = starts.lowest(kind);
    let mut pairs = law.values.iter().zip(lowest);
    if !law.adds() && pairs.any(|(value, lowest)| *value < 0.5 * lowest) {
        return None;
    }
    Some(Found {
        law,
        fit,
        nats,
        p_value: p_value::highest_on_path(nats, path),
    })
}

/// The start from which the likelihood is largest, with that, beside the `components` that are there.
fn best_start<'a>(
    present: Fitted<'_>,
    components: &[Vec<f64>],
    starts: &'a Starts,
    kind: Kind,
) -> Option<(f64, &'a Law)> {
    let Fitted {
        bins,
        data,
        laws,
        fit: base,
    } = present;
    let unfiltered = laws.iter().all(Law::adds);
    let mut best: Option<(f64, &Law)> = None;
    for start in starts.promising(data, base, components, kind, unfiltered) {
        let all = match &start.component {
            Some(own) if unfiltered => [components, std::slice::from_ref(own)].concat(),
            _ => {
                let mut all = laws.to_vec();
                all.push(start.law.clone());
                super::components(bins, &all)
            }
        };
        let mut squared = base.squared.clone();
        squared.resize(all.len(), 0.0);
        let Some((_, value)) = greatest(data, &all, Some(&squared)) else {
            continue;
        };
        if best.is_none_or(|(most, _)| value > most) {
            best = Some((value, &start.law));
        }
    }
    best
}
