//! The values of laws that fit best.

use crate::diagnosis::laws::rise::Rise;
use crate::diagnosis::laws::starts::Start;
use crate::diagnosis::laws::{Law, behind, component, component_of, components, components_of};
use crate::diagnosis::record::bins::{Filtered, SpectralBins};
use crate::diagnosis::statistic::p_value;
use crate::fit::likelihood::scoring::{Range, greatest_beside, maximise_beside};
use crate::fit::likelihood::{Data, Fit};
use crate::model::averaging;
use crate::model::kind::Kind;

pub use crate::diagnosis::laws::starts::{Fitted, Starts};

/// Smallest step in the logarithm of a shape: a choice, 0.2 %.
const FINEST: f64 = 2e-3;

/// Gain in log-likelihood that is worth a move: a thousandth of a nat, which no test sees.
const WORTH: f64 = 1e-3;

/// Loss in log-likelihood at which values that are meant take the place of the likeliest ones: what a number costs that is not
/// fitted then.
const SPARED: f64 = 1.0;

/// Gain in log-likelihood at the best start below which nothing significant is near: at one place
/// noise gains as much in a few of 100 records.
const PROMISING: f64 = 2.0;

/// Factor within which a filter has the corner, or the duration, of the plainest one that does nearly the same: a choice. Three means
/// one after the other are as wide as one over less than twice as long.
const ALIKE: f64 = 3.0;

/// Components of some laws and the best squares for them.
struct Standing<'a> {
    /// The bins behind those that filter.
    bins: Filtered<'a>,
    components: Vec<Vec<f64>>,
    squared: Vec<f64>,
    value: f64,
}

/// Best squares of `components` of `bins`, searched from `start`, with their log-likelihood.
fn greatest(
    bins: &Filtered<'_>,
    data: &Data,
    components: &[Vec<f64>],
    start: Option<&[f64]>,
) -> Option<(Vec<f64>, f64)> {
    greatest_beside(data, components, &bins.fixed(), start, Range::NonNegative)
}

/// Moves the shapes of the laws from number `from` on until the likelihood gains no more.
pub fn polish(
    bins: &SpectralBins,
    data: &Data,
    laws: &mut [Law],
    from: usize,
    first_step: f64,
) -> Option<Fit> {
    let mut best = standing(bins, data, laws, None)?;
    let places: Vec<(usize, usize)> = (from..laws.len())
        .flat_map(|law| laws[law].shape().map(move |place| (law, place)))
        .collect();
    let mut step = first_step;
    while step > FINEST && !places.is_empty() {
        let before = laws.to_vec();
        match by_turns(bins, data, laws, &places, step, best) {
            (next, true) => best = stride(bins, data, laws, &before, next),
            (same, false) => {
                best = same;
                step *= 0.5;
            }
        }
    }
    for law in from..laws.len() {
        let own = laws[law].clone();
        let Some(meant) = own.effect.meant(&own.values, bins.rate_hz()) else {
            continue;
        };
        laws[law].values = meant;
        match moved(bins, data, laws, law, &best) {
            Some(next) if next.value > best.value - SPARED => best = next,
            _ => laws[law] = own,
        }
    }
    let fixed = best.bins.fixed();
    maximise_beside(data, &best.components, &fixed, Some(&best.squared))
}

