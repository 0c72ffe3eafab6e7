//! The heights of all jumps of a record together.
//!
//! A jump is found in noise to which it adds itself, and behind a filter of which no more is known than what it lets
//! through: of a strong one that leaves a part. So the samples over which a filter spreads it count as missing, in the
//! record and in the waveform that is looked for, and the heights of all are measured together.

use std::ops::Range;

use crate::diagnosis::axis::{AxisState, SPREAD};
use crate::diagnosis::record::bridge::bridge;
use crate::diagnosis::record::wave::{Jump, Wave};
use crate::diagnosis::statistic::kriging::Unknown;
use crate::diagnosis::statistic::matched_filter::{Step, Transform, Transformer, together};

/// Gives `jumps`, which were taken out of `left`, the heights that they have together, and takes out of it what these differ
/// by. What a converter's filter makes of each is replaced by what is likeliest there.
pub fn measure(axis: &AxisState, left: &mut [f64], jumps: &mut [Jump]) {
    let factor = axis.slow_factor();
    let spread = if axis.is_filtered() { SPREAD } else { 0 };
    let edge = |index: usize| index.saturating_sub(spread)..(index + spread).min(left.len());
    let edges: Vec<Range<usize>> = jumps.iter().map(|jump| edge(jump.index)).collect();
    span(left, &edges);
    let (whole, density) = likeliest(axis, left, &edges);
    let waveform = passage(axis, &whole, spread.div_ceil(factor));
    let moments: Vec<usize> = jumps.iter().map(|jump| jump.index / factor).collect();
    let Some(found) = together(&whole, &density, &waveform, &moments) else {
        return;
    };
    let mut rest = jumps.to_vec();
    let sizes = found.sizes.iter().zip(&found.size_sds);
    for ((jump, rest), (height, sd)) in jumps.iter_mut().zip(&mut rest).zip(sizes) {
        jump.height += height;
        (jump.height_sd, rest.height) = (*sd, *height);
    }
    Wave::Steps(rest).take_out(left);
    span(left, &edges);
    likeliest(axis, left, &edges);
}

/// Makes what is in the `edges` of `left` the likeliest of all, as far as the slow copy is the record itself. That copy,
/// and what whitens it.
fn likeliest(axis: &AxisState, left: &mut [f64], edges: &[Range<usize>]) -> (Transform, Vec<f64>) {
    let factor = axis.slow_factor();
    let (mut whole, density) = axis.slow(left, factor);
    let law = axis.slow_densities(&whole, factor);
    let unknown = Unknown::within(&law, &slower(edges, factor, whole.len()));
    let moves = unknown.moves(&whole);
    whole.add(&unknown.series(&moves, whole.rate_hz()));
    whole.close(&density, &axis.seam(whole.rate_hz()));
    if factor == 1 {
        let places = unknown.places().iter().zip(&moves);
        places.for_each(|(&place, by)| left[place] += by);
    }
    (whole, density)
}

/// Stretches in samples that stand for `factor` of the record's each, of which there are `len`.
fn slower(stretches: &[Range<usize>], factor: usize, len: usize) -> Vec<Range<usize>> {
    let slow = |one: &Range<usize>| one.start / factor..one.end.div_ceil(factor).min(len);
    let inside = stretches.iter().map(slow).filter(|one| one.start < one.end);
    inside.collect()
}

/// A jump by 1 at the begin of the ring of `whole`, over which a filter spreads `reach` samples on either side, as these
/// are likeliest.
fn passage(axis: &AxisState, whole: &Transform, reach: usize) -> Transform {
    let law = axis.slow_densities(whole, axis.slow_factor());
    let (ring, rate_hz) = (Transformer::new(whole.len()), whole.rate_hz());
    let middle = ring.len() / 2;
    let unknown = Unknown::within(&law, &[middle - reach..middle + reach]);
    let moves = unknown.moves(&ring.waveform_at(&Step, middle, rate_hz));
    let mut begins = ring.zeros();
    for (n, by) in moves.into_iter().enumerate() {
        begins[(n + ring.len() - reach) % ring.len()] = by;
    }
    let mut passage = ring.waveform(&Step, rate_hz);
    passage.add(&ring.transform_ring(begins, rate_hz));
    passage
}

