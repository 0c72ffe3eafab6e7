//! A line as it is measured, with its phase.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use realfft::num_complex::Complex64;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::runs;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::steady::line::IMPERFECT;
use crate::fft::phasor::Phasor;
use crate::model::averaging;
use crate::spectrum::Line;

/// Share of the record over which each end is tapered where a line is measured: a choice. It costs
/// 5 % of the samples, in their weight, and takes away most of what drift leaks.
const TAPER: f64 = 0.05;

/// Variance of an amplitude as it is said, over what noise makes of it: a choice. What a filter that no chain declares takes off a line is
/// not known to the noise; with it, and in the noise that it was found in, 95 % of the judge's
/// amplitudes lie in their intervals (docs/studies/diagnosis.md).
pub const UNDECLARED: f64 = 2.0;

/// A line with its phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The line as it was found, with the amplitude that was measured.
    pub line: Line,
    /// As it is taken out.
    pub wave: Wave,
    /// Standard deviation of the amplitude.
    pub amplitude_sd: f64,
}

impl Measured {
    /// Whether it is at half the rate, where it is its own mirror image.
    pub fn is_at_half(&self) -> bool {
        matches!(self.wave, Wave::Line { cycles, .. } if cycles == 0.5)
    }
}

/// Blocks in which a record is kept that is looked at about a frequency: 4/T away from it a block turns by a 64th of a
/// cycle from its begin to its end, which takes 0.04 % off a line.
const BLOCKS: usize = 256;

/// The line within some 1/T of `f_hz` at which its size is largest, found otherwise with the
/// probability `p_value` by chance.
pub fn measure_near(axis: &AxisState, f_hz: f64, p_value: f64) -> Measured {
    /// Frequencies tried for each 1/T, and how many of them to either side at first: quarters, of
    /// which one halfway loses 3 % of the amplitude, up to 3/T. The next look is ten times as fine.
    const FINE: f64 = 0.25;
    const STEPS_EACH_SIDE: i32 = 12;
    let length = axis.filled.len();
    let seen = Demodulated::new(axis, f_hz / axis.rate_hz);
    let mut best = (0.0, seen.power(0.0));
    for (reach, step) in [(STEPS_EACH_SIDE, FINE), (8, 0.1 * FINE)] {
        let centre = best.0;
        for number in -reach..=reach {
            let offset = centre + f64::from(number) * step;
            let power = seen.power(offset);
            if power > best.1 {
                best = (offset, power);
            }
        }
    }
    let mut best = measure(
        axis,
        &Line {
            frequency_hz: f_hz + best.0 * axis.rate_hz / length as f64,
            frequency_sd_hz: f64::INFINITY,
            amplitude: 0.0,
            ratio: 0.0,
            false_alarm: p_value,
        },
    );
    let amplitude_sd = best.amplitude_sd / UNDECLARED.sqrt();
    best.line.ratio = 0.5 * (best.line.amplitude / amplitude_sd).powi(2);
    // The bound of H. Cramer and C. R. Rao for a tone whose amplitude is estimated with it.
    let duration_s = length as f64 / axis.rate_hz;
    best.line.frequency_sd_hz =
        12_f64.sqrt() / TAU * amplitude_sd / best.line.amplitude / duration_s;
    best
}

/// Size and phase of a line by least squares with tapered ends.
pub fn measure(axis: &AxisState, line: &Line) -> Measured {
    let mut cycles = line.frequency_hz / axis.rate_hz;
    // At half the rate a line is its own mirror image: of a sine nothing is seen, of a cosine twice as much. Closer than
    // half of 1/T the two are one.
    let is_mirrored = (0.5 - cycles) * (axis.filled.len() as f64) < 0.5;
    if is_mirrored {
        cycles = 0.5;
    }
    let Demodulated { sums, weights } = Demodulated::new(axis, cycles);
    let sum: Complex64 = sums.iter().sum();
    let (cosine, sine) = if is_mirrored {
        (0.5 * sum.re / weights, 0.0)
    } else {
        (sum.re / weights, -sum.im / weights)
    };
    let amplitude_sd = UNDECLARED.sqrt() * amplitude_sd(axis, line.frequency_hz, weights);
    Measured {
        line: Line {
            frequency_hz: cycles * axis.rate_hz,
            amplitude: cosine.hypot(sine),
            ..*line
        },
        wave: Wave::Line {
            cycles,
            cosine,
            sine,
            lost: None,
        },
        amplitude_sd,
    }
}

/// Standard deviation of the amplitude of a line that is measured by so many samples: `var A = 2 S / T` for a two-sided density S.
pub fn amplitude_sd(axis: &AxisState, f_hz: f64, samples: f64) -> f64 {
    (2.0 * axis.density(f_hz) * axis.rate_hz / samples).sqrt()
}

/// How many samples measure a line.
pub fn weights(axis: &AxisState) -> f64 {
    let measured = axis.residual.measured();
    let all = 0..axis.filled.len();
    let runs = runs::without(&[all], axis.bridged()).into_iter();
    let there = runs.flatten().filter(|&n| measured[n].is_finite());
    // Half of each end is tapered away.
    (1.0 - TAPER) * there.count() as f64
}

