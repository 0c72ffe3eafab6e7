//! Does simulated data follow the law of its model?
//!
//! The law comes from the formulas, the data from generators and filters: neither knows the other.

use inm_allan::Statistic;
use inm_host::internals::bins::strided::Strided;
use inm_host::internals::model::law::Law;
use inm_host::internals::model::whole::Model;
use inm_host::internals::simulate::capture::write_capture;
use inm_host::internals::simulate::source::Simulation;
use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::source::{Chunk, Source, Values};
use inm_host::internals::spectrum::{Cascade, Estimate, Plan, Settings};
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

const RATE_HZ: f64 = 2000.0;
const SEED: u64 = 20;

/// Records for the Allan variance, and samples of each.
const RECORDS: u64 = 24;
const LENGTH: u64 = 1 << 16;

/// Samples of the record for the spectrum.
const LONG: u64 = 1 << 21;

/// Models of one axis, of all terms and of every way through the chain.
fn models() -> Vec<(&'static str, Model)> {
    // Levels at which each of them shows somewhere between one sample and the whole record.
    let five = r#""coefficients": { "R": 2e-6, "K": 2e-4, "B": 1e-3, "N": 1e-4, "Q": 3e-8 }"#;
    let markov = r#""coefficients": { "N": 1e-4 }, "effects": [
        { "effect": "markov", "parameters": { "amplitude": 2e-3, "time_s": 0.004 } },
        { "effect": "markov", "parameters": { "amplitude": 3e-3, "time_s": 0.5 } } ]"#;
    let sinusoid = r#""coefficients": { "N": 1e-4 }, "effects": [
        { "effect": "sinusoid", "parameters": { "f_hz": 237.0, "amplitude": 4e-3 } } ]"#;
    let model = |chain: &str, rest: &str| {
        let chain = match chain {
            "" => String::new(),
            chain => format!(r#""chain": "{chain}","#),
        };
        let text = format!(
            r#"{{ "schema": 1, "rate_hz": {RATE_HZ}, "axes": [ {{ "name": "X", {chain} {rest} }} ] }}"#
        );
        Model::from_json(&text).expect("a model")
    };
    vec![
        ("five terms", model("", five)),
        (
            "five terms, converter and pole",
            model("ads1281:linear+400hz", five),
        ),
        (
            "five terms, minimum phase",
            model("ads1281:minimum+1507hz", five),
        ),
        ("five terms, poles alone", model("400hz+30hz", five)),
        ("Markov", model("", markov)),
        (
            "Markov, converter and pole",
            model("ads1281:linear+400hz", markov),
        ),
        (
            "sinusoid, converter and pole",
            model("ads1281:linear+400hz", sinusoid),
        ),
    ]
}

fn law(model: &Model) -> Law {
    model.axes[0].law(model.rate_hz)
}

#[test]
fn allan_variance_follows_the_law() {
    for (name, model) in models() {
        let law = law(&model);
        let mut found: Vec<(u64, Vec<f64>)> = Vec::new();
        for seed in SEED..SEED + RECORDS {
            let mut simulation = Simulation::new(&model, LENGTH, seed).expect("a model");
            let mut bins = Strided::default();
            bins.push_floats(&simulation.next_columns(LENGTH as usize)[0]);
            for estimate in bins.estimates(Statistic::Allan) {
                match found.iter_mut().find(|(m, _)| *m == estimate.m) {
                    Some((_, values)) => values.push(estimate.variance),
                    None => found.push((estimate.m, vec![estimate.variance])),
                }
            }
        }
        // A few differences a record make the scatter of their mean trustworthy.
        let tried: Vec<_> = found
            .into_iter()
            .filter(|(m, _)| m.is_power_of_two() && 16 * m <= LENGTH)
            .collect();
        assert!(tried.len() >= 12, "{name}: {} averaging times", tried.len());
        for (m, values) in tried {
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let scatter = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
            // A line has no scatter; what its phase does over a whole record is below 1e-3.
            let sigma = (scatter / count).sqrt().max(1e-3 * mean);
            let z = (mean - law.allan_variance(m)) / sigma;
            // Student's t of 23 degrees of freedom: 5 is passed once in 20 000.
            assert!(
                z.abs() < 5.0,
                "{name}, m = {m}, seeds from {SEED}: {mean:e} for {:e}, {z} sigma",
                law.allan_variance(m)
            );
        }
    }
}

#[test]
fn spectrum_follows_the_law() {
    for (name, model) in models() {
        if name.starts_with("sinusoid") {
            continue;
        }
        let [mean, square] = deviations(&model, LONG, SEED);
        // Neighbours overlap: their z correlate, which widens the mean by less than 1.5. The
        // square is chi^2 over its degrees of freedom.
        assert!(
            mean.abs() < 1.5 * 4.0,
            "{name}, seed {SEED}: mean z {mean} deviations of it"
        );
        // At least 100 bins.
        assert!(
            (square - 1.0).abs() < 1.5 * 4.0 * (2.0_f64 / 100.0).sqrt(),
            "{name}, seed {SEED}: mean square z {square}"
        );
    }
}

