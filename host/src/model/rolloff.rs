//! Roll-off: an analog pole that the declared signal chain does not have.

use std::f64::consts::PI;

use super::Seed;
use super::effect::{Band, Distorter, Distortion, Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;

/// One pole ahead of the sampler: power `1 / (1 + (f / corner)^2)` on all that is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollOff {
    /// Frequency of half power, hertz.
    pub corner_hz: f64,
}

impl Distortion for RollOff {
    fn power(&self, f_hz: f64, _rate_hz: f64) -> f64 {
        1.0 / (1.0 + (f_hz / self.corner_hz).powi(2))
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        Box::new(Filter::new(self, rate_hz))
    }
}

/// Taps on either side of the middle one: what the digital pole leaves of the response is smooth, and the kink at half the
/// rate that its mirror image makes of it fades as the square of their number.
const REACH: usize = 128;

/// Time constants that the digital pole runs ahead of the record: what it began with is then `e^-8` of it, 0.03 %.
const SETTLED: f64 = 8.0;

/// Samples that it runs ahead, at most, as they are held: 8 MB. A corner below a millionth of the rate begins unsettled.
const MOST_SETTLING: usize = 1 << 20;

/// A digital pole of the same time constant, whose memory is as long as it has to be, behind a symmetric filter with what is
/// left of the amplitude response up to half the rate. Phases, which no spectrum shows, are the digital pole's.
struct Filter {
    taps: Vec<f64>,
    /// What the digital pole keeps of its last value a sample.
    kept: f64,
    last: f64,
    /// Samples that it runs ahead of the record.
    ahead: usize,
    /// Samples that windows to come begin with.
    past: Vec<f64>,
    begun: bool,
}

impl Filter {
    fn new(law: &RollOff, rate_hz: f64) -> Self {
        let decay = 2.0 * PI * law.corner_hz / rate_hz;
        let kept = (-decay).exp();
        // Response at equal steps to half the rate, back to time, and a taper over its ends.
        const STEPS: usize = 8 * REACH;
        let gain = |step: usize| {
            let share = step as f64 / STEPS as f64;
            let pole = pole_power(kept, PI * share);
            (law.power(0.5 * rate_hz * share, rate_hz) / pole).sqrt()
        };
        let gains: Vec<f64> = (0..=STEPS).map(gain).collect();
        let tap = |lag: usize| {
            let sum: f64 = (0..=STEPS)
                .map(|step| {
                    let share = if step == 0 || step == STEPS { 0.5 } else { 1.0 };
                    share * gains[step] * (PI * (lag * step) as f64 / STEPS as f64).cos()
                })
                .sum();
            let taper = 0.5 + 0.5 * (PI * lag as f64 / (REACH + 1) as f64).cos();
            sum / STEPS as f64 * taper
        };
        let half: Vec<f64> = (0..=REACH).map(tap).collect();
        let taps: Vec<f64> = (1..=REACH)
            .rev()
            .map(|lag| half[lag])
            .chain(half.iter().copied())
            .collect();
        let total: f64 = taps.iter().sum();
        Self {
            taps: taps.iter().map(|tap| tap / total).collect(),
            kept,
            last: 0.0,
            ahead: ((SETTLED / decay).ceil() as usize).min(MOST_SETTLING),
            past: Vec::new(),
            begun: false,
        }
    }

    /// The next value of the digital pole.
    fn follow(&mut self, value: f64) -> f64 {
        self.last = self.kept * self.last + (1.0 - self.kept) * value;
        self.last
    }
}

/// Power response of the digital pole at an angular frequency, radians a sample.
fn pole_power(kept: f64, radians: f64) -> f64 {
    // (1 - kept)^2 + 4 kept sin^2(radians / 2) does not cancel where `kept` is next to one.
    let straight = (1.0 - kept).powi(2);
    straight / (straight + 4.0 * kept * (0.5 * radians).sin().powi(2))
}

impl Distorter for Filter {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        self.past.append(samples);
        let mut unsettled = 0;
        if !self.begun {
            unsettled = self.ahead;
            let mirrored = REACH + self.ahead;
            if self.past.len() <= mirrored {
                return;
            }
            // Before the record its mirror image: at the same level, and as loud.
            let mirror: Vec<f64> = self.past[1..=mirrored].iter().rev().copied().collect();
            self.last = mirror[0];
            self.past.splice(..0, mirror);
            self.begun = true;
        }
        let mut line = std::mem::take(&mut self.past);
        // Each sample in the middle of its window: the last ones wait for the next block.
        for (made, window) in line.windows(self.taps.len()).enumerate() {
            let products = window.iter().zip(&self.taps);
            let filtered = products.map(|(value, tap)| value * tap).sum::<f64>();
            let value = self.follow(filtered);
            if made >= unsettled {
                samples.push(value);
            }
        }
        self.past = line.split_off(line.len().saturating_sub(2 * REACH));
    }
}

