//! Trials of effects: does what their simulators make follow the law of the model?

use super::axis::ModelAxis;
use super::effect::Part;
use super::whole::Model;
use super::{Coefficient, Seed};
use crate::simulate::axis::AxisSimulation;

/// An axis with `coefficients` and `effects`, as they are written in a model file.
pub fn axis(coefficients: &str, effects: &str) -> ModelAxis {
    let text = format!(
        r#"{{ "schema": 1, "rate_hz": 1000, "axes": [ {{ "name": "X",
            "coefficients": {{ {coefficients} }}, "effects": [ {effects} ] }} ] }}"#
    );
    Model::from_json(&text)
        .expect("a model")
        .axes
        .swap_remove(0)
}

/// Data of `axis` at a nominal `rate_hz`, made in blocks of `block` samples.
pub fn record(axis: &ModelAxis, rate_hz: f64, count: usize, seed: u64, block: usize) -> Vec<f64> {
    if axis.values_hz(rate_hz) < rate_hz {
        let mut made = AxisSimulation::new(axis, 0, &[1.0], rate_hz, seed);
        let blocks = std::iter::repeat_with(|| made.next(block));
        return blocks.flatten().take(count).collect();
    }
    let rate_hz = axis.clock() * rate_hz;
    let mut streams = (0..).map(|stream| Seed { seed, stream });
    let mut seed = || streams.next().expect("no end");
    let mut generators = Vec::new();
    let mut distorters = Vec::new();
    for coefficient in Coefficient::ALL {
        let term = coefficient.term(*axis.coefficients.get(coefficient));
        generators.push(term.generator(rate_hz, seed()));
    }
    for effect in &axis.effects {
        match effect.part() {
            Part::Term(term) => generators.push(term.generator(rate_hz, seed())),
            Part::Distortion(one) => distorters.push(one.distorter(rate_hz, seed())),
            Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => {}
        }
    }
    let mut samples = Vec::new();
    while samples.len() < count {
        let mut next = vec![axis.mean; block];
        generators.iter_mut().for_each(|one| one.add_to(&mut next));
        distorters.iter_mut().for_each(|one| one.apply(&mut next));
        samples.append(&mut next);
    }
    samples.truncate(count);
    samples
}

/// Allan variance at `m` samples, from every difference.
pub fn allan_variance(samples: &[f64], m: usize) -> f64 {
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for sample in samples {
        sum += sample;
        sums.push(sum);
    }
    let difference = |k: usize| (sums[k + 2 * m] - 2.0 * sums[k + m] + sums[k]) / m as f64;
    let count = sums.len() - 2 * m;
    (0..count).map(|k| difference(k).powi(2)).sum::<f64>() / (2 * count) as f64
}

/// Whether the mean of the Allan variances of many records is the law's.
pub fn assert_allan_variance(axis: &ModelAxis, rate_hz: f64, averaging: &[usize]) {
    const RECORDS: u64 = 32;
    const SEED: u64 = 100;
    const LENGTH: usize = 4096;
    let law = axis.law(rate_hz);
    let records: Vec<Vec<f64>> = (SEED..SEED + RECORDS)
        .map(|seed| AxisSimulation::new(axis, 0, &[1.0], rate_hz, seed).next(LENGTH))
        .collect();
    for &m in averaging {
        let found: Vec<f64> = records.iter().map(|one| allan_variance(one, m)).collect();
        let count = RECORDS as f64;
        let mean = found.iter().sum::<f64>() / count;
        let scatter = found.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let z = (mean - law.allan_variance(m as u64)) / (scatter / count).sqrt();
        // Student's t of 31 degrees of freedom: 5 is passed once in 40 000.
        assert!(
            z.abs() < 5.0,
            "{:?}, m = {m}, seeds from {SEED}: {mean:e} for {:e}, {z} sigma",
            axis.effects,
            law.allan_variance(m as u64)
        );
    }
}