#[test]
fn correlation_is_that_of_the_model_term_by_term() {
    for coefficients in [
        r#"{ "N": 1e-4 }"#,
        r#"{ "Q": 1e-7 }"#,
        r#"{ "B": 1e-3 }"#,
        r#"{ "K": 1e-3 }"#,
    ] {
        let axis = |name: &str| {
            format!(r#"{{ "name": "{name}", "chain": "400hz", "coefficients": {coefficients} }}"#)
        };
        let text = format!(
            r#"{{ "schema": 1, "rate_hz": {RATE_HZ}, "axes": [ {}, {}, {} ],
                 "correlation": [[1, 0.3, -0.5], [0.3, 1, 0.2], [-0.5, 0.2, 1]] }}"#,
            axis("X"),
            axis("Y"),
            axis("Z")
        );
        let model = Model::from_json(&text).expect("a model");
        let mut simulation = Simulation::new(&model, LONG / 8, SEED).expect("a model");
        let columns = simulation.next_columns(LONG as usize);
        // Differences are short of memory, whatever the term, and independent at a distance.
        let steps: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| column.chunks_exact(16).map(|c| c[1] - c[0]).collect())
            .collect();
        for (i, j, expected) in [(0, 1, 0.3), (0, 2, -0.5), (1, 2, 0.2)] {
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let found = product(&steps[i], &steps[j])
                / (product(&steps[i], &steps[i]) * product(&steps[j], &steps[j])).sqrt();
            let sigma = (1.0 - expected * expected) / (steps[i].len() as f64).sqrt();
            assert!(
                (found - expected).abs() < 5.0 * sigma,
                "{coefficients}, axes {i} and {j}, seed {SEED}: {found} for {expected}"
            );
        }
    }
}

#[test]
fn data_do_not_depend_on_how_they_are_read() {
    let (_, model) = models().remove(1);
    let whole = Simulation::new(&model, 20_000, SEED)
        .expect("a model")
        .next_columns(20_000)
        .remove(0);
    let mut simulation = Simulation::new(&model, 20_000, SEED).expect("a model");
    let mut pieces = Vec::new();
    for size in (1..).map(|k| 37 * k) {
        let piece = simulation.next_columns(size).remove(0);
        if piece.is_empty() {
            break;
        }
        pieces.extend(piece);
    }
    assert!(whole == pieces);
}

#[test]
fn a_capture_holds_the_simulation_in_codes() {
    let mut model = Model::published(None);
    for axis in &mut model.axes[..2] {
        axis.chain = Some("ads1281:linear+400hz".parse().expect("a chain"));
    }
    // Beyond full scale, some 8.1 g.
    model.axes[2].mean = 200.0;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("simulated.inmcap");
    let length = 1000;
    let mut simulation = Simulation::new(&model, length, SEED).expect("a model");
    write_capture(&mut simulation, &path).expect("written");

    let mut expected = Simulation::new(&model, length, SEED).expect("a model");
    let mut source = CaptureSource::open(&path).expect("a capture");
    let signal = source.signal().clone();
    let chains: Vec<_> = signal.axes.iter().map(|axis| axis.chain.clone()).collect();
    let given: Vec<_> = model.axes.iter().map(|axis| axis.chain.clone()).collect();
    assert_eq!(chains, given);
    let mut read = 0;
    while let Some(chunk) = source.next_chunk().expect("readable") {
        let Chunk::Samples(block) = chunk else {
            continue;
        };
        read += block.len() as u64;
        let columns = expected.next_columns(block.len());
        for (axis, (found, wanted)) in block.columns.iter().zip(&columns).enumerate() {
            let Values::Codes(codes) = &found.values else {
                panic!("a capture holds codes");
            };
            if axis == 2 {
                assert_eq!(found.invalid, [0..block.len()], "clipped from end to end");
                continue;
            }
            let described = &signal.axes[axis];
            for (code, wanted) in codes.iter().zip(wanted) {
                let value = described.scale * (f64::from(*code) - described.zero);
                // Half a step of two counts, and the sign bit.
                assert!((value - wanted).abs() <= 2.0 * described.scale);
            }
        }
    }
    assert_eq!(read, length);
}

