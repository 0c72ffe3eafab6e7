//! Long gaps, filled with noise as the rest of the record has it.
//!
//! A straight line in the place of a stretch cuts off what hangs together over long: what whitens a record answers to the
//! cut with a mark at either end, the louder the stronger a tone or a walk. So the stretch is drawn from the law, as short
//! gaps are; only its ends, which know of the record, are solved for.

use std::ops::Range;

use crate::diagnosis::record::bridge::bridge;
use crate::diagnosis::record::drawn::{Drawn, Noise};

/// Samples at either end of a gap that are solved for: a choice. Beyond them noise goes on as it was drawn.
const END: usize = 1024;

/// Fills `gaps` of `values`, which are bridged, with `noise` on the ring of `drawn`.
pub fn fill(drawn: &Drawn, values: &mut [f64], gaps: &[Range<usize>], noise: &Noise<'_>) {
    let mut off = drawn.off(values, noise);
    let inside = || gaps.iter().cloned().flatten();
    let before: Vec<f64> = inside().map(|n| off[n]).collect();
    gaps.iter().for_each(|gap| off[gap.clone()].fill(f64::NAN));
    bridge(&mut off[..values.len()]);
    drawn.close(&mut off);
    for (n, before) in inside().zip(before) {
        values[n] += off[n] - before;
    }
    let ends = gaps.iter().flat_map(|gap| {
        let first = gap.start..(gap.start + END).min(gap.end);
        let last = gap.end.saturating_sub(END).max(first.end)..gap.end;
        [first, last]
    });
    let places: Vec<usize> = ends.chain(drawn.seam()).flatten().collect();
    let moves = drawn.moves(off, &places, noise);
    for (&place, by) in places.iter().zip(moves) {
        if let Some(value) = values.get_mut(place) {
            *value += by;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::statistic::matched_filter::Transformer;
    use crate::model::random::{Gaussian, Seed};

    const LENGTH: usize = 20_000;
    const RATE_HZ: f64 = 100.0;

    /// A strong tone about 5 Hz that loses its phase within 100 s, on white noise of density 1.
    fn law(len: usize) -> Vec<f64> {
        let of = |k: usize| {
            let f_hz = k as f64 * RATE_HZ / len as f64;
            1.0 + 1e10 / (1.0 + ((f_hz - 5.0) / 0.01).powi(2))
        };
        (0..=len / 2).map(of).collect()
    }

    /// The record, on a ring that it fills, whitened.
    fn whitened(values: &[f64]) -> Vec<f64> {
        let ring = Transformer::new(values.len());
        let density = law(ring.len());
        let whole = ring.transform_ring(ring.series(values), RATE_HZ);
        let white = whole.filtered(|k| (density[k] * RATE_HZ).sqrt().recip().into());
        white.to_vec()
    }

    #[test]
    fn a_tone_goes_on_through_a_gap() {
        for seed in 0..4 {
            let ring = Transformer::new(LENGTH);
            let mut normal = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
            let mut values = ring.noise(&law(LENGTH), RATE_HZ, || normal.draw()).to_vec();
            let gap = 7000..9700;
            values[gap.clone()].fill(f64::NAN);
            let drawn = Drawn::of(&values);
            let gaps = bridge(&mut values);
            assert_eq!(gaps, std::slice::from_ref(&gap));
            let about = |values: &[f64]| {
                let white = whitened(values);
                let ends = (gap.start - 5..gap.start + 5).chain(gap.end - 5..gap.end + 5);
                ends.map(|n| white[n].abs()).fold(0.0, f64::max)
            };
            let cut = about(&values);
            let density = law(drawn.ring_len());
            let noise = Noise {
                rate_hz: RATE_HZ,
                density: &density,
                strength: &|_| 1.0,
            };
            fill(&drawn, &mut values, &gaps, &noise);
            let filled = about(&values);
            // Of 80 normal numbers one lies beyond 5 in 20 000 runs, and none ever beyond 8.
            assert!(cut > 8.0 && filled < 5.0, "seed {seed}: {cut}, {filled}");
        }
    }
}
