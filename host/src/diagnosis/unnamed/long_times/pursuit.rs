//! The search for bands that an Allan deviation lacks: one after the other, sizes that suit all variances best.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::result::views::{AllanPoint, SpectrumPoint};
use crate::diagnosis::unnamed::dictionary::Band;
use crate::fit::least_squares::solve_non_negative;
use crate::model::Term;

/// Bands, at most: a choice. Every subset of them is tried for sizes that are not below zero, 64 at most.
const MOST: usize = 6;

/// Widths that are tried an octave, from that whose noise is slower than the longest averages to that which turns once in the
/// shortest that lack anything: a choice, as many as of the shelves that a spectrum is held against. Faster noise would
/// fill what is quiet between the lines of a record, which the Allan deviation of its short averages, theirs, does not show.
const PER_OCTAVE: f64 = 2.0;

/// Standard deviations, tolerance included, from which a variance lacks something by itself: a choice, 5 % of the deviation
/// where sampling is no matter.
const LACKS: f64 = 2.0;

/// Probability of a band too many where something is missing.
pub const NEEDLESS: f64 = 0.05;

/// What a density may be off by beside chance: 1 dB, as third octaves are compared.
const SPECTRUM_TOLERANCE: f64 = 0.26;

/// What an Allan variance may be off by beside chance: 1 % of the deviation, as models are compared.
pub const TOLERANCE: f64 = 0.02;

/// Probability of a gain by chance, in nats, of the best of so many bands.
pub fn by_gain(nats: f64, bands: usize) -> f64 {
    (bands as f64 * (-nats).exp()).min(1.0)
}

/// Bands that a pursuit found.
pub struct Found {
    /// Each with the square of its amplitude.
    pub bands: Vec<(Band, f64)>,
    /// Gain of the first, nats.
    first_nats: f64,
    /// Gain of all of them, nats.
    pub nats: f64,
}

impl Found {
    /// Probability of the first by chance, as the best of a dictionary of so many.
    pub fn p_value(&self, bands: usize) -> f64 {
        by_gain(self.first_nats, bands)
    }

    /// Log-likelihood of a spectrum with them less that without, where it is no gain: it is the same record. A third octave is
    /// known as well as its freedom says, and the model of it to [`SPECTRUM_TOLERANCE`].
    pub fn room_nats(&self, spectrum: &[SpectrumPoint], rate_hz: f64) -> f64 {
        let of_bands = |f_hz: f64| {
            let of_band =
                |(band, squared): &(Band, f64)| squared * band.term().spectrum(f_hz, rate_hz);
            self.bands.iter().map(of_band).sum::<f64>()
        };
        let change = |third: &[SpectrumPoint]| {
            let weighed = |of: &dyn Fn(&SpectrumPoint) -> f64| -> f64 {
                third.iter().map(|point| point.edf * of(point)).sum()
            };
            let edf = weighed(&|_| 1.0);
            let psd = weighed(&|point| point.psd) / edf;
            let after = weighed(&|point| point.after) / edf;
            let with = after + weighed(&|point| of_bands(point.f_hz)) / edf;
            let known = 2.0 / edf + SPECTRUM_TOLERANCE * SPECTRUM_TOLERANCE;
            let change = psd / after - psd / with - (with / after).ln();
            if after > 0.0 { change / known } else { 0.0 }
        };
        thirds(spectrum).map(change).sum::<f64>().min(0.0)
    }
}

/// Points of a spectrum in third octaves, by ascending frequency.
fn thirds(mut points: &[SpectrumPoint]) -> impl Iterator<Item = &[SpectrumPoint]> {
    std::iter::from_fn(move || {
        let end_hz = points.first()?.f_hz * (1.0_f64 / 3.0).exp2();
        let (third, later) = points.split_at(points.partition_point(|point| point.f_hz < end_hz));
        points = later;
        Some(third)
    })
}

/// The search for bands.
pub struct Pursuit {
    /// What is missing of each variance, in its standard deviations.
    missing: DVector<f64>,
    /// All bands, and what each adds for an amplitude of 1, in the same.
    pub dictionary: Vec<(Band, DVector<f64>)>,
}