/// Moves each of these shapes a step up or down where that gains: where it ends, and whether any gained.
fn by_turns<'a>(
    bins: &'a SpectralBins,
    data: &Data,
    laws: &mut [Law],
    places: &[(usize, usize)],
    step: f64,
    mut best: Standing<'a>,
) -> (Standing<'a>, bool) {
    let mut gained = false;
    for &(law, place) in places {
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
    (best, gained)
}

/// Goes on in the direction in which the laws came from `before`, twice as far each time, while that gains: along the ridge of
/// shapes that stand in for each other, where moves by turns are hundreds of small ones.
fn stride<'a>(
    bins: &'a SpectralBins,
    data: &Data,
    laws: &mut [Law],
    before: &[Law],
    mut best: Standing<'a>,
) -> Standing<'a> {
    let ratios: Vec<Vec<f64>> = (laws.iter().zip(before))
        .map(|(now, then)| {
            let pairs = now.values.iter().zip(&then.values);
            pairs
                .map(|(now, then)| if now == then { 1.0 } else { now / then })
                .collect()
        })
        .collect();
    let mut power = 1;
    loop {
        let mut next = laws.to_vec();
        for (law, ratios) in next.iter_mut().zip(&ratios) {
            let pairs = law.values.iter_mut().zip(ratios);
            pairs.for_each(|(value, ratio)| *value *= ratio.powi(power));
        }
        if !next.iter().all(|law| law.is_sound(bins)) {
            return best;
        }
        match standing(bins, data, &next, Some(&best.squared)) {
            Some(found) if found.value > best.value + WORTH => best = found,
            _ => return best,
        }
        laws.clone_from_slice(&next);
        power *= 2;
    }
}

/// Where laws stand, the squares searched from `start`.
fn standing<'a>(
    bins: &'a SpectralBins,
    data: &Data,
    laws: &[Law],
    start: Option<&[f64]>,
) -> Option<Standing<'a>> {
    let filtered = behind(bins, laws);
    let components = components_of(&filtered, laws);
    let (squared, value) = greatest(&filtered, data, &components, start)?;
    Some(Standing {
        bins: filtered,
        components,
        squared,
        value,
    })
}

/// What stands after law number `which` was moved.
fn moved<'a>(
    bins: &'a SpectralBins,
    data: &Data,
    laws: &[Law],
    which: usize,
    from: &Standing<'a>,
) -> Option<Standing<'a>> {
    // A term that moves changes its own component alone, a filter all of them.
    if !laws[which].adds() {
        return standing(bins, data, laws, Some(&from.squared));
    }
    let mut components = from.components.clone();
    components[component_of(bins, laws, which)] = component(&from.bins, &laws[which])?;
    let (squared, value) = greatest(&from.bins, data, &components, Some(&from.squared))?;
    Some(Standing {
        bins: from.bins.clone(),
        components,
        squared,
        value,
    })
}

/// A law that was found, together with others.
pub struct Found {
    /// The law with the values that fit best, size 1.
    pub law: Law,
    /// Fit of the five terms, the laws that were there and this one.
    pub fit: Fit,
    /// Gain in log-likelihood over the fit without it.
    pub nats: f64,
    /// Length of the path of shapes that were searched, as the data see them, radians.
    pub path: f64,
    /// Probability of as large a gain where it is absent.
    pub p_value: f64,
}

/// The best values of a kind of law beside those that are there; `None` where it is nowhere near significant.
pub fn search(present: Fitted<'_>, starts: &Starts, kind: Kind) -> Option<Found> {
    gaining(present, starts, kind, PROMISING)
}

/// The same however little it gains.
pub fn best(present: Fitted<'_>, starts: &Starts, kind: Kind) -> Option<Found> {
    gaining(present, starts, kind, f64::NEG_INFINITY)
}

/// The best values of a kind of law, if its best start gains `least` nats.
fn gaining(present: Fitted<'_>, starts: &Starts, kind: Kind, least: f64) -> Option<Found> {
    let Fitted {
        bins,
        data,
        laws,
        fit: base,
    } = present;
    let components = components(bins, laws);
    let (value, law) = best_start(present, &components, starts, kind)?;
    // What is nowhere near significant need not be polished.
    if value - base.log_likelihood < least {
        return None;
    }
    let directions = starts.directions(bins, laws, base, law);
    let path = Rise::new(data, base, &components)?.path(directions);
    let (mut all, fit) = polished(present, law)?;
    let nats = fit.log_likelihood - base.log_likelihood;
    let law = all.pop()?;
    // A filter that shuts out most of the band would make every law anew from white noise.
    if !law.adds() && starts.are_beyond(kind, &law.values) {
        return None;
    }
    Some(Found {
        law,
        fit,
        nats,
        path,
        p_value: p_value::searched(
            p_value::highest_on_path(nats, path),
            starts.sorts(kind) as f64,
        ),
    })
}

