//! What a column says without the noise of its own reading.
//!
//! A thermometer adds noise that the sensor does not follow. Behind a short lag more of it is left than behind a long one,
//! so that a lag that is fitted to the readings themselves comes out too long, and the gain too small (errors in the
//! variables: W. A. Fuller, *Measurement Error Models*, 1987). Temperature itself is slow and smooth: a level whose slope goes
//! for a walk, `T[n + 1] = T[n] + s[n]`, `s[n + 1] = s[n] + w[n]`, read as `T[n] + v[n]`. How far the slope walks beside what the
//! reading adds is what makes the readings likeliest (R. E. Kalman 1960), and the level given all of them is the smoothing spline of
//! that stiffness (H. E. Rauch, F. Tung and C. T. Striebel, AIAA J. 3 (1965) 1445). It has no seam: as the record begins
//! and ends it is as smooth as within.

use crate::diagnosis::record::bridge::block_means;
use crate::numeric::top::golden_section;

/// Means that a column is smoothed in, at most: a choice. One of a million readings a record is a mean over 16, in which no
/// temperature bends.
const MEANS: usize = 1 << 16;

/// Means below which nothing is known of their noise: two say a level and a slope.
const FEWEST: usize = 3;

/// Logarithm of the variance of the slope's steps over that of the reading, at most: readings to which nothing is added, up to a
/// quarter of their rate.
const STIFFEST: f64 = 10.0;

/// The same at least: of `MEANS` readings that lie on one straight line it is as good as none, for the slope would turn within
/// the fourth root of its inverse, a million.
const SOFTEST: f64 = -55.0;

/// A column without what its reading adds, and what is left of that.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The column, one value a sample.
    pub column: Vec<f64>,
    /// Variance of what one reading adds.
    variance: f64,
    /// Readings over which the slope turns as much as they are known: of slower noise all is left.
    stiff: f64,
}

impl Reading {
    /// Of a column as it is read, one value a sample.
    pub fn of(column: &[f64]) -> Self {
        let factor = column.len().div_ceil(MEANS).max(1);
        let means = block_means(column, factor);
        if means.len() < FEWEST {
            return Self::exact(column.to_vec());
        }
        let ratio = likeliest(&means);
        let states = smoothed(&means, ratio);
        let last = states.len() - 2;
        let between = |n: usize| {
            let place = (n as f64 + 0.5) / factor as f64 - 0.5;
            let from = (place.max(0.0) as usize).min(last);
            cubic([states[from], states[from + 1]], place - from as f64)
        };
        let variance = factor as f64 * filtered(&means, ratio, |_, _| ()).variance;
        Self {
            column: (0..column.len()).map(between).collect(),
            variance,
            stiff: factor as f64 * ratio.powf(-0.25),
        }
    }

    /// Of a column to which nothing is added.
    pub const fn exact(column: Vec<f64>) -> Self {
        Self {
            column,
            variance: 0.0,
            stiff: 1.0,
        }
    }

    /// Two-sided density of what is left of the noise in the column, at `turn` radians a sample of `rate_hz`; per hertz.
    pub fn density(&self, turn: f64, rate_hz: f64) -> f64 {
        let passed = 1.0 / (1.0 + (turn * self.stiff).powi(4));
        self.variance / rate_hz * passed * passed
    }
}

/// A level, and by how much it rises until the next one.
#[derive(Debug, Clone, Copy)]
struct State {
    level: f64,
    slope: f64,
}

/// How well a state is known: variances of level and slope, and what they have in common, over the variance of a reading.
#[derive(Debug, Clone, Copy)]
struct Spread {
    level: f64,
    both: f64,
    slope: f64,
}

/// The level at a place between two neighbours, 0 at the first and 1 at the second, by the cubic that has their slopes (C. Hermite).
/// Beyond them it goes on straight.
fn cubic([one, other]: [State; 2], place: f64) -> f64 {
    if place <= 0.0 {
        return one.level + place * one.slope;
    }
    if place >= 1.0 {
        return other.level + (place - 1.0) * other.slope;
    }
    let rest = 1.0 - place;
    let own = rest * rest * ((1.0 + 2.0 * place) * one.level + place * one.slope);
    own + place * place * ((1.0 + 2.0 * rest) * other.level - rest * other.slope)
}

/// Variance of the slope's steps, over that of a reading, that makes the readings likeliest.
fn likeliest(readings: &[f64]) -> f64 {
    /// Distance of the logarithms that are tried first, a factor of about fifty, and halvings of the golden section's kind that
    /// follow: to a factor of 1.01.
    const EVERY: f64 = 4.0;
    const STEPS: u32 = 14;
    let nats = |log: f64| filtered(readings, log.exp(), |_, _| ()).nats;
    let tried = std::iter::successors(Some(SOFTEST), |log| Some(log + EVERY));
    let tried = tried.take_while(|log| *log <= STIFFEST);
    let best = tried.map(|log| (log, nats(log)));
    let best = best.max_by(|a, b| a.1.total_cmp(&b.1));
    let log = best.map_or(STIFFEST, |(log, _)| log);
    golden_section(log - EVERY, log + EVERY, STEPS, nats).exp()
}

/// How likely readings are.
struct Likelihood {
    /// Its logarithm, nats but for a constant.
    nats: f64,
    /// The likeliest variance of a reading.
    variance: f64,
}

