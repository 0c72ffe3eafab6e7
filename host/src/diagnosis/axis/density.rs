//! Densities of an axis's model and of its parts.

use std::ops::Range;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws;
use crate::fit::likelihood::components::SEEN;
use crate::model::effect::{Part, Stage};
use crate::model::{Coefficient, unnamed};

impl AxisState {
    /// Two-sided density of the fitted model at `f_hz`, chain and filters included.
    pub fn density(&self, f_hz: f64) -> f64 {
        let laws = (0..self.laws.len()).map(|which| self.law_density(which, f_hz));
        let sum = self.bins.base_density(&self.fit.squared, f_hz) + laws.sum::<f64>();
        sum * self.filters(f_hz) + self.floor()
    }

    /// Density of what joins behind the laws that filter; zero where none does.
    pub fn floor(&self) -> f64 {
        laws::floor(&self.bins, &self.laws)
    }

    /// Two-sided density at `f_hz` as the bins measure it, with what the model lacks.
    pub fn measured_density(&self, f_hz: f64) -> f64 {
        self.density(f_hz) * self.between_bins(f_hz, |log, _| log)
    }

    /// Power that the laws which filter let through, as a record shows it.
    pub fn filters(&self, f_hz: f64) -> f64 {
        self.shown_from(Stage::Coupling, f_hz)
    }

    /// The same of what happens to the level, which joins [behind a coupling](Stage::Coupling).
    pub fn level_filters(&self, f_hz: f64) -> f64 {
        self.shown_from(Stage::Noise, f_hz)
    }

    fn shown_from(&self, stage: Stage, f_hz: f64) -> f64 {
        let mut filters = laws::filters(&self.laws);
        filters.retain(|one| one.stage() >= stage);
        laws::shown_of(&filters, f_hz, self.rate_hz)
    }

    /// Whether any of the laws filters what happens to the level.
    pub fn filters_level(&self) -> bool {
        let filters = laws::filters(&self.laws);
        filters.iter().any(|one| one.stage() > Stage::Coupling)
    }

    /// Its part that law number `which` adds, filters not included.
    pub fn law_density(&self, which: usize, f_hz: f64) -> f64 {
        self.unit_law_density(which, f_hz).map_or(0.0, |density| {
            density * self.fit.squared[laws::component_of(&self.bins, &self.laws, which)]
        })
    }

