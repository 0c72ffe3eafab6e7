//! A stretch in which something moves the sensor: about which frequencies, how strongly, and how it lies afterwards.
//!
//! What it is over the line between the levels before and after is held against bands of noise that are let in for as
//! long, beside the noise that is always there, by Whittle's likelihood of its periodogram; how strong they are, their energy says.

use std::ops::Range;

use super::about::About;
use super::bands;
use super::bands::bands;
use super::course::{deflection, levels, of_strength};
use super::described::described;
use super::fading::fading;
use super::strength::{Beside, Inside};
use crate::model::unnamed::Band;
use crate::numeric::order::median;

/// Standard deviations of what levels differ by anyway from which one has changed: a choice, one in 16 000.
const CHANGED: f64 = 4.0;

/// How many times as far as a place is long the record must be quiet on both sides of it: a choice, as far as its levels reach.
const REACH: usize = 2;

/// A stretch in samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Samples in which it is.
    pub samples: Range<usize>,
    /// The level afterwards less that before, and its standard deviation; `None` where it has not changed.
    pub step: Option<[f64; 2]>,
    /// Its own level less the middle of both, and its standard deviation; `None` where it has none.
    pub mean: Option<[f64; 2]>,
    /// Samples in which it comes up, and in as many it fades.
    pub fade: usize,
    /// What it is about, the strongest first: cycles a sample, and the unit of the record.
    pub bands: Vec<Band>,
    /// Gain in log-likelihood of its strength, on every other error of prediction.
    pub nats: f64,
}

/// Why a stretch is none in which something moves the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotMoved {
    /// Too short to tell, or nothing is in it.
    Short,
    /// The noise that is always there is louder, in its own colour.
    Louder,
}

impl Moved {
    /// Of the `samples` of a record.
    ///
    /// # Errors
    /// [`NotMoved`] where they are none.
    pub fn new(
        beside: &Beside<'_>,
        samples: &Range<usize>,
        about: Option<&About>,
    ) -> Result<Self, NotMoved> {
        let mean = beside.mean(samples);
        let level = mean.map(|[level, _]| level);
        let inside = Inside::new(beside, samples, level).ok_or(NotMoved::Short)?;
        let Inside {
            values,
            groups,
            data,
            noise,
            is_known,
        } = &inside;
        let (bands, gain) = bands(data, noise, groups).ok_or(NotMoved::Short)?;
        // Each number costs as by the information criterion of G. Schwarz, Ann. Stat. 6 (1978): a band has three, noise
        // that is louder has one. A level of its own is either's: what is louder strays further from its mean.
        let ordinates = samples.len() / 2;
        let cost_nats = 0.5 * (3 * bands.len() - 1) as f64 * (ordinates as f64).ln();
        let of_louder = inside.louder().map_or(0.0, |louder| louder.gain_nats);
        if *is_known && of_louder > gain - cost_nats {
            return Err(NotMoved::Louder);
        }
        Ok(Self {
            samples: samples.clone(),
            step: beside.step(samples),
            mean,
            fade: fading(values, inside.noise_power()),
            bands: described(values, groups, noise),
            nats: about.map_or(1.0, |about| of_strength(about, samples)),
        })
    }
}

