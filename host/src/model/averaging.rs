//! Averaging: each sample is the mean of what came in the time before it.

use std::f64::consts::PI;
use std::ops::Range;

use super::Seed;
use super::effect::{Band, Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::filter::{self, DEEPEST, Filter, Place, Poles, RunningMeans};
use super::kind::Kind;
use super::marks::Mark;

/// A mean over `n = duration_s rate` samples, done several times, of a power with the exponent `times`.
///
/// Behind the converter a running mean, the oldest sample of which counts by what is left of `n`; twice is a triangle's
/// (Bartlett's) weights:
///
/// ```text
/// y_k = (x_k + x_(k-1) + ... + x_(k-m+1) + d x_(k-m)) / n,    m = floor(n),  d = n - m
/// |H|^2 = (D^2 + d^2 + 2 D d cos((m + 1) w / 2)) / n^2,       D = sin(m w / 2) / sin(w / 2)
/// ```
///
/// Within it a mean of what comes much faster, as the decimators of delta-sigma converters are: of white noise the images fold
/// down, `sum_j sinc^2(n (f / rate + j))`, over the same at zero. Once and over a whole number of samples it is the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Averaging {
    /// Length of time that a mean is over, seconds; behind the converter, up to one sample it changes nothing.
    pub duration_s: f64,
    /// How many times it is done, one or more.
    pub times: u8,
    /// Where: within the converter or behind it.
    pub place: Place,
}

/// Times at most: a choice, the decimators of converters have six stages.
const MOST_TIMES: f64 = 8.0;

/// Images on either side that are summed up: of the square of a mean done twice the next one is `10^-4` of the first.
const IMAGES: i32 = 8;

/// Power at a zero of the response, as a part of the lobes beside it, that a record with a beginning and an end shows where it is
/// looked at ordinate by ordinate: a choice.
const DEEPEST_SHOWN: f64 = 1e-3;

impl Averaging {
    /// With these parameters, in the catalogue's order; once and behind the converter where no more is said.
    pub fn of(values: &[f64]) -> Self {
        let times = values
            .get(1)
            .map(|times| times.clamp(1.0, MOST_TIMES) as u8);
        Self {
            duration_s: values[0],
            times: times.unwrap_or(1),
            place: times.map_or(Place::Behind, |_| Place::of(values.get(2))),
        }
    }

    /// Samples from the beginning of a record whose means are over what came before it.
    pub fn begins_with(&self, rate_hz: f64) -> usize {
        match self.place {
            Place::Behind => usize::from(self.times) * (self.samples(rate_hz).ceil() as usize - 1),
            Place::Ahead | Place::Within => 0,
        }
    }

    /// Power of a running mean.
    fn running(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let n = self.samples(rate_hz);
        let (m, rest) = (n.floor(), n.fract());
        let x = PI * f_hz / rate_hz;
        let sine = x.sin();
        let sum = if sine == 0.0 { m } else { (m * x).sin() / sine };
        let power = sum * sum + rest * rest + 2.0 * sum * rest * ((m + 1.0) * x).cos();
        (power / (n * n)).powi(i32::from(self.times))
    }

    /// Power of a mean of what comes much faster, with all that folds down.
    fn folded(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let samples = self.duration_s * rate_hz;
        let sinc_squared = |sine: f64, x: f64| if x == 0.0 { 1.0 } else { (sine / x).powi(2) };
        let ([sine, cosine], [turn_sine, turn_cosine]) = (
            <[f64; 2]>::from((PI * samples * f_hz / rate_hz).sin_cos()),
            <[f64; 2]>::from((PI * samples).sin_cos()),
        );
        let x = |image: f64| PI * samples * (f_hz / rate_hz + image);
        let mut sum = sinc_squared(sine, x(0.0)).powi(i32::from(self.times));
        // Sines and cosines of the images above and below, each a turn further.
        let mut above = [sine, cosine];
        let mut below = above;
        for image in 1..=IMAGES {
            let image = f64::from(image);
            let [up, down] = [above, below];
            above = [
                up[0] * turn_cosine + up[1] * turn_sine,
                up[1] * turn_cosine - up[0] * turn_sine,
            ];
            below = [
                down[0] * turn_cosine - down[1] * turn_sine,
                down[1] * turn_cosine + down[0] * turn_sine,
            ];
            let both = [(above[0], image), (below[0], -image)];
            let powers = both.map(|(sine, image)| sinc_squared(sine, x(image)));
            sum += powers
                .map(|one| one.powi(i32::from(self.times)))
                .iter()
                .sum::<f64>();
        }
        sum
    }

