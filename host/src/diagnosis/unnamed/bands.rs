//! The bands of noise that a model lacks: one after the other, the one that explains most first.
//!
//! A [dictionary](Dictionary) of peaks, some about zero, is held against the spectrum: how much likelier each would make it with the
//! size that suits it best. The best one is moved until nothing gains and taken in, then all sizes are fitted
//! together; until the best of the dictionary is worth less than it costs (a matching pursuit, S. Mallat and
//! Z. Zhang, IEEE Trans. Signal Process. 41, 1993, by likelihood).

mod needed;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use super::dictionary::{Band, Dictionary};
use super::sizes::Sizes;
use super::with_bands::WithBands;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws;
use crate::diagnosis::laws::gain::Local;
use crate::diagnosis::record::bins::Filtered;
use crate::fit::likelihood::scoring::maximise_beside;
use crate::fit::likelihood::{Data, log_likelihood};
use crate::numeric::mixture::add_mixture;

/// Bands, at most: a choice, twice what any measured record has needed. Where the pursuit ends here, slow times have to do with what was
/// taken in for them at first.
const MOST: usize = 128;

/// Probability of a band too many in a spectrum that has all it needs. That something is missing at all is
/// known by then, at the family's level.
const NEEDLESS: f64 = 0.05;

/// Least width over frequency: a quarter of that of a bin of the spectrum, 5 %. Its bins do not distinguish narrower ones.
const NARROWEST: f64 = 0.25 * 0.05;

/// Moves of a band's middle and width, in widths and as logarithms: the coarse first.
const MOVES: [f64; 3] = [0.25, 0.1, 0.04];

/// Turns of moving, at most, for each size of a move.
const TURNS: usize = 8;

/// Rounds of taking bands in and moving all of them, at most: a choice; two are usual.
const ROUNDS: usize = 6;

/// The model of an axis with bands, and its fit to all of `data` together with the sizes of its `tones`; `None` where no
/// band is worth its cost. The search begins with the bands `known`.
pub fn fitted(
    axis: &AxisState,
    data: &Data,
    tones: &[Vec<f64>],
    known: &[Band],
) -> Option<WithBands> {
    Search::new(axis, data, tones, &[]).completed(known)
}

/// The same beside `tones` that stay as they were measured.
pub fn beside(
    axis: &AxisState,
    data: &Data,
    tones: &[Vec<f64>],
    known: &[Band],
) -> Option<WithBands> {
    Search::new(axis, data, &[], tones).completed(known)
}

/// A model with one more band.
struct Longer {
    band: Band,
    component: Vec<f64>,
    squared: Vec<f64>,
    log_likelihood: f64,
}

struct Search<'a> {
    axis: &'a AxisState,
    /// Its bins behind its filters.
    bins: Filtered<'a>,
    data: &'a Data,
    sizes: Sizes<'a>,
    /// Number of components that are no bands, and how many of them are tones, the last.
    named: usize,
    tones: usize,
    components: Vec<Vec<f64>>,
    squared: Vec<f64>,
    bands: Vec<Band>,
}

impl<'a> Search<'a> {
    fn new(axis: &'a AxisState, data: &'a Data, tones: &[Vec<f64>], measured: &[Vec<f64>]) -> Self {
        let bins = laws::behind(&axis.bins, &axis.laws);
        let mut components = laws::components_of(&bins, &axis.laws);
        let mut squared = axis.fit.squared.clone();
        components.extend_from_slice(tones);
        squared.extend(tones.iter().map(|_| 1.0));
        let mut fixed = bins.fixed();
        add_mixture(&mut fixed, measured, &vec![1.0; measured.len()]);
        let sizes = Sizes::beside(data, fixed);
        let squared = sizes.start(&components, squared);
        Self {
            axis,
            bins,
            data,
            sizes,
            named: components.len(),
            tones: tones.len(),
            components,
            squared,
            bands: Vec::new(),
        }
    }

    /// The model with all bands that are worth their cost, of which some may be `known`.
    fn completed(mut self, known: &[Band]) -> Option<WithBands> {
        self.begin_with(known)?;
        let dictionary = &Dictionary::new(&self.bins, &self.sizes);
        let cost_nats = (dictionary.trials() / NEEDLESS).ln();
        for _ in 0..ROUNDS {
            let before = self.log_likelihood();
            while self.bands.len() < MOST && self.add_best(dictionary, cost_nats).is_some() {}
            if self.bands.is_empty() {
                break;
            }
            self.move_all()?;
            self.drop_worthless(cost_nats);
            if self.log_likelihood() - before < cost_nats {
                break;
            }
        }
        self.finish(cost_nats)
    }

    fn expected(&self) -> Vec<f64> {
        let mut expected = self.sizes.fixed.clone();
        add_mixture(&mut expected, &self.components, &self.squared);
        expected
    }

    fn log_likelihood(&self) -> f64 {
        log_likelihood(self.data, &self.expected())
    }

