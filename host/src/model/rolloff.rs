//! Roll-off: analog poles that the declared signal chain does not have.

use std::f64::consts::{PI, TAU};

use super::Seed;
use super::effect::{Band, Distorter, Distortion, Effect, Parameter, Part, Quantity, Stage};
use super::filter::{self, DEEPEST, Filter, Place, Poles};
use super::kind::Kind;
use super::marks::Mark;

/// Poles of a Butterworth response `B(f) = 1 / (1 + (f / corner)^(2 poles))^times` on all that is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollOff {
    /// Frequency of half power of each time, hertz.
    pub corner_hz: f64,
    /// How many poles each time, one or more.
    pub poles: u8,
    /// How many times one after the other: twice where it runs forward and back, or where two stages are equal.
    pub times: u8,
    /// Where they are: `|H|^2 = B(f)` ahead of a converter that has a filter of its own, `sum_k B(f + k rate) / sum_k B(k rate)`
    /// within a sensor, `B(rate / pi tan(pi f / rate))`, the corner likewise, behind it, by the bilinear transform.
    pub place: Place,
}

impl RollOff {
    /// With these parameters, in the catalogue's order; of one pole ahead of the converter where no more is said.
    pub fn of(values: &[f64]) -> Self {
        let count =
            |place: usize, most: f64| values.get(place).map(|one| one.clamp(1.0, most) as u8);
        let poles = count(1, MOST_POLES);
        let place = poles.map_or(Place::Ahead, |_| Place::of(values.get(2)));
        Self {
            corner_hz: values[0],
            poles: poles.unwrap_or(1),
            times: count(3, MOST_TIMES).unwrap_or(1),
            place,
        }
    }

    /// Its poles as a recursion over samples.
    fn digital(&self, rate_hz: f64) -> Poles {
        let decay = TAU * self.corner_hz / rate_hz;
        Poles::new(usize::from(self.poles), decay).repeated(self.times)
    }

    /// Power at so many corners.
    fn butterworth(&self, corners: f64) -> f64 {
        (1.0 + corners.powi(2 * i32::from(self.poles))).powi(-i32::from(self.times))
    }

    /// Power with all that folds down about multiples of the rate.
    fn folded(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let power = |f_hz: f64| self.butterworth(f_hz / self.corner_hz);
        // At half the rate image `k` of a corner far below is `(2 k - 1)^(-2 poles)` of the first.
        let images = match self.poles * self.times {
            1 => return self.folded_pole(f_hz, rate_hz),
            2 => 6.0,
            _ => 3.0,
        };
        let images = images + (2.0 * self.corner_hz / rate_hz).min(MOST_IMAGES).ceil();
        let beyond = (1..=images as u32).map(|image| {
            let beyond_hz = f64::from(image) * rate_hz;
            power(f_hz + beyond_hz) + power(f_hz - beyond_hz)
        });
        power(f_hz) + beyond.sum::<f64>()
    }

    /// The same of one pole: what an autoregressive series has.
    fn folded_pole(&self, f_hz: f64, rate_hz: f64) -> f64 {
        // Beyond, it is flat to a part in 10^20, and its hyperbolic sine is soon no number.
        let decay = (TAU * self.corner_hz / rate_hz).min(50.0);
        let turn = TAU * f_hz / rate_hz;
        // (cosh decay - cos turn) without the difference of what is nearly equal.
        let apart = 2.0 * ((0.5 * decay).sinh().powi(2) + (0.5 * turn).sin().powi(2));
        0.5 * decay * decay.sinh() / apart
    }
}

/// Images for a corner above half the rate, at most: a choice.
const MOST_IMAGES: f64 = 16.0;

/// Poles at most: a choice. The response of more is a wall.
const MOST_POLES: f64 = 12.0;

/// Times at most: a choice, twice is what is built.
const MOST_TIMES: f64 = 4.0;

/// Up to which share of the rate a frequency is bent: a choice that keeps numbers finite.
const HIGHEST: f64 = 0.4999;

