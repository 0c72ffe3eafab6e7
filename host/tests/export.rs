//! Are exported files what the programs they are for would read, and do they hold the model?

use std::collections::BTreeMap;

use inm_allan::Statistic;
use inm_host::internals::analyse::{AnalysisOptions, analyse};
use inm_host::internals::bins::strided::Strided;
use inm_host::internals::export::input::Input;
use inm_host::internals::export::{Format, export};
use inm_host::internals::model::markov::Markov;
use inm_host::internals::model::white::White;
use inm_host::internals::model::whole::Model;
use inm_host::internals::model::{Coefficient, Term};
use inm_host::internals::report;
use inm_host::internals::simulate::source::Simulation;
use nalgebra::{DMatrix, DVector};
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;

fn text(input: &Input, format: Format) -> String {
    String::from_utf8(export(input, format).expect("exportable")).expect("text")
}

fn input(model: Model) -> Input {
    Input {
        name: "test".to_owned(),
        bounds: vec![Default::default(); model.axes.len()],
        model,
        longest_s: 1000.0,
    }
}

/// Three axes: published, published behind the chain, Markov noise and a sinusoid behind a pole.
fn three() -> Input {
    let mut model = Model::published(None);
    model.axes[1].chain = Some("ads1281:linear+400hz".parse().expect("a chain"));
    model.axes[2] = serde_json::from_str(
        r#"{ "name": "Z", "unit": "m/s^2", "mean": 9.8, "chain": "40hz",
             "coefficients": { "N": 1e-3, "K": 1e-4 },
             "effects": [
               { "effect": "markov", "parameters": { "amplitude": 0.02, "time_s": 0.3 } },
               { "effect": "sinusoid", "parameters": { "f_hz": 3, "amplitude": 0.01 } } ] }"#,
    )
    .expect("an axis");
    input(model)
}

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).expect("rows of numbers");
    let columns = rows.first().map_or(0, Vec::len);
    DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j])
}

fn vector(value: &Value) -> DVector<f64> {
    serde_json::from_value::<Vec<f64>>(value.clone())
        .expect("numbers")
        .into()
}

/// Runs the matrices of a file, and nothing else, on white noise.
fn run(axis: &Value, length: usize, random: &mut rand_pcg::Pcg64) -> Vec<f64> {
    let (f, g, q, p0) = (
        matrix(&axis["F"]),
        matrix(&axis["G"]),
        matrix(&axis["Q"]),
        matrix(&axis["P0"]),
    );
    let (h, mut x) = (vector(&axis["H"]), vector(&axis["x0"]));
    let mut normal = |count| DVector::from_fn(count, |_, _| StandardNormal.sample(random));
    let start = p0.symmetric_eigen();
    let spread = start.eigenvalues.map(|value: f64| value.max(0.0).sqrt());
    x += &start.eigenvectors * normal(x.len()).component_mul(&spread);
    let deviation = q.diagonal().map(f64::sqrt);
    let mut samples = Vec::with_capacity(length);
    for _ in 0..length {
        samples.push(h.dot(&x));
        x = &f * x + &g * normal(deviation.len()).component_mul(&deviation);
    }
    samples
}

#[test]
fn shaping_filter_run_on_white_noise_has_the_allan_deviation_of_the_model() {
    const RECORDS: u128 = 16;
    const LENGTH: usize = 1 << 14;
    const SEED: u128 = 3;
    let input = three();
    let file: Value = serde_json::from_str(&text(&input, Format::StateSpace)).expect("JSON");
    for (axis, model) in file["axes"]
        .as_array()
        .expect("axes")
        .iter()
        .zip(&input.model.axes)
    {
        let law = model.law(input.model.rate_hz);
        let mut found: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
        for record in 0..RECORDS {
            let samples = run(axis, LENGTH, &mut rand_pcg::Pcg64::new(SEED, record));
            let mut bins = Strided::default();
            bins.push_floats(&samples);
            for estimate in bins.estimates(Statistic::Allan) {
                if estimate.m.is_power_of_two() && 16 * estimate.m <= LENGTH as u64 {
                    found.entry(estimate.m).or_default().push(estimate.variance);
                }
            }
        }
        assert!(found.len() > 9, "{} averaging times", found.len());
        for (m, values) in found {
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let scatter = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
            let expected = law.allan_variance(m);
            // Two percent of deviation are four of variance; Student's t of 15 degrees of
            // freedom passes 5 once in 6000.
            let tolerance = 0.04 * expected + 5.0 * (scatter / count).sqrt();
            assert!(
                (mean - expected).abs() < tolerance,
                "axis {}, m = {m}, seed {SEED}: {mean:e} for {expected:e} +- {tolerance:e}",
                model.name
            );
        }
    }
}

