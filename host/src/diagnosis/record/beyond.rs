//! Samples at a rail, drawn from beyond it.
//!
//! A sample at a limit says that the true one lies beyond it. What is drawn in its place without that lies short of the limit as often as
//! not, and what was measured beside it looks louder than it is. So each is drawn again from its law given all others and the
//! limit, by turns (A. E. Gelfand, A. F. M. Smith and T.-M. Lee, J. Am. Stat. Assoc. 87 (1992) 523): with the circulant matrix `P` of the
//! spectrum `1 / S`, a sample is normal about `x - (P x) / P_0` with the variance `1 / P_0`, cut at the limit.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::diagnosis::record::drawn::{Drawn, Noise};
use crate::diagnosis::record::wave::{Side, Wave};
use crate::diagnosis::statistic::matched_filter::Transform;

/// A sample that lies beyond a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Its place.
    pub index: usize,
    /// The limit, in what is left of the record.
    pub value: f64,
    /// 1 if it lies above, -1 if below.
    pub sign: f64,
}

/// Limits that samples lie beyond which were replaced by some waves as no measurements, in what is `left` of the record; ascending.
pub fn limits(waves: &[Wave], left: &[f64]) -> Vec<Limit> {
    let limits = waves.iter().flat_map(|wave| {
        let (all, sign) = match wave {
            Wave::Replaced(one) if one.side == Side::Above => (one.all.as_slice(), 1.0),
            Wave::Replaced(one) if one.side == Side::Below => (one.all.as_slice(), -1.0),
            _ => (&[][..], 0.0),
        };
        all.iter().map(move |one| Limit {
            index: one.index,
            value: left[one.index] + one.size,
            sign,
        })
    });
    let mut limits: Vec<Limit> = limits.collect();
    limits.sort_by_key(|one| one.index);
    limits
}

/// Turns: a choice. White samples need one; an excursion of a walk began between its ends as it may be.
const TURNS: usize = 8;

/// Samples within which one moves another within a turn: a choice. What reaches further is made good with the next.
const REACH: usize = 32;

/// What samples further apart than that may pull at each other within a turn, over what each is held by, at most: half of it, so that
/// what a turn leaves of it grows no further. Quantisation noise reaches over all of a record.
const PULL: f64 = 0.5;

/// Variance of a sample given all others over that of noise as loud as in the middle of the band, at least: a choice. Behind a
/// converter's filter the others leave a sample no room, and one by one none can move.
const ROOM: f64 = 0.01;

/// Draws the samples of `values` that lie beyond `limits`, ascending, with `noise` on the ring on which all that is missing
/// is `drawn`.
pub fn draw(values: &mut [f64], limits: &[Limit], noise: &Noise<'_>, drawn: &Drawn) {
    let (rate_hz, density) = (noise.rate_hz, noise.density);
    let inverse = |record: &Transform| record.filtered(|k| (density[k] * rate_hz).recip().into());
    let row = inverse(&drawn.impulse(rate_hz));
    let far = row[REACH + 1..=row.len() / 2].iter().map(|one| one.abs());
    let share = limits.len() as f64 / values.len() as f64;
    let pull = 2.0 * share * far.sum::<f64>() / row[0];
    if row[0].recip() < ROOM * density[density.len() / 2] * rate_hz || pull > PULL {
        return;
    }
    let usual = row[0].sqrt().recip();
    let mut normal = drawn.numbers();
    for _ in 0..TURNS {
        let whole = inverse(&drawn.closed(values, rate_hz));
        let mut pulls: Vec<f64> = limits.iter().map(|one| whole[one.index]).collect();
        for (place, limit) in limits.iter().enumerate() {
            let value = values[limit.index];
            let mean = value - pulls[place] / row[0];
            let sd = usual * (noise.strength)(limit.index);
            let least = limit.sign * (limit.value - mean) / sd;
            let now = mean + limit.sign * sd * beyond(least, normal.draw());
            values[limit.index] = now;
            let reached = limits[place..].iter().zip(&mut pulls[place..]);
            for (other, pull) in reached {
                let apart = other.index - limit.index;
                if apart > REACH {
                    break;
                }
                *pull += (now - value) * row[apart];
            }
        }
    }
}