    /// Samples that a mean is over, one or more.
    fn samples(&self, rate_hz: f64) -> f64 {
        (self.duration_s * rate_hz).max(1.0)
    }
}

impl Distortion for Averaging {
    fn stage(&self) -> Stage {
        Stage::Filter
    }

    fn power(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let power = match self.place {
            Place::Behind => self.running(f_hz, rate_hz),
            Place::Ahead | Place::Within => self.folded(f_hz, rate_hz) / self.folded(0.0, rate_hz),
        };
        power.max(DEEPEST)
    }

    fn shown(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let sine = (PI * f_hz / rate_hz).sin();
        let lobes = (self.samples(rate_hz) * sine).powi(-2 * i32::from(self.times));
        let lobes = lobes.min(1.0);
        self.power(f_hz, rate_hz).max(DEEPEST_SHOWN * lobes)
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        if self.place != Place::Behind {
            let power = |f_hz| self.power(f_hz, rate_hz);
            return Box::new(Filter::new(Poles::new(0, 0.0), power, rate_hz));
        }
        Box::new(RunningMeans::new(self.times, self.samples(rate_hz)))
    }
}

/// Averaging in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "averaging"
    }

    fn meaning(&self) -> &'static str {
        "each sample is a running mean: the spectrum falls in lobes with zeros between them, at multiples of one over the \
         time that the mean is over"
    }

    fn check(&self, values: &[f64]) -> String {
        let of = Averaging::of(values);
        // A straight line between two readings is their mean with the weights of a triangle.
        let or = if of.times == 2 && of.place != Place::Behind {
            format!(
                ", or for samples that were interpolated between {:.4} readings a second",
                values[0].recip()
            )
        } else {
            String::new()
        };
        format!(
            "look for a filter over {:.4} s in the sensor's settings, its driver or the logger{or}, and switch it off; samples \
             that share what they are the mean of are not independent",
            values[0]
        )
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let duration = Parameter::new(
            "duration_s",
            Quantity::Second,
            "time that each mean is over",
        );
        let times = Parameter::new(
            "times",
            Quantity::Count,
            "how many times it is averaged within the converter; left out, once behind it",
        );
        let own_rate = Parameter::new(
            "own_rate",
            Quantity::Count,
            "1 where the means are over the record's own samples, 0 where over faster ones",
        );
        let all = [duration, times, own_rate];
        all.into_iter().take(values.len().max(1)).collect()
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        vec![Mark::Corner(1.0 / values[0])]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(Averaging::of(values)))
    }

    fn surprise_nats(&self, values: &[f64], _rate_hz: f64) -> f64 {
        filter::surprise_nats(values)
    }

    /// A mean is over whole samples.
    fn meant(&self, values: &[f64], rate_hz: f64) -> Option<Vec<f64>> {
        /// Part of a sample by which a duration may be off: a choice, several steps of a search.
        const OFF: f64 = 0.1;
        let samples = values[0] * rate_hz;
        let is_near = samples.round() >= 1.0 && (samples - samples.round()).abs() < OFF;
        is_near.then(|| [&[samples.round() / rate_hz], &values[1..]].concat())
    }

    fn starts(&self, band: &Band) -> Vec<Vec<f64>> {
        /// Samples that a mean is over: from little more than one to those whose lobes are as narrow as the bins of a
        /// spectrum, 16 an octave.
        const SAMPLES: Range<f64> = 1.1..32.0;
        /// A zero in the wrong bin is worse than none, so that starts are as close as bins,
        const AS_BINS: f64 = 0.045;
        /// and as close that at half the rate, where one more sample is half a lobe more, none is further from a lobe
        /// than a sixteenth of it.
        const OF_A_SAMPLE: f64 = 0.25;
        let next = |samples: &f64| Some(samples + (AS_BINS * samples).min(OF_A_SAMPLE));
        let all = std::iter::successors(Some(SAMPLES.start), next);
        let all = all.take_while(|samples| *samples < SAMPLES.end);
        let durations: Vec<f64> = all.map(|samples| 0.5 * samples / band.to_hz).collect();
        filter::starts(&durations, &[&[], &[2.0], &[3.0], &[2.0, 1.0]])
    }
}

#[cfg(test)]
mod tests;
