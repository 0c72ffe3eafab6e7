//! Records of any length, rate, noise and chain.

use std::f64::consts::TAU;

use super::limits;
use crate::hidden::draw::Draw;
use crate::hidden::effect::Kind;
use crate::hidden::noise::base::Base;
use crate::hidden::noise::chain::Chain;
use crate::hidden::robust::record::prime_below;
use crate::hidden::scene::Scene;

/// Samples of the shortest record: what a diagnosis needs.
pub const SHORTEST: usize = 1 << 13;

/// Rates of the converter, samples a second.
const CONVERTER_HZ: [f64; 5] = [250.0, 500.0, 1000.0, 2000.0, 4000.0];

/// A record of up to `longest` samples with room for `kinds`.
pub fn draw(kinds: &[&Kind], longest: usize, axes: usize, draw: &mut Draw) -> Scene {
    let limits = || kinds.iter().filter_map(|kind| limits::of(kind.name));
    let shortest = limits()
        .map(|limit| limit.samples)
        .fold(SHORTEST, usize::max);
    let slowest_hz = limits().map(|limit| limit.rate_hz).fold(1.0, f64::max);
    let samples = length(shortest, longest.max(shortest), draw);
    // Three digits, as rates have.
    let rate_hz = three_digits(draw.log_uniform(slowest_hz, 4000.0));
    let (chain, declared) = match draw.index(5) {
        0..=2 => (Chain::None, true),
        which => {
            let pole_hz = draw.pick(&[None, Some(300), Some(400)]);
            (Chain::Ads1281 { pole_hz }, which == 3)
        }
    };
    let rate_hz = match chain.is_none() {
        true => rate_hz,
        false => {
            let fast = CONVERTER_HZ
                .into_iter()
                .filter(|rate_hz| *rate_hz >= slowest_hz);
            draw.pick(&fast.collect::<Vec<_>>())
        }
    };
    Scene {
        rate_hz,
        samples,
        axes: (0..axes).map(|_| base(rate_hz, samples, draw)).collect(),
        target: draw.index(axes),
        chain,
        declared,
        relative: true,
        missing: 0.0,
        code: 0.0,
        measured: None,
    }
}

/// Log-uniform; a third of them primes, a third powers of two.
fn length(shortest: usize, longest: usize, draw: &mut Draw) -> usize {
    let samples = draw.log_uniform(shortest as f64, longest as f64 + 1.0) as usize;
    match draw.index(3) {
        0 => prime_below(samples).max(shortest),
        1 => samples.next_power_of_two().min(longest),
        _ => samples,
    }
}

fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Any mix of the five terms. The white noise that is there, or would be, sets the scale: the others cross it
/// at frequencies that the record holds.
fn base(rate_hz: f64, samples: usize, draw: &mut Draw) -> Base {
    let duration_s = samples as f64 / rate_hz;
    let n = draw.log_uniform(1e-5, 1e-1) / rate_hz.sqrt();
    // K, B, N, Q as bits, one of the fifteen mixes; the ramp in a third of the records.
    let mix = 1 + draw.index(15);
    let has = |bit: usize, value: f64| if mix >> bit & 1 == 1 { value } else { 0.0 };
    let walk_hz = draw.log_uniform(0.3 / duration_s, rate_hz / 30.0);
    let flicker_hz = draw.log_uniform(1.0 / duration_s, rate_hz / 10.0);
    let quantisation_hz = draw.log_uniform(rate_hz / 100.0, rate_hz / 2.0);
    let k = has(0, TAU * walk_hz * n);
    let b = has(1, n * (TAU * flicker_hz).sqrt());
    let q = has(3, n * rate_hz.sqrt() / (TAU * quantisation_hz));
    let mut base = Base {
        r: 0.0,
        k,
        b,
        n: has(2, n),
        q,
        mean: 0.0,
    };
    let deviation = base.allan_variance(0.25 * duration_s).sqrt();
    if draw.chance(1.0 / 3.0) {
        base.r = draw.sign() * draw.log_uniform(0.1, 30.0) * deviation / duration_s;
    }
    base.mean = match draw.chance(0.5) {
        true => 9.8 + 0.02 * draw.normal(),
        false => 100.0 * n * rate_hz.sqrt() * draw.normal(),
    };
    base
}

/// In a word: what there is besides the ramp.
pub fn mix(base: &Base) -> String {
    let terms = [(base.k, 'K'), (base.b, 'B'), (base.n, 'N'), (base.q, 'Q')];
    let there = terms.iter().filter(|(value, _)| *value > 0.0);
    there.map(|(_, symbol)| *symbol).collect()
}