impl Pursuit {
    /// For these points of a record and its model.
    pub fn new(points: &[&AllanPoint], rate_hz: f64) -> Self {
        let deviation = |point: &AllanPoint| {
            let variance = point.adev.max(point.after).powi(2);
            variance * (2.0 / point.edf).sqrt().hypot(TOLERANCE)
        };
        let missing: Vec<f64> = points
            .iter()
            .map(|point| (point.adev.powi(2) - point.after.powi(2)) / deviation(point))
            .collect();
        let mut pairs = points.iter().zip(&missing);
        let first = pairs.find(|(_, missing)| **missing > LACKS);
        let half_hz = 0.5 * rate_hz;
        let fastest_hz = first.map_or(half_hz, |(point, _)| half_hz.min(point.tau_s.recip()));
        let longest_s = points.last().map_or(0.0, |point| point.tau_s);
        // A twentieth of its turn passes within the longest average: over all of them its variance still grows.
        let slowest_hz = 0.05 / longest_s;
        let steps = ((fastest_hz / slowest_hz).log2() * PER_OCTAVE).max(0.0) as usize;
        let entry = |step: usize| {
            let band = Band {
                f_hz: 0.0,
                width_hz: slowest_hz * (step as f64 / PER_OCTAVE).exp2(),
            };
            let term = band.term();
            let adds = points
                .iter()
                .map(|point| term.allan_variance(point.m, rate_hz) / deviation(point));
            (band, DVector::from_iterator(points.len(), adds))
        };
        Self {
            missing: DVector::from_vec(missing),
            dictionary: (0..=steps).map(entry).collect(),
        }
    }

    /// Those of the slowest `entries` bands that are worth their cost: the first at a `level`, further ones where something is
    /// missing.
    pub fn bands(&self, entries: usize, level: f64) -> Found {
        let cost_nats = |probability: f64| (self.dictionary.len() as f64 / probability).ln();
        let mut chosen: Vec<usize> = Vec::new();
        let (mut squared, mut misfit) = (DVector::zeros(0), self.missing.norm_squared());
        let (whole, mut first_nats) = (misfit, 0.0);
        while chosen.len() < MOST {
            let others = (0..entries).filter(|one| !chosen.contains(one));
            let fits = others.map(|one| (one, self.fitted(&[chosen.as_slice(), &[one]].concat())));
            let Some((one, (next, left))) = fits.min_by(|a, b| a.1.1.total_cmp(&b.1.1)) else {
                break;
            };
            let nats = 0.5 * (misfit - left);
            let is_first = chosen.is_empty();
            if nats <= cost_nats(if is_first { level } else { NEEDLESS }) {
                break;
            }
            if is_first {
                first_nats = nats;
            }
            chosen.push(one);
            (squared, misfit) = (next, left);
        }
        let both = chosen.into_iter().zip(squared.iter().copied());
        let bands = both
            .filter(|(_, squared)| *squared > 0.0)
            .map(|(one, squared)| (self.dictionary[one].0, squared))
            .collect();
        Found {
            bands,
            first_nats,
            nats: 0.5 * (whole - misfit),
        }
    }

    /// Squares of the amplitudes of some bands, and what they leave.
    fn fitted(&self, chosen: &[usize]) -> (DVector<f64>, f64) {
        let columns: Vec<DVector<f64>> = chosen
            .iter()
            .map(|&one| self.dictionary[one].1.clone())
            .collect();
        let a = DMatrix::from_columns(&columns);
        let squared = solve_non_negative(&a, &self.missing);
        let left = (&a * &squared - &self.missing).norm_squared();
        (squared, left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 100.0;

    /// A white spectrum of density 1 that a model expects, and `of` it what was measured.
    fn spectrum(of: impl Fn(f64) -> f64) -> Vec<SpectrumPoint> {
        let at = |step: i32| 0.01 * (f64::from(step) / 12.0).exp2();
        let point = |f_hz: f64| SpectrumPoint {
            f_hz,
            psd: of(f_hz),
            lo: 0.0,
            hi: 0.0,
            edf: 100.0,
            before: 1.0,
            after: 1.0,
            simulated: None,
        };
        (0..140).map(|step| point(at(step))).collect()
    }

    #[test]
    fn a_spectrum_has_room_only_for_what_it_lacks() {
        let band = Band {
            f_hz: 0.0,
            width_hz: 1.0,
        };
        let found = Found {
            bands: vec![(band, 4.0)],
            first_nats: 0.0,
            nats: 0.0,
        };
        let added = |f_hz: f64| 4.0 * band.term().spectrum(f_hz, RATE_HZ);
        // It was there all the time: a gain, which is counted already.
        assert_eq!(
            found.room_nats(&spectrum(|f_hz| 1.0 + added(f_hz)), RATE_HZ),
            0.0
        );
        // Twice as loud where it is, for some octaves: several tolerances each.
        let nats = found.room_nats(&spectrum(|_| 1.0), RATE_HZ);
        assert!(nats < -10.0, "{nats}");
        // A tenth of a decibel is within them.
        let faint = Found {
            bands: vec![(band, 0.04)],
            ..found
        };
        let nats = faint.room_nats(&spectrum(|_| 1.0), RATE_HZ);
        assert!((-0.5..=0.0).contains(&nats), "{nats}");
    }
}