#[test]
fn stated_accuracy_is_below_two_percent() {
    let file: Value = serde_json::from_str(&text(&three(), Format::StateSpace)).expect("JSON");
    for axis in file["axes"].as_array().expect("axes") {
        let percent = axis["accuracy"]["allan_deviation_percent"].as_f64();
        assert!(
            percent.is_some_and(|percent| percent < 2.0),
            "{}",
            axis["accuracy"]
        );
        assert_eq!(axis["left_out"], Value::Array(Vec::new()));
    }
}

/// A mapping of scalars as a YAML 1.1 reader takes it; kalibr uses one.
fn yaml(text: &str) -> BTreeMap<String, String> {
    text.lines()
        .map(|line| line.split(" #").next().unwrap_or_default().trim())
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(|line| {
            let (key, value) = line.split_once(": ").expect("key: value");
            (key.to_owned(), value.trim().to_owned())
        })
        .collect()
}

/// A floating-point number of YAML 1.1: with a point, and a signed exponent if any.
fn yaml_float(text: &str) -> f64 {
    assert!(text.contains('.'), "{text} is no number to YAML 1.1");
    if let Some((_, exponent)) = text.split_once('e') {
        assert!(
            exponent.starts_with(['+', '-']),
            "{text} is no number to YAML 1.1"
        );
    }
    text.parse().expect("a number")
}

#[test]
fn kalibr_reads_its_file() {
    let input = input(Model::published(None));
    let file = yaml(&text(&input, Format::Kalibr));
    // What ImuParameters of kalibr asks for: both above zero, and a rate.
    assert_eq!(yaml_float(&file["accelerometer_noise_density"]), 1.05e-4);
    assert_eq!(yaml_float(&file["accelerometer_random_walk"]), 3.6e-5);
    assert_eq!(yaml_float(&file["update_rate"]), 2000.0);
    assert_eq!(file["rostopic"], "/imu0");

    let mut white = Model::published(None);
    white
        .axes
        .iter_mut()
        .for_each(|axis| axis.coefficients.k = 0.0);
    let error = export(&self::input(white.clone()), Format::Kalibr).expect_err("no random walk");
    assert!(error.to_string().contains("has no K"), "{error}");
    let mut bounded = self::input(white);
    bounded.bounds[0].k = Some(5e-5);
    let file = text(&bounded, Format::Kalibr);
    assert_eq!(yaml_float(&yaml(&file)["accelerometer_random_walk"]), 5e-5);
    assert!(file.contains("95 % bound"));
}

/// The arrays of a Python dictionary or a MATLAB call: `'name': np.array([...])`, `'name', [...]`.
fn arrays(text: &str) -> BTreeMap<String, Vec<f64>> {
    text.lines()
        .map(str::trim)
        .filter(|line| line.starts_with('\''))
        .filter_map(|line| {
            let name = line.split('\'').nth(1)?;
            let list = line.split_once('[')?.1.split_once(']')?.0;
            let numbers = list
                .split([',', ' '])
                .filter(|item| !item.is_empty())
                .map(|item| item.parse().expect("a number"));
            Some((name.to_owned(), numbers.collect()))
        })
        .collect()
}

#[test]
fn gnss_ins_sim_reads_its_file_and_it_is_as_close_as_it_says() {
    let input = input(Model::published(None));
    let file = text(&input, Format::GnssInsSim);
    let arrays = arrays(&file);
    // The keys that set_accel_error knows, and no other.
    let keys: Vec<&str> = arrays.keys().map(String::as_str).collect();
    assert_eq!(keys, ["b", "b_corr", "b_drift", "vrw"]);
    assert_eq!(arrays["vrw"], [1.05e-4, 9.4e-5, 1.03e-4]);
    for (k, axis) in input.model.axes.iter().enumerate() {
        let stated = file
            .lines()
            .find_map(|line| line.strip_prefix(&format!("#     {}: ", axis.name)))
            .and_then(|rest| rest.strip_suffix(" %"))
            .and_then(|percent| percent.parse::<f64>().ok())
            .expect("a percentage");
        let white = White {
            root_density: arrays["vrw"][k],
        };
        let drift = Markov {
            deviation: arrays["b_drift"][k],
            time_s: arrays["b_corr"][k],
        };
        let mut slow = axis.clone();
        slow.coefficients.q = 0.0;
        slow.coefficients.r = 0.0;
        let law = slow.law(input.model.rate_hz);
        for m in (4..21).map(|k| 1 << k) {
            let rate_hz = input.model.rate_hz;
            let variance = white.allan_variance(m, rate_hz) + drift.allan_variance(m, rate_hz);
            let percent = 100.0 * ((variance / law.allan_variance(m)).sqrt() - 1.0).abs();
            assert!(
                percent < stated + 1.0,
                "axis {}, m = {m}: {percent} %",
                axis.name
            );
        }
    }
}