/// Bridges stretches.
fn span(values: &mut [f64], stretches: &[Range<usize>]) {
    for stretch in stretches {
        values[stretch.clone()].fill(f64::NAN);
    }
    bridge(values);
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Chain;
    use crate::diagnosis::axis::profile::Noise;
    use crate::diagnosis::detect::steps::pursuit::Pursuit;
    use crate::diagnosis::detect::trial::{self, RATE_HZ, Trial, noise};
    use crate::model::random::{Gaussian, Seed};

    /// A record behind a converter's filter with jumps by `heights` at 6000 and 12 000 that take three samples and
    /// come two samples late, and what stands of it with half of each taken out.
    fn behind_a_filter(seed: u64, heights: [f64; 2]) -> (AxisState, Vec<f64>, Vec<Jump>) {
        let chain: Chain = "ads1281:linear".parse().expect("a chain");
        let len = noise(seed).len();
        let ring = Transformer::new(len);
        let f_hz = |k: usize| k as f64 * RATE_HZ / ring.len() as f64;
        let law = |k: usize| chain.power(f_hz(k), RATE_HZ) / RATE_HZ + 1e-9;
        let density: Vec<f64> = (0..=ring.len() / 2).map(law).collect();
        let mut normal = Gaussian::new(Seed { seed, stream: 6 }, 1.0);
        let mut values = ring.noise(&density, RATE_HZ, || normal.draw()).to_vec();
        for (height, begin) in heights.into_iter().zip([6000, 12_000]) {
            for (n, value) in values[begin..].iter_mut().enumerate() {
                *value += height * (1.0 - (2.0 - n as f64).exp()).clamp(0.0, 1.0);
            }
        }
        let jumps = [(6000, heights[0]), (12_000, heights[1])];
        let jumps = jumps
            .map(|(index, height)| trial::jump(index, 0.5 * height))
            .to_vec();
        let axis = AxisState::new(Arc::new(values.clone()), RATE_HZ, Some(&chain));
        Wave::Steps(jumps.clone()).take_out(&mut values);
        (axis.expect("a spectrum"), values, jumps)
    }

    #[test]
    fn strong_jumps_behind_a_filter_have_their_heights_and_leave_nothing() {
        for seed in 0..3 {
            let heights = [3000.0, -2000.0];
            let (axis, mut left, mut jumps) = behind_a_filter(seed, heights);
            measure(&axis, &mut left, &mut jumps);
            let mut wrong = 0.0;
            for (jump, height) in jumps.iter().zip(heights) {
                // Six deviations, which the jumps in the noise widen.
                let off = (jump.height - height).abs();
                assert!(
                    off < 6.0 * jump.height_sd && off < 0.01 * height.abs(),
                    "seed {seed}: {jump:?}"
                );
                wrong += off;
            }
            // Of 6400 normal numbers one lies beyond 6 in 80 000 records; what a height is off by stays as a level.
            let beyond = left[5800..12_200]
                .iter()
                .map(|one| one.abs())
                .fold(0.0, f64::max);
            assert!(beyond < 6.0 + wrong, "seed {seed}: {beyond} is left");
        }
    }

    #[test]
    fn a_strong_jump_behind_a_filter_is_one() {
        for seed in 3..5 {
            let (axis, ..) = behind_a_filter(seed, [3000.0, -2000.0]);
            let mut trial = Trial::new(noise(seed));
            trial.axis = axis;
            let all = trial.look(|look| {
                let mut pursuit = Pursuit::new(look);
                let first = pursuit.largest(Noise::Anew).expect("a plain jump");
                pursuit.all(first, 0)
            });
            let close = |jump: &Jump, height: f64| (jump.height / height - 1.0).abs() < 0.01;
            assert!(
                all.len() == 2 && close(&all[0], 3000.0) && close(&all[1], -2000.0),
                "seed {seed}: {all:?}"
            );
        }
    }
}
