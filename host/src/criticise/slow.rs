//! Slow deterministic changes of the level: settling from the start, and what follows a covariate.
//! Seen on the record's slow copy, where each waveform is compared with the noise at all
//! frequencies at once.

use std::sync::Arc;

use super::axis::AxisState;
use super::mend::{Wave, block_means};
use super::tail;
use super::whole::{Half, Projection, Settling, Transformer, held_out_gain};

/// A waveform that is in the record.
pub struct SlowChange {
    /// It.
    pub wave: Wave,
    /// Its size over its standard deviation.
    pub z: f64,
    /// Standard deviation of its size.
    pub size_sd: f64,
    /// Standard deviation of the logarithm of its time constant, where it has one.
    pub time_log_sd: f64,
    /// Probability of as large a statistic without it.
    pub p_value: f64,
    /// Gain in log-likelihood on ordinates that it was not fitted to.
    pub nats: f64,
}

/// Exponential settling from the start.
pub fn warm_up(axis: &AxisState, level: f64) -> Option<SlowChange> {
    /// Time constants an octave.
    const PER_OCTAVE: f64 = 3.0;
    let factor = axis.drift_factor();
    let (record, density) = axis.slow(&axis.filled, factor);
    let length = record.len();
    let transformer = Transformer::new(length);
    let rate_hz = axis.rate_hz / factor as f64;
    let wave = |samples: f64| {
        let settling = Settling {
            samples,
            len: length,
        };
        let mut wave = transformer.waveform(&settling, rate_hz);
        wave.close(&density);
        wave
    };
    let at = |samples: f64| Projection::new(&record, &density, &wave(samples), Half::Both);
    let shortest = (length as f64 / 512.0).max(8.0);
    let longest = length as f64 / 1.5;
    let octaves = (longest / shortest).log2();
    let count = (PER_OCTAVE * octaves) as usize;
    let mut best = (0.0, 0.0);
    for step in 0..=count {
        let samples = shortest * (step as f64 / PER_OCTAVE).exp2();
        let z = at(samples).z();
        if z.abs() > f64::abs(best.0) {
            best = (z, samples);
        }
    }
    let z_at = |samples: f64| at(samples).z();
    // The top between the steps.
    let mut step = 0.15;
    while step > 1e-3 {
        let moved = [f64::exp(step), f64::exp(-step)]
            .into_iter()
            .map(|factor| (z_at(best.1 * factor), best.1 * factor))
            .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
        if moved.0.abs() > best.0.abs() && moved.1 < longest * 1.2 && moved.1 > shortest * 0.8 {
            best = moved;
        } else {
            step *= 0.5;
        }
    }
    let (z, samples) = best;
    // Neighbouring time constants are as good as one: about one independent trial an octave.
    let p_value = tail::searched(tail::chi_squared(z * z, 2.0), octaves);
    if p_value >= level {
        return None;
    }
    let projection = at(samples);
    // The square of z falls as a parabola in the logarithm of the time constant.
    let bend = {
        let h = 0.05_f64;
        let side = z_at(samples * h.exp()).powi(2) + z_at(samples * (-h).exp()).powi(2);
        (2.0 * z * z - side) / (2.0 * h * h)
    };
    let amplitude = projection.size();
    let time_log_sd = bend.max(1e-9).recip().sqrt();
    // The size goes with the time constant.
    let slope = {
        let h = 0.05_f64;
        (at(samples * h.exp()).size() - at(samples * (-h).exp()).size()) / (2.0 * h)
    };
    Some(SlowChange {
        wave: Wave::WarmUp {
            amplitude,
            samples: samples * factor as f64,
        },
        z,
        size_sd: projection.size_sd().hypot(slope * time_log_sd),
        time_log_sd,
        p_value,
        nats: held_out_gain(&record, &density, &wave(samples)),
    })
}

/// Whether the level follows `column`, one value a sample, `lag` samples behind at most some.
pub fn follows(axis: &AxisState, column: &[f64], level: f64) -> Option<(SlowChange, f64)> {
    let factor = axis.drift_factor();
    let (record, density) = axis.slow(&axis.filled, factor);
    let transformer = Transformer::new(record.len());
    let rate_hz = axis.rate_hz / factor as f64;
    let means = block_means(column, factor);
    // First-order lags from none to an eighth of the record.
    let mut lags = vec![0.0];
    let mut lag = 4.0;
    while lag < means.len() as f64 / 8.0 {
        lags.push(lag);
        lag *= 2.0;
    }
    let lagged = |lag: f64| -> Vec<f64> {
        let keep = if lag > 0.0 { (-1.0 / lag).exp() } else { 0.0 };
        let mut state = means[0];
        means
            .iter()
            .map(|value| {
                state = keep * state + (1.0 - keep) * value;
                state
            })
            .collect()
    };
    let wave = |lag: f64| {
        let mut wave = transformer.transform(&lagged(lag), rate_hz);
        wave.close(&density);
        wave
    };
    let (mut projection, mut lag) = lags
        .iter()
        .map(|&lag| {
            (
                Projection::new(&record, &density, &wave(lag), Half::Both),
                lag,
            )
        })
        .max_by(|a, b| a.0.z().abs().total_cmp(&b.0.z().abs()))?;
    // The top between the steps.
    let mut step = 0.35;
    while lag > 0.0 && step > 5e-3 {
        let best = [f64::exp(step), f64::exp(-step)]
            .into_iter()
            .map(|factor| {
                let lag = lag * factor;
                (
                    Projection::new(&record, &density, &wave(lag), Half::Both),
                    lag,
                )
            })
            .max_by(|a, b| a.0.z().abs().total_cmp(&b.0.z().abs()))?;
        if best.0.z().abs() > projection.z().abs() {
            (projection, lag) = best;
        } else {
            step *= 0.5;
        }
    }
    let z = projection.z();
    let p_value = tail::searched(tail::two_sided(z), lags.len() as f64);
    // The square of z falls as a parabola in the logarithm of the lag.
    let lag_log_sd = if lag > 0.0 {
        let h = 0.1_f64;
        let square = |lag: f64| {
            Projection::new(&record, &density, &wave(lag), Half::Both)
                .z()
                .powi(2)
        };
        let bend = (2.0 * z * z - square(lag * h.exp()) - square(lag * (-h).exp())) / (2.0 * h * h);
        bend.max(1e-9).recip().sqrt()
    } else {
        f64::INFINITY
    };
    if p_value >= level || !z.is_finite() {
        return None;
    }
    let keep = if lag > 0.0 {
        (-1.0 / (lag * factor as f64)).exp()
    } else {
        0.0
    };
    let mean = column.iter().sum::<f64>() / column.len() as f64;
    let mut state = column[0];
    let full: Vec<f32> = column
        .iter()
        .map(|value| {
            state = keep * state + (1.0 - keep) * value;
            (state - mean) as f32
        })
        .collect();
    Some((
        SlowChange {
            wave: Wave::Follows {
                gain: projection.size(),
                column: Arc::new(full),
            },
            z,
            size_sd: projection.size_sd(),
            time_log_sd: lag_log_sd,
            p_value,
            nats: held_out_gain(&record, &density, &wave(lag)),
        },
        lag * factor as f64 / axis.rate_hz,
    ))
}
