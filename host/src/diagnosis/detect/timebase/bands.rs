//! Wide peaks of a spectrum: tones that wander, noise that rings.
//!
//! Averaged periodograms (P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967)) over the median
//! of their neighbours; what stands out is one band as far as it stays above the floor. Its middle is
//! the centre of the power beyond the floor. How far that moves from one part of the record to the
//! next is what its place in another record is uncertain by: a source that wanders within hours
//! wanders between days.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;

use crate::numeric::order::median;
use crate::numeric::taper::hann;

/// Samples of a segment, at most and at least: choices between the width of a bin and the number of
/// averages.
const SEGMENT: [usize; 2] = [1 << 15, 1 << 10];

/// Segments in a record, at least: half overlapped they scatter as 52 would, by 14 %. Of fewer a
/// band does not stand out of noise.
const SEGMENTS: usize = 32;

/// Parts of a record whose middles are compared: a choice, the eight of the test of lines.
const PARTS: usize = 8;

/// Neighbours that the floor is the median of: this share of a bin's number to either side, and no
/// more than that many. Choices: three quarters of an octave, which a band is to be narrow in.
const SPAN: f64 = 0.25;
const MOST_NEIGHBOURS: usize = 400;

/// Lowest bin that is looked at: its floor is the median of 13.
const LOWEST: usize = 24;

/// Standard deviations of a bin beyond the floor where a band begins, and where it ends: choices. A
/// begin by chance must be rare among 16 384 bins, an end need not be.
const STANDS_OUT: f64 = 6.0;
const ENDS: f64 = 2.0;

/// Share of the wider one's width within which two bands are one: a choice.
const CLOSE: f64 = 0.5;

/// Bins by which the middle of a band is uncertain, at least: a line between two of them. A tenth
/// is a choice.
const BIN_SD: f64 = 0.1;

/// A band that stands out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Centre of the power beyond the floor, hertz.
    pub f_hz: f64,
    /// By how much that moves from one eighth of the record to another, standard deviation, hertz.
    pub f_sd_hz: f64,
    /// Where it begins and ends, hertz.
    pub ends_hz: [f64; 2],
    /// Power beyond the floor, squared unit of the signal.
    pub power: f64,
}

/// The bands of a record without gaps, ascending. None where the record is too short.
pub fn bands(values: &[f64], rate_hz: f64) -> Vec<Band> {
    let longest = (values.len() / SEGMENTS).max(1);
    let segment = SEGMENT[0].min(1 << longest.ilog2());
    if segment < SEGMENT[1] {
        return Vec::new();
    }
    let parts: Vec<Vec<f64>> = values
        .chunks_exact(values.len() / PARTS)
        .take(PARTS)
        .map(|part| periodogram(part, segment, rate_hz))
        .collect();
    let bins = segment / 2;
    let mean: Vec<f64> = (0..bins)
        .map(|k| parts.iter().map(|part| part[k]).sum::<f64>() / PARTS as f64)
        .collect();
    let floor: Vec<f64> = (0..bins).map(|k| median_about(&mean, k)).collect();
    // Hann windows that overlap by half: 18/11 of the segments count (Welch 1967).
    let count = (values.len() / segment) as f64 * 18.0 / 11.0;
    let beyond = |k: usize| (mean[k] / floor[k] - 1.0) * count.sqrt();
    let bin_hz = rate_hz / segment as f64;
    standing_out(bins, beyond)
        .iter()
        .map(|&[low, high]| {
            let middle = |power: &dyn Fn(usize) -> f64| {
                let (mut sum, mut first) = (0.0, 0.0);
                for (k, floor) in floor.iter().enumerate().take(high + 1).skip(low) {
                    let power = (power(k) - floor).max(0.0);
                    sum += power;
                    first += power * k as f64;
                }
                (first / sum, sum)
            };
            let (centre, power) = middle(&|k| mean[k]);
            let squares: f64 = parts
                .iter()
                .map(|part| (middle(&|k| part[k]).0 - centre).powi(2))
                .filter(|square| square.is_finite())
                .sum();
            let sd = (squares / (PARTS - 1) as f64).sqrt().max(BIN_SD);
            Band {
                f_hz: centre * bin_hz,
                f_sd_hz: sd * bin_hz,
                ends_hz: [(low as f64 - 1.0) * bin_hz, (high as f64 + 1.0) * bin_hz],
                // Two-sided densities.
                power: 2.0 * power * bin_hz,
            }
        })
        .collect()
}

