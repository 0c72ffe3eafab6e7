//! Averaging: each sample is the mean of what came in the time before it.

use std::f64::consts::PI;
use std::ops::Range;

use super::Seed;
use super::effect::{Band, Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::filter::{Filter, Place, Poles};
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

/// Power at a zero of the response, as a part of the lobes beside it: choices. The second is what a record with a beginning and an
/// end shows where it is looked at ordinate by ordinate, the first only keeps logarithms finite.
const DEEPEST: f64 = 1e-9;
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
        let mean = |_| RunningMean::new(self.samples(rate_hz));
        Box::new(Repeated((0..self.times).map(mean).collect()))
    }
}

/// Running means one after the other.
struct Repeated(Vec<RunningMean>);

impl Distorter for Repeated {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        self.0.iter_mut().for_each(|mean| mean.apply(samples));
    }
}

/// Samples that a mean is over at most, as they are held: 8 MB. Longer ones are over as many.
const MOST: f64 = (1 << 20) as f64;

struct RunningMean {
    /// How many samples count as a whole.
    whole: usize,
    /// What the one before them counts.
    rest: f64,
    /// The latest samples, as many as a mean needs but for the next; the beginning of the record, until there is
    /// enough for its mirror image.
    past: Vec<f64>,
    has_begun: bool,
    /// Sum of the samples that count as a whole, up to the latest.
    sum: f64,
    /// Outputs until it is summed up anew.
    until_anew: usize,
}

impl RunningMean {
    fn new(samples: f64) -> Self {
        let samples = samples.min(MOST);
        Self {
            whole: samples as usize,
            rest: samples.fract(),
            past: Vec::new(),
            has_begun: false,
            sum: 0.0,
            until_anew: 0,
        }
    }

    /// The mean over a window, the oldest sample of which counts by what is left. A sample costs two additions: the sum goes
    /// on from the last one and is made anew after as many as it holds, so that no error adds up.
    fn mean(&mut self, window: &[f64]) -> f64 {
        let (oldest, newest) = (window[0], window[self.whole]);
        if self.until_anew == 0 {
            self.sum = window[1..].iter().sum();
            self.until_anew = self.whole;
        } else {
            self.sum += newest - oldest;
        }
        self.until_anew -= 1;
        (self.sum + self.rest * oldest) / (self.whole as f64 + self.rest)
    }
}

impl Distorter for RunningMean {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        let before = self.whole;
        self.past.append(samples);
        if !self.has_begun {
            if self.past.len() <= before {
                return;
            }
            // Before the record its mirror image, at the same level.
            let mirror = self.past[1..=before].iter().rev().copied();
            self.past = mirror.chain(self.past.iter().copied()).collect();
            self.has_begun = true;
        }
        let past = std::mem::take(&mut self.past);
        samples.extend(past.windows(before + 1).map(|window| self.mean(window)));
        self.past = past;
        let gone = self.past.len() - before;
        self.past.drain(..gone);
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
        format!(
            "look for a filter over {:.4} s in the sensor's settings, its driver or the logger, and switch it off; samples \
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
        /// What it costs that it is done more than once: as a parameter that is fitted.
        const AGAIN: f64 = 1.0;
        if values.len() > 1 { AGAIN } else { 0.0 }
    }