/// A standard normal number of which it is known that it is not below `least`, made of one of which nothing is known.
fn beyond(least: f64, normal: f64) -> f64 {
    /// From here on the tail falls exponentially, to a part in a thousand.
    const FAR: f64 = 30.0;
    let standard = Normal::standard();
    let share = standard.sf(normal).max(f64::MIN_POSITIVE);
    if least > FAR {
        return least - share.ln() / least;
    }
    -standard.inverse_cdf(share * standard.sf(least))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Seed;
    use crate::model::random::Gaussian;

    #[test]
    fn normal_numbers_beyond_a_limit_have_the_mean_of_their_tail() {
        let standard = Normal::standard();
        let mut normal = Gaussian::new(Seed { seed: 1, stream: 0 }, 1.0);
        const COUNT: usize = 4000;
        for least in [-3.0, 0.0, 1.0, 5.0, 20.0, 40.0_f64] {
            let drawn: Vec<f64> = (0..COUNT).map(|_| beyond(least, normal.draw())).collect();
            assert!(drawn.iter().all(|one| *one >= least - 1e-9), "{least}");
            let mean = drawn.iter().sum::<f64>() / COUNT as f64;
            // Density over tail (J. Mills); far out the limit and its inverse.
            let expected = match least {
                _ if least > 10.0 => least + 1.0 / least,
                _ => {
                    let density = (-0.5 * least * least).exp() / std::f64::consts::TAU.sqrt();
                    density / standard.sf(least)
                }
            };
            // A tail scatters by no more than a normal law, and by no more than its mean lies beyond the limit.
            let sd = (expected - least).min(1.0) / (COUNT as f64).sqrt();
            assert!(
                (mean - expected).abs() < 5.0 * sd,
                "{least}: {mean}, seed 1"
            );
        }
    }

    #[test]
    fn what_lies_beyond_a_limit_is_as_large_as_what_was_cut() {
        const LENGTH: usize = 20_000;
        const LIMIT: f64 = 0.8;
        let mut normal = Gaussian::new(Seed { seed: 2, stream: 0 }, 1.0);
        let truth: Vec<f64> = (0..LENGTH).map(|_| normal.draw()).collect();
        let limits: Vec<Limit> = (0..LENGTH)
            .filter(|n| truth[*n] > LIMIT)
            .map(|index| Limit {
                index,
                value: LIMIT,
                sign: 1.0,
            })
            .collect();
        let mut values: Vec<f64> = truth.iter().map(|value| value.min(LIMIT)).collect();
        let drawn = Drawn::of(&values);
        let count = drawn.ring_len() / 2 + 1;
        let density = vec![1.0; count];
        let draw = |values: &mut [f64], density: &[f64]| {
            let noise = Noise {
                rate_hz: 1.0,
                density,
                strength: &|_| 1.0,
            };
            draw(values, &limits, &noise, &drawn);
        };
        draw(&mut values, &density);
        let square =
            |values: &[f64]| values.iter().map(|one| one * one).sum::<f64>() / LENGTH as f64;
        let (found, is) = (square(&values), square(&truth));
        // A fifth of the squares are drawn, of deviation 1.6 each.
        let sd = 1.6 * (0.21 / LENGTH as f64).sqrt();
        assert!((found - is).abs() < 5.0 * sd, "{found} of {is}, seed 2");
        // Where the others say all there is to know, none is moved.
        let mut filtered = density;
        filtered[2 * count / 3..].fill(1e-6);
        let before = values.clone();
        draw(&mut values, &filtered);
        assert_eq!(values, before);
        // Nor where each pulls at all others, as in quantisation noise.
        let turn = |k: usize| 0.5 * std::f64::consts::PI * k as f64 / count as f64;
        let rising: Vec<f64> = (0..count).map(|k| 1e-6 + turn(k).sin().powi(2)).collect();
        let mut values: Vec<f64> = truth.iter().map(|value| value.min(0.5 * LIMIT)).collect();
        let before = values.clone();
        draw(&mut values, &rising);
        assert_eq!(values, before);
    }
}
