//! What an axis of a random record is made of: noise of any colour, and what is no noise at all.

use std::f64::consts::TAU;

use crate::hidden::draw::Draw;
use crate::hidden::noise::gaussian::gaussian;

/// Exponents of the densities that are mixed: quantisation, white, flicker, walk and what lies
/// between and beyond.
const EXPONENTS: [f64; 7] = [-2.0, -1.0, 0.0, 0.5, 1.0, 1.5, 2.0];

/// Samples of one axis, of the order of one.
pub fn draw(count: usize, rate_hz: f64, draw: &mut Draw) -> Vec<f64> {
    if count == 0 {
        return Vec::new();
    }
    // Most records are noise: what is none is often refused, and then shows nothing more.
    if draw.chance(0.75) {
        return noise(count, rate_hz, draw);
    }
    strange(count, draw)
}

/// Gaussian noise of one to four power laws, each within three decades of the other in power at
/// the middle of the band.
fn noise(count: usize, rate_hz: f64, draw: &mut Draw) -> Vec<f64> {
    let laws: Vec<(f64, f64)> = (0..=draw.index(4))
        .map(|_| (draw.pick(&EXPONENTS), draw.log_uniform(1e-3, 1.0)))
        .collect();
    let middle_hz = rate_hz / (2.0 * (count as f64).sqrt());
    let density = |f_hz: f64| -> f64 {
        let law = |(exponent, power): &(f64, f64)| power * (f_hz / middle_hz).powf(-exponent);
        laws.iter().map(law).sum()
    };
    let samples = gaussian(count, rate_hz, density, draw);
    let mean = samples.iter().sum::<f64>() / count as f64;
    let square: f64 = samples.iter().map(|sample| (sample - mean).powi(2)).sum();
    let deviation = (square / count as f64).sqrt();
    if deviation == 0.0 {
        return samples;
    }
    let scaled = samples.iter().map(|sample| (sample - mean) / deviation);
    scaled.collect()
}

/// What no sensor should say, but files do.
fn strange(count: usize, draw: &mut Draw) -> Vec<f64> {
    let (period, level) = (1 + draw.index(1000), draw.normal());
    let block: Vec<f64> = (0..period).map(|_| draw.normal()).collect();
    let share = draw.log_uniform(1e-4, 0.5);
    let f = draw.uniform(0.0, 0.5);
    let what = draw.index(12);
    let one = |i: usize| match what {
        0 => level,
        1 => f64::from(u8::from(draw.chance(share))),
        2 => i as f64 / count as f64,
        3 => (i % period) as f64,
        4 => f64::from(u8::from(i == count / 2)),
        5 => draw.uniform(-1.0, 1.0),
        // Cauchy: no variance.
        6 => draw.normal() / draw.normal(),
        7 => block[i % period],
        8 => f64::NAN,
        9 => (draw.normal() * 3.0).round(),
        10 => (TAU * f * i as f64).cos(),
        _ => draw.normal() * (10.0 * draw.normal()).exp(),
    };
    (0..count).map(one).collect()
}
