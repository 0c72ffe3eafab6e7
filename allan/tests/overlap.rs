//! What striding costs: degrees of freedom of the streaming estimates against full overlap.

mod support;

use inm_allan::Statistic;
use inm_allan::edf::{Noise, edf};
use support::{ALL, grid};

/// The largest loss over records of 8 averaging times and more, of any length and alignment.
fn worst_loss(statistic: Statistic, noise: Noise) -> f64 {
    let mut worst = 0.0_f64;
    // One octave stands for all above the ground; the strides scale.
    for (m, stride) in grid(160).into_iter().filter(|&(_, stride)| stride == 2) {
        for samples in (8 * m..20 * m).step_by(7) {
            let span = statistic.span(m);
            let full = edf(statistic, noise, m, 1, samples - span + 1);
            // The least favourable alignment of the record to the stride.
            let terms = (samples - span + 1) / stride;
            worst = worst.max(1.0 - edf(statistic, noise, m, stride, terms) / full);
        }
    }
    worst
}

#[test]
fn white_flicker_and_walk_lose_less_than_one_percent() {
    // At level 1 a stride is two samples. Higher up the last incomplete stride is a larger part of
    // a sample, so the limit of fine sampling is tested too, at level 10.
    for statistic in ALL {
        for noise in [Noise::White, Noise::Flicker, Noise::Walk] {
            let loss = worst_loss(statistic, noise);
            assert!(loss < 0.01, "{statistic:?} {noise:?}: {loss}");
            for lag in [24, 28, 32, 40] {
                let (m, stride) = (lag << 10, 1 << 10);
                let span = statistic.span(m);
                for extra in [0, stride / 2, stride - 1] {
                    let samples = 8 * m + extra;
                    let full = edf(statistic, noise, m, 1, samples - span + 1);
                    let terms = (samples - span + 1) / stride;
                    let loss = 1.0 - edf(statistic, noise, m, stride, terms) / full;
                    assert!(loss < 0.01, "{statistic:?} {noise:?} lag {lag} + {extra}: {loss}");
                }
            }
        }
    }
}

#[test]
fn quantisation_noise_loses_the_stride() {
    // Differenced white noise: neighbours are independent, so the loss is the stride itself.
    let full = edf(Statistic::Allan, Noise::Quantisation, 48, 1, 10_000);
    let strided = edf(Statistic::Allan, Noise::Quantisation, 48, 2, 5_000);
    assert!((full / strided / 2.0 - 1.0).abs() < 1e-3, "{full} {strided}");
}
