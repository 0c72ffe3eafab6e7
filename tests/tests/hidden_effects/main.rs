//! Every hidden effect has the property that its name promises.

use std::f64::consts::{PI, TAU};

use inm_tests::hidden::axis::Axis;
use inm_tests::hidden::draw::Draw;
use inm_tests::hidden::effect::{Effect, find};
use inm_tests::hidden::noise::base::Base;
use inm_tests::hidden::noise::chain::Chain;
use inm_tests::hidden::scene::Scene;
use inm_tests::hidden::truth::Truth;
use realfft::RealFftPlanner;

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

#[test]
fn a_sinusoid_is_a_cosine_of_its_amplitude() {
    for seed in 1..4 {
        let alone = Alone::new("sinusoid", 1.0, seed);
        let expected = alone.parameter("amplitude");
        let found = amplitude(&alone.samples, alone.parameter("f_hz"));
        // A record does not hold a whole number of cycles: at worst 1 / (pi cycles).
        near(found, expected, expected / 100.0, seed);
    }
}

#[test]
fn a_hum_has_its_harmonics() {
    for seed in 1..4 {
        let alone = Alone::new("hum", 1e3, seed);
        let base_hz = alone.parameter("f_hz");
        let mut harmonics = 0;
        for number in 1..=5_u32 {
            let name = format!("amplitude_{number}");
            let expected = alone.truth().parameter(&name).unwrap_or(0.0);
            harmonics += u32::from(expected > 0.0);
            let found = amplitude(&alone.samples, f64::from(number) * base_hz);
            let largest = alone.parameter("amplitude_1");
            near(found, expected, largest / 500.0, seed);
        }
        assert!(harmonics >= 2, "seed {seed}");
    }
}

/// Sampling errors of a correlation by Bartlett: at most `sqrt(2 time / T)` of the variance.
#[test]
fn markov_noise_forgets_exponentially() {
    for seed in 1..6 {
        let alone = Alone::new("markov", 1.0, seed);
        let (amplitude, time_s) = (alone.parameter("amplitude"), alone.parameter("time_s"));
        let tolerance = 5.0 * (2.0 * time_s / alone.duration_s()).sqrt() * amplitude.powi(2);
        for times in [0.0, 0.5, 1.0, 2.0] {
            let lag = (times * time_s * RATE_HZ).round();
            let expected = amplitude.powi(2) * (-lag / (time_s * RATE_HZ)).exp();
            // The synthesis starts at zero: its level is the process' own, up to one draw, which
            // the mean takes out.
            let mean = alone.samples.iter().sum::<f64>() / alone.samples.len() as f64;
            let centred: Vec<f64> = alone.samples.iter().map(|x| x - mean).collect();
            near(
                correlation(&centred, lag as usize),
                expected,
                tolerance,
                seed,
            );
        }
    }
}

#[test]
fn a_resonance_rings_and_forgets() {
    for seed in 1..6 {
        let alone = Alone::new("resonance", 1.0, seed);
        let (f_hz, width_hz) = (alone.parameter("f_hz"), alone.parameter("width_hz"));
        let power = alone.parameter("amplitude").powi(2);
        let time_s = 1.0 / (PI * width_hz);
        let tolerance = 5.0 * (2.0 * time_s / alone.duration_s()).sqrt() * power;
        let mean = alone.samples.iter().sum::<f64>() / alone.samples.len() as f64;
        let centred: Vec<f64> = alone.samples.iter().map(|x| x - mean).collect();
        for periods in [0.0, 0.5, 1.0, 3.0] {
            let lag = (periods * RATE_HZ / f_hz).round();
            let t_s = lag / RATE_HZ;
            let expected = power * (-t_s / time_s).exp() * (TAU * f_hz * t_s).cos();
            near(
                correlation(&centred, lag as usize),
                expected,
                tolerance,
                seed,
            );
        }
    }
}

/// The level far above the corner against that far below, each over 400 ordinates: 5 % each.
#[test]
fn a_rolloff_halves_the_power_at_its_corner() {
    let alone = Alone::within("rolloff", 4.0, 1.0, 1);
    let corner_hz = alone.parameter("corner_hz");
    near(corner_hz, 500.0, 1e-9, 1);
    for (f_hz, expected) in [(50.0, 1.0 / 1.01), (500.0, 0.5), (900.0, 1.0 / 4.24)] {
        let found = band(&alone.samples, f_hz, 400);
        near(found, expected, 5.0 * expected / 400_f64.sqrt(), 1);
    }
}