/// First and last bin of all that stands out of `bins`; `beyond` is by how many deviations a bin does.
fn standing_out(bins: usize, beyond: impl Fn(usize) -> f64) -> Vec<[usize; 2]> {
    let mut found: Vec<[usize; 2]> = Vec::new();
    let mut k = LOWEST;
    while k + 1 < bins {
        if beyond(k) < STANDS_OUT {
            k += 1;
            continue;
        }
        let (mut low, mut high) = (k, k);
        while low > 1 && beyond(low - 1) > ENDS {
            low -= 1;
        }
        while high + 2 < bins && beyond(high + 1) > ENDS {
            high += 1;
        }
        k = high + 1;
        match found.last_mut() {
            Some(last) if close(*last, [low, high]) => last[1] = high,
            _ => found.push([low, high]),
        }
    }
    found
}

fn close(one: [usize; 2], next: [usize; 2]) -> bool {
    let width = (one[1] - one[0]).max(next[1] - next[0]);
    (next[0].saturating_sub(one[1])) as f64 <= CLOSE * width as f64
}

/// Two-sided densities of tapered segments that overlap by half, their means taken out.
fn periodogram(values: &[f64], segment: usize, rate_hz: f64) -> Vec<f64> {
    let window: Vec<f64> = (0..segment)
        .map(|n| hann(n as f64 + 0.5, segment as f64))
        .collect();
    let energy: f64 = window.iter().map(|w| w * w).sum();
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(segment);
    let mut output = plan.make_output_vec();
    let mut sums = vec![0.0; segment / 2];
    let mut count = 0.0;
    let mut from = 0;
    while from + segment <= values.len() {
        let part = &values[from..from + segment];
        let mean = part.iter().sum::<f64>() / segment as f64;
        let mut input: Vec<f64> = part
            .iter()
            .zip(&window)
            .map(|(value, weight)| (value - mean) * weight)
            .collect();
        if plan.process(&mut input, &mut output).is_ok() {
            for (sum, one) in sums.iter_mut().zip(&output) {
                *sum += Complex64::norm_sqr(one);
            }
            count += 1.0;
        }
        from += segment / 2;
    }
    let scale = 1.0 / (count * energy * rate_hz);
    sums.iter_mut().for_each(|sum| *sum *= scale);
    sums
}

fn median_about(values: &[f64], k: usize) -> f64 {
    let span = ((SPAN * k as f64) as usize).min(MOST_NEIGHBOURS);
    let mut near = values[(k - span).max(1).min(k)..=(k + span).min(values.len() - 1)].to_vec();
    median(&mut near).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    const LEN: usize = 1 << 18;
    const RATE_HZ: f64 = 100.0;

    /// White noise of deviation 1 and a tone about `f_hz` that strays by the share `stray` in a
    /// correlation time of a sixtieth of the record.
    fn record(seed: u64, f_hz: f64, amplitude: f64, stray: f64) -> Vec<f64> {
        let mut random = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let keep = f64::exp(-60.0 / LEN as f64);
        let (mut off, mut turn) = (random.draw(), 0.0);
        (0..LEN)
            .map(|_| {
                off = keep * off + (1.0 - keep * keep).sqrt() * random.draw();
                turn = f64::fract(turn + f_hz * (1.0 + stray * off) / RATE_HZ);
                random.draw() + amplitude * (TAU * turn).cos()
            })
            .collect()
    }

    #[test]
    fn white_noise_has_no_band() {
        // 4000 bins, each beyond 6 sigma of a gamma law of 52 with a chance of 2e-7.
        for seed in 0..8 {
            let found = bands(&record(seed, 5.0, 0.0, 0.0), RATE_HZ);
            assert!(found.is_empty(), "seed {seed}: {found:?}");
        }
    }

    #[test]
    fn a_wandering_tone_is_one_band_as_unsure_as_it_wanders() {
        let mut squares = 0.0;
        const RUNS: u64 = 12;
        for seed in 10..10 + RUNS {
            let found = bands(&record(seed, 5.0, 0.4, 3e-3), RATE_HZ);
            assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
            let band = found[0];
            // The mean power of the tone; the ends of its law are below the floor.
            assert!(
                (band.power / 0.08 - 1.0).abs() < 0.2,
                "seed {seed}: {band:?}"
            );
            squares += ((band.f_hz - 5.0) / band.f_sd_hz).powi(2);
            assert!(band.f_sd_hz < 2.0 * 3e-3 * 5.0, "seed {seed}: {band:?}");
        }
        // The whole record's middle is surer than an eighth's: well below 1, and not zero.
        let mean = squares / RUNS as f64;
        assert!((1e-3..1.0).contains(&mean), "{mean}, seeds 10..22");
    }

    #[test]
    fn bands_closer_than_half_of_their_width_are_one() {
        let ends = |second: std::ops::Range<usize>| {
            let beyond = |k: usize| {
                if (100..110).contains(&k) || second.contains(&k) {
                    10.0
                } else {
                    0.0
                }
            };
            standing_out(1000, beyond)
        };
        assert_eq!(ends(113..120), [[100, 119]]);
        assert_eq!(ends(120..130), [[100, 109], [120, 129]]);
    }
}