/// Every effect of the catalogue, with values that show within a few thousand samples at 1000/s.
const EFFECTS: &[(&str, &str)] = &[
    ("sinusoid", r#""f_hz": 51.3, "amplitude": 0.1"#),
    ("markov", r#""amplitude": 0.2, "time_s": 0.01"#),
    (
        "resonance",
        r#""f_hz": 80, "width_hz": 3, "amplitude": 0.1"#,
    ),
    ("powerlaw", r#""exponent": 1.3, "density_1hz": 0.01"#),
    ("rolloff", r#""corner_hz": 200"#),
    ("averaging", r#""duration_s": 0.0075"#),
    ("highpass", r#""corner_hz": 20"#),
    (
        "hum",
        r#""f_hz": 50, "amplitude_1": 0.1, "amplitude_2": 0.05"#,
    ),
    (
        "wandering_line",
        r#""f_hz": 70, "wander_hz": 2, "wander_s": 0.3, "amplitude_1": 0.1, "amplitude_2": 0.05"#,
    ),
    ("telegraph", r#""height": 1, "dwell_s": 0.02"#),
    (
        "steps",
        r#""time_s_1": 0.7, "height_1": 3, "time_s_2": 1.9, "height_2": -1"#,
    ),
    (
        "shock",
        r#""time_s_1": 0.3, "peak_1": 2, "duration_s_1": 0.4, "f_hz_1": 40, "decay_s_1": 0.1"#,
    ),
    (
        "motion",
        r#""time_s_1": 0.6, "duration_s_1": 0.4, "step_1": -2, "f_hz_1": 40, "width_hz_1": 10, "amplitude_1": 1"#,
    ),
    ("warmup", r#""amplitude": 2, "time_s": 0.3"#),
    (
        "drift",
        r#""duration_s": 2.5, "level_1": 1, "level_2": -2, "level_3": 0, "level_4": 4"#,
    ),
    ("thermal", r#""gain": 0.001, "lag_s": 10"#),
    ("outliers", r#""rate_hz": 50, "size": 10"#),
    ("stale", r#""share": 0.1"#),
    ("held", r#""sensor_hz": 300"#),
    (
        "dropped",
        r#""time_s_1": 0.5, "samples_1": 700, "time_s_2": 1.1, "samples_2": 3"#,
    ),
    ("clipping", r#""level": 10.1, "side": 1"#),
    ("quantisation", r#""step": 0.1"#),
    ("burst", r#""from_s": 0.4, "to_s": 1.2, "factor": 2"#),
    ("cyclic", r#""depth": 0.5, "period_s": 0.7, "phase_rad": 1"#),
    ("common_mode", r#""gain": -0.5"#),
    ("timebase", r#""ratio": 1.0001"#),
    ("unnamed", r#""f_hz": 60, "width_hz": 20, "amplitude": 0.1"#),
];

#[cfg(test)]
mod tests {
    use super::super::catalogue::CATALOGUE;
    use super::*;

    #[test]
    fn data_do_not_depend_on_the_blocks_they_are_made_in() {
        let known: Vec<&str> = CATALOGUE.iter().map(|effect| effect.name()).collect();
        let tried: Vec<&str> = EFFECTS.iter().map(|(name, _)| *name).collect();
        assert_eq!(known, tried);
        let plain = ModelAxis {
            mean: 9.8,
            ..axis(r#""N": 0.01, "K": 0.1"#, "")
        };
        for (name, parameters) in EFFECTS {
            let effect = format!(r#"{{ "effect": "{name}", "parameters": {{ {parameters} }} }}"#);
            let axis = ModelAxis {
                effects: axis("", &effect).effects,
                ..plain.clone()
            };
            let whole = record(&axis, 1000.0, 3000, 6, 3000);
            assert!(whole == record(&axis, 1000.0, 3000, 6, 37), "{name}");
            assert!(whole == record(&axis, 1000.0, 3000, 6, 1), "{name}");
            let acts = !matches!(axis.effects[0].part(), Part::Follows(_));
            assert_eq!(
                whole != record(&plain, 1000.0, 3000, 6, 3000),
                acts,
                "{name}"
            );
        }
    }
}