/// What a record holds once is as large as it was measured, however loud the noise is meanwhile.
#[test]
fn a_burst_leaves_what_happened_as_it_is() {
    for (seed, factor) in [(31, 3.0), (32, 0.2)] {
        let rms = |effects: &str| {
            let text = format!(
                r#"{{ "schema": 1, "rate_hz": 100, "axes": [ {{ "name": "X", "coefficients": {{ "N": 0.001 }},
                    "effects": [ {{ "effect": "motion", "parameters": {{ "time_s_1": 20, "duration_s_1": 20, "step_1": 0, "f_hz_1": 8,
                    "width_hz_1": 4, "amplitude_1": 1 }} }}{effects} ] }} ] }}"#
            );
            let model = Model::from_json(&text).expect("a model");
            let mut simulation = Simulation::new(&model, 6000, seed).expect("a model");
            let column = simulation.next_columns(6000).remove(0);
            let moved = &column[2200..3800];
            (moved.iter().map(|one| one * one).sum::<f64>() / moved.len() as f64).sqrt()
        };
        let burst = format!(
            r#", {{ "effect": "burst", "parameters": {{ "from_s": 10, "to_s": 50, "factor": {factor} }} }}"#
        );
        let (alone, with) = (rms(""), rms(&burst));
        // The noise is a hundredth of it.
        assert!(
            (with / alone - 1.0).abs() < 0.01,
            "seed {seed}: {alone}, {with}"
        );
    }
}

/// Effects that are Gaussian, each from anywhere in its range: rates, times and corners over decades, as what is right in the
/// middle of the band need not be at its ends.
#[test]
fn effects_follow_their_law_over_their_range() {
    const DRAWS: u64 = 12;
    for kind in ["markov", "resonance", "unnamed", "powerlaw", "rolloff"] {
        for seed in 0..DRAWS {
            let mut random = Pcg64::new(u128::from(seed), 41);
            let mut between = |low: f64, high: f64| {
                let share: f64 = StandardUniform.sample(&mut random);
                low * (high / low).powf(share)
            };
            let rate_hz = between(0.1, 4000.0);
            let parameters = match kind {
                "markov" => {
                    let time_s = between(0.3, 3000.0) / rate_hz;
                    format!(r#""amplitude": 1.0, "time_s": {time_s}"#)
                }
                "rolloff" => format!(r#""corner_hz": {}"#, between(1e-4, 4.0) * rate_hz),
                "powerlaw" => {
                    let exponent = between(0.3, 1.9);
                    format!(
                        r#""exponent": {exponent}, "density_1hz": {}"#,
                        1.0 / rate_hz
                    )
                }
                _ => {
                    let f_hz = between(3e-4, 0.49) * rate_hz;
                    let width_hz = between(0.02, 2.0) * f_hz;
                    format!(r#""f_hz": {f_hz}, "width_hz": {width_hz}, "amplitude": 1.0"#)
                }
            };
            // White noise, without which there would be nothing for a roll-off.
            let white = 1e-2 / rate_hz.sqrt();
            let text = format!(
                r#"{{ "schema": 1, "rate_hz": {rate_hz}, "axes": [ {{ "name": "X", "coefficients": {{ "N": {white} }},
                    "effects": [ {{ "effect": "{kind}", "parameters": {{ {parameters} }} }} ] }} ] }}"#
            );
            let model = Model::from_json(&text).expect("a model");
            let [mean, square] = deviations(&model, 1 << 17, seed);
            let what = format!("{kind}, seed {seed}, {rate_hz}/s, {parameters}");
            // Neighbours overlap, as below; bins of thirty degrees of freedom are a little lopsided.
            assert!(
                mean.abs() < 1.5 * 4.0,
                "{what}: mean z {mean} deviations of it"
            );
            assert!(square < 1.8, "{what}: mean square z {square}");
        }
    }
}

/// How far the bins of a simulated record are off the model's law, in deviations: their mean, in those of the mean, and their
/// mean square.
fn deviations(model: &Model, length: u64, seed: u64) -> [f64; 2] {
    let law = law(model);
    let mut simulation = Simulation::new(model, length, seed).expect("a model");
    let mut cascade = Cascade::new(&Plan::new());
    let mut first = 0;
    while first < length {
        let column = simulation.next_columns(1 << 16).remove(0);
        cascade.push_values(first, &column).expect("in order");
        first += column.len() as u64;
    }
    let estimate = Estimate::new(&cascade, model.rate_hz, &Settings::default());
    let expected = estimate.expected(|f_hz| law.density(f_hz));
    let bins = estimate.bins.iter().zip(&expected);
    let z: Vec<f64> = bins
        // Bins of many degrees of freedom are nearly Gaussian. In the stop band there is
        // nothing but what leaks there.
        .filter(|(bin, _)| bin.edf > 30.0 && bin.f_hz < 0.45 * model.rate_hz)
        .map(|(bin, expected)| (bin.psd / expected - 1.0) * (0.5 * bin.edf).sqrt())
        .collect();
    let count = z.len() as f64;
    assert!(count > 100.0, "{count} bins");
    [
        z.iter().sum::<f64>() / count.sqrt(),
        z.iter().map(|z| z * z).sum::<f64>() / count,
    ]
}
