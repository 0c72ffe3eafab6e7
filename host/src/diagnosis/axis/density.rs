//! Densities of an axis's model and of its parts.

use std::ops::Range;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws;
use crate::fit::likelihood::components::SEEN;
use crate::model::effect::Part;
use crate::model::{Coefficient, unnamed};

impl AxisState {
    /// Two-sided density of the fitted model at `f_hz`, chain and filters included.
    pub fn density(&self, f_hz: f64) -> f64 {
        let laws = (0..self.laws.len()).map(|which| self.law_density(which, f_hz));
        let sum = self.bins.base_density(&self.fit.squared, f_hz) + laws.sum::<f64>();
        sum * self.filters(f_hz)
    }

    /// Power that the laws which filter let through.
    pub fn filters(&self, f_hz: f64) -> f64 {
        laws::power_of(&laws::filters(&self.laws), f_hz, self.rate_hz)
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

    /// Share of all of the density that has no name.
    pub fn unnamed_share(&self, f_hz: f64) -> f64 {
        let unnamed = |which: &usize| self.laws[*which].effect == unnamed::KIND;
        let numbers = (0..self.laws.len()).filter(unnamed);
        numbers.map(|which| self.law_share(which, f_hz)).sum()
    }

    /// Share of all of the density that a component of the five terms has.
    pub fn term_share(&self, component: usize, f_hz: f64) -> f64 {
        self.fit.squared[component] * self.component_density(component, f_hz) / self.density(f_hz)
    }

    /// Share of all of the density that noise without a memory has, white and quantisation: it is what swings where the
    /// strength of the noise does. A walk and flicker are sums of what went before, and go on as they were.
    pub fn short_share(&self, f_hz: f64) -> f64 {
        let short = (0..).zip(SEEN);
        let short = short.filter(|(_, term)| matches!(term, Coefficient::N | Coefficient::Q));
        let share: f64 = short.map(|(one, _)| self.term_share(one, f_hz)).sum();
        share.min(1.0)
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