    /// The same for a component of square 1; `None` for a law that filters.
    pub fn unit_law_density(&self, which: usize, f_hz: f64) -> Option<f64> {
        let law = &self.laws[which];
        match law.effect.part(&law.values) {
            Part::Term(term) => {
                Some(self.bins.term_density(&*term, f_hz) * self.bins.chain_power(f_hz))
            }
            Part::Distortion(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => None,
        }
    }

    /// Share of all of the density that law number `which` adds.
    pub fn law_share(&self, which: usize, f_hz: f64) -> f64 {
        self.law_density(which, f_hz) * self.filters(f_hz) / self.density(f_hz)
    }

    /// Bands, hertz, in which half of the density or more has no name, as the bins see it.
    pub fn unnamed_hz(&self) -> Vec<Range<f64>> {
        let is_unnamed = |which: &usize| self.laws[*which].effect == unnamed::KIND;
        let unnamed: Vec<usize> = (0..self.laws.len()).filter(is_unnamed).collect();
        if unnamed.is_empty() {
            return Vec::new();
        }
        let has_none = |f_hz: f64| {
            let of = |which: &usize| self.law_density(*which, f_hz);
            let own = unnamed.iter().map(of).sum::<f64>() * self.filters(f_hz);
            own >= 0.5 * self.density(f_hz)
        };
        let mut f_hz: Vec<f64> = self.bins.all().iter().map(|bin| bin.f_hz).collect();
        f_hz.sort_by(f64::total_cmp);
        let places = (0..f_hz.len()).filter(|&place| has_none(f_hz[place]));
        let mut bands: Vec<Range<f64>> = Vec::new();
        for place in places {
            // Half of the way to the bins beside it.
            let end = |other: usize| f_hz.get(other).map(|other| 0.5 * (f_hz[place] + other));
            let start_hz = place.checked_sub(1).and_then(end).unwrap_or(0.0);
            let end_hz = end(place + 1).unwrap_or(0.5 * self.rate_hz);
            match bands.last_mut().filter(|last| last.end >= start_hz) {
                Some(last) => last.end = end_hz,
                None => bands.push(start_hz..end_hz),
            }
        }
        bands
    }

    /// Share of all of the density that a component of the five terms has.
    pub fn term_share(&self, component: usize, f_hz: f64) -> f64 {
        self.fit.squared[component] * self.component_density(component, f_hz) / self.density(f_hz)
    }

    /// Share of all of the density that noise without a memory has, white and quantisation: it is what swings where the
    /// strength of the noise does. A walk and flicker are sums of what went before, and go on as they were; one that may as
    /// well be none would be all there is where the strength swings to nothing, and counts as none.
    pub fn short_share(&self, f_hz: f64) -> f64 {
        /// Standard deviations from which a walk or flicker is there: a choice, one record in a thousand has less.
        const THERE: f64 = 3.0;
        let (mut short, mut none) = (0.0, 0.0);
        for (one, term) in (0..).zip(SEEN) {
            let sd = self.fit.covariance[(one, one)].sqrt();
            if matches!(term, Coefficient::N | Coefficient::Q) {
                short += self.term_share(one, f_hz);
            } else if self.fit.squared[one] < THERE * sd {
                none += self.term_share(one, f_hz);
            }
        }
        if short > 0.0 {
            (short / (1.0 - none)).min(1.0)
        } else {
            0.0
        }
    }

    /// The same in the mean over some ordinates of a transform with so many hertz between two.
    pub fn mean_short_share(&self, ordinates: &Range<usize>, spacing_hz: f64) -> f64 {
        /// Ordinates that are asked, at most: a choice. Shares change smoothly.
        const ASKED: usize = 256;
        let stride = ordinates.len().div_ceil(ASKED).max(1);
        let asked = ordinates.clone().skip(stride / 2).step_by(stride);
        let shares = asked.map(|k| self.short_share(k as f64 * spacing_hz));
        let (sum, count) = shares.fold((0.0, 0.0), |(sum, count), one| (sum + one, count + 1.0));
        if count > 0.0 { sum / count } else { 1.0 }
    }

    /// Density of a component of the five terms whose square is 1.
    pub fn component_density(&self, component: usize, f_hz: f64) -> f64 {
        self.bins.unit_density(component, f_hz, self.filters(f_hz))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::trial::{RATE_HZ, axis, short};

    const SEED: u64 = 1;

    #[test]
    fn a_walk_that_is_not_resolved_is_no_floor_where_the_strength_swings() {
        let mut axis = axis(SEED, short(SEED), |_, noise| noise);
        let walk = SEEN
            .iter()
            .position(|term| *term == Coefficient::K)
            .expect("a walk among the terms");
        let f_hz = 0.01 * RATE_HZ;
        // As much of it as of all else there.
        let unit = axis.component_density(walk, f_hz);
        axis.fit.squared[walk] = 0.0;
        axis.fit.squared[walk] = axis.density(f_hz) / unit;
        let squared = axis.fit.squared[walk];
        let mut share = |deviations: f64| {
            axis.fit.covariance[(walk, walk)] = (squared / deviations).powi(2);
            axis.short_share(f_hz)
        };
        let (unresolved, resolved) = (share(2.0), share(10.0));
        assert!(resolved < 0.51, "{resolved}, seed {SEED}");
        assert!(unresolved > 1.9 * resolved, "{unresolved}, seed {SEED}");
    }
}
