//! What turns or swings all the time, not quite evenly.

use std::f64::consts::TAU;

use super::record::{Disturbance, Room, gains};
use crate::hidden::draw::Draw;

/// Harmonics of a base of `f_hz` that wanders about it: the deviation `wander_hz` is forgotten over `time_s`.
fn harmonics(
    room: &Room,
    f_hz: f64,
    wander_hz: f64,
    time_s: f64,
    sizes: &[f64],
    draw: &mut Draw,
) -> Vec<f64> {
    let phases: Vec<f64> = sizes.iter().map(|_| draw.uniform(0.0, TAU)).collect();
    let keep = (-1.0 / (time_s * room.rate_hz)).exp();
    let fresh = (1.0 - keep * keep).sqrt();
    let (mut away, mut cycles) = (draw.normal(), 0.0_f64);
    let sample = |_| {
        cycles += (f_hz + wander_hz * away) / room.rate_hz;
        away = keep * away + fresh * draw.normal();
        let one = |(number, (size, phase)): (usize, (&f64, &f64))| {
            size * (TAU * (cycles * (number + 1) as f64).fract() + phase).sin()
        };
        sizes.iter().zip(&phases).enumerate().map(one).sum()
    };
    (0..room.samples).map(sample).collect()
}

/// A fan of some ten turns a second, whose speed wanders by a percent, and twice that of its blades.
pub fn fan(room: &Room, draw: &mut Draw) -> Disturbance {
    let f_hz = draw.uniform(12.0, 45.0).min(0.2 * room.rate_hz);
    let wander_hz = f_hz * draw.log_uniform(0.003, 0.02);
    let size = room.deviation * draw.log_uniform(0.3, 10.0);
    let sizes = [size, size * draw.uniform(0.0, 0.5)];
    let time_s = draw.log_uniform(3.0, 30.0);
    Disturbance {
        wave: harmonics(room, f_hz, wander_hz, time_s, &sizes, draw),
        gains: gains(draw),
        ..Disturbance::default()
    }
}

/// Mains as they are: 10 to 100 mHz to and fro over minutes, with the third harmonic or more.
pub fn mains(room: &Room, draw: &mut Draw) -> Disturbance {
    let f_hz = draw.pick(&[50.0, 60.0]) + 0.02 * draw.normal();
    let wander_hz = draw.log_uniform(0.01, 0.1);
    let size = room.deviation * draw.log_uniform(0.3, 10.0);
    let sizes = [
        size,
        size * draw.uniform(0.0, 0.3),
        size * draw.uniform(0.3, 0.8),
    ];
    let time_s = draw.log_uniform(60.0, 300.0);
    Disturbance {
        wave: harmonics(room, f_hz, wander_hz, time_s, &sizes, draw),
        gains: gains(draw),
        ..Disturbance::default()
    }
}
