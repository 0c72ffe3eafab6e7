//! What a record says of kinds that somebody suspects: how near the likeliest of each comes to a name, and how
//! large one may be that was not found.
//!
//! It is asked once an axis is explained, and changes nothing of that. The limit is the bound of a profile
//! likelihood ([`Profile`]): the largest size beside which the sizes of all else, what has no name among it, explain
//! the spectrum as well as 95 % of records do. The shape is given, since a profile over all shapes bounds nothing: at
//! the ends of the band each of these laws becomes one of the five terms. Laws that were found keep their shapes.

use rayon::prelude::*;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::telegraph as two_levels;
use crate::diagnosis::laws::search::{self, Found, Starts};
use crate::diagnosis::laws::{self, Law};
use crate::diagnosis::result::rival::Rival;
use crate::diagnosis::result::suspicion::{Best, Limit, Suspicion};
use crate::diagnosis::statistic::p_value;
use crate::fit::likelihood::maximise;
use crate::fit::likelihood::profile::Profile;
use crate::model::kind::Kind;
use crate::model::telegraph::Telegraph;
use crate::model::{markov, telegraph};

/// Dwells of a telegraph in the record from which its spectrum bounds it: with fewer the power at the slow end is not
/// that of Gaussian noise, which the likelihood takes it for. A choice: the fewest at which a test holds the bound.
const LEAST_DWELLS: f64 = 400.0;

/// What an explained axis says of each kind, at this `level` of one test.
pub fn suspicions(axis: &AxisState, kinds: &[Kind], level: f64) -> Vec<Suspicion> {
    let starts = axis.starts();
    let suspicion = |&effect: &Kind| {
        let starts = starts.as_deref();
        Suspicion {
            effect,
            best: starts.and_then(|starts| best(axis, starts, effect, level)),
            limits: starts.map_or_else(Vec::new, |starts| limits(axis, starts, effect)),
        }
    };
    kinds.par_iter().map(suspicion).collect()
}

/// The kind whose law a spectrum shows where there is one of these: two levels look like Markov noise.
fn in_spectrum(kind: Kind) -> Kind {
    if kind == telegraph::KIND {
        markov::KIND
    } else {
        kind
    }
}

/// Values of a law as those of the `kind` that was asked for.
fn as_of(kind: Kind, mut law: Vec<f64>) -> Vec<f64> {
    if kind == telegraph::KIND {
        for value in &mut law {
            *value = Telegraph::per_markov(*value);
        }
    }
    law
}

/// The likeliest effect of a kind; `None` where no search by shape begins with it, or comes to one.
fn best(axis: &AxisState, starts: &Starts, kind: Kind, level: f64) -> Option<Best> {
    let found = search::best(axis.fitted(), starts, in_spectrum(kind))?;
    let all = with(axis, &found.law);
    let values = laws::sized(&axis.bins, &all, axis.laws.len(), &found.fit);
    let values = as_of(kind, values);
    let names = kind.parameters(&values).into_iter();
    let names = names.map(|one| one.name.into_owned());
    Some(Best {
        parameters: names.zip(values).collect(),
        gain_nats: found.nats.max(0.0),
        needed_nats: p_value::nats_on_path(level, found.path),
        p_value: found.p_value,
        rivals: rivals(axis, kind, &found),
    })
}

/// What has the same spectrum; nothing where the odds are not known.
fn rivals(axis: &AxisState, kind: Kind, found: &Found) -> Vec<Rival> {
    if in_spectrum(kind) == kind {
        return Vec::new();
    }
    let odds = two_levels::log_odds(axis, &found.law, &found.fit);
    let rival = odds.map(|log_odds| Rival {
        effect: found.law.effect,
        log_odds,
    });
    rival.into_iter().collect()
}

/// How large an effect of a kind may be at each of the shapes that a search begins with; none for a kind that
/// takes power away, or with more than one parameter beside its size.
fn limits(axis: &AxisState, starts: &Starts, kind: Kind) -> Vec<Limit> {
    let laws: Vec<&Law> = starts.laws(in_spectrum(kind)).collect();
    let duration_s = axis.filled.len() as f64 / axis.rate_hz;
    let limit = |law: &&Law| {
        let size = kind.size().filter(|_| law.shape().count() == 1)?;
        let values = as_of(kind, law.values.clone());
        if kind == telegraph::KIND && LEAST_DWELLS * Telegraph::of(&values).dwell_s > duration_s {
            return None;
        }
        let upper = upper(axis, law);
        let mut values = law.values.clone();
        values[size] = upper.unwrap_or(0.0);
        let values = as_of(kind, values);
        let names = kind.parameters(&values).into_iter();
        let mut named: Vec<_> = names.map(|one| one.name.into_owned()).zip(values).collect();
        let (name, value) = named.remove(size);
        Some(Limit {
            size: name,
            upper: upper.map(|_| value),
            at: named.into_iter().collect(),
        })
    };
    laws.par_iter().filter_map(limit).collect()
}

/// One-sided 95 % bound of the size of a law beside all that is there; `None` where the record sets none.
fn upper(axis: &AxisState, law: &Law) -> Option<f64> {
    let size = law.effect.size()?;
    let all = with(axis, law);
    let filtered = laws::behind(&axis.bins, &all);
    let mut components = laws::components_of(&filtered, &all);
    if laws::floor(&axis.bins, &all) > 0.0 {
        // A bound may take it for less than it is, and is on the safe side.
        components.push(filtered.fixed());
    }
    let mut fit = maximise(&axis.data, &components)?;
    let which = axis.laws.len();
    let component = laws::component_of(&axis.bins, &all, which);
    let bound = Profile::new(&axis.data, &components, &fit, component).bound();
    fit.squared[component] = bound;
    bound
        .is_finite()
        .then(|| laws::sized(&axis.bins, &all, which, &fit)[size])
}

/// The laws of an axis, and one more.
fn with(axis: &AxisState, law: &Law) -> Vec<Law> {
    let mut all = axis.laws.clone();
    all.push(law.clone());
    all
}

#[cfg(test)]
mod tests;
