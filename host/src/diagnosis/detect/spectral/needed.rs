//! Laws that are needed no more.
//!
//! A law is named beside what is known by then. A drift that is still taken for a walk lifts all that the walk comes to, and a
//! law that sets it right elsewhere is significant until the drift is out. So each law is asked the same question again
//! beside all that was found since: whether it would be named now.

use super::level;
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::Detector;
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::laws::search::{self, Fitted};
use crate::diagnosis::statistic::p_value;

/// First move of the laws that stay, as a logarithm: they were fitted, and give way to little.
const STEP: f64 = 0.05;

/// Takes the law back that would be named least, once nothing else is found. It names nothing, so it is no test.
pub static STILL: Detector = Detector { tests: 0, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let axis = look.axis;
    let laws = axis.explanations().iter();
    let laws = laws.filter(|one| one.law().is_some()).enumerate();
    let asked = laws.filter_map(|(which, one)| Some((one.kind(), chance(look, which, one)?)));
    let least = asked.max_by(|a, b| a.1.total_cmp(&b.1));
    let least = least.filter(|(_, chance)| *chance >= level(look));
    Ok(least.map_or_else(Vec::new, |(kind, _)| vec![Proposal::Withdraw(vec![kind])]))
}

/// Probability of as large a gain as that of law number `which` where it is absent; `None` where something else than the
/// spectrum named it.
fn chance(look: &Look<'_>, which: usize, one: &Explanation) -> Option<f64> {
    let axis = look.axis;
    let mut laws = axis.laws.clone();
    let law = laws.remove(which);
    if law.effect != one.kind() {
        return None;
    }
    let fit = search::polish(&axis.bins, &axis.data, &mut laws, 0, STEP)?;
    let without = Fitted {
        bins: &axis.bins,
        data: &axis.data,
        laws: &laws,
        fit: &fit,
    };
    let found = search::best(without, &*axis.starts()?, law.effect)?;
    // The one that is there may be the better of the two.
    let nats = axis.fit.log_likelihood - fit.log_likelihood;
    Some(p_value::highest_on_path(nats.max(found.nats), found.path))
}
