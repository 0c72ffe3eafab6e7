//! The bands that noise without a name may be made of: a dictionary of peaks, and of shelves about zero.

use rayon::prelude::*;

use super::sizes::Sizes;
use crate::diagnosis::laws::Law;
use crate::diagnosis::laws::gain::Local;
use crate::diagnosis::laws::rise::Rise;
use crate::diagnosis::record::bins::Filtered;
use crate::fit::likelihood::Data;
use crate::model::unnamed;

/// Widths over middle that are tried at first: from hardly a peak to what a bin of the spectrum, 4.4 % wide,
/// just shows.
const SHARES: [f64; 6] = [1.0, 0.5, 0.25, 0.12, 0.06, 0.03];

/// Bands about zero an octave of their widths.
const SHELVES_PER_OCTAVE: f64 = 2.0;

/// Bands of the dictionary that look alike: neighbours are half a width apart, and the next width is twice as large.
const OVERLAP: f64 = 4.0;

/// Share of what is measured, times the degrees of freedom, over that where both come to most, below which a band does not
/// count in a bin while it is searched for.
const COUNTS: f64 = 1e-3;

/// A band about `f_hz`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Its middle, hertz; zero or above.
    pub f_hz: f64,
    /// Its width at half the power, hertz.
    pub width_hz: f64,
}

impl Band {
    /// As noise of amplitude 1.
    pub fn term(self) -> unnamed::Band {
        unnamed::Band {
            f_hz: self.f_hz,
            width_hz: self.width_hz,
            amplitude: 1.0,
        }
    }

    /// Its law, of amplitude 1.
    pub fn law(self) -> Law {
        Law {
            effect: unnamed::KIND,
            values: vec![self.f_hz, self.width_hz, 1.0],
        }
    }

    /// That of a law, if it is one.
    pub fn of_law(law: &Law) -> Option<Self> {
        match law.values[..] {
            [f_hz, width_hz, _] if law.effect == unnamed::KIND => Some(Self { f_hz, width_hz }),
            _ => None,
        }
    }

    /// What the bins of an axis, behind its filters, are expected to be for an amplitude of 1.
    pub fn component(self, bins: &Filtered<'_>) -> Vec<f64> {
        bins.expect(&self.term())
    }

    /// The same, where it counts beside what is measured.
    pub fn local(self, bins: &Filtered<'_>, sizes: &Sizes<'_>) -> Local {
        let mut all = self.component(bins);
        let most = sizes.most(&all);
        // What is far below the peak may stand out of what is measured there.
        let weights = all.iter().zip(&sizes.measured).zip(&sizes.data.dof);
        let weights: Vec<f64> = weights.map(|((own, psd), dof)| dof * own / psd).collect();
        let greatest = weights.iter().copied().fold(0.0, f64::max);
        let counts = |one: &f64| *one >= COUNTS * greatest;
        let first = weights.iter().position(counts).unwrap_or(0);
        let end = weights.iter().rposition(counts).map_or(0, |last| last + 1);
        all.truncate(end);
        Local {
            first,
            expected: all.split_off(first),
            most,
        }
    }
}

/// Bands to begin with, and how they look.
pub struct Dictionary(Vec<(Band, Local)>);

impl Dictionary {
    /// For the spectrum of an axis, its bins behind its filters.
    pub fn new(bins: &Filtered<'_>, sizes: &Sizes<'_>) -> Self {
        let frequencies = &sizes.data.f_hz;
        let (from_hz, to_hz) = (frequencies[0], frequencies[frequencies.len() - 1]);
        let shelves = (to_hz / from_hz).log2() * SHELVES_PER_OCTAVE;
        let mut bands: Vec<Band> = (0..=shelves as usize)
            .map(|step| Band {
                f_hz: 0.0,
                width_hz: 2.0 * from_hz * (step as f64 / SHELVES_PER_OCTAVE).exp2(),
            })
            .collect();
        for share in SHARES {
            let mut f_hz = from_hz;
            while f_hz < to_hz {
                bands.push(Band {
                    f_hz,
                    width_hz: share * f_hz,
                });
                f_hz *= 1.0 + 0.5 * share;
            }
        }
        let looks = bands.into_par_iter();
        Self(looks.map(|band| (band, band.local(bins, sizes))).collect())
    }

    /// How many of its bands differ.
    pub fn trials(&self) -> f64 {
        self.0.len() as f64 / OVERLAP
    }

    /// Some bands that may gain most beside `components` of these squares, which come to `expected`: the best by itself,
    /// and the best of each breadth where all that is there makes room for it.
    pub fn promising(
        &self,
        data: &Data,
        expected: &[f64],
        components: &[Vec<f64>],
        squared: &[f64],
    ) -> Vec<Band> {
        let rise = Rise::beside_squares(data, expected, components, squared);
        let gains: Vec<[f64; 2]> = self
            .0
            .par_iter()
            .map(|(_, local)| {
                let (_, alone) = local.best(data, expected);
                let whole = local.whole(expected.len());
                [alone, rise.as_ref().map_or(0.0, |rise| rise.of(&whole))]
            })
            .collect();
        let greatest = |way: usize, own: &dyn Fn(&Band) -> bool| {
            let all = self.0.iter().zip(&gains);
            let own = all.filter(|((band, _), gains)| own(band) && gains[way] > 0.0);
            own.max_by(|a, b| a.1[way].total_cmp(&b.1[way]))
                .map(|((band, _), _)| *band)
        };
        let mut best: Vec<Band> = Vec::new();
        best.extend(greatest(0, &|_| true));
        best.extend(greatest(1, &|band| band.f_hz == 0.0));
        for share in SHARES {
            let is_own = |band: &Band| (band.width_hz / band.f_hz / share - 1.0).abs() < 1e-6;
            best.extend(greatest(1, &is_own));
        }
        best
    }
}