/// The laws that are there and one more, of the values that fit best from where it `starts`, with their fit.
fn polished(present: Fitted<'_>, starts: &Law) -> Option<(Vec<Law>, Fit)> {
    /// First steps of the logarithm of a shape: as far as starts are apart, and, where a filter has zeros that may lie in the
    /// wrong bins, less than bins are.
    const FAR: f64 = 0.3;
    const NEAR: f64 = 0.01;
    let Fitted {
        bins, data, laws, ..
    } = present;
    let from = |step: f64| {
        let mut all = laws.to_vec();
        all.push(starts.clone());
        let fit = polish(bins, data, &mut all, laws.len(), step)?;
        Some((all, fit))
    };
    let far = from(FAR)?;
    let has_zeros = starts.effect == averaging::KIND;
    let near = has_zeros.then(|| from(NEAR)).flatten();
    match near {
        Some(near) if near.1.log_likelihood > far.1.log_likelihood => Some(near),
        _ => Some(far),
    }
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
    let present_bins = behind(bins, laws);
    let value = |start: &Start| {
        // What adds leaves all others as they are; what filters changes all of them.
        let (filtered, all) = start.beside(&present_bins, components, laws);
        let mut squared = base.squared.clone();
        squared.resize(all.len(), 0.0);
        Some(greatest(&filtered, data, &all, Some(&squared))?.1)
    };
    let largest = |some: &[&'a Start]| {
        let values = some
            .iter()
            .filter_map(|start| Some((value(start)?, &start.law)));
        values.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let all = starts.promising(present, components, kind);
    let (plain, others): (Vec<_>, Vec<_>) = all
        .into_iter()
        .partition(|start| start.law.counts().is_empty());
    let best = largest(&plain)?;
    if best.0 - base.log_likelihood < PROMISING {
        return Some(best);
    }
    // A filter of another sort that is there gains as the plainest one already, which has its width by a factor or two.
    let first = best.1.values[0];
    let is_near = |start: &&Start| {
        let ratio = start.law.values[0] / first;
        (ALIKE.recip()..=ALIKE).contains(&ratio)
    };
    let others: Vec<&Start> = others.into_iter().filter(is_near).collect();
    let better = largest(&others).filter(|one| one.0 > best.0);
    Some(better.unwrap_or(best))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{Trial, averaged, noise};
    use crate::model::rolloff;

    #[test]
    fn a_stride_goes_on_while_it_gains_and_no_farther() {
        // Running means over four samples have their corner at 11 Hz.
        let axis = Trial::new(averaged(noise(4), 4.0)).axis;
        let at = |corner_hz: f64| Law {
            effect: rolloff::KIND,
            values: vec![corner_hz],
        };
        let (before, mut laws) = ([at(40.0)], vec![at(39.0)]);
        let stands = |laws: &[Law]| standing(&axis.bins, &axis.data, laws, None).expect("a fit");
        let (first, from) = (stands(&before), stands(&laws));
        assert!(from.value > first.value, "seed 4: it gained");
        let value = from.value;
        let end = stride(&axis.bins, &axis.data, &mut laws, &before, from);
        assert!(end.value > value, "seed 4");
        let off = |found: &Standing<'_>, laws: &[Law]| (found.value - stands(laws).value).abs();
        assert!(off(&end, &laws) < WORTH, "seed 4: it is where it says");
        let corner_hz = laws[0].values[0];
        // Each stride is as long as all before it: from 40 Hz the last one goes beyond by half of the way at most.
        assert!((5.0..20.0).contains(&corner_hz), "seed 4: {corner_hz}");
        let again = stride(&axis.bins, &axis.data, &mut laws.clone(), &laws, end);
        assert!(off(&again, &laws) < WORTH, "seed 4: no way, no stride");
    }
}
