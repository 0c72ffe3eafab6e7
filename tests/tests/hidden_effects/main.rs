//! Every hidden effect has the property that its name promises.

mod events;
mod laws;
mod levels;
mod lines;
mod samples;

use inm_tests::hidden::axis::Axis;
use inm_tests::hidden::draw::Draw;
use inm_tests::hidden::effect::{Effect, find};
use inm_tests::hidden::noise::base::Base;
use inm_tests::hidden::noise::chain::Chain;
use inm_tests::hidden::scene::Scene;
use inm_tests::hidden::truth::Truth;
use realfft::RealFftPlanner;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 2000.0;

/// An effect by itself, in noise too small to matter unless a test says otherwise.
struct Alone {
    scene: Scene,
    effect: Box<dyn Effect>,
    samples: Vec<f64>,
    settled: Vec<(String, f64)>,
    seed: u64,
}

impl Alone {
    fn new(kind: &str, factor: f64, seed: u64) -> Self {
        Self::within(kind, factor, 1e-9, seed)
    }

    /// In white noise of this N.
    fn within(kind: &str, factor: f64, n: f64, seed: u64) -> Self {
        let base = Base {
            r: 0.0,
            k: 0.0,
            b: 0.0,
            n,
            q: 0.0,
            mean: 0.0,
        };
        let kind = find(kind).expect("a kind of the catalogue");
        let scene = Scene {
            rate_hz: RATE_HZ,
            samples: 1 << 18,
            axes: vec![base; kind.axes],
            target: 0,
            chain: Chain::None,
            declared: true,
            relative: false,
            missing: 0.0,
            code: 0.0,
            measured: None,
        };
        let effect = (kind.draw)(&scene, &mut Draw::new(seed, kind.name)).scaled(factor);
        let mut alone = Self {
            scene,
            effect,
            samples: Vec::new(),
            settled: Vec::new(),
            seed,
        };
        (alone.samples, alone.settled) = alone.axis(0);
        alone
    }

    fn axis(&self, axis: usize) -> (Vec<f64>, Vec<(String, f64)>) {
        let effects = [self.effect.as_ref()];
        let (samples, settled) =
            Axis::new(&self.scene, axis, &effects, self.seed, "alone").samples();
        (samples, settled.into_iter().flatten().collect())
    }

    fn truth(&self) -> Truth {
        self.effect.truths().pop().expect("at least one truth")
    }

    fn parameter(&self, name: &str) -> f64 {
        self.truth().parameter(name).expect(name)
    }

    fn duration_s(&self) -> f64 {
        self.scene.duration_s()
    }
}

/// Amplitude at a frequency, by least squares on cosine and sine.
fn amplitude(samples: &[f64], f_hz: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (i, sample) in samples.iter().enumerate() {
        let angle = TAU * (f_hz * i as f64 / RATE_HZ).fract();
        re += sample * angle.cos();
        im += sample * angle.sin();
    }
    2.0 * re.hypot(im) / samples.len() as f64
}

fn correlation(samples: &[f64], lag: usize) -> f64 {
    let pairs = samples.iter().zip(&samples[lag..]);
    pairs.map(|(a, b)| a * b).sum::<f64>() / (samples.len() - lag) as f64
}

fn variance(samples: &[f64]) -> f64 {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples.len() as f64
}

/// Mean of the periodogram over `ordinates` from `f_hz` on: power per hertz, two-sided.
fn band(samples: &[f64], f_hz: f64, ordinates: usize) -> f64 {
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(samples.len());
    let mut spectrum = plan.make_output_vec();
    plan.process(&mut samples.to_vec(), &mut spectrum)
        .expect("sizes fit");
    let first = (f_hz * samples.len() as f64 / RATE_HZ).round() as usize;
    let sum: f64 = spectrum[first..first + ordinates]
        .iter()
        .map(|x| x.norm_sqr())
        .sum();
    sum / (samples.len() as f64 * RATE_HZ * ordinates as f64)
}

#[track_caller]
fn near(value: f64, expected: f64, tolerance: f64, seed: u64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "seed {seed}: {value}, expected {expected} within {tolerance}"
    );
}
