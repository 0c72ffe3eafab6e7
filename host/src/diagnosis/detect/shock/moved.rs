//! A stretch in which something moves the sensor: about which frequencies, how strongly, and how it lies afterwards.
//!
//! What it is over the line between the levels before and after is held against bands of noise that are let in for as
//! long, beside the noise that is always there, by Whittle's likelihood of its periodogram.

use std::ops::Range;

use super::about::About;
use super::bands::{bands, data, groups, mean, periodogram};
use super::course::{deflection, levels, of_strength};
use crate::diagnosis::laws::gain::Local;
use crate::fit::likelihood::Data;
use crate::model::unnamed::Band;
use crate::numeric::order::median;

/// Samples that bands are taken from, at least: a choice. Of fewer hardly a frequency can be told.
pub const LEAST: usize = 48;

/// Standard deviations of what levels differ by anyway from which one has changed: a choice, one in 16 000.
const CHANGED: f64 = 4.0;

/// A stretch in samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Samples in which it is.
    pub samples: Range<usize>,
    /// The level afterwards less that before, and its standard deviation; `None` where it has not changed.
    pub step: Option<[f64; 2]>,
    /// What it is about: cycles a sample, and the unit of the record.
    pub bands: Vec<Band>,
    /// Gain in log-likelihood of its strength, on every other error of prediction.
    pub nats: f64,
}

/// A record about an event.
pub struct Beside<'a> {
    /// The samples.
    pub values: &'a [f64],
    /// Runs in which nothing happens, ascending.
    pub quiet: &'a [Range<usize>],
    /// The run of samples about the event in which nothing else happens.
    pub own: &'a Range<usize>,
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
        if samples.len() < LEAST {
            return Err(NotMoved::Short);
        }
        let inside = Inside::new(beside, samples).ok_or(NotMoved::Short)?;
        let Inside {
            groups,
            data,
            noise,
            is_known,
        } = &inside;
        let (bands, gain) = bands(data, noise, groups).ok_or(NotMoved::Short)?;
        // Each number costs as by the information criterion of G. Schwarz, Ann. Stat. 6 (1978): a band has three, noise
        // that is louder has one.
        let ordinates = samples.len() / 2;
        let cost_nats = 0.5 * (3 * bands.len() - 1) as f64 * (ordinates as f64).ln();
        let of_louder = inside.louder().map_or(0.0, |louder| louder.gain_nats);
        if *is_known && of_louder > gain - cost_nats {
            return Err(NotMoved::Louder);
        }
        Ok(Self {
            samples: samples.clone(),
            step: beside.step(samples),
            bands,
            nats: about.map_or(1.0, |about| of_strength(about, samples)),
        })
    }
}

/// The spectrum of a stretch, and of others as long in which nothing happens.
struct Inside {
    /// Ordinates that are taken together.
    groups: Vec<Range<usize>>,
    data: Data,
    /// What is expected of noise alone; hardly anything where that is not known.
    noise: Vec<f64>,
    is_known: bool,
}

/// How much louder the noise of a stretch is.
#[derive(Debug, Clone, Copy)]
pub struct Louder {
    /// Factor on its deviation, and the standard deviation of the logarithm of that.
    pub factor: f64,
    pub log_factor_sd: f64,
    /// Frequency above which it is louder, cycles a sample; `None` where all of it is.
    pub above: Option<f64>,
    /// Gain in log-likelihood over noise as it is elsewhere, nats.
    pub gain_nats: f64,
}

impl Inside {
    fn new(beside: &Beside<'_>, samples: &Range<usize>) -> Option<Self> {
        if samples.len() < LEAST {
            return None;
        }
        // Of an even number ordinates lie alike.
        let even = samples.start..samples.end - samples.len() % 2;
        let inside = deflection(beside.values, &even, beside.own);
        let groups = groups(even.len() / 2);
        let data = data(&periodogram(&inside), &groups)?;
        let (noise, is_known) = beside.noise(&even, &groups, &data);
        Some(Self {
            groups,
            data,
            noise,
            is_known,
        })
    }

    /// How much louder it is, if the noise is of which [a part](own_shapes) is.
    fn louder(&self) -> Option<Louder> {
        if !self.is_known {
            return None;
        }
        let (data, noise) = (&self.data, &self.noise);
        let all = own_shapes(noise, &data.f_hz)
            .into_iter()
            .map(|(above, expected)| {
                let own = Local { first: 0, expected };
                let (squared, gain_nats) = own.best(data, noise);
                let share = |bin: usize| {
                    let louder = squared * own.expected[bin];
                    louder / (noise[bin] + louder)
                };
                // Fisher's information on the logarithm of what is added.
                let known = (0..noise.len()).map(|bin| 0.5 * data.dof[bin] * share(bin).powi(2));
                let added_sd = known.sum::<f64>().powf(-0.5);
                Louder {
                    factor: (1.0 + squared).sqrt(),
                    above,
                    log_factor_sd: 0.5 * added_sd * squared / (1.0 + squared),
                    gain_nats,
                }
            });
        all.max_by(|a, b| a.gain_nats.total_cmp(&b.gain_nats))
    }
}