#[test]
fn matlab_file_is_one_call_with_n_b_and_k() {
    let file = text(&input(Model::published(None)), Format::Matlab);
    let arrays = arrays(&file);
    assert_eq!(arrays["NoiseDensity"], [1.05e-4, 9.4e-5, 1.03e-4]);
    assert_eq!(arrays["BiasInstability"], [5.5e-5, 3.9e-5, 4.8e-5]);
    assert_eq!(arrays["RandomWalk"], [3.6e-5, 2.3e-5, 3.3e-5]);
    assert!(file.contains("'NoiseType', 'single-sided'"));
    // A statement goes over lines by three points, and ends in a semicolon.
    let mut open = false;
    for line in file.lines() {
        let code = line.split('%').next().unwrap_or_default().trim_end();
        if !code.is_empty() {
            assert!(code.ends_with("...") || code.ends_with(';'), "{line}");
            open = code.ends_with("...");
        }
    }
    assert!(!open, "the last statement ends");
}

#[test]
fn tables_hold_the_allan_deviation() {
    let input = three();
    let laws: Vec<_> = input
        .model
        .axes
        .iter()
        .map(|axis| axis.law(2000.0))
        .collect();
    let text = text(&input, Format::Csv);
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(2)
        .map(|line| {
            line.split(',')
                .map(|cell| cell.parse().expect("a number"))
                .collect()
        })
        .collect();
    assert_eq!(text.lines().nth(1), Some("tau_s,X,Y,Z"));
    for row in &rows {
        let m = (row[0] * 2000.0).round() as u64;
        for (law, value) in laws.iter().zip(&row[1..]) {
            assert_eq!(*value, law.allan_variance(m).sqrt());
        }
    }
    let bytes = export(&input, Format::Npy).expect("an array");
    let data = &bytes[bytes.len() - 8 * 4 * rows.len()..];
    let numbers = data
        .chunks_exact(8)
        .map(|b| f64::from_le_bytes(b.try_into().expect("eight")));
    assert!(numbers.eq(rows.into_iter().flatten()));
    assert!(bytes.starts_with(b"\x93NUMPY"));
}

#[test]
fn an_analysis_is_a_model_too() {
    let mut model = Model::published(None);
    model.rate_hz = 100.0;
    let mut simulation = Simulation::new(&model, 20_000, 1).expect("a model");
    let analysis = analyse(&mut simulation, &AnalysisOptions::default(), |_| {}).expect("read");
    let file = tempfile::NamedTempFile::new().expect("a file");
    report::json::write(&analysis, &mut file.as_file()).expect("written");
    let input = Input::open(&file.path().to_string_lossy()).expect("an analysis");
    assert_eq!(input.model.rate_hz, 100.0);
    assert_eq!(input.longest_s, 100.0);
    for (axis, truth) in input.model.axes.iter().zip(&model.axes) {
        assert_eq!(axis.name, truth.name);
        // The largest coefficient here; known to some percent from 20 000 samples.
        let ratio = axis.coefficients.q / truth.coefficients.q;
        assert!((ratio - 1.0).abs() < 0.05, "{}: {ratio}", axis.name);
    }
    // What is not resolved from zero has a bound, and nothing else has.
    let mut bounded = 0;
    for (axis, bounds) in input.model.axes.iter().zip(&input.bounds) {
        for one in Coefficient::ALL {
            let absent = *axis.coefficients.get(one) == 0.0;
            assert_eq!(bounds.get(one).is_some(), absent, "{} {one:?}", axis.name);
            bounded += u32::from(absent);
        }
    }
    assert!(bounded > 0, "200 s do not show every ramp");
}

/// A diagnosis gives a value to what it could not tell from zero, and its export wrote it.
#[test]
fn what_a_diagnosis_could_not_tell_from_zero_is_left_out() {
    let path = "../tests/golden/diagnosis.json";
    let told = std::fs::read_to_string(path).expect("a diagnosis");
    let told: Value = serde_json::from_str(&told).expect("JSON");
    let input = Input::open(path).expect("a diagnosis");
    let (mut left_out, mut kept) = (0, 0);
    for (place, axis) in input.model.axes.iter().enumerate() {
        let last = &told["axes"][place]["final"];
        for one in Coefficient::ALL {
            let (coefficient, bound) = (*axis.coefficients.get(one), *input.bounds[place].get(one));
            let said = &last["coefficients"][one.symbol()];
            if said["identified"] == true {
                assert_eq!(said["value"].as_f64(), Some(coefficient), "{one:?}");
                assert_eq!(bound, None, "{one:?}");
                kept += 1;
            } else {
                assert_eq!(coefficient, 0.0, "{one:?}");
                assert_eq!(bound, said["upper"].as_f64(), "{one:?}");
                let fitted = last["model"]["coefficients"][one.symbol()].as_f64();
                left_out += u32::from(fitted != Some(0.0));
            }
        }
        assert!(!axis.effects.is_empty(), "what was found stays");
    }
    assert!(left_out > 0 && kept > 0, "{left_out} left out, {kept} kept");
    // K would be a random walk among the states.
    let states = text(&input, Format::StateSpace);
    assert!(!states.contains("walk"), "{states}");
}
