//! Motion that comes and goes: a knock, a door, steps, a lorry, a hand.

use std::f64::consts::{PI, TAU};

use super::record::{Disturbance, Room, gains};
use crate::hidden::draw::Draw;

/// A blow at `at_s` that rings at `f_hz` and dies away over `decay_s`.
fn blow(wave: &mut [f64], room: &Room, at_s: f64, f_hz: f64, decay_s: f64, peak: f64) {
    let from = (at_s * room.rate_hz).max(0.0) as usize;
    let lasting = (20.0 * decay_s * room.rate_hz) as usize;
    for (i, value) in wave.iter_mut().skip(from).take(lasting).enumerate() {
        let t_s = i as f64 / room.rate_hz;
        *value += peak * (-t_s / decay_s).exp() * (TAU * f_hz * t_s).sin();
    }
}

fn event(room: &Room, from_s: f64, length_s: f64, wave: Vec<f64>, draw: &mut Draw) -> Disturbance {
    Disturbance {
        event_s: Some((from_s, (from_s + length_s).min(room.duration_s()))),
        wave,
        gains: gains(draw),
        logger: None,
    }
}

/// A knuckle on the desk: it rings for some cycles of the desk's own frequency.
pub fn knock(room: &Room, draw: &mut Draw) -> Disturbance {
    let f_hz = draw.log_uniform(20.0, 300.0).min(0.35 * room.rate_hz);
    let decay_s = draw.uniform(2.0, 12.0) / f_hz;
    let peak = room.deviation * draw.log_uniform(20.0, 2000.0);
    // Over as far as a thousandth.
    let length_s = 7.0 * decay_s;
    let at_s = room.moment_s(length_s, draw);
    let mut wave = vec![0.0; room.samples];
    blow(&mut wave, room, at_s, f_hz, decay_s, peak);
    event(room, at_s, length_s, wave, draw)
}

/// A door slammed: the floor sways at some hertz, walls and things rattle with it.
pub fn door(room: &Room, draw: &mut Draw) -> Disturbance {
    let length_s = draw.uniform(0.8, 2.5);
    let at_s = room.moment_s(length_s, draw);
    let peak = room.deviation * draw.log_uniform(10.0, 500.0);
    let mut wave = vec![0.0; room.samples];
    blow(
        &mut wave,
        room,
        at_s,
        draw.uniform(4.0, 15.0),
        length_s / 7.0,
        peak,
    );
    for _ in 0..4 {
        let later_s = at_s + draw.uniform(0.0, 0.2 * length_s);
        let (f_hz, share) = (draw.uniform(18.0, 40.0), draw.uniform(0.1, 0.5));
        blow(
            &mut wave,
            room,
            later_s,
            f_hz,
            length_s / 12.0,
            share * peak,
        );
    }
    event(room, at_s, length_s, wave, draw)
}

/// Somebody walks past: steps that come nearer and go away.
pub fn footsteps(room: &Room, draw: &mut Draw) -> Disturbance {
    let (count, every_s) = (8 + draw.index(25), 1.0 / draw.uniform(1.6, 2.2));
    let length_s = count as f64 * every_s + 0.5;
    let at_s = room.moment_s(length_s, draw);
    let peak = room.deviation * draw.log_uniform(10.0, 200.0);
    let (f_hz, decay_s) = (draw.uniform(10.0, 25.0), draw.uniform(0.03, 0.1));
    let mut wave = vec![0.0; room.samples];
    for step in 0..count {
        let near = (PI * (step as f64 + 0.5) / count as f64).sin();
        let late_s = (step as f64 + 0.05 * draw.normal()) * every_s;
        let own = peak * near * draw.uniform(0.7, 1.3);
        blow(&mut wave, room, at_s + late_s, f_hz, decay_s, own);
    }
    event(room, at_s, length_s, wave, draw)
}

/// A lorry passes: the ground trembles at about ten hertz, for as long as it is near.
pub fn lorry(room: &Room, draw: &mut Draw) -> Disturbance {
    let length_s = draw.uniform(8.0, 40.0);
    let at_s = room.moment_s(length_s, draw);
    let (f_hz, width_hz) = (draw.uniform(8.0, 18.0), draw.uniform(2.0, 8.0));
    let size = room.deviation * draw.log_uniform(2.0, 50.0);
    let keep = (-PI * width_hz / room.rate_hz).exp();
    let fresh = (1.0 - keep * keep).sqrt();
    let (sine, cosine) = (TAU * f_hz / room.rate_hz).sin_cos();
    let (mut x, mut y) = (draw.normal(), draw.normal());
    let from = (at_s * room.rate_hz) as usize;
    let count = (length_s * room.rate_hz) as usize;
    let mut wave = vec![0.0; room.samples];
    for (i, value) in wave.iter_mut().skip(from).take(count).enumerate() {
        let near = (PI * i as f64 / count as f64).sin().powi(2);
        *value = size * near * x;
        (x, y) = (
            keep * (cosine * x - sine * y) + fresh * draw.normal(),
            keep * (sine * x + cosine * y) + fresh * draw.normal(),
        );
    }
    event(room, at_s, length_s, wave, draw)
}

/// Somebody takes the sensor up and puts it down, in half of the records otherwise than it lay.
pub fn handling(room: &Room, draw: &mut Draw) -> Disturbance {
    let length_s = draw.uniform(3.0, 15.0);
    let at_s = room.moment_s(length_s, draw);
    let size = room.deviation * draw.log_uniform(200.0, 5000.0);
    let tilt = match draw.chance(0.5) {
        true => size * draw.uniform(-0.3, 0.3),
        false => 0.0,
    };
    let waves: Vec<(f64, f64)> = (0..12)
        .map(|_| (draw.log_uniform(0.3, 4.0), draw.uniform(0.0, TAU)))
        .collect();
    let mut wave = vec![0.0; room.samples];
    for (i, value) in wave.iter_mut().enumerate() {
        let t_s = i as f64 / room.rate_hz - at_s;
        let share = t_s / length_s;
        if (0.0..1.0).contains(&share) {
            let held = (PI * share).sin().powf(0.3);
            let sway = |(f_hz, phase): &(f64, f64)| (TAU * f_hz * t_s + phase).sin();
            *value = size * held * waves.iter().map(sway).sum::<f64>() / 3.0 + tilt * share;
        } else if share >= 1.0 {
            *value = tilt;
        }
    }
    event(room, at_s, length_s, wave, draw)
}