/// What of some noise may be louder, and above which frequency that is where it is not all of it: all; what is left of it
/// where slow noise does not rise above it, which is white below its least density, or falls with the square of the
/// frequency as that of rounding; or all but a floor that is behind what is loud, as that of rounding behind a filter.
fn own_shapes(noise: &[f64], f_hz: &[f64]) -> [(Option<f64>, Vec<f64>); 4] {
    /// Density over the least one from which noise is slow noise: where that is as strong as what is left.
    const TWICE: f64 = 2.0;
    let least = (1..noise.len()).min_by(|&a, &b| noise[a].total_cmp(&noise[b]));
    let least = least.unwrap_or(0);
    let floor = noise[least];
    let below = |power: i32| -> Vec<f64> {
        let shape = noise.iter().zip(f_hz).enumerate();
        let shape = shape.map(|(group, (density, here_hz))| match group < least {
            true => floor * (here_hz / f_hz[least]).powi(power),
            false => *density,
        });
        shape.collect()
    };
    let slow = noise[..least]
        .iter()
        .rposition(|density| *density > TWICE * floor);
    let above_floor = noise.iter().map(|density| density - floor).collect();
    [
        (None, noise.to_vec()),
        (slow.map(|group| f_hz[group]), below(0)),
        (slow.map(|_| f_hz[least]), below(2)),
        (None, above_floor),
    ]
}

impl Beside<'_> {
    /// How much louder the noise of a stretch is than beside it; `None` where that is not known.
    pub fn louder(&self, samples: &Range<usize>) -> Option<Louder> {
        Inside::new(self, samples)?.louder()
    }

    /// Change of the level over an event, where it is larger than levels as far apart differ by anyway.
    fn step(&self, samples: &Range<usize>) -> Option<[f64; 2]> {
        /// Places that are compared, at least and at most: choices.
        const PLACES: [usize; 2] = [8, 256];
        let [before, after] = levels(self.values, samples, self.own);
        let step = after? - before?;
        let reach = 2 * samples.len();
        let room = |run: &Range<usize>| run.len().checked_sub(samples.len() + 2 * reach);
        let starts = |run: &Range<usize>| {
            let from = run.start + reach;
            room(run).map(|room| (from..=from + room).step_by(samples.len()))
        };
        let all: Vec<usize> = self.quiet.iter().filter_map(starts).flatten().collect();
        if all.len() < PLACES[0] {
            return None;
        }
        let stride = all.len().div_ceil(PLACES[1]);
        let chosen = all.into_iter().step_by(stride);
        let differs = |start: usize| {
            let place = start..start + samples.len();
            let own = start - reach..place.end + reach;
            let [before, after] = levels(self.values, &place, &own);
            Some((after? - before?).abs())
        };
        let mut differ: Vec<f64> = chosen.filter_map(differs).collect();
        // The middle of the sizes of a normal law.
        let sd = median(&mut differ)? / 0.6745;
        (step.abs() > CHANGED * sd).then_some([step, sd])
    }

    /// What the groups of ordinates are of stretches as long in which nothing happens, and whether there are any; hardly
    /// anything where there are none.
    fn noise(
        &self,
        samples: &Range<usize>,
        groups: &[Range<usize>],
        data: &Data,
    ) -> (Vec<f64>, bool) {
        /// Stretches that are enough, and share of what is measured that is nothing: choices.
        const ENOUGH: usize = 16;
        const NOTHING: f64 = 1e-6;
        let len = samples.len();
        let places = |run: &Range<usize>| {
            let (from, to) = (run.start + len, run.end.saturating_sub(2 * len - 1));
            (from..to).step_by(len)
        };
        let mut places: Vec<usize> = self.quiet.iter().flat_map(places).collect();
        places.sort_by_key(|place| place.abs_diff(samples.start));
        places.truncate(ENOUGH);
        let count = places.len() as f64;
        let is_known = !places.is_empty();
        let mut noise: Vec<f64> = data.psd.iter().map(|psd| NOTHING * psd).collect();
        for start in places {
            let place = start..start + len;
            let own = start - len..place.end + len;
            let quiet = periodogram(&deflection(self.values, &place, &own));
            for (noise, group) in noise.iter_mut().zip(groups) {
                *noise += mean(&quiet[group.clone()]) / count;
            }
        }
        (noise, is_known)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::motion::{Motion, Stretch};
    use crate::model::once::Once;
    use crate::model::random::{Gaussian, Generator, Seed};

    /// White noise of deviation 1 with a stretch from 20 000 to 21 000 in it, and the mean square of that.
    fn moved(seed: u64, f_hz: f64, width_hz: f64, step: f64) -> (Result<Moved, NotMoved>, f64) {
        let seed = Seed { seed, stream: 0 };
        let mut values = vec![0.0; 40_000];
        Gaussian::new(seed, 1.0).add_to(&mut values);
        let stretch = Stretch {
            time_s: 20_000.0,
            duration_s: 1000.0,
            step,
            band: Band {
                f_hz,
                width_hz,
                amplitude: 20.0,
            },
        };
        Motion(vec![stretch]).course(1.0, seed).add_to(&mut values);
        let mut alone = vec![0.0; 21_000];
        Motion(vec![stretch]).course(1.0, seed).add_to(&mut alone);
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
            let (one, square) = moved(seed, 0.05, 0.02, 3.0);
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
            let (one, _) = moved(seed, 0.1, 0.05, 0.0);
            one.expect("a stretch").step.is_some()
        });
        // One in 16 000 each, and a scale that 38 places know to 13 %.
        assert_eq!(steps.count(), 0);
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
