//! The law of a kind that explains most beside those that are there.

use crate::diagnosis::laws::polish::greatest;
use crate::diagnosis::laws::rise::Rise;
use crate::diagnosis::laws::starts::Start;
use crate::diagnosis::laws::{Law, behind, components};
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::statistic::p_value;
use crate::fit::likelihood::Fit;
use crate::model::averaging;
use crate::model::kind::Kind;

pub use crate::diagnosis::laws::polish::polish;
pub use crate::diagnosis::laws::starts::{Fitted, Starts};

/// Gain in log-likelihood at the best start below which nothing significant is near: at one place
/// noise gains as much in a few of 100 records.
const PROMISING: f64 = 2.0;

/// Factor within which a filter has the corner, or the duration, of the plainest one that does nearly the same: a choice. Three means
/// one after the other are as wide as one over less than twice as long; one pole in the place of eight has a fifth of their corner.
const ALIKE: f64 = 6.0;

/// Sorts of a filter that are fitted in full beside the plainest: a choice between time and the right one.
const POLISHED: usize = 3;

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
    let begins = best_starts(present, &components, starts, kind);
    // What is nowhere near significant need not be polished.
    if begins.first()?.0 - base.log_likelihood < least {
        return None;
    }
    let polished = begins.iter().filter_map(|(_, law)| polished(present, law));
    let likeliest = polished.max_by(|a, b| worth(bins, a).total_cmp(&worth(bins, b)));
    let (mut all, fit) = likeliest?;
    let nats = fit.log_likelihood - base.log_likelihood;
    let law = all.pop()?;
    let directions = starts.directions(bins, laws, base, &law);
    let path = Rise::new(data, base, &components)?.path(directions);
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

/// Log-likelihood of laws and their fit, less what makes the values of the last one unlikely.
fn worth(bins: &SpectralBins, (laws, fit): &(Vec<Law>, Fit)) -> f64 {
    let surprise = laws.last().map_or(0.0, |law| {
        law.effect.surprise_nats(&law.values, bins.rate_hz())
    });
    fit.log_likelihood - surprise
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

/// The start from which the likelihood is largest, with that, beside the `components` that are there; then the same of the other
/// sorts of the kind, where that gains.
fn best_starts<'a>(
    present: Fitted<'_>,
    components: &[Vec<f64>],
    starts: &'a Starts,
    kind: Kind,
) -> Vec<(f64, &'a Law)> {
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
    let Some(best) = largest(&plain) else {
        return Vec::new();
    };
    if best.0 - base.log_likelihood < PROMISING {
        return vec![best];
    }
    // A filter of another sort that is there gains as the plainest one already, which has its width by a factor or two.
    let first = best.1.values[0];
    let is_near = |start: &&Start| {
        let ratio = start.law.values[0] / first;
        (ALIKE.recip()..=ALIKE).contains(&ratio)
    };
    let others: Vec<&Start> = others.into_iter().filter(is_near).collect();
    let sorts = others.chunk_by(|one, next| one.law.counts() == next.law.counts());
    let mut sorts: Vec<_> = sorts.filter_map(largest).collect();
    // Starts are so far apart that the likeliest sort need not have the likeliest one.
    sorts.sort_by(|a, b| b.0.total_cmp(&a.0));
    std::iter::once(best)
        .chain(sorts.into_iter().take(POLISHED))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::axis::AxisState;
    use crate::diagnosis::detect::trial::{RATE_HZ, Trial, noise};
    use crate::diagnosis::laws::spread::Spread;
    use crate::model::effect::Distortion;
    use crate::model::highpass::{self, Coupling};
    use crate::model::random::Seed;
    use crate::model::rolloff::{self, RollOff};
    use crate::model::rounding::Rounding;

    const SEED: u64 = 5;

    fn found(axis: &AxisState) -> Found {
        let starts = axis.starts().expect("bins");
        search(axis.fitted(), &starts, rolloff::KIND).expect("a filter")
    }

    #[test]
    fn what_keeps_the_slow_out_is_found_with_its_poles() {
        for counts in [&[][..], &[2.0], &[0.0, 1.0]] {
            let mut values = noise(SEED);
            let random = Seed {
                seed: SEED,
                stream: 9,
            };
            let filter = Coupling::of(&[&[0.5], counts].concat());
            filter.distorter(RATE_HZ, random).apply(&mut values);
            let axis = Trial::new(values).axis;
            let starts = axis.starts().expect("bins");
            let found = search(axis.fitted(), &starts, highpass::KIND).expect("a filter");
            assert_eq!(found.law.counts(), counts, "seed {SEED}");
            let corner_hz = found.law.values[0];
            let laws = std::slice::from_ref(&found.law);
            let sd = Spread::new(&axis.bins, &axis.data, laws, &found.fit).log_deviations(0)[0];
            assert!(
                (corner_hz / 0.5).ln().abs() < 5.0 * sd,
                "seed {SEED}, {counts:?}: {corner_hz} Hz, {sd}"
            );
            assert!(found.p_value < 1e-9, "seed {SEED}: {}", found.p_value);
        }
    }

    #[test]
    fn the_sort_of_a_filter_is_found_and_codes_have_a_floor_behind_it() {
        let step = 0.3;
        for counts in [&[][..], &[2.0], &[4.0], &[2.0, 1.0], &[2.0, 1.0, 2.0]] {
            let mut values = noise(SEED);
            let filter = RollOff::of(&[&[10.0], counts].concat());
            let random = Seed {
                seed: SEED,
                stream: 9,
            };
            filter.distorter(RATE_HZ, random).apply(&mut values);
            let codes = values.iter().map(|value| (value / step).round() * step);
            let mut axis = Trial::new(codes.collect()).axis;
            let without = found(&axis);
            axis.bins.know_floor(Rounding { step }.density(RATE_HZ));
            let with = found(&axis);
            assert_eq!(with.law.counts(), counts, "seed {SEED}");
            let corner_hz = with.law.values[0];
            let laws = std::slice::from_ref(&with.law);
            let sd = Spread::new(&axis.bins, &axis.data, laws, &with.fit).log_deviations(0)[0];
            assert!(
                (corner_hz / 10.0).ln().abs() < 5.0 * sd,
                "seed {SEED}, {counts:?}: {corner_hz} Hz, {sd}"
            );
            assert!(
                counts.is_empty() || with.nats > without.nats + 10.0,
                "seed {SEED}, {counts:?}: {} nats with the floor, {} without",
                with.nats,
                without.nats
            );
        }
    }
}