#[test]
fn a_telegraph_has_two_levels_and_poisson_switches() {
    for seed in 1..6 {
        let alone = Alone::new("telegraph", 1.0, seed);
        let (height, dwell_s) = (alone.parameter("height"), alone.parameter("dwell_s"));
        let switches = alone
            .samples
            .windows(2)
            .filter(|pair| (pair[1] - pair[0]).abs() > 0.5 * height)
            .count() as f64;
        let expected = alone.duration_s() / dwell_s;
        near(switches, expected, 5.0 * expected.sqrt(), seed);
        let high = alone.samples.iter().filter(|x| **x > 0.0).count() as f64;
        let share = high / alone.samples.len() as f64;
        // Dwells of both sides are exponential: the share varies by sqrt(1 / (2 switches)).
        near(share, 0.5, 5.0 * (0.5 / expected).sqrt(), seed);
        for sample in &alone.samples {
            near(sample.abs(), 0.5 * height, 1e-3 * height, seed);
        }
    }
}

#[test]
fn steps_stay() {
    for seed in 1..6 {
        let alone = Alone::new("steps", 1.0, seed);
        let mut level = alone.samples[0];
        let mut count = 0;
        while let Some(time_s) = alone.truth().parameter(&format!("time_s_{}", count + 1)) {
            count += 1;
            let at = (time_s * RATE_HZ).ceil() as usize;
            level += alone.parameter(&format!("height_{count}"));
            near(alone.samples[at + 1], level, 1e-5, seed);
            near(alone.samples[at + 5000], level, 1e-5, seed);
        }
        let last = alone.samples[alone.samples.len() - 1];
        near(last, level, 1e-5, seed);
        assert!((1..=3).contains(&count), "seed {seed}");
    }
}

#[test]
fn outliers_are_rare_and_of_their_size() {
    for seed in 1..6 {
        let alone = Alone::new("outliers", 1.0, seed);
        let (rate_hz, size) = (alone.parameter("rate_hz"), alone.parameter("size"));
        let off: Vec<f64> = alone
            .samples
            .iter()
            .map(|x| x - alone.samples[0])
            .filter(|x| x.abs() > 1e-4 * size)
            .collect();
        let expected = rate_hz * alone.duration_s();
        near(off.len() as f64, expected, 5.0 * expected.sqrt(), seed);
        let mean_square = off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64;
        let tolerance = 5.0 * (2.0 / off.len() as f64).sqrt() * size.powi(2);
        near(mean_square, size.powi(2), tolerance, seed);
    }
}

#[test]
fn stale_samples_repeat() {
    for seed in 1..4 {
        let alone = Alone::new("stale", 100.0, seed);
        let repeats = alone.samples.windows(2).filter(|w| w[0] == w[1]).count() as f64;
        let expected = alone.parameter("share") * alone.samples.len() as f64;
        near(repeats, expected, 5.0 * expected.sqrt(), seed);
    }
}

#[test]
fn dropped_samples_are_gone() {
    for seed in 1..4 {
        let alone = Alone::new("dropped", 1.0, seed);
        let missing = alone.parameter("samples_1") as usize;
        assert_eq!(alone.samples.len() + missing, 1 << 18, "seed {seed}");
        let at = (alone.parameter("time_s_1") * RATE_HZ) as usize;
        // The hum by itself, whole: what is behind the gap comes that much earlier.
        let hum = alone
            .effect
            .waveform(&alone.scene, 0, &mut Draw::new(0, ""));
        let hum = hum.expect("a dropped sample shows in a hum");
        near(alone.samples[at - 1], hum[at - 1], 1e-6, seed);
        near(alone.samples[at], hum[at + missing], 1e-6, seed);
    }
}