impl Distortion for RollOff {
    fn stage(&self) -> Stage {
        Stage::Filter
    }

    fn power(&self, f_hz: f64, rate_hz: f64) -> f64 {
        match self.place {
            Place::Ahead => self.butterworth(f_hz / self.corner_hz),
            Place::Within => self.folded(f_hz, rate_hz) / self.folded(0.0, rate_hz),
            Place::Behind => {
                // At half the rate the tangent has no end.
                let bent = |f_hz: f64| (PI * f_hz.min(HIGHEST * rate_hz) / rate_hz).tan();
                self.butterworth(bent(f_hz) / bent(self.corner_hz))
                    .max(DEEPEST)
            }
        }
    }

    fn distorter(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Distorter> {
        let poles = self.digital(rate_hz);
        Box::new(Filter::new(
            poles,
            |f_hz| self.power(f_hz, rate_hz),
            rate_hz,
        ))
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
        if RollOff::of(values).poles > 1 {
            return format!(
                "compare {:.4} Hz with the bandwidth that is set in the sensor's registers or its driver, and with the filters \
                 of the data sheet: that many poles are a filter's, not an RC's",
                values[0]
            );
        }
        format!(
            "compare {:.4} Hz with the data sheet's bandwidth and the RC at the sensor's output; \
             if it is one of them, declare it: --chain {:.0}hz",
            values[0], values[0]
        )
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let corner = Parameter::new("corner_hz", Quantity::Hertz, "frequency of half power");
        let poles = Parameter::new(
            "poles",
            Quantity::Count,
            "poles of a Butterworth response inside of a sensor; left out, one ahead of the converter",
        );
        let own_rate = Parameter::new(
            "own_rate",
            Quantity::Count,
            "1 where the filter runs at the record's own rate, 0 where it runs faster",
        );
        let times = Parameter::new(
            "times",
            Quantity::Count,
            "how many times one after the other, 2 where it runs forward and back; left out, once",
        );
        let all = [corner, poles, own_rate, times];
        all.into_iter().take(values.len().max(1)).collect()
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        vec![Mark::Corner(values[0])]
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Distortion(Box::new(RollOff::of(values)))
    }

    fn surprise_nats(&self, values: &[f64], rate_hz: f64) -> f64 {
        /// What that costs: one instrument in seven, a choice. It decides where noise with a correlation time
        /// and a pole on all noise differ by less than the record can distinguish.
        const NATS: f64 = 2.0;
        let slow = if values[0] < SELDOM * rate_hz {
            NATS
        } else {
            0.0
        };
        slow + filter::surprise_nats(values)
    }

    fn starts(&self, band: &Band) -> Vec<Vec<f64>> {
        // Up to far above half the rate, where only the beginning of the fall shows: from a corner that is
        // too low by more than the root of two the likelihood would not rise. What is found at less than half of
        // where a search begins is none, but a process that is slow: whoever reads a hundred samples in the time that a filter takes to
        // answer has noise of the reading as well, which no filter has touched.
        let from_hz = SELDOM * 2.0 * band.to_hz;
        let corners = |to_hz: f64| -> Vec<f64> { Band { from_hz, to_hz }.steps(2.0).collect() };
        let one = filter::starts(&corners(16.0 * band.to_hz), &[&[]]);
        // Of others the flank is in the band, or there is nothing to know them by.
        let flanks = corners(0.7 * band.to_hz);
        let within: [&[f64]; 5] = [&[1.0], &[2.0], &[3.0], &[4.0], &[1.0, 0.0, 2.0]];
        let behind: [&[f64]; 4] = [&[1.0, 1.0], &[2.0, 1.0], &[4.0, 1.0], &[8.0, 1.0]];
        let forward_and_back: [&[f64]; 3] = [&[1.0, 1.0, 2.0], &[2.0, 1.0, 2.0], &[4.0, 1.0, 2.0]];
        let sorts = [&within[..], &behind, &forward_and_back].concat();
        let others = filter::starts(&flanks, &sorts);
        [one, others].concat()
    }
}

#[cfg(test)]
mod tests;
