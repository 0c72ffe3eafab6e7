//! Slow changes that have a name, measured again.
//!
//! A settling is first measured in noise whose walk was raised by it: its time constant is then known less well than the
//! record knows it, and what that leaves of a strong one looks like a drift. So it is put back and measured in the noise that
//! is left now, until that moves it no more.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::detect::slow_change::MeasuredAgain;
use crate::diagnosis::detect::{thermal, warmup};
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::record::wave::Wave;
use crate::model::kind::Kind;

/// Gain in log-likelihood from which a change is measured anew, nats: a choice. Its size and its time gain one by what
/// they follow of the noise.
const LEAST_GAIN: f64 = 3.0;

/// What is to be done about a slow change that is known, where it is known better now.
pub fn proposal(look: &Look<'_>) -> Option<Proposal> {
    let amended = [
        again(look, crate::model::warmup::KIND, warmup::measured_again),
        again(look, crate::model::thermal::KIND, thermal::measured_again),
    ];
    amended.into_iter().flatten().next()
}

fn again(
    look: &Look<'_>,
    kind: Kind,
    measured: fn(&Look<'_>, &[f64], &Explanation) -> Option<MeasuredAgain>,
) -> Option<Proposal> {
    let place = look.place_of(kind)?;
    let known = &look.axis.explanations()[place];
    // One that began with a settling of its own is measured with it.
    let [wave] = known.waves() else {
        return None;
    };
    let (proposal, gain, known_gain) = measured(look, &put_back(look.axis, wave), known)?;
    let Proposal::Explain(mut candidate) = proposal else {
        return None;
    };
    let is_better = gain - known_gain > LEAST_GAIN && candidate.effect.kind == kind;
    is_better.then(|| {
        candidate.amends = Some(place);
        candidate.p_value = known.p_value;
        Proposal::Explain(candidate)
    })
}

/// The residual with a waveform in it.
fn put_back(axis: &AxisState, wave: &Wave) -> Vec<f64> {
    let mut less = vec![0.0; axis.filled.len()];
    wave.take_out(&mut less);
    let pairs = axis.filled.iter().zip(less);
    pairs.map(|(left, less)| left - less).collect()
}