/// Likelihood of `readings` whose slope walks by steps of a variance that is `ratio` times that of a reading. Each state, given the
/// readings up to its own, goes to `to`.
fn filtered(readings: &[f64], ratio: f64, mut to: impl FnMut(State, Spread)) -> Likelihood {
    // What the first two say, nothing being known before them.
    let mut state = State {
        level: readings[1],
        slope: readings[1] - readings[0],
    };
    let mut spread = Spread {
        level: 1.0,
        both: 1.0,
        slope: 2.0,
    };
    let first = State {
        level: readings[0],
        ..state
    };
    to(
        first,
        Spread {
            both: -1.0,
            ..spread
        },
    );
    to(state, spread);
    let (mut squares, mut logs) = (0.0, 0.0);
    for reading in &readings[2..] {
        let (ahead, wide) = next(state, spread, ratio);
        let variance = wide.level + 1.0;
        let error = reading - ahead.level;
        squares += error * error / variance;
        logs += variance.ln();
        let gains = [wide.level / variance, wide.both / variance];
        state = State {
            level: ahead.level + gains[0] * error,
            slope: ahead.slope + gains[1] * error,
        };
        spread = Spread {
            level: gains[0],
            both: gains[1],
            slope: wide.slope - gains[1] * wide.both,
        };
        to(state, spread);
    }
    let count = (readings.len() - 2) as f64;
    let variance = squares / count;
    Likelihood {
        nats: -0.5 * (count * variance.max(f64::MIN_POSITIVE).ln() + logs),
        variance,
    }
}

/// A reading later.
fn next(state: State, spread: Spread, ratio: f64) -> (State, Spread) {
    let ahead = State {
        level: state.level + state.slope,
        slope: state.slope,
    };
    let wide = Spread {
        level: spread.level + 2.0 * spread.both + spread.slope,
        both: spread.both + spread.slope,
        slope: spread.slope + ratio,
    };
    (ahead, wide)
}

/// Each state given all readings.
fn smoothed(readings: &[f64], ratio: f64) -> Vec<State> {
    let mut known = Vec::with_capacity(readings.len());
    filtered(readings, ratio, |state, spread| known.push((state, spread)));
    let mut later = known[known.len() - 1].0;
    let mut states = vec![later; known.len()];
    for (place, (state, spread)) in known.iter().enumerate().rev().skip(1) {
        let (ahead, wide) = next(*state, *spread, ratio);
        let determinant = wide.level * wide.slope - wide.both * wide.both;
        // Covariance of the state with the one a reading later, over the spread of that.
        let of_level = [spread.level + spread.both, spread.both];
        let of_slope = [spread.both + spread.slope, spread.slope];
        let off = [later.level - ahead.level, later.slope - ahead.slope];
        let moved = [
            (wide.slope * off[0] - wide.both * off[1]) / determinant,
            (wide.level * off[1] - wide.both * off[0]) / determinant,
        ];
        let add = |row: [f64; 2]| row[0] * moved[0] + row[1] * moved[1];
        later = State {
            level: state.level + add(of_level),
            slope: state.slope + add(of_slope),
        };
        states[place] = later;
    }
    states
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Seed;
    use crate::model::random::Gaussian;

    /// Two slow waves, and the same as they are read.
    fn read(seed: u64, len: usize, noise: f64) -> [Vec<f64>; 2] {
        let mut normal = Gaussian::new(Seed { seed, stream: 0 }, noise);
        let wave = |n: usize| (0.0003 * n as f64).sin() + 0.3 * (0.0011 * n as f64).cos();
        let true_values: Vec<f64> = (0..len).map(wave).collect();
        let read = true_values
            .iter()
            .map(|value| value + normal.draw())
            .collect();
        [true_values, read]
    }

    #[test]
    fn slow_waves_stay_and_most_of_the_noise_goes() {
        for (seed, len) in [(1, 100_000), (2, 65_537), (3, 30_011)] {
            let [is, read] = read(seed, len, 0.05);
            let found = Reading::of(&read).column;
            let squares = (0..len).map(|n| (found[n] - is[n]).powi(2));
            let rms = (squares.sum::<f64>() / len as f64).sqrt();
            // A tenth of the noise: a hundredth of all ordinates.
            assert!(rms < 0.005, "seed {seed}: {rms}");
            // As it begins and ends half as much is known: the mean of hundred readings is, with a slope, four times as wide.
            for end in [0, len - 1] {
                let off = (found[end] - is[end]).abs();
                assert!(off < 4.0 * 0.02, "seed {seed}: {off} at {end}");
            }
        }
    }

    #[test]
    fn a_column_without_noise_stays_as_it_is() {
        let [is, _] = read(4, 50_000, 0.05);
        let found = Reading::of(&is).column;
        let off = |range: std::ops::Range<usize>| {
            let off = range.map(|n| (found[n] - is[n]).abs());
            off.fold(0.0, f64::max)
        };
        // Waves of height 1, which bend by a millionth from one sample to the next.
        let off = off(0..50_000);
        assert!(off < 1e-6, "{off:e}");
        assert_eq!(Reading::of(&[20.0; 1000]).column, [20.0; 1000]);
    }
}