/// Whether next to nothing is left at some other `lines` where `one` is taken out of the samples that were measured: they are what gaps,
/// and what is drawn in the place of what is excluded, make of it. All that is left together, but for what noise makes of it, is no more
/// than a steady line may miss.
pub fn holds(axis: &AxisState, one: &Measured, lines: &[Line]) -> bool {
    /// Noise at a line over its mean, at most: more than by chance once in 20 000 lines.
    const NOISE: f64 = 10.0;
    let mut values = axis.filled.to_vec();
    one.wave.take_out(&mut values);
    let left = lines.iter().map(|line| {
        let seen = Demodulated::of(axis, &values, line.frequency_hz / axis.rate_hz);
        let noise = 2.0 * amplitude_sd(axis, line.frequency_hz, seen.weights).powi(2);
        let power = seen.power(0.0) / seen.weights.powi(2);
        if power < NOISE * noise { 0.0 } else { power }
    });
    left.sum::<f64>() < IMPERFECT * one.line.amplitude.powi(2)
}

/// A record with tapered ends, shifted down by a frequency, in blocks.
struct Demodulated {
    /// Twice the sum of each block.
    sums: Vec<Complex64>,
    /// Weights of all samples that were measured.
    weights: f64,
}

impl Demodulated {
    /// Down by `cycles` a sample.
    fn new(axis: &AxisState, cycles: f64) -> Self {
        Self::of(axis, &axis.filled, cycles)
    }

    /// The same of some `values` in the place of what is left of the record.
    fn of(axis: &AxisState, values: &[f64], cycles: f64) -> Self {
        let length = values.len();
        let end = ((TAPER * length as f64) as usize).max(1);
        let rise = |edge: usize| (0.5 * PI * (edge as f64 + 0.5) / end as f64).sin().powi(2);
        let rise: Vec<f64> = (0..end).map(rise).collect();
        let phasor = Phasor::new(-cycles);
        let measured = axis.residual.measured();
        let mut weights = 0.0;
        let mut sum_of = |run: Range<usize>| {
            let first = run.start;
            let values = (first..).zip(values[run.clone()].iter().zip(&measured[run]));
            let mut sum = Complex64::ZERO;
            phasor.zip(
                first,
                values,
                2.0.into(),
                |(index, (value, measured)), phasor| {
                    if measured.is_finite() {
                        let edge = index.min(length - 1 - index);
                        let weight = rise.get(edge).copied().unwrap_or(1.0);
                        sum += phasor * (weight * value);
                        weights += weight;
                    }
                },
            );
            sum
        };
        let block = length.div_ceil(BLOCKS);
        let blocks = (0..length).step_by(block);
        let sums = blocks.map(|first| {
            // What was drawn in the place of what is excluded has none of the line.
            let block = first..(first + block).min(length);
            let runs = runs::without(&[block], axis.bridged()).into_iter();
            runs.map(&mut sum_of).sum()
        });
        Self {
            sums: sums.collect(),
            weights,
        }
    }

    /// Power of what lies `offset` cycles a record away.
    fn power(&self, offset: f64) -> f64 {
        let turn = -TAU * offset / self.sums.len() as f64;
        let sums = (0_u32..).zip(&self.sums);
        let turned = sums.map(|(number, sum)| sum * Complex64::cis(turn * f64::from(number)));
        turned.sum::<Complex64>().norm_sqr()
    }
}

/// Whether a frequency is so near a known one that a line there may be left of that.
pub fn is_beside(axis: &AxisState, known_hz: f64, f_hz: f64) -> bool {
    let duration_s = axis.filled.len() as f64 / axis.rate_hz;
    (known_hz - f_hz).abs() < (40.0 / duration_s).max(0.004 * known_hz)
}

/// Whether a line is no more than what may be left of a steady one beside it.
pub fn is_left_of_known(axis: &AxisState, line: &Line) -> bool {
    let mut waves = axis.residual.waves().iter();
    waves.any(|wave| match wave {
        Wave::Line {
            cycles,
            cosine,
            sine,
            ..
        } => {
            let most = IMPERFECT * (cosine * cosine + sine * sine);
            is_beside(axis, cycles * axis.rate_hz, line.frequency_hz)
                && line.amplitude.powi(2) < most
        }
        _ => false,
    })
}

/// Whether a line stands out of what a model expects where it is, too, if that falls in lobes: they are narrower than what
/// the floor of lines is the median over, which is below their tops.
pub fn stands_out(axis: &AxisState, line: &Line, level: f64) -> bool {
    if !axis.laws.iter().any(|law| law.effect == averaging::KIND) {
        return true;
    }
    let measured = axis.measured_share() * axis.filled.len() as f64;
    let noise = 2.0 * amplitude_sd(axis, line.frequency_hz, measured).powi(2);
    let over_noise = line.amplitude.powi(2) / noise;
    let frequencies = 0.5 * measured;
    frequencies * (-over_noise).exp() < level
}
