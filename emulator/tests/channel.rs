//! The channel's noise against theory: each term alone, raw and through the converter.
//!
//! Tolerances are five standard deviations of the estimate, from the number of independent values
//! in it; seeds are fixed.

use inm_emulator::{
    Conversion, Phase, Registers, Signal,
    channel::Channel,
    filter::DECIMATION,
    response::Response,
    sensor::{Coefficients, Sensor},
};

const RATE_HZ: u32 = 2000;
const INPUT_HZ: f64 = 64_000.0;

/// A level sensor with one kind of noise, in m/s^2 about its mean at rest.
struct Axis {
    channel: Channel,
    steps_per_m_s2: f64,
    rest_steps: f64,
}

fn axis(noise: Coefficients, seed: u64) -> Axis {
    let sensor = Sensor {
        noise,
        gravity_m_s2: 3.0,
        zero_g_error_v: -0.05,
        ..Sensor::XY
    };
    let mut channel = Channel::new(&sensor, seed, 0).expect("in range");
    channel.set_rate(RATE_HZ * DECIMATION as u32);
    Axis {
        channel,
        steps_per_m_s2: sensor.steps_per_m_s2(),
        rest_steps: sensor.rest_steps(),
    }
}

impl Axis {
    /// Raw inputs, ahead of the converter.
    fn raw(&mut self, count: usize) -> Vec<f64> {
        (0..count)
            .map(|_| (f64::from(self.channel.next()) - self.rest_steps) / self.steps_per_m_s2)
            .collect()
    }

    /// Codes behind the converter at 2000/s.
    fn converted(self, count: usize) -> Vec<f64> {
        let mut registers = Registers::default();
        registers.set(1, 0x5A);
        let mut conversion = Conversion::new(self.channel);
        (0..count)
            .map(|_| {
                let code = f64::from(conversion.next_word(&registers) as i32 >> 1);
                (code - self.rest_steps) / self.steps_per_m_s2
            })
            .collect()
    }
}

fn variance(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64
}

/// Overlapping Allan variance at averaging factor `m`.
fn allan_variance(values: &[f64], m: usize) -> f64 {
    let mut sums = vec![0.0];
    for value in values {
        sums.push(sums[sums.len() - 1] + value);
    }
    let count = sums.len() - 2 * m;
    let squares = (0..count).map(|i| (sums[i + 2 * m] - 2.0 * sums[i + m] + sums[i]).powi(2));
    squares.sum::<f64>() / (2.0 * count as f64 * (m * m) as f64)
}

/// Power gain of the sensor's pole as it is emulated.
fn pole_gain(f_hz: f64) -> f64 {
    let a = 1.0 - (-2.0 * std::f64::consts::PI * 400.0 / INPUT_HZ).exp();
    let b = 1.0 - a;
    a * a / (1.0 + b * b - 2.0 * b * (2.0 * std::f64::consts::PI * f_hz / INPUT_HZ).cos())
}

/// Variance behind pole and converter of noise with this two-sided density at the input.
fn expected_variance(density: impl Fn(f64) -> f64) -> f64 {
    let response = Response::new(Phase::Linear, RATE_HZ);
    let step = 0.5;
    let sum: f64 = (0..4000)
        .map(|i| {
            let f_hz = (f64::from(i) + 0.5) * step;
            let gain = response.gain(f_hz / f64::from(RATE_HZ));
            density(f_hz) * pole_gain(f_hz) * gain * gain
        })
        .sum();
    2.0 * step * sum
}

fn assert_close(what: &str, seed: u64, got: f64, expected: f64, sigma: f64) {
    let off = got / expected - 1.0;
    assert!(
        off.abs() < 5.0 * sigma,
        "{what}, seed {seed}: off by {off}, sigma {sigma}"
    );
}

#[test]
fn at_rest_the_level_is_gravity_and_zero_g_error() {
    let raw = axis(Coefficients::NONE, 1).raw(1000);
    assert!(raw.iter().all(|x| x.abs() < 1e-7), "one step is 7e-8 m/s^2");
}