    /// A mean is over whole samples.
    fn meant(&self, values: &[f64], rate_hz: f64) -> Option<Vec<f64>> {
        /// Part of a sample by which a duration may be off: a choice, several steps of a search.
        const OFF: f64 = 0.1;
        let samples = values[0] * rate_hz;
        let is_near = (samples - samples.round()).abs() < OFF;
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
        let once = durations.iter().map(|duration_s| vec![*duration_s]);
        let others = [vec![2.0], vec![3.0], vec![2.0, 1.0]];
        let more = others.into_iter().flat_map(|kind| {
            let durations = durations.iter();
            let with_duration = durations.map(|one| [&[*one], kind.as_slice()].concat());
            with_duration.collect::<Vec<_>>()
        });
        once.chain(more).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::Gaussian;
    use crate::model::trial;

    #[test]
    fn a_mean_over_nearly_whole_samples_is_meant_to_be_over_these() {
        assert_eq!(Entry.meant(&[15.03 / 50.0], 50.0), Some(vec![15.0 / 50.0]));
        assert_eq!(Entry.meant(&[15.4 / 50.0], 50.0), None);
    }

    #[test]
    fn the_response_is_that_of_the_weights() {
        for n in [1.0, 1.3, 2.0, 5.0, 7.75, 24.0] {
            let law = Averaging {
                duration_s: n / 50.0,
                times: 1,
                place: Place::Behind,
            };
            let (whole, rest) = (n as usize, n.fract());
            let weights = std::iter::repeat_n(1.0, whole).chain([rest]);
            for f_hz in (0..50).map(|step| 0.5 * f64::from(step)) {
                let turn = 2.0 * PI * f_hz / 50.0;
                let (mut cosine, mut sine) = (0.0, 0.0);
                for (lag, weight) in (0_u32..).zip(weights.clone()) {
                    cosine += weight * (f64::from(lag) * turn).cos();
                    sine += weight * (f64::from(lag) * turn).sin();
                }
                let exact = (cosine * cosine + sine * sine) / (n * n);
                let off = (law.power(f_hz, 50.0) - exact).abs();
                // But for the zeros, which have a floor below all lobes.
                let lobes = (n * (0.5 * turn).sin()).powi(-2).min(1.0);
                assert!(
                    off < 1e-9 + DEEPEST * lobes,
                    "{n} samples, {f_hz} Hz: {off}"
                );
            }
        }
    }

    #[test]
    fn within_a_converter_images_fold_down() {
        for (n, times) in [(1.0, 3), (0.7, 2), (5.15, 2), (4.0, 3)] {
            let law = Averaging::of(&[n / 50.0, f64::from(times)]);
            for f_hz in (0..50).map(|step| 0.5 * f64::from(step) + 0.01) {
                let image = |j: i32| {
                    let x = PI * n * (f_hz / 50.0 + f64::from(j));
                    (x.sin() / x).powi(2 * times)
                };
                let exact: f64 = (-2000..=2000).map(image).sum();
                let made = law.folded(f_hz, 50.0);
                // What the sum leaves out is a part in a thousand of the images.
                assert!(
                    (made - exact).abs() < 1e-3 * exact.max(1e-6),
                    "{law:?} {f_hz} Hz: {made} {exact}"
                );
            }
        }
        // Once over whole samples it is a running mean.
        let [within, behind] = [&[0.1, 1.0][..], &[0.1]].map(Averaging::of);
        for f_hz in [0.3, 7.0, 21.0] {
            let ratio = within.folded(f_hz, 50.0) / behind.running(f_hz, 50.0);
            // Of the square of a sinc a fiftieth of what is left out shows.
            assert!((ratio - 1.0).abs() < 0.02, "{f_hz} Hz: {ratio}");
        }
    }

    #[test]
    fn a_mean_is_over_the_samples_before_it() {
        let mut samples: Vec<f64> = (0..100).map(f64::from).collect();
        let law = Averaging::of(&[0.25]);
        law.distorter(10.0, Seed { seed: 0, stream: 0 })
            .apply(&mut samples);
        // Two and a half samples of a ramp: (k + k - 1 + (k - 2) / 2) / 2.5.
        for (k, value) in samples.iter().enumerate().skip(3) {
            assert!((value - (k as f64 - 0.8)).abs() < 1e-9, "{k}: {value}");
        }
        assert_eq!(samples.len(), 100);
    }

    #[test]
    fn allan_variance_follows_the_law() {
        for duration_s in [0.002, 0.0237] {
            let effects = format!(
                r#"{{ "effect": "averaging", "parameters": {{ "duration_s": {duration_s} }} }}"#
            );
            let axis = trial::axis(r#""N": 0.02, "K": 20, "Q": 4e-4"#, &effects);
            trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 8, 24, 100]);
        }
    }

    #[test]
    fn the_record_has_as_many_samples_and_its_level_from_the_start() {
        let mut noise = Gaussian::new(Seed { seed: 3, stream: 0 }, 1.0);
        let mut samples: Vec<f64> = (0..500).map(|_| 1e3 + noise.draw()).collect();
        let law = Averaging::of(&[1.7]);
        law.distorter(10.0, Seed { seed: 0, stream: 0 })
            .apply(&mut samples);
        assert_eq!(samples.len(), 500);
        // Half of a mirrored mean counts twice: a variance of 2 / 17 at most, five deviations.
        assert!(
            samples.iter().all(|value| (value - 1e3).abs() < 1.8),
            "seed 3"
        );
    }
}
