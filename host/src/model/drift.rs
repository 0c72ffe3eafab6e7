//! Drift: the level goes slowly and smoothly where nothing that was recorded with it leads.

use super::Seed;
use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::once::Once;
use super::random::Generator;
use crate::numeric::written::significant;

/// A natural cubic spline through levels at even distances, the first at the start of the record; after the last the
/// level stays. It is the smoothest curve through them: of all with these levels it has the least mean square of the
/// second derivative (I. J. Schoenberg, Proc. Natl. Acad. Sci. 52, 1964). Not random: as for
/// [`Steps`](super::steps::Steps), the law says zero, and whoever knows the record takes out the course that the
/// generator makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Drift {
    /// Time from the first level to the last, seconds.
    pub duration_s: f64,
    /// The levels, unit of the signal.
    pub levels: Vec<f64>,
}

impl Drift {
    /// With these parameters, in the catalogue's order.
    pub fn of(values: &[f64]) -> Self {
        Self {
            duration_s: values[0],
            levels: values[1..].to_vec(),
        }
    }

    /// The same upside down.
    #[must_use]
    pub fn negated(&self) -> Self {
        Self {
            levels: self.levels.iter().map(|level| -level).collect(),
            ..*self
        }
    }

    /// Its course, sample by sample.
    pub fn spline(&self, rate_hz: f64) -> Spline {
        let intervals = self.levels.len().saturating_sub(1).max(1);
        Spline {
            per_sample: intervals as f64 / (self.duration_s * rate_hz),
            bends: bends(&self.levels),
            levels: self.levels.clone(),
            index: 0,
        }
    }
}

/// Second derivatives of the natural cubic spline through `levels` at distance one: zero at both ends, and between them
/// so that the first derivative is continuous, `b_(i-1) + 4 b_i + b_(i+1) = 6 (y_(i-1) - 2 y_i + y_(i+1))`.
fn bends(levels: &[f64]) -> Vec<f64> {
    let inner = levels.len().saturating_sub(2);
    // Gauss' elimination of a matrix with three diagonals, downwards and back.
    let (mut above, mut right) = (vec![0.0; inner], vec![0.0; inner]);
    for (row, three) in levels.windows(3).enumerate() {
        let (above_before, right_before) = match row {
            0 => (0.0, 0.0),
            _ => (above[row - 1], right[row - 1]),
        };
        let pivot: f64 = 4.0 - above_before;
        above[row] = pivot.recip();
        right[row] = (6.0 * (three[0] - 2.0 * three[1] + three[2]) - right_before) / pivot;
    }
    let mut bends = vec![0.0; levels.len()];
    for row in (0..inner).rev() {
        bends[row + 1] = right[row] - above[row] * bends[row + 2];
    }
    bends
}

/// The course of a drift, sample by sample from the first.
pub struct Spline {
    levels: Vec<f64>,
    /// Second derivatives there, the distance of two levels as unit of time.
    bends: Vec<f64>,
    /// Distances of two levels that a sample lasts.
    per_sample: f64,
    index: u64,
}

impl Spline {
    /// The course at a time in distances of two levels.
    fn at(&self, time: f64) -> f64 {
        let place = time as usize;
        let Some([low, high]) = self
            .levels
            .get(place..place + 2)
            .map(|ends| [ends[0], ends[1]])
        else {
            return self.levels.last().copied().unwrap_or(0.0);
        };
        let after = time - place as f64;
        let before = 1.0 - after;
        let bend = |share: f64| share * (share * share - 1.0) / 6.0;
        before * low
            + after * high
            + bend(before) * self.bends[place]
            + bend(after) * self.bends[place + 1]
    }
}

impl Generator for Spline {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            *sample += self.at(self.index as f64 * self.per_sample);
            self.index += 1;
        }
    }
}

impl Once for Drift {
    fn drifts(&self) -> bool {
        true
    }

    fn course(&self, rate_hz: f64, _seed: Seed) -> Box<dyn Generator> {
        Box::new(self.spline(rate_hz))
    }
}

/// Drift in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "drift"
    }

    fn meaning(&self) -> &'static str {
        "the level goes slowly and smoothly where nothing that was recorded with it leads: the temperature first of \
         all, then what the sensor stands on"
    }

    fn parameters(&self, values: &[f64]) -> Vec<Parameter> {
        let duration = Parameter::new(
            "duration_s",
            Quantity::Second,
            "time from the first level to the last",
        );
        let level = |number| {
            Parameter::new(
                "level",
                Quantity::Signal,
                "level, at even distances in time",
            )
            .in_row(number)
        };
        let levels = values.len().saturating_sub(1).max(2);
        std::iter::once(duration)
            .chain((1..=levels).map(level))
            .collect()
    }

    fn check(&self, values: &[f64]) -> String {
        let levels = &values[1..];
        let least = levels.iter().copied().fold(f64::INFINITY, f64::min);
        let most = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        format!(
            "record the temperature with it and give the column as --temperature: a drift of {} that follows it is \
             `thermal`; of two boards side by side both drift if it is the room",
            significant(most - least, 4)
        )
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(Drift::of(values)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(drift: &Drift, samples: usize, rate_hz: f64) -> Vec<f64> {
        let mut course = vec![0.0; samples];
        drift.spline(rate_hz).add_to(&mut course);
        course
    }

    #[test]
    fn passes_through_its_levels_and_stays_after_the_last() {
        let levels = vec![1.0, -2.0, 0.5, 0.5, 7.0];
        let drift = Drift {
            duration_s: 4.0,
            levels: levels.clone(),
        };
        let course = course(&drift, 601, 100.0);
        for (number, level) in levels.iter().enumerate() {
            assert!((course[100 * number] - level).abs() < 1e-12, "{number}");
        }
        assert!(course[400..].iter().all(|level| *level == 7.0));
    }

    #[test]
    fn is_smooth_and_straight_at_both_ends() {
        let drift = Drift {
            duration_s: 6.0,
            levels: vec![0.0, 3.0, -1.0, 2.0, 2.0, -4.0, 1.0],
        };
        let course = course(&drift, 6001, 1000.0);
        let bend = |n: usize| course[n - 1] - 2.0 * course[n] + course[n + 1];
        // The second derivative is continuous: it changes by no more from sample to sample than a thousandth of the
        // third, and that is largest where it goes from one level's to the next one's.
        let most = (1..6000).map(|n| bend(n).abs()).fold(0.0, f64::max);
        for n in 2..6000 {
            assert!((bend(n) - bend(n - 1)).abs() < 3e-3 * most, "{n}");
        }
        assert!(bend(1).abs() < 3e-3 * most && bend(5999).abs() < 3e-3 * most);
    }

    #[test]
    fn a_straight_line_stays_one() {
        let drift = Drift {
            duration_s: 10.0,
            levels: vec![1.0, 1.5, 2.0, 2.5],
        };
        for (n, level) in course(&drift, 100, 10.0).iter().enumerate() {
            assert!((level - 1.0 - 0.015 * n as f64).abs() < 1e-12, "{n}");
        }
    }
}