/// Roll-off in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "rolloff"
    }

    fn meaning(&self) -> &'static str {
        "the spectrum falls toward half the rate: a low-pass that the declared signal chain does \
         not have, the sensor's own pole or its output filter"
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "compare {:.4} Hz with the data sheet's bandwidth and the RC at the sensor's output; \
             if it is one of them, declare it: --chain {:.0}hz",
            values[0], values[0]
        )
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new(
            "corner_hz",
            Quantity::Hertz,
            "frequency of half power",
        )]
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        vec![Mark::Corner(values[0])]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(RollOff {
            corner_hz: values[0],
        }))
    }

    fn starts(&self, band: &Band) -> Vec<Vec<f64>> {
        // Up to far above half the rate, where only the beginning of the fall shows: from a corner that is
        // too low by more than the root of two the likelihood would not rise.
        Band {
            from_hz: band.to_hz / 64.0,
            to_hz: 16.0 * band.to_hz,
        }
        .steps(2.0)
        .map(|corner_hz| vec![corner_hz])
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::random::Gaussian;

    /// What comes of white noise at 1000/s behind a corner, in blocks of this many samples.
    fn filtered(corner_hz: f64, seed: u64, count: usize, block: usize) -> Vec<f64> {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let mut filter = RollOff { corner_hz }.distorter(1000.0, Seed { seed, stream: 1 });
        let mut made = Vec::new();
        while made.len() < count {
            let mut samples: Vec<f64> = (0..block).map(|_| noise.draw()).collect();
            filter.apply(&mut samples);
            made.append(&mut samples);
        }
        made.truncate(count);
        made
    }

    #[test]
    fn the_filter_has_the_response_of_the_law() {
        const RATE_HZ: f64 = 10.0;
        for share in [1e-6, 3.6e-3, 7.5e-3, 0.1, 0.5, 8.0] {
            let law = RollOff {
                corner_hz: share * RATE_HZ,
            };
            let filter = Filter::new(&law, RATE_HZ);
            for f_hz in (1..90).map(|step| 0.05 * f64::from(step)) {
                let radians = 2.0 * PI * f_hz / RATE_HZ;
                let lags = (0..filter.taps.len()).map(|tap| tap as f64 - REACH as f64);
                let gain: f64 = lags
                    .zip(&filter.taps)
                    .map(|(lag, tap)| tap * (lag * radians).cos())
                    .sum();
                let made = gain * gain * pole_power(filter.kept, radians);
                let ratio = made / law.power(f_hz, RATE_HZ);
                // Less than 0.02 dB, which no record shows.
                assert!((ratio - 1.0).abs() < 4e-3, "{share} {f_hz} Hz: {ratio}");
            }
        }
    }

    #[test]
    fn a_corner_far_below_the_rate_has_its_power() {
        const SEED: u64 = 71;
        const COUNT: usize = 1 << 18;
        let corner_hz = 1.0;
        let made = filtered(corner_hz, SEED, COUNT, 4096);
        let power = made.iter().map(|x| x * x).sum::<f64>() / made.len() as f64;
        // White noise of 2 / rate a hertz up to pi / 2 corners.
        let expected = PI * corner_hz / 1000.0;
        // As many independent values as the corner leaves: a relative deviation of sqrt(2 / (2 pi corner count / rate)),
        // 3.5 %; four times that.
        let ratio = power / expected;
        assert!((ratio - 1.0).abs() < 0.14, "seed {SEED}: {ratio}");
    }

    #[test]
    fn the_record_is_as_loud_at_its_beginning_as_later() {
        const RECORDS: u64 = 200;
        let mut squares = [0.0; 2];
        for seed in 0..RECORDS {
            let made = filtered(200.0, seed, 4096, 1024);
            // The mirror's edge is a few samples long.
            squares[0] += made[8..264].iter().map(|x| x * x).sum::<f64>();
            squares[1] += made[2048..2304].iter().map(|x| x * x).sum::<f64>();
        }
        // 51200 samples each, tied over a few: 1.2 % of the ratio, four times that.
        let ratio = squares[0] / squares[1];
        assert!((ratio - 1.0).abs() < 0.05, "seeds 0..{RECORDS}: {ratio}");
    }

    #[test]
    fn blocks_make_no_difference() {
        let whole = filtered(200.0, 3, 3000, 4096);
        for block in [1, 129, 700, 1000] {
            assert_eq!(filtered(200.0, 3, 3000, block), whole, "blocks of {block}");
        }
    }
}
