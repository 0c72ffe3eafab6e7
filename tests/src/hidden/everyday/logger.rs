//! What a logger makes of samples.

use std::f64::consts::PI;

use super::record::{Disturbance, Room};
use crate::hidden::draw::Draw;
use crate::hidden::noise::chain;

/// The sensor is slower than the logger, at no simple ratio: each value is written until there is a new one.
pub fn held(room: &Room, draw: &mut Draw) -> Disturbance {
    /// Values that a diagnosis needs, and some more: with fewer it says so, and that they are held.
    const VALUES: f64 = 9000.0;
    let ratio = draw.log_uniform(1.2, (room.samples as f64 / VALUES).min(10.0));
    let hold = move |samples: &mut [f64]| {
        for i in 0..samples.len() {
            // The last sample at which the sensor had a new one.
            let latest = ((i as f64 / ratio).floor() * ratio).ceil() as usize;
            samples[i] = samples[latest.min(i)];
        }
    };
    all(Box::new(hold))
}

/// Each value is the mean of the last few.
pub fn averaged(_room: &Room, draw: &mut Draw) -> Disturbance {
    let count = 2 + draw.index(15);
    let average = move |samples: &mut [f64]| {
        let raw = samples.to_vec();
        for (i, sample) in samples.iter_mut().enumerate() {
            let from = (i + 1).saturating_sub(count);
            let window = &raw[from..=i];
            *sample = window.iter().sum::<f64>() / window.len() as f64;
        }
    };
    all(Box::new(average))
}

/// Corners of filters, shares of the rate.
const CORNERS: (f64, f64) = (0.03, 0.3);

/// A digital sensor: a Butterworth low-pass of one to four poles that runs so fast that what folds down is summed up here, and
/// codes.
pub fn sensor(room: &Room, draw: &mut Draw) -> Disturbance {
    const IMAGES: i32 = 40;
    let rate_hz = room.rate_hz;
    let corner_hz = rate_hz * draw.log_uniform(CORNERS.0, CORNERS.1);
    let poles = 1 + draw.index(4) as i32;
    let in_codes = codes(draw);
    let digitise = move |samples: &mut [f64]| {
        let passed = |f_hz: f64| {
            let image = |k: i32| {
                let corners = (f_hz + f64::from(k) * rate_hz) / corner_hz;
                1.0 / (1.0 + corners.powi(2 * poles))
            };
            (-IMAGES..=IMAGES).map(image).sum()
        };
        chain::filter(samples, rate_hz, passed);
        in_codes(samples);
    };
    all(Box::new(digitise))
}

/// A sensor with a delta-sigma converter: means of means, twice or three times, over one to six samples; and codes.
pub fn decimated(room: &Room, draw: &mut Draw) -> Disturbance {
    /// The converter's own samples in one of the record.
    const FASTER: usize = 16;
    let rate_hz = room.rate_hz;
    let times = 2 + draw.index(2) as i32;
    let over = draw.uniform(1.0, 6.0);
    let in_codes = codes(draw);
    let digitise = move |samples: &mut [f64]| {
        let passed = |f_hz: f64| {
            let image = |k: usize| {
                let cycles = (f_hz / rate_hz + k as f64) / FASTER as f64;
                let count = (over * FASTER as f64).round();
                let sine = (PI * cycles).sin();
                let mean = if sine.abs() < 1e-12 {
                    1.0
                } else {
                    (PI * cycles * count).sin() / (count * sine)
                };
                mean.powi(2 * times)
            };
            (0..FASTER).map(image).sum()
        };
        chain::filter(samples, rate_hz, passed);
        in_codes(samples);
    };
    all(Box::new(digitise))
}

/// A script that has filtered the record by a digital Butterworth low-pass, half of them forward and back.
pub fn scripted(room: &Room, draw: &mut Draw) -> Disturbance {
    let rate_hz = room.rate_hz;
    let corner = draw.log_uniform(CORNERS.0, CORNERS.1);
    let poles = draw.pick(&[1, 2, 4]);
    let times = draw.pick(&[1, 2]);
    let filter = move |samples: &mut [f64]| {
        let passed = |f_hz: f64| {
            // At half the rate the tangent has no end.
            let corners = (PI * f_hz / rate_hz).tan() / (PI * corner).tan();
            (1.0 + corners.abs().min(1e9).powi(2 * poles)).powi(-times)
        };
        chain::filter(samples, rate_hz, passed);
    };
    all(Box::new(filter))
}

/// What is slow does not come through: a coupling of one pole, a geophone's two, or a running mean that a script took away.
pub fn coupled(room: &Room, draw: &mut Draw) -> Disturbance {
    /// Periods of the corner in the record at least, and samples in one: fewer show in no spectrum.
    const LEAST: (f64, f64) = (50.0, 30.0);
    let rate_hz = room.rate_hz;
    let period = draw.log_uniform(LEAST.1, room.samples as f64 / LEAST.0);
    let sort = draw.index(3);
    let filter = move |samples: &mut [f64]| {
        let passed = |f_hz: f64| {
            let turns = f_hz / rate_hz * period;
            match sort {
                0 | 1 => {
                    let corners = turns.powi(2 * (1 + sort as i32));
                    corners / (1.0 + corners)
                }
                _ if turns == 0.0 => 0.0,
                // A mean over a period, centred.
                _ => (1.0 - (PI * turns).sin() / (PI * turns)).powi(2),
            }
        };
        chain::filter(samples, rate_hz, passed);
    };
    all(Box::new(filter))
}

/// Rounds to codes of a part of what changes from one sample to the next.
fn codes(draw: &mut Draw) -> impl Fn(&mut [f64]) + use<> {
    let in_codes = draw.log_uniform(0.5, 30.0);
    move |samples| {
        let changes = samples.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        let square = changes.sum::<f64>() / (2 * samples.len()) as f64;
        let step = square.sqrt() / in_codes;
        for sample in samples {
            *sample = (*sample / step).round() * step;
        }
    }
}

fn all(logger: super::record::Logger) -> Disturbance {
    Disturbance {
        gains: [1.0; super::record::AXES],
        logger: Some(logger),
        ..Disturbance::default()
    }
}