#[test]
fn clipped_samples_lie_on_the_limit() {
    for seed in 1..4 {
        let alone = Alone::within("clipping", 5.0, 1e-3, seed);
        let side = alone.parameter("side");
        let (name, level) = &alone.settled[0];
        assert_eq!(name, "level");
        let on = alone.samples.iter().filter(|x| *x == level).count();
        assert_eq!(on, 50, "seed {seed}");
        assert!(
            alone.samples.iter().all(|x| x * side <= level * side),
            "seed {seed}"
        );
    }
}

#[test]
fn quantised_samples_are_multiples_of_the_step() {
    let alone = Alone::within("quantisation", 2.0, 1e-3, 1);
    let step = alone.parameter("step");
    // Twice the noise's deviation, sqrt(rate) N.
    near(step, 2.0 * 1e-3 * RATE_HZ.sqrt(), 1e-6, 1);
    for sample in &alone.samples {
        near((sample / step).round() * step, *sample, 1e-9, 1);
    }
}

#[test]
fn a_burst_is_louder_by_its_factor() {
    for seed in 1..4 {
        let alone = Alone::within("burst", 5.0, 1e-3, seed);
        let at = |name: &str| (alone.parameter(name) * RATE_HZ) as usize;
        let inside = &alone.samples[at("from_s") + 1..at("to_s")];
        let before = &alone.samples[..at("from_s")];
        let ratio = variance(inside) / variance(before);
        let expected = alone.parameter("factor").powi(2);
        let relative = (2.0 / inside.len() as f64 + 2.0 / before.len() as f64).sqrt();
        near(ratio, expected, 5.0 * relative * expected, seed);
    }
}

#[test]
fn cyclic_noise_swings_as_a_cosine() {
    for seed in 1..4 {
        let alone = Alone::within("cyclic", 4.0, 1e-3, seed);
        let (depth, period_s) = (alone.parameter("depth"), alone.parameter("period_s"));
        let phase_rad = alone.parameter("phase_rad");
        let swing = |t_s: f64| 1.0 + depth * (TAU * t_s / period_s + phase_rad).cos();
        // Powers in four parts of a cycle, over those that the cosine says.
        let (mut powers, mut expected, mut counts) = ([0.0; 4], [0.0; 4], [0.0_f64; 4]);
        for (i, sample) in alone.samples.iter().enumerate() {
            let t_s = i as f64 / RATE_HZ;
            let part = (4.0 * (t_s / period_s).fract()) as usize;
            powers[part] += sample * sample;
            expected[part] += swing(t_s).powi(2) * 1e-6 * RATE_HZ;
            counts[part] += 1.0;
        }
        for part in 0..4 {
            // The fourth powers of the cosine are at most three halves of the squares' square, five sigma.
            let relative = (2.0 * 1.5 / counts[part]).sqrt();
            near(powers[part] / expected[part], 1.0, 5.0 * relative, seed);
        }
    }
}

#[test]
fn shocks_have_their_height_and_their_energy() {
    for seed in 1..9 {
        // So plain that the noise is a millionth of it.
        let alone = Alone::new("shock", 1e6, seed);
        let truth = alone.truth();
        let (mut energy, mut highest, mut count) = (0.0, 0.0, 0);
        while let Some(peak) = truth.parameter(&format!("peak_{}", count + 1)) {
            count += 1;
            let of = |name: &str| truth.parameter(&format!("{name}_{count}"));
            highest = f64::max(highest, peak.abs());
            energy += peak
                * peak
                * match (of("f_hz"), of("decay_s"), of("duration_s")) {
                    (Some(f_hz), Some(decay_s), None) => {
                        // The integral of e^(-2t/T) sin^2 wt, over the square of its highest point, with a = wT:
                        // T a^2 / (4 (1 + a^2)) and e^(-2 atan(a) / a) a^2 / (1 + a^2).
                        let a = TAU * f_hz * decay_s;
                        0.25 * decay_s * (2.0 * a.atan() / a).exp()
                    }
                    (None, None, Some(length_s)) => 0.5 * length_s,
                    other => panic!("seed {seed}: {other:?}"),
                };
        }
        assert!((1..=4).contains(&count), "seed {seed}");
        let largest = alone
            .samples
            .iter()
            .fold(0.0, |most: f64, one| most.max(one.abs()));
        assert!(
            largest < 1.0001 * highest,
            "seed {seed}: {largest} of {highest}"
        );
        let sum = alone.samples.iter().map(|one| one * one).sum::<f64>() / RATE_HZ;
        // What ends within a noise of 1e-6 of it lies a record's tail below; sums of twenty samples or more a decay
        // are integrals to some percent, for the first sample may come half a period late.
        near(sum / energy, 1.0, 0.1, seed);
    }
}

