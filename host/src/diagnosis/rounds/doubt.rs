//! Names that are given back: the effect explains some of what it was named for, but what is there
//! does not behave as the effect does.

use crate::diagnosis::doubt::lopsided;
use crate::diagnosis::doubt::steadiness;
use crate::diagnosis::laws::departure::{self, Departure};
use crate::diagnosis::record::residual::Wave;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::rounds::Rounds;
use crate::diagnosis::rounds::steady;

/// Shares of the density, the largest that a law reaches somewhere tells its band.
const SHARES: [f64; 4] = [0.5, 0.25, 0.1, 0.03];

/// Standard deviation of a parameter's logarithm that is little.
const LITTLE: f64 = 0.15;

/// What becomes of a law's name, and what there is to say.
enum Verdict {
    /// It stays.
    Keeps(Option<Remark>),
    /// It is none.
    GivesBack(Option<Remark>),
}

impl Rounds<'_> {
    /// Takes back what the record speaks against; remarks on each.
    pub(crate) fn doubts(&mut self) -> Option<Vec<Remark>> {
        self.tops()?;
        let mut remarks = std::mem::take(&mut self.unsteady);
        remarks.extend(self.lopsided()?);
        let level = self.level();
        let left = departure::departure(&self.axis.data, &self.axis.fit.expected)
            .filter(|one| one.p_value < level);
        let mut given_back = Vec::new();
        for which in 0..self.axis.laws.len() {
            let Some(place) = self.accepted.iter().position(|one| one.law == Some(which)) else {
                continue;
            };
            let effect = self.accepted[place].effect;
            remarks.extend(match self.verdict(which, effect, left.as_ref()) {
                Verdict::Keeps(remark) => remark,
                Verdict::GivesBack(remark) => {
                    self.accepted.remove(place);
                    given_back.push(which);
                    remark
                }
            });
        }
        self.forget_laws(&given_back)?;
        if remarks.is_empty() {
            remarks.extend(self.changing_noise());
        }
        Some(remarks)
    }

    /// What the record says of a law's name.
    fn verdict(&self, which: usize, effect: &str, left: Option<&Departure>) -> Verdict {
        if effect == "resonance" && self.is_skirt(which) {
            return Verdict::GivesBack(None);
        }
        // Where all of the noise is unsteady, what moves a little may still be what it is.
        let unsteady = self.restless || !self.axis.apart.is_empty();
        let moves = match self.changing_law(which, effect) {
            Some((remark, log_sd)) if !unsteady || log_sd > LITTLE => {
                return Verdict::GivesBack(Some(remark));
            }
            other => other.map(|(remark, _)| remark),
        };
        let doubt = self
            .unsteady_law(which, effect)
            .or_else(|| self.misfit(which, effect, left));
        doubt.map_or(Verdict::Keeps(moves), |doubt| {
            Verdict::GivesBack(Some(doubt))
        })
    }

    /// Fits without laws that were given back: the model holds what has a name, and no more.
    fn forget_laws(&mut self, given_back: &[usize]) -> Option<()> {
        if given_back.is_empty() {
            return Some(());
        }
        let mut number = 0;
        self.axis.laws.retain(|_| {
            number += 1;
            !given_back.contains(&(number - 1))
        });
        for one in &mut self.accepted {
            let before = |law: usize| given_back.iter().filter(|&&gone| gone < law).count();
            one.law = one.law.map(|law| law - before(law));
        }
        self.axis.refresh()
    }

    /// Whether a resonance is what is left beside a band that was left out.
    fn is_skirt(&self, which: usize) -> bool {
        let [f_hz, width_hz, ..] = self.axis.laws[which].values[..] else {
            return false;
        };
        let apart = self.axis.apart.iter();
        let near = |band: &std::ops::Range<f64>| {
            band.start < f_hz + width_hz && f_hz - width_hz < band.end
        };
        apart.into_iter().any(near)
    }

    /// Takes back lines that are tops of a resonance.
    fn tops(&mut self) -> Option<()> {
        let rate_hz = self.axis.rate_hz;
        let rings = self.resonances();
        let is_top = |f_hz: f64| rings.iter().any(|band| band.contains(&f_hz));
        let before = self.axis.mended.waves.len();
        self.axis
            .mended
            .waves
            .retain(|wave| !matches!(wave, Wave::Line { cycles, .. } if is_top(cycles * rate_hz)));
        if self.axis.mended.waves.len() < before {
            self.accepted.retain(|one| {
                let f_hz = one.parameters.get("f_hz").map_or(0.0, |f_hz| f_hz.value);
                one.effect != "sinusoid" || !is_top(f_hz)
            });
            self.axis.refresh()?;
        }
        Some(())
    }

    /// Where a law makes most of the spectrum, or what it makes at most.
    pub(crate) fn main_band(&self, which: usize) -> std::ops::Range<f64> {
        let bands = SHARES.iter().map(|&share| self.band_of(which, share));
        bands
            .into_iter()
            .find(|band| band.end > band.start)
            .unwrap_or(0.0..0.0)
    }

    /// A law of steady noise where the noise is not steady.
    fn unsteady_law(&self, which: usize, effect: &str) -> Option<Remark> {
        // Filters act on all noise alike; two levels are not Gaussian.
        let adds = self.axis.laws[which].effect.size().is_some();
        if !adds || effect == "telegraph" {
            return None;
        }
        let band = self.main_band(which);
        let unsteady = |band| steadiness::unsteady(self.axis, band, &self.axis.apart, self.level());
        let half_hz = 0.5 * self.axis.rate_hz;
        let found = unsteady(band.clone())?;
        // What moves everywhere is no matter of this law.
        if self.restless {
            let outside = unsteady(0.0..band.start).or(unsteady(band.end..half_hz));
            if outside.is_some_and(|one| 2.0 * one.variance.abs() > found.variance.abs()) {
                return None;
            }
        }
        let mut remark = steady::remark(&found);
        remark.description = format!(
            "{}; a {effect} has the same mean spectrum, but would be steady",
            remark.description
        );
        Some(remark)
    }

    /// A law in whose band the model still fails.
    fn misfit(&self, which: usize, effect: &str, left: Option<&Departure>) -> Option<Remark> {
        let left = left?;
        let band = self.main_band(which);
        (band.start < left.to_hz && left.from_hz < band.end).then(|| Remark {
            test: "spectrum".into(),
            place: band.clone().into(),
            p_value: self
                .accepted
                .iter()
                .find(|one| one.law == Some(which))
                .map_or(left.p_value, |one| one.p_value),
            description: format!(
                "power that a {effect} comes nearest to, without agreeing with it"
            ),
        })
    }

    /// A law of amplitudes that is not the same on both sides, and outliers that are its tail.
    fn lopsided(&mut self) -> Option<Option<Remark>> {
        // These bend the law of amplitudes themselves.
        let bends = ["clipping", "quantisation", "telegraph"];
        if self.accepted.iter().any(|one| bends.contains(&one.effect)) {
            return Some(None);
        }
        let found = lopsided::lopsided(self.axis);
        if found.p_value >= self.level() {
            return Some(None);
        }
        let side = found.skewness.signum();
        // Its tail passes for them.
        if self.withdraw("outliers") {
            self.axis.refresh()?;
        }
        Some(Some(Remark {
            test: "amplitude".into(),
            place: if side > 0.0 {
                Place::UpperSide
            } else {
                Place::LowerSide
            },
            p_value: found.p_value,
            description: format!(
                "the law of amplitudes is lopsided, its tail longer on that side: skewness {:.2} \
                 of the noise's whitened samples; something one-sided joins the noise behind all \
                 filters",
                found.skewness
            ),
        }))
    }
}
