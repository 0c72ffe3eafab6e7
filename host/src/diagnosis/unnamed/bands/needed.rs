//! Bands that a search begins with, and those that it can do without once others are there.

use rayon::prelude::*;

use super::{Band, Search};

impl Search<'_> {
    /// Takes bands in, each as large as suits the spectrum beside the others.
    pub(super) fn begin_with(&mut self, bands: &[Band]) -> Option<()> {
        if bands.is_empty() {
            return Some(());
        }
        for band in bands {
            self.bands.push(*band);
            self.components.push(band.component(&self.bins));
            self.squared.push(0.0);
        }
        let start = self.sizes.start(&self.components, self.squared.clone());
        self.squared = self.sizes.likeliest(&self.components, &start)?.0;
        self.drop_unneeded();
        Some(())
    }

    /// Leaves out one after the other the bands that are not worth their cost beside what was taken in later.
    pub(super) fn drop_worthless(&mut self, cost_nats: f64) {
        let mut before = self.log_likelihood();
        while let Some((place, squared, after)) = self.least_worth() {
            if before - after >= cost_nats {
                break;
            }
            self.bands.remove(place);
            self.components.remove(self.named + place);
            self.squared = squared;
            before = after;
        }
    }

    /// The band without which the spectrum is likeliest, with the sizes of all else and the log-likelihood then.
    fn least_worth(&self) -> Option<(usize, Vec<f64>, f64)> {
        let without = |place: usize| {
            let (mut components, mut squared) = (self.components.clone(), self.squared.clone());
            components.remove(self.named + place);
            squared.remove(self.named + place);
            let start = self.sizes.start(&components, squared);
            let (squared, log_likelihood) = self.sizes.likeliest(&components, &start)?;
            Some((place, squared, log_likelihood))
        };
        let fits = (0..self.bands.len()).into_par_iter().filter_map(without);
        fits.max_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// Leaves out bands that are not needed any more.
    pub(super) fn drop_unneeded(&mut self) {
        for place in (0..self.bands.len()).rev() {
            if self.squared[self.named + place] <= 0.0 {
                self.bands.remove(place);
                self.components.remove(self.named + place);
                self.squared.remove(self.named + place);
            }
        }
    }
}
