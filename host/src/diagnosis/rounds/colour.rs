//! Noise whose colour changes in time, which a law or the five terms describe on average.

use std::ops::Range;

use crate::diagnosis::doubt::constancy::{self, Change};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::rounds::Rounds;

/// Effects that bend the law of amplitudes, or have what is too small to be told one by one: their
/// strengths are not those of Gaussian noise.
const BENDS: [&str; 6] = [
    "clipping",
    "quantisation",
    "telegraph",
    "outliers",
    "stale",
    "dropped",
];

impl Rounds<'_> {
    /// A law whose parameters change in time, which noise of another kind makes whose colour does, and
    /// by how much, as the standard deviation of a logarithm.
    pub(crate) fn changing_law(&self, which: usize, effect: &str) -> Option<(Remark, f64)> {
        // Two levels are not Gaussian.
        if effect == "telegraph" {
            return None;
        }
        let change = constancy::change_of_law(self.axis, which);
        let change = change.filter(|one| one.p_value < self.level())?;
        let band = self.main_band(which);
        let what = format!("as a {effect} whose {}", change.parameter);
        Some((changing(&change, &band, &what), change.log_sd))
    }

    /// The five terms themselves, where their sizes change against one another: noise whose colour
    /// does.
    pub(crate) fn changing_noise(&self) -> Option<Remark> {
        if self.accepted.iter().any(|one| BENDS.contains(&one.effect)) {
            return None;
        }
        let change = constancy::change_of_terms(self.axis);
        let change = change.filter(|one| one.p_value < self.level())?;
        let band = 0.0..0.5 * self.axis.rate_hz;
        Some(changing(
            &change,
            &band,
            &format!("as if {}", change.parameter),
        ))
    }
}

fn changing(change: &Change, band: &Range<f64>, what: &str) -> Remark {
    let time_s = change.time_s;
    let when = if change.cyclic {
        format!("in cycles of {time_s:.3} s")
    } else {
        format!("over {time_s:.2} s")
    };
    Remark {
        test: "steadiness".into(),
        place: band.clone().into(),
        p_value: change.p_value,
        description: format!(
            "noise whose colour and strength change {when}: {what} moved by {:.0} %",
            100.0 * change.log_sd
        ),
    }
}