#[test]
fn white_noise_raw_and_converted() {
    let seed = 21;
    let white = 1.05e-4;
    let noise = Coefficients {
        white,
        ..Coefficients::NONE
    };
    // Raw: N^2 fs through the pole, alpha / (2 - alpha); correlation time 1/alpha = 26 inputs.
    let raw = axis(noise, seed).raw(2_000_000);
    let a = 1.0 - (-2.0 * std::f64::consts::PI * 400.0 / INPUT_HZ).exp();
    let expected = white * white * INPUT_HZ * a / (2.0 - a);
    assert_close(
        "raw",
        seed,
        variance(&raw),
        expected,
        (2.0 / a / 2e6_f64).sqrt(),
    );
    let converted = axis(noise, seed).converted(200_000);
    let expected = expected_variance(|_| white * white);
    // Bandwidth 448 of 1000 Hz: 0.45 independent values a sample, less for squares' correlation.
    assert_close(
        "converted",
        seed,
        variance(&converted),
        expected,
        (2.0 / 0.45 / 2e5_f64).sqrt(),
    );
    // And the level that is read off the Allan plot, sigma^2 = N^2 / tau, at 64 conversions.
    let tau = 64.0 / f64::from(RATE_HZ);
    let got = allan_variance(&converted, 64);
    // Overlapping estimate: about 1.5 times as many degrees of freedom as records.
    let sigma = (2.0_f64 / (1.5 * 200_000.0 / 64.0)).sqrt();
    assert_close(
        "Allan",
        seed,
        got,
        0.999 * 0.999 * white * white / tau,
        sigma,
    );
}

#[test]
fn quantisation_noise_raw_and_converted() {
    let seed = 22;
    let q = 2.25e-4;
    let noise = Coefficients {
        quantisation: q,
        ..Coefficients::NONE
    };
    // Raw: velocity noise of variance 32 Q^2, differenced, times fs, through the pole:
    // alpha^2 * 2 / (2 - alpha). 0.32 g, as good as white.
    let raw = axis(noise, seed).raw(1_000_000);
    let a = 1.0 - (-2.0 * std::f64::consts::PI * 400.0 / INPUT_HZ).exp();
    let expected = 32.0 * q * q * INPUT_HZ * INPUT_HZ * a * a * 2.0 / (2.0 - a);
    assert!((expected.sqrt() / 9.80665 - 0.32).abs() < 0.01);
    assert_close(
        "raw",
        seed,
        variance(&raw),
        expected,
        (2.0 / 1e6_f64).sqrt(),
    );
    let converted = axis(noise, seed).converted(200_000);
    let per_hz = |f_hz: f64| {
        let difference = 2.0 * (std::f64::consts::PI * f_hz / INPUT_HZ).sin();
        32.0 * q * q * INPUT_HZ * difference * difference
    };
    let expected = expected_variance(per_hz);
    assert_close(
        "converted",
        seed,
        variance(&converted),
        expected,
        (2.0 / 0.4 / 2e5_f64).sqrt(),
    );
    // Below the data rate's Nyquist frequency that is Q^2 tau0 (2 pi f)^2: Allan 3 Q^2 / tau^2.
    // With the pole and the filter the band ends at some 450 Hz, and with it the 3 becomes less:
    // compared with the integral over the Allan window of 8 samples.
    let tau = 8.0 / f64::from(RATE_HZ);
    let window = |f_hz: f64| {
        let sample = (std::f64::consts::PI * f_hz / f64::from(RATE_HZ)).sin();
        2.0 * (std::f64::consts::PI * f_hz * tau).sin().powi(4) / (8.0 * sample).powi(2)
    };
    let expected = expected_variance(|f_hz| per_hz(f_hz) * window(f_hz));
    let sigma = (2.0_f64 / (200_000.0 / 8.0)).sqrt();
    assert_close(
        "Allan",
        seed,
        allan_variance(&converted, 8),
        expected,
        sigma,
    );
}

