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

/// Taps on either side of the middle one.
const REACH: usize = 128;

/// A symmetric filter with the pole's amplitude response up to half the rate; it does not turn
/// phases, which no spectrum shows.
struct Filter {
    taps: Vec<f64>,
    /// Samples that windows to come begin with.
    past: Vec<f64>,
    begun: bool,
}

impl Filter {
    fn new(law: &RollOff, rate_hz: f64) -> Self {
        // Response at equal steps to half the rate, back to time, and a taper over its ends.
        const STEPS: usize = 8 * REACH;
        let gain = |step: usize| {
            let f_hz = 0.5 * rate_hz * step as f64 / STEPS as f64;
            law.power(f_hz, rate_hz).sqrt()
        };
        let tap = |lag: usize| {
            let sum: f64 = (0..=STEPS)
                .map(|step| {
                    let share = if step == 0 || step == STEPS { 0.5 } else { 1.0 };
                    share * gain(step) * (PI * (lag * step) as f64 / STEPS as f64).cos()
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
            past: Vec::new(),
            begun: false,
        }
    }
}

impl Distorter for Filter {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        self.past.append(samples);
        if !self.begun {
            if self.past.len() <= REACH {
                return;
            }
            // Before the record its mirror image: at the same level, and as loud.
            let mirror: Vec<f64> = self.past[1..=REACH].iter().rev().copied().collect();
            self.past.splice(..0, mirror);
            self.begun = true;
        }
        let mut line = std::mem::take(&mut self.past);
        // Each sample in the middle of its window: the last ones wait for the next block.
        samples.extend(line.windows(self.taps.len()).map(|window| {
            let products = window.iter().zip(&self.taps);
            products.map(|(value, tap)| value * tap).sum::<f64>()
        }));
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

    /// What comes out of white noise, in blocks of this many samples.
    fn filtered(seed: u64, count: usize, block: usize) -> Vec<f64> {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let law = RollOff { corner_hz: 200.0 };
        let mut filter = law.distorter(1000.0, Seed { seed, stream: 1 });
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
    fn the_record_is_as_loud_at_its_beginning_as_later() {
        const RECORDS: u64 = 200;
        let mut squares = [0.0; 2];
        for seed in 0..RECORDS {
            let made = filtered(seed, 4096, 1024);
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
        let whole = filtered(3, 3000, 4096);
        for block in [1, 129, 700, 1000] {
            assert_eq!(filtered(3, 3000, block), whole, "blocks of {block}");
        }
    }
}