#[test]
fn a_warmup_settles() {
    let alone = Alone::new("warmup", 1.0, 2);
    let (amplitude, time_s) = (alone.parameter("amplitude"), alone.parameter("time_s"));
    let at = |t_s: f64| alone.samples[(t_s * RATE_HZ) as usize];
    let fall = at(0.0) - at(time_s);
    near(fall, amplitude * (1.0 - (-1.0_f64).exp()), 1e-6, 2);
    let more = at(time_s) - at(3.0 * time_s);
    let expected = amplitude * ((-1.0_f64).exp() - (-3.0_f64).exp());
    near(more, expected, 1e-6, 2);
}

/// `lag y' = gain T - y`, over the record: the lag as the slope of (gain T - y) on y'. The
/// thermometer's own noise is averaged over a second.
#[test]
fn the_thermal_level_follows_late() {
    for seed in 1..4 {
        let alone = Alone::new("thermal", 1.0, seed);
        let (gain, lag_s) = (alone.parameter("gain"), alone.parameter("lag_s"));
        let temperature = alone.effect.temperature().expect("a column");
        let second = RATE_HZ as usize;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let level: Vec<f64> = alone.samples.chunks_exact(second).map(mean).collect();
        let air: Vec<f64> = temperature.chunks_exact(second).map(mean).collect();
        let (mut slope, mut weight) = (0.0, 0.0);
        for i in 1..level.len() - 1 {
            let rise = 0.5 * (level[i + 1] - level[i - 1]);
            slope += rise * (gain * (air[i] - 25.0) - level[i]);
            weight += rise * rise;
        }
        near(slope / weight, lag_s, 0.1 * lag_s + 0.2, seed);
    }
}

#[test]
fn common_noise_is_shared_by_its_gains() {
    let alone = Alone::new("common_mode", 1.0, 1);
    let first = &alone.samples;
    let power = variance(first);
    for (axis, name) in [(1, "gain_2"), (2, "gain_3")] {
        let (other, _) = alone.axis(axis);
        let product: f64 = first.iter().zip(&other).map(|(a, b)| a * b).sum();
        let gain = product / first.len() as f64 / power;
        near(gain, alone.parameter(name), 1e-4, 1);
    }
}

/// Two bands a decade apart, 300 ordinates each: 6 % each.
#[test]
fn a_powerlaw_has_its_slope() {
    for seed in 1..4 {
        let alone = Alone::new("powerlaw", 1.0, seed);
        let exponent = alone.parameter("exponent");
        let (low, high) = (
            band(&alone.samples, 40.0, 300),
            band(&alone.samples, 400.0, 300),
        );
        // Centres of the bands, 300 ordinates of 0.0076 Hz wide.
        let expected = -exponent * (401.1_f64 / 41.1).ln();
        near(
            (high / low).ln(),
            expected,
            5.0 * (2.0 / 300_f64).sqrt(),
            seed,
        );
        let density = alone.parameter("density_1hz");
        let expected = density * 41.1_f64.powf(-exponent);
        near(low, expected, 5.0 * expected / 300_f64.sqrt(), seed);
    }
}

#[test]
fn a_wrong_timebase_moves_all_lines() {
    let alone = Alone::new("timebase", 1e3, 1);
    let ratio = alone.parameter("ratio");
    let there = alone.effect.in_reference().expect("a reference").truths();
    let here = alone.effect.truths();
    assert!(there.len() >= 2 && here.len() == there.len() + 1);
    for (here, there) in here.iter().zip(&there) {
        let (f_hz, true_hz) = (here.parameter("f_hz"), there.parameter("f_hz"));
        let (f_hz, true_hz) = (f_hz.expect("a line"), true_hz.expect("a line"));
        near(f_hz * ratio, true_hz, 1e-9 * true_hz, 1);
        let expected = here.parameter("amplitude").expect("a line");
        near(
            amplitude(&alone.samples, f_hz),
            expected,
            expected / 50.0,
            1,
        );
    }
}
