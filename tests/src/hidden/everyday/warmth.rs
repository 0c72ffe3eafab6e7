//! What warms and cools.

use super::record::{Disturbance, Room, gains};
use crate::hidden::draw::Draw;

/// What short-term noise leaves of a mean over this time.
fn left(room: &Room, time_s: f64) -> f64 {
    room.deviation / (time_s * room.rate_hz).sqrt()
}

/// A heater with a thermostat: on and off, five to thirty times a record, behind a lag.
pub fn heater(room: &Room, draw: &mut Draw) -> Disturbance {
    let period_s = room.duration_s() / draw.uniform(5.0, 30.0);
    let duty = draw.uniform(0.3, 0.7);
    let lag_s = period_s * draw.uniform(0.05, 0.4);
    let size = left(room, period_s) * draw.log_uniform(30.0, 1000.0);
    let start = draw.uniform(0.0, 1.0);
    let follow = 1.0 - (-1.0 / (lag_s * room.rate_hz)).exp();
    let mut level = 0.0;
    let sample = |i: usize| {
        let at = (i as f64 / room.rate_hz / period_s + start).fract();
        level += follow * (f64::from(u8::from(at < duty)) - level);
        size * level
    };
    Disturbance {
        wave: (0..room.samples).map(sample).collect(),
        gains: gains(draw),
        ..Disturbance::default()
    }
}

/// Warm-up of the sensor and, slower, of the box around it.
pub fn two_warmups(room: &Room, draw: &mut Draw) -> Disturbance {
    let fast_s = room.duration_s() / draw.uniform(20.0, 60.0);
    let slow_s = room.duration_s() / draw.uniform(3.0, 8.0);
    let mut size = || left(room, fast_s) * draw.sign() * draw.log_uniform(50.0, 1000.0);
    let (fast, slow) = (size(), size());
    let sample = |i: usize| {
        let t_s = i as f64 / room.rate_hz;
        fast * (-t_s / fast_s).exp() + slow * (-t_s / slow_s).exp()
    };
    Disturbance {
        wave: (0..room.samples).map(sample).collect(),
        gains: gains(draw),
        ..Disturbance::default()
    }
}