impl Beside<'_> {
    /// Change of the level over an event, where it is larger than levels as far apart differ by anyway.
    pub fn step(&self, samples: &Range<usize>) -> Option<[f64; 2]> {
        let of = |place: &Range<usize>, own: &Range<usize>| {
            let [before, after] = levels(self.values, place, own);
            Some(after? - before?)
        };
        let (height, sd) = (of(samples, self.own)?, self.anyway(samples, of)?);
        (height.abs() > CHANGED * sd).then_some([height, sd])
    }

    /// Level of an event less the middle of those before and after it, where that is further than it is anyway.
    fn mean(&self, samples: &Range<usize>) -> Option<[f64; 2]> {
        let of = |place: &Range<usize>, own: &Range<usize>| {
            Some(bands::mean(&deflection(self.values, place, own)))
        };
        let (height, sd) = (of(samples, self.own)?, self.anyway(samples, of)?);
        (height.abs() > CHANGED * sd).then_some([height, sd])
    }

    /// Standard deviation of what is `of` places as long as an event in which nothing happens. Where there are too few, it is
    /// that of some half as long, and so on, as if it went twice as far in twice the time, as what drifts does.
    fn anyway(
        &self,
        samples: &Range<usize>,
        of: impl Fn(&Range<usize>, &Range<usize>) -> Option<f64>,
    ) -> Option<f64> {
        /// Places that are compared, at least and at most, and samples of one, at least: choices.
        const PLACES: [usize; 2] = [8, 256];
        const LEAST: usize = 8;
        let lengths = std::iter::successors(Some(samples.len()), |length| Some(length / 2));
        let mut lengths = lengths.take_while(|length| *length >= LEAST);
        let (length, all) = lengths.find_map(|length| {
            let all = self.places(length);
            (all.len() >= PLACES[0]).then_some((length, all))
        })?;
        let stride = all.len().div_ceil(PLACES[1]);
        let chosen = all.into_iter().step_by(stride);
        let differs = |start: usize| {
            let place = start..start + length;
            let own = start - REACH * length..place.end + REACH * length;
            Some(of(&place, &own)?.abs())
        };
        let mut differ: Vec<f64> = chosen.filter_map(differs).collect();
        // The middle of the sizes of a normal law.
        let sd = median(&mut differ)? / 0.6745;
        Some(sd * samples.len() as f64 / length as f64)
    }

    /// Where places of a `length` begin in which nothing happens, nor beside them.
    fn places(&self, length: usize) -> Vec<usize> {
        let room = |run: &Range<usize>| run.len().checked_sub((1 + 2 * REACH) * length);
        let starts = |run: &Range<usize>| {
            let from = run.start + REACH * length;
            room(run).map(|room| (from..=from + room).step_by(length))
        };
        self.quiet.iter().filter_map(starts).flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::motion::{Motion, Stretch};
    use crate::model::once::Once;
    use crate::model::random::{Gaussian, Generator, Seed};

    /// White noise of deviation 1 with a stretch from 20 000 to 21 000 in it, and the mean square of that.
    fn moved(
        seed: u64,
        [f_hz, width_hz]: [f64; 2],
        [step, level]: [f64; 2],
    ) -> (Result<Moved, NotMoved>, f64) {
        let seed = Seed { seed, stream: 0 };
        let mut values = vec![0.0; 40_000];
        Gaussian::new(seed, 1.0).add_to(&mut values);
        let stretch = Stretch {
            time_s: 20_000.0,
            duration_s: 1000.0,
            step,
            mean: level,
            fade_s: 0.0,
            band: Band {
                f_hz,
                width_hz,
                amplitude: 20.0,
            },
        };
        Motion::new(vec![stretch])
            .course(1.0, seed)
            .add_to(&mut values);
        let mut alone = vec![0.0; 21_000];
        Motion::new(vec![stretch])
            .course(1.0, seed)
            .add_to(&mut alone);
        let square = alone[20_000..20_500]
            .iter()
            .map(|one| one * one)
            .sum::<f64>()
            / 500.0;
        let quiet = [0..20_000, 21_000..40_000];
        let beside = Beside {
            values: &values,
            quiet: &quiet,
            own: &(0..40_000),
        };
        (Moved::new(&beside, &(20_000..21_000), None), square)
    }

    #[test]
    fn the_band_and_the_step_are_those_that_were_made() {
        for seed in 1..=5 {
            let (one, square) = moved(seed, [0.05, 0.02], [3.0, 0.0]);
            let one = one.expect("a stretch");
            // Noise of deviation 1 in means over a thousand: the difference strays by 0.045.
            let [step, sd] = one.step.expect("a step");
            assert!((step - 3.0).abs() < 5.0 * 0.045, "seed {seed}: {step}");
            assert!((sd / 0.045 - 1.0).abs() < 0.5, "seed {seed}: {sd}");
            let power: f64 = one.bands.iter().map(|band| band.amplitude.powi(2)).sum();
            // Fitted to some thirty of its correlation times, with a width of its own for what is seen of it.
            assert!(
                (power / square - 1.0).abs() < 0.5,
                "seed {seed}: {power} of {square}"
            );
            let largest = one.bands.iter();
            let largest = largest.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
            let f_hz = largest.expect("a band").f_hz;
            assert!((f_hz - 0.05).abs() < 0.015, "seed {seed}: {f_hz}");
        }
    }

    #[test]
    fn a_level_that_comes_back_has_no_step() {
        let steps = (10..30).filter(|&seed| {
            let (one, _) = moved(seed, [0.1, 0.05], [0.0, 0.0]);
            one.expect("a stretch").step.is_some()
        });
        // One in 16 000 each, and a scale that 38 places know to 13 %.
        assert_eq!(steps.count(), 0);
    }

    #[test]
    fn a_level_meanwhile_is_no_band_about_zero() {
        for seed in 40..45 {
            let (one, _) = moved(seed, [0.1, 0.03], [0.0, 30.0]);
            let one = one.expect("a stretch");
            let [mean, sd] = one.mean.expect("a level");
            // A thousand samples of deviation 1, and the levels beside them with a thousand each.
            let expected_sd = (1.5_f64 / 1000.0).sqrt();
            assert!((sd / expected_sd - 1.0).abs() < 0.5, "seed {seed}: {sd}");
            assert!(
                (mean - 30.0).abs() < 5.0 * expected_sd,
                "seed {seed}: {mean}"
            );
            let slow = one.bands.iter().filter(|band| band.f_hz < 0.02);
            let slow: f64 = slow.map(|band| band.amplitude).sum();
            assert!(slow < 10.0, "seed {seed}: {slow}");
        }
    }

    /// Where nothing happens for too short a time to hold eight places as long, shorter ones say what levels differ by.
    #[test]
    fn a_level_that_is_left_for_good_is_told_in_a_short_record() {
        for (seed, step, is_told) in [(50, -30.0, true), (51, 3.0, false), (52, 30.0, true)] {
            let drawn = Seed { seed, stream: 0 };
            let mut values = vec![0.0; 2600];
            Gaussian::new(drawn, 1.0).add_to(&mut values);
            values[1300..].iter_mut().for_each(|value| *value += step);
            let beside = Beside {
                values: &values,
                quiet: &[0..800, 1800..2600],
                own: &(0..2600),
            };
            let told = beside.step(&(800..1800));
            assert_eq!(told.is_some(), is_told, "seed {seed}: {told:?}");
            // Means of a thousand samples and of 800 of deviation 1.
            let close = told.is_none_or(|[height, _]| (height - step).abs() < 0.25);
            assert!(close, "seed {seed}: {told:?}");
        }
    }

    /// Noise that is louder for a while, from end to end of the band, is a burst of it.
    #[test]
    fn noise_that_is_louder_in_its_own_colour_is_no_motion() {
        let seed = Seed {
            seed: 40,
            stream: 0,
        };
        let mut values = vec![0.0; 40_000];
        Gaussian::new(seed, 1.0).add_to(&mut values);
        values[20_000..21_000]
            .iter_mut()
            .for_each(|value| *value *= 3.0);
        let beside = Beside {
            values: &values,
            quiet: &[0..20_000, 21_000..40_000],
            own: &(0..40_000),
        };
        let found = Moved::new(&beside, &(20_000..21_000), None);
        assert_eq!(found, Err(NotMoved::Louder), "{seed:?}");
    }
}