#[test]
fn random_walk_grows_as_it_should() {
    let seed = 23;
    let walk = 3.6e-5;
    let noise = Coefficients {
        walk,
        ..Coefficients::NONE
    };
    let m = 100;
    let n = 400_000;
    let converted = axis(noise, seed).converted(n);
    let tau = m as f64 / f64::from(RATE_HZ);
    // Overlapping estimate of a walk: about one degree of freedom a record.
    let sigma = (2.0 / (n as f64 / m as f64)).sqrt();
    assert_close(
        "Allan",
        seed,
        allan_variance(&converted, m),
        walk * walk * tau / 3.0,
        sigma,
    );
}

#[test]
fn flicker_is_a_floor() {
    let seed = 24;
    let flicker = 0.55e-4;
    let noise = Coefficients {
        flicker,
        ..Coefficients::NONE
    };
    let n = 1_000_000;
    let converted = axis(noise, seed).converted(n);
    for m in [300, 1000, 3000] {
        let expected = flicker * flicker * 2.0 * std::f64::consts::LN_2 / std::f64::consts::PI;
        // About one degree of freedom a record, and the bank's own upper end: 2 % at m = 300.
        let sigma = (2.0 / (n as f64 / m as f64)).sqrt() + 0.004;
        assert_close(
            "Allan",
            seed,
            allan_variance(&converted, m),
            expected,
            sigma,
        );
    }
}

#[test]
fn the_ramp_is_a_line() {
    let ramp = 4.2e-3;
    let converted = axis(
        Coefficients {
            ramp,
            ..Coefficients::NONE
        },
        25,
    )
    .converted(20_000);
    let rise = converted[19_999] - converted[9_999];
    assert!((rise / (ramp * 5.0) - 1.0).abs() < 1e-4, "{rise}");
}

#[test]
fn seeds_and_axes_are_independent() {
    let noise = Coefficients::PUBLISHED[0];
    let sensor = Sensor {
        noise,
        ..Sensor::XY
    };
    let n = 100_000;
    let record = |seed, axis| {
        let mut channel = Channel::new(&sensor, seed, axis).expect("in range");
        channel.set_rate(64_000);
        (0..n)
            .map(|_| f64::from(channel.next()))
            .collect::<Vec<_>>()
    };
    let first = record(1, 0);
    for (seed, axis) in [(2, 0), (1, 1), (1, 2), (0, 0)] {
        let other = record(seed, axis);
        let product: f64 = first.iter().zip(&other).map(|(a, b)| a * b).sum();
        let power: f64 = first.iter().map(|a| a * a).sum();
        // Nearly white: five over sqrt(n).
        assert!((product / power).abs() < 0.016, "seed {seed}, axis {axis}");
    }
    assert_eq!(first, record(1, 0));
}

#[test]
fn the_output_stops_at_the_sensors_rails() {
    // 6 g on a 4 g range: flat at 0.1 V below the supply, 1.3 V above AINN, well inside the
    // converter.
    let sensor = Sensor {
        gravity_m_s2: 58.8,
        ..Sensor::XY
    };
    let mut channel = Channel::new(&sensor, 1, 0).expect("in range");
    channel.set_rate(64_000);
    let volts = f64::from(channel.next()) / sensor.steps_per_volt();
    assert!((volts - 1.3).abs() < 1e-8, "{volts}");
    let coarse = Sensor {
        sensitivity_v_per_g: Sensor::COARSE_V_PER_G,
        ..sensor
    };
    let mut channel = Channel::new(&coarse, 1, 0).expect("in range");
    let volts = f64::from(channel.next()) / coarse.steps_per_volt();
    assert!((volts - 58.8 / 9.80665 * 0.0836).abs() < 1e-8, "{volts}");
}

#[test]
fn blocks_and_single_inputs_are_the_same() {
    let noise = Coefficients::PUBLISHED[1];
    let (mut single, mut block) = (axis(noise, 3).channel, axis(noise, 3).channel);
    for round in 0..100 {
        // A block out of step with the conversions as well.
        if round == 50 {
            assert_eq!(single.next(), block.next());
        }
        let mut inputs = [0; DECIMATION];
        block.fill(&mut inputs);
        assert_eq!(
            inputs,
            [(); DECIMATION].map(|()| single.next()),
            "round {round}"
        );
    }
}
