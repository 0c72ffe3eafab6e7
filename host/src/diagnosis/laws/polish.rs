//! The values of laws that fit best.

use crate::diagnosis::laws::{Law, behind, component, component_of, components_of};
use crate::diagnosis::record::bins::{Filtered, SpectralBins};
use crate::fit::likelihood::scoring::{Range, greatest_beside, maximise_beside};
use crate::fit::likelihood::{Data, Fit};

/// Smallest step in the logarithm of a shape: a choice, 0.2 %.
const FINEST: f64 = 2e-3;

/// Gain in log-likelihood that is worth a move: a thousandth of a nat, which no test sees.
const WORTH: f64 = 1e-3;

/// Loss in log-likelihood at which values that are meant take the place of the likeliest ones: what a number costs that is not
/// fitted then.
const SPARED: f64 = 1.0;

/// Components of some laws and the best squares for them.
struct Standing<'a> {
    /// The bins behind those that filter.
    bins: Filtered<'a>,
    components: Vec<Vec<f64>>,
    squared: Vec<f64>,
    value: f64,
}

/// Best squares of `components` of `bins`, searched from `start`, with their log-likelihood.
pub(super) fn greatest(
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
