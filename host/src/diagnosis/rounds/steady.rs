//! Bands of noise that no steady law speaks for.

use crate::diagnosis::doubt::steadiness::{self, Unsteady};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::rounds::Rounds;
use crate::model::effect::Part;

/// Share of the ordinates that a band may hold: a wider one is not a band but all of the noise.
const NARROW: f64 = 0.25;

/// Samples of a stretch that is no shock.
pub(crate) const LONG: usize = 1024;

/// Bands at most.
const MOST: usize = 6;

/// Frequency, times the dwell, up to which jumps leave something.
const LEFT_OF_JUMPS: f64 = 30.0;

/// Share of the density from which a law decides what the noise there looks like.
const DECIDES: f64 = 0.1;

impl Rounds<'_> {
    /// Takes the least steady band out of what fits and tests look at, and remarks on it.
    pub(crate) fn steady(&mut self) -> Option<bool> {
        if self.axis.apart.len() == MOST {
            return Some(false);
        }
        let half_hz = 0.5 * self.axis.rate_hz;
        let mut apart = self.axis.apart.clone();
        apart.extend(self.switching_band());
        let Some(found) = steadiness::unsteady(self.axis, 0.0..half_hz, &apart, self.level())
        else {
            return Some(false);
        };
        if found.to_hz - found.from_hz > NARROW * half_hz {
            return Some(false);
        }
        if self.is_of_outliers(&found) {
            return Some(false);
        }
        // A loud stretch shows in every band, and in some by more than in others; a short one may be a
        // shock that rings.
        let burst = self.even_burst();
        if burst.is_some_and(|burst| burst.range.len() >= LONG) {
            return Some(false);
        }
        if self.switching_law()? {
            return Some(true);
        }
        let band = found.from_hz..found.to_hz;
        self.set_band_apart(&found, band);
        // What was named while the band was still in may have been named for it.
        self.withdraw("outliers");
        let jumps = self.axis.mended.jumps();
        let moments: Vec<_> = jumps.map(|jump| jump.index..jump.index + 1).collect();
        if self.is_of_band(&moments) {
            self.withdraw("steps");
        }
        self.axis.laws.clear();
        self.accepted.retain(|one| one.law.is_none());
        self.switching = false;
        self.axis.refresh_jumps()?;
        Some(true)
    }

    /// Leaves a band out, joined with one beside it.
    fn set_band_apart(&mut self, found: &Unsteady, band: std::ops::Range<f64>) {
        let width = band.end - band.start;
        let beside = |one: &std::ops::Range<f64>| {
            one.start < band.end + width && band.start - width < one.end
        };
        let joined = self.axis.apart.iter().position(beside);
        let Some(joined) = joined else {
            self.unsteady.push(remark(found));
            self.axis.apart.push(band);
            return;
        };
        let old = self.axis.apart[joined].clone();
        let all = old.start.min(band.start)..old.end.max(band.end);
        for one in &mut self.unsteady {
            if let Place::Band { ends_hz, .. } = &mut one.place
                && *ends_hz == [old.start, old.end]
            {
                *ends_hz = [all.start, all.end];
            }
        }
        self.axis.apart[joined] = all;
    }

    /// Whether a band is as unsteady as outliers make it that are too small to be told one by one,
    /// which shows where the noise is least. `n` samples of size `s` a second have the density
    /// `n s^2 / rate^2`; where that is the share `m` of all, and sizes are normal, the strength of tiles
    /// of duration `t` has the relative variance `3 m^2 / (n t)` (Campbell's theorem).
    fn is_of_outliers(&self, found: &Unsteady) -> bool {
        /// Share of what is seen that they must explain: their law is known to some factor.
        const MOST_OF_IT: f64 = 0.3;
        let outliers = self.accepted.iter().find(|one| one.effect == "outliers");
        let Some([count_hz, size]) = outliers.and_then(|one| {
            let value = |name| Some(one.parameters.get(name)?.value);
            Some([value("rate_hz")?, value("size")?])
        }) else {
            return false;
        };
        let density = count_hz * (size / self.axis.rate_hz).powi(2);
        let share = (density / self.axis.density(found.peak_hz)).min(1.0);
        let variance = 3.0 * share * share / (count_hz * found.tile_s);
        variance > MOST_OF_IT * found.variance && found.variance > 0.0
    }

    /// Where two levels decide what the noise looks like: Gaussian it is not.
    fn switching_band(&self) -> Option<std::ops::Range<f64>> {
        let telegraph = self.accepted.iter().find(|one| one.effect == "telegraph")?;
        let end_hz = match telegraph.law {
            Some(law) => self.band_of(law, DECIDES).end,
            // Told jump by jump: what is left of them fades within some tens of 1 / dwell.
            None => LEFT_OF_JUMPS / telegraph.parameters.get("dwell_s")?.value,
        };
        Some(0.0..end_hz)
    }

    /// Between which frequencies law number `which` makes at least `share` of the density; for a
    /// filter, where it takes away as much.
    pub(crate) fn band_of(&self, which: usize, share: f64) -> std::ops::Range<f64> {
        let axis = &*self.axis;
        let law = &axis.laws[which];
        let part = law.effect.part(&law.values);
        let decides = |f_hz: f64| match &part {
            Part::Term(_) => axis.law_density(which, f_hz) >= share * axis.density(f_hz),
            Part::Distortion(filter) => filter.power(f_hz, axis.rate_hz) <= 1.0 - share,
            Part::Clock(_) | Part::Follows(_) => false,
        };
        let bins = axis.frame.bins().iter().map(|bin| bin.f_hz);
        let inside: Vec<f64> = bins.filter(|&f_hz| decides(f_hz)).collect();
        match (inside.first(), inside.last()) {
            (Some(&from_hz), Some(&to_hz)) => from_hz..to_hz,
            _ => 0.0..0.0,
        }
    }
}

/// In words.
pub(crate) fn remark(found: &Unsteady) -> Remark {
    let Unsteady {
        from_hz,
        to_hz,
        peak_hz,
        tile_s,
        variance,
        p_value,
        ..
    } = *found;
    let description = if variance < 0.0 {
        "power that is steadier than noise: a tone that wanders within the band".into()
    } else {
        format!(
            "power whose strength changes in time, by {:.0} % over {tile_s:.2} s: a tone that \
             wanders or is switched, shocks that ring, or noise that comes and goes",
            100.0 * variance.sqrt()
        )
    };
    Remark {
        test: "steadiness".into(),
        place: Place::Band {
            ends_hz: [from_hz, to_hz],
            peak_hz: Some(peak_hz),
        },
        p_value,
        description,
    }
}
