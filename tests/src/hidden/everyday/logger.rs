//! What a logger makes of samples.

use super::record::{Disturbance, Room};
use crate::hidden::draw::Draw;

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

fn all(logger: super::record::Logger) -> Disturbance {
    Disturbance {
        gains: [1.0; super::record::AXES],
        logger: Some(logger),
        ..Disturbance::default()
    }
}