    /// Moves each band to where it gains most beside all others as they are now, one after the other: the first ones were
    /// taken in when nothing else was there, and made up for what the later ones do.
    fn move_all(&mut self) -> Option<()> {
        for place in 0..self.bands.len() {
            let number = self.named + place;
            let own = std::mem::take(&mut self.squared[number]);
            let others = self.expected();
            let band = self.moved(self.bands[place], &others);
            let component = band.component(&self.bins);
            let squared = band
                .local(&self.bins, &self.sizes)
                .best(self.data, &others)
                .0;
            let worth = |component: &[f64], squared: f64| {
                let mut expected = others.clone();
                add_mixture(&mut expected, &[component.to_vec()], &[squared]);
                log_likelihood(self.data, &expected)
            };
            // Where it is looked at is not all that it does.
            if worth(&component, squared) > worth(&self.components[number], own) {
                self.bands[place] = band;
                self.components[number] = component;
                self.squared[number] = squared;
            } else {
                self.squared[number] = own;
            }
        }
        self.squared = self.sizes.likeliest(&self.components, &self.squared)?.0;
        self.drop_unneeded();
        Some(())
    }

    /// Takes in the band that gains most, if that is more than `cost_nats`.
    fn add_best(&mut self, dictionary: &Dictionary, cost_nats: f64) -> Option<()> {
        let expected = self.expected();
        let (components, squared) = (&self.components, &self.squared);
        let tried = dictionary.promising(self.data, &expected, components, squared);
        let before = log_likelihood(self.data, &expected);
        let fits = tried
            .into_par_iter()
            .filter_map(|band| self.with(band, &expected));
        let better = |a: Longer, b: Longer| {
            if b.log_likelihood > a.log_likelihood {
                b
            } else {
                a
            }
        };
        let mut best = fits.reduce_with(better)?;
        if best.log_likelihood - before <= cost_nats {
            return None;
        }
        let mut others = self.sizes.fixed.clone();
        add_mixture(&mut others, &self.components, &best.squared);
        let moved = self.moved(best.band, &others);
        if let Some(moved) = self.with(moved, &expected) {
            best = better(best, moved);
        }
        self.bands.push(best.band);
        self.components.push(best.component);
        self.squared = best.squared;
        self.drop_unneeded();
        Some(())
    }

    /// The likeliest sizes with one more band.
    fn with(&self, band: Band, expected: &[f64]) -> Option<Longer> {
        let component = band.component(&self.bins);
        let whole = Local {
            first: 0,
            expected: component.clone(),
            most: self.sizes.most(&component),
        };
        let mut start = self.squared.clone();
        start.push(whole.best(self.data, expected).0);
        let components = [self.components.as_slice(), std::slice::from_ref(&component)].concat();
        let (squared, log_likelihood) = self.sizes.likeliest(&components, &start)?;
        Some(Longer {
            band,
            component,
            squared,
            log_likelihood,
        })
    }

    /// Where a band gains most beside `others`: its middle and its width are moved by turns.
    fn moved(&self, band: Band, others: &[f64]) -> Band {
        let gain = |band: Band| {
            band.local(&self.bins, &self.sizes)
                .best(self.data, others)
                .1
        };
        let (least_hz, most_hz) = (self.data.f_hz[0], 0.5 * self.axis.rate_hz);
        let mut best = (band, gain(band));
        for size in MOVES {
            for _ in 0..TURNS {
                let Band { f_hz, width_hz } = best.0;
                let aside = if f_hz > 0.0 { size * width_hz } else { 0.0 };
                let wider = f64::exp(2.0 * size);
                let tried = [
                    (f_hz + aside, width_hz),
                    (f_hz - aside, width_hz),
                    (f_hz, width_hz * wider),
                    (f_hz, width_hz / wider),
                ];
                let tried = tried.into_par_iter().filter_map(|(f_hz, width_hz)| {
                    let least_hz = NARROWEST * f_hz.max(least_hz);
                    let is_inside =
                        (0.0..most_hz).contains(&f_hz) && (least_hz..most_hz).contains(&width_hz);
                    let band = Band { f_hz, width_hz };
                    is_inside.then(|| (band, gain(band)))
                });
                match tried.reduce_with(|a, b| if b.1 > a.1 { b } else { a }) {
                    Some(better) if better.1 > best.1 => best = better,
                    _ => break,
                }
            }
        }
        best.0
    }

    /// The laws with the bands behind them, and the fit of all beside the tones at the sizes that they come to.
    fn finish(mut self, cost_nats: f64) -> Option<WithBands> {
        if self.bands.is_empty() {
            return None;
        }
        let places = self.named - self.tones..self.named;
        let tones: Vec<f64> = self.squared.drain(places.clone()).collect();
        let own: Vec<Vec<f64>> = self.components.drain(places).collect();
        let mut fixed = self.sizes.fixed.clone();
        add_mixture(&mut fixed, &own, &tones);
        let start = Some(self.squared.as_slice());
        let mut fit = maximise_beside(self.data, &self.components, &fixed, start)?;
        fit.expected = self.bins.fixed();
        add_mixture(&mut fit.expected, &self.components, &fit.squared);
        let bands = self.bands.into_iter().map(Band::law);
        let named = self.axis.laws.iter().cloned();
        Some(WithBands {
            laws: named.chain(bands).collect(),
            fit,
            tones,
            cost_nats,
        })
    }
}
