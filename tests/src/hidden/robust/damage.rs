//! What happens to the samples of a random record, mildly or hugely.

use std::f64::consts::TAU;
use std::ops::Range;

use crate::hidden::draw::Draw;

/// Bits of numbers that are none: quiet and signalling, of both signs, with and without a payload.
const NANS: [u64; 5] = [
    0x7ff8_0000_0000_0000,
    0xfff8_0000_0000_0000,
    0x7ff0_0000_0000_0001,
    0xfff0_0000_0000_0001,
    0x7fff_ffff_ffff_ffff,
];

/// None to three things that happen, each of any size from a thousandth of the deviation to a
/// hundred million of it.
pub fn happen(samples: &mut [f64], draw: &mut Draw) {
    if samples.is_empty() {
        return;
    }
    for _ in 0..draw.index(4) {
        let size = draw.log_uniform(1e-3, 1e8) * draw.sign();
        one(samples, size, draw);
    }
}

fn one(samples: &mut [f64], size: f64, draw: &mut Draw) {
    let count = samples.len();
    let stretch = stretch(count, draw);
    let share = draw.log_uniform(1e-5, 0.9);
    match draw.index(12) {
        // Spikes of one size, or of any.
        0 => spikes(samples, share * 0.05, |_| size, draw),
        1 => spikes(samples, share * 0.05, |draw| size * draw.normal(), draw),
        2 => {
            let from = samples[stretch.start..].iter_mut();
            from.for_each(|sample| *sample += size);
        }
        3 => (stretch.clone()).for_each(|i| samples[i] += size),
        4 => clip(samples, share, size.signum()),
        5 => {
            for i in 1..count {
                if draw.chance(share) {
                    samples[i] = samples[i - 1];
                }
            }
        }
        6 => {
            // Sample and hold.
            let hold = 2 + draw.index(20);
            (0..count).for_each(|i| samples[i] = samples[i - i % hold]);
        }
        7 => {
            let (f, phase) = (draw.log_uniform(1e-5, 0.5), draw.uniform(0.0, TAU));
            let line = |i: usize| size * (TAU * (f * i as f64).fract() + phase).cos();
            (0..count).for_each(|i| samples[i] += line(i));
        }
        8 => {
            let noise = samples[stretch].iter_mut();
            noise.for_each(|sample| *sample += size * draw.normal());
        }
        // Stuck.
        9 => {
            let held = samples[stretch.start];
            samples[stretch].fill(held);
        }
        10 => {
            let step = size.abs().clamp(1e-3, 100.0);
            let rounded = samples.iter_mut();
            rounded.for_each(|sample| *sample = (*sample / step).round() * step);
        }
        _ => {
            let time = share * count as f64 + 1.0;
            let settle = |i: usize| size * (-(i as f64) / time).exp();
            (0..count).for_each(|i| samples[i] += settle(i));
        }
    }
}

fn spikes(samples: &mut [f64], share: f64, size: impl Fn(&mut Draw) -> f64, draw: &mut Draw) {
    for sample in samples {
        if draw.chance(share) {
            *sample += size(draw);
        }
    }
}

fn clip(samples: &mut [f64], share: f64, side: f64) {
    let mut sorted: Vec<f64> = samples.iter().map(|sample| sample * side).collect();
    sorted.sort_by(f64::total_cmp);
    let limit = sorted[((1.0 - share) * (sorted.len() - 1) as f64) as usize];
    for sample in samples {
        *sample = (*sample * side).min(limit) * side;
    }
}

/// A stretch of any length anywhere; now and then it touches an end.
fn stretch(count: usize, draw: &mut Draw) -> Range<usize> {
    let length = (draw.log_uniform(1.0, count as f64 + 1.0) as usize).min(count);
    let free = count - length;
    let start = match draw.index(4) {
        0 => 0,
        1 => free,
        _ => draw.index(free + 1),
    };
    start..start + length
}

/// Samples that are missing: none in half of the records. Infinities in some.
pub fn lose(samples: &mut [f64], draw: &mut Draw) {
    if samples.is_empty() || draw.chance(0.5) {
        return;
    }
    let nan = f64::from_bits(draw.pick(&NANS));
    let share = draw.log_uniform(1e-5, 0.6);
    match draw.index(7) {
        0 => at_random(samples, share, nan, draw),
        1 => at_random(samples, 0.3, nan, draw),
        2 => (0..=draw.index(20)).for_each(|_| {
            let gap = stretch(samples.len(), draw);
            let shorter = gap.start..gap.start + gap.len().div_ceil(20);
            samples[shorter].fill(nan);
        }),
        3 => samples[0] = nan,
        4 => samples[samples.len() - 1] = nan,
        5 => {
            let every = 2 + draw.index(50);
            samples.iter_mut().step_by(every).for_each(|s| *s = nan);
        }
        _ => {
            let infinite = f64::INFINITY * draw.sign();
            at_random(samples, share.min(0.01), infinite, draw);
        }
    }
}

fn at_random(samples: &mut [f64], share: f64, value: f64, draw: &mut Draw) {
    for sample in samples {
        if draw.chance(share) {
            *sample = value;
        }
    }
}
