//! Laws of the noise that are given back: the spectrum has their shape, but what is there does not behave as
//! they do.

use std::ops::Range;

use super::{Doubt, Hearing, colour};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::{spectral, unsteady_band};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::steady;
use crate::model::kind::Kind;
use crate::model::{resonance, telegraph};

/// Shares of the density, the largest that a law reaches somewhere delimits its band: choices, from
/// most of it down to what can hardly be seen.
const SHARES: [f64; 4] = [0.5, 0.25, 0.1, 0.03];

/// Standard deviation of a parameter's logarithm that is little: a choice. What is so plain that a movement by a quarter
/// is seen is what it is; a corner that goes to and fro moves by half.
const LITTLE: f64 = 0.25;

/// Hears every law. Its test of the colour is counted with that of the five terms, and its test of steadiness
/// with the detector of unsteady bands.
pub static DOUBT: Doubt = Doubt {
    tests: 0,
    why: "what is there does not behave as it",
    hear,
};

/// What becomes of a law's name, and what there is to say.
enum Verdict {
    /// The name stays, perhaps with a remark.
    Keeps(Option<Remark>),
    /// The name is taken back, perhaps with a remark.
    GivesBack(Option<Remark>),
}

/// A law with its name.
struct Case<'a> {
    axis: &'a AxisState,
    level: f64,
    strength_moves: bool,
    which: usize,
    kind: Kind,
}

fn hear(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    let axis = &*hearing.axis;
    let laws = axis.explanations().iter();
    let laws = laws.filter(|one| one.law().is_some()).enumerate();
    let verdicts = laws.map(|(which, one)| {
        let case = Case {
            axis,
            level: hearing.level,
            strength_moves: hearing.strength_moves,
            which,
            kind: one.kind(),
        };
        case.verdict()
    });
    let verdicts: Vec<Verdict> = verdicts.collect();
    let mut gone = Vec::new();
    for (which, verdict) in verdicts.into_iter().enumerate() {
        hearing.remarks.extend(match verdict {
            Verdict::Keeps(remark) => remark,
            Verdict::GivesBack(remark) => {
                gone.push(which);
                remark
            }
        });
    }
    if gone.is_empty() {
        return Ok(());
    }
    // Fitted without: the model holds what has a name, and no more.
    hearing.axis.withdraw_laws(&gone);
    hearing.axis.refresh()
}

impl Case<'_> {
    /// What the record says of the law's name.
    fn verdict(&self) -> Verdict {
        if self.kind == resonance::KIND && self.is_skirt() {
            return Verdict::GivesBack(None);
        }
        let band_hz = self.main_band_hz();
        let moves = colour::of_law(self.axis, self.level, self.which, self.kind, &band_hz);
        let moves = match moves {
            Some((remark, log_sd)) if log_sd > LITTLE => {
                return Verdict::GivesBack(Some(remark));
            }
            other => other.map(|(remark, _)| remark),
        };
        self.unsteady(&band_hz)
            .map_or(Verdict::Keeps(moves), |doubt| {
                Verdict::GivesBack(Some(doubt))
            })
    }

    /// Whether a resonance is what is left next to a band that is excluded.
    fn is_skirt(&self) -> bool {
        let [f_hz, width_hz, ..] = self.axis.laws[self.which].values[..] else {
            return false;
        };
        let mut excluded = self.axis.excluded().iter().map(|one| &one.band_hz);
        excluded.any(|band| band.start < f_hz + width_hz && f_hz - width_hz < band.end)
    }

    /// Where the law makes most of the spectrum, or what it makes at most.
    fn main_band_hz(&self) -> Range<f64> {
        let bands = SHARES.map(|share| spectral::band_of(self.axis, self.which, share));
        let mut bands = bands.into_iter();
        bands.find(|band| band.end > band.start).unwrap_or(0.0..0.0)
    }

    /// A law of steady noise where the noise is not steady.
    fn unsteady(&self, band_hz: &Range<f64>) -> Option<Remark> {
        // Filters act on all noise alike; two levels are not Gaussian.
        let adds = self.axis.laws[self.which].effect.size().is_some();
        if !adds || self.kind == telegraph::KIND {
            return None;
        }
        let excluded_hz = self.axis.excluded_hz();
        let unsteady =
            |band_hz| steady::noise::unsteady(self.axis, band_hz, &excluded_hz, self.level);
        let half_hz = 0.5 * self.axis.rate_hz;
        let found = unsteady(band_hz.clone())?;
        // What moves everywhere is no matter of this law.
        if self.strength_moves {
            let outside = unsteady(0.0..band_hz.start).or(unsteady(band_hz.end..half_hz));
            if outside.is_some_and(|one| 2.0 * one.variance.abs() > found.variance.abs()) {
                return None;
            }
        }
        let mut remark = unsteady_band::remark(&found);
        remark.description = format!(
            "{}; a {} has the same mean spectrum, but would be steady",
            remark.description, self.kind
        );
        Some(remark)
    }
}

#[cfg(test)]
mod tests;
