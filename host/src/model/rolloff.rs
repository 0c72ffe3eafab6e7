//! Roll-off: an analog pole that the declared signal chain does not have.

use std::f64::consts::PI;

use super::Seed;
use super::effect::{Band, Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::kind::Kind;
use super::marks::Mark;
use super::symmetric_filter::{REACH, SymmetricFilter};

/// One pole ahead of the sampler: power `1 / (1 + (f / corner)^2)` on all that is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollOff {
    /// Frequency of half power, hertz.
    pub corner_hz: f64,
}

impl Distortion for RollOff {
    fn stage(&self) -> Stage {
        Stage::Filter
    }

    fn power(&self, f_hz: f64, _rate_hz: f64) -> f64 {
        1.0 / (1.0 + (f_hz / self.corner_hz).powi(2))
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        Box::new(Filter::new(self, rate_hz))
    }
}

/// Time constants that the digital pole runs ahead of the record: what it began with is then `e^-8` of it, 0.03 %.
const SETTLED: f64 = 8.0;

/// Samples that it runs ahead, at most, as they are held: 8 MB. A corner below a millionth of the rate begins unsettled.
const MOST_SETTLING: usize = 1 << 20;

/// A digital pole of the same time constant, whose memory is as long as it has to be, behind a symmetric filter with what is
/// left of the amplitude response up to half the rate. Phases, which no spectrum shows, are the digital pole's.
struct Filter {
    symmetric: SymmetricFilter,
    /// What the digital pole keeps of its last value a sample.
    kept: f64,
    last: f64,
    /// Samples that are mirrored before the record: those in which the pole settles, and a window's.
    mirrored: usize,
    /// The beginning of the record, until there is enough for its mirror image.
    beginning: Vec<f64>,
    /// Values that are not the record's yet, once it has begun.
    unsettled: Option<usize>,
}

impl Filter {
    fn new(law: &RollOff, rate_hz: f64) -> Self {
        let decay = 2.0 * PI * law.corner_hz / rate_hz;
        let kept = (-decay).exp();
        let gain = |share: f64| {
            let pole = pole_power(kept, PI * share);
            (law.power(0.5 * rate_hz * share, rate_hz) / pole).sqrt()
        };
        let settling = ((SETTLED / decay).ceil() as usize).min(MOST_SETTLING);
        Self {
            symmetric: SymmetricFilter::new(gain),
            kept,
            last: 0.0,
            mirrored: settling + REACH,
            beginning: Vec::new(),
            unsettled: None,
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
        let mut came = std::mem::take(samples);
        let mut unsettled = match self.unsettled {
            Some(unsettled) => unsettled,
            None => {
                self.beginning.append(&mut came);
                if self.beginning.len() <= self.mirrored {
                    return;
                }
                // Before the record its mirror image: at the same level, and as loud.
                let mut mirror: Vec<f64> = self.beginning[1..=self.mirrored].to_vec();
                mirror.reverse();
                self.last = mirror[0];
                came = [mirror, std::mem::take(&mut self.beginning)].concat();
                self.mirrored - REACH
            }
        };
        for value in self.symmetric.pass(&came) {
            let value = self.follow(value);
            if unsettled > 0 {
                unsettled -= 1;
            } else {
                samples.push(value);
            }
        }
        self.unsettled = Some(unsettled);
    }
}

/// Roll-off in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

/// Corner below which a sensor is seldom read so fast, as a share of the rate: fifty samples in the
/// time that it takes to answer tell no more than five.
const SELDOM: f64 = 0.02;

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

    fn surprise_nats(&self, values: &[f64], rate_hz: f64) -> f64 {
        /// What that costs: one instrument in seven, a choice. It decides where noise with a correlation time
        /// and a pole on all noise differ by less than the record can distinguish.
        const NATS: f64 = 2.0;
        if values[0] < SELDOM * rate_hz {
            NATS
        } else {
            0.0
        }
    }

    fn starts(&self, band: &Band) -> Vec<Vec<f64>> {
        // Up to far above half the rate, where only the beginning of the fall shows: from a corner that is
        // too low by more than the root of two the likelihood would not rise. What is found at less than half of
        // where a search begins is none, but a process that is slow: whoever reads a hundred samples in the time that a filter takes to
        // answer has noise of the reading as well, which no filter has touched.
        Band {
            from_hz: SELDOM * 2.0 * band.to_hz,
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
                let made = filter.symmetric.power(radians) * pole_power(filter.kept, radians);
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
