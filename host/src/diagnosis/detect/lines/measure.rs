//! A line as it is measured, with its phase.

use std::f64::consts::{PI, TAU};

use realfft::num_complex::Complex64;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::record::wave::Wave;
use crate::fft::phasor::Phasor;
use crate::spectrum::Line;

/// Share of the record over which each end is tapered where a line is measured: a choice. It costs
/// 5 % of the samples, in their weight, and takes away most of what drift leaks.
const TAPER: f64 = 0.05;

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

/// The line within some 1/T of `f_hz` at which its size is largest, found otherwise with the
/// probability `p_value` by chance.
pub fn measure_near(axis: &AxisState, f_hz: f64, p_value: f64) -> Measured {
    /// Frequencies tried for each 1/T, and how many of them to either side at first: quarters, of
    /// which one halfway loses 3 % of the amplitude, up to 3/T. The next look is ten times as fine.
    const FINE: f64 = 0.25;
    const STEPS_EACH_SIDE: i32 = 12;
    let step_hz = FINE * axis.rate_hz / axis.filled.len() as f64;
    let at = |frequency_hz: f64| {
        let line = Line {
            frequency_hz,
            frequency_sd_hz: f64::INFINITY,
            amplitude: 0.0,
            ratio: 0.0,
            false_alarm: p_value,
        };
        measure(axis, &line)
    };
    let mut best = at(f_hz);
    for (reach, step_hz) in [(STEPS_EACH_SIDE, step_hz), (8, 0.1 * step_hz)] {
        let centre_hz = best.line.frequency_hz;
        for step in -reach..=reach {
            let one = at(centre_hz + f64::from(step) * step_hz);
            if one.line.amplitude > best.line.amplitude {
                best = one;
            }
        }
    }
    // The bound of H. Cramer and C. R. Rao for a tone whose amplitude is estimated with it.
    let duration_s = axis.filled.len() as f64 / axis.rate_hz;
    best.line.frequency_sd_hz =
        6_f64.sqrt() / TAU * best.amplitude_sd / best.line.amplitude / duration_s;
    best
}

/// Size and phase of a line by least squares with tapered ends.
pub fn measure(axis: &AxisState, line: &Line) -> Measured {
    let length = axis.filled.len();
    let cycles = line.frequency_hz / axis.rate_hz;
    let end = ((TAPER * length as f64) as usize).max(1);
    let (mut sum, mut weights) = (Complex64::ZERO, 0.0);
    let measured = axis.residual.measured();
    let values = axis.filled.iter().enumerate();
    Phasor::new(-cycles).zip(0, values, 2.0.into(), |(index, value), phasor| {
        if !measured[index].is_finite() {
            return;
        }
        let edge = index.min(length - 1 - index);
        let weight = if edge < end {
            (0.5 * PI * (edge as f64 + 0.5) / end as f64).sin().powi(2)
        } else {
            1.0
        };
        sum += phasor * (weight * value);
        weights += weight;
    });
    let (cosine, sine) = (sum.re / weights, -sum.im / weights);
    // var A = 4 S / T for a two-sided density S.
    let density = axis.density(line.frequency_hz);
    let amplitude_sd = (4.0 * density * axis.rate_hz / weights).sqrt();
    Measured {
        line: Line {
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
