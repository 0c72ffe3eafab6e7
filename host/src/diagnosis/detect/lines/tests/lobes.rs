//! Running means: the spectrum falls in lobes, whose tops are no lines.

use super::*;
use crate::model::averaging;

/// Samples that a mean is over: lobes of a twentieth of the rate.
const SAMPLES: f64 = 20.9;

/// Frequency of a lobe's top, hertz.
const TOP_HZ: f64 = 6.5 * trial::RATE_HZ / SAMPLES;

/// Frequencies of the lines of differences of noise that are averaged, with a line of an amplitude at the top of a lobe.
fn found(seed: u64, amplitude: f64, is_known: bool) -> Vec<f64> {
    let white = noise(seed);
    let differences = white.windows(2).map(|pair| pair[1] - pair[0]);
    let mut values = trial::averaged(differences.collect(), SAMPLES);
    trial::add(&mut values, &trial::line(TOP_HZ, amplitude));
    let mut trial = Trial::new(values);
    if is_known {
        let law = Law {
            effect: averaging::KIND,
            values: vec![SAMPLES / trial::RATE_HZ],
        };
        trial.know(averaging::KIND, [law.values[0]], Change::Law(law));
    }
    let groups = lines(&trial.axis, 1e-3);
    let lines = groups.into_iter().map(|group| match group {
        Group::Single(one) => one.line.frequency_hz,
        Group::Hum { base_hz, .. } => base_hz,
        Group::Cluster { f_hz, .. } => f_hz,
    });
    lines.collect()
}

#[test]
fn tops_of_lobes_are_no_lines_once_the_mean_is_known() {
    let all = |is_known| (60..66).flat_map(move |seed| found(seed, 0.0, is_known));
    assert!(
        all(false).count() >= 3,
        "seeds 60 to 65: they pass for lines"
    );
    assert_eq!(all(true).collect::<Vec<_>>(), [0.0; 0], "seeds 60 to 65");
}

#[test]
fn a_line_at_the_top_of_a_lobe_is_one() {
    for seed in 70..73 {
        let lines = found(seed, 0.05, true);
        let is_it = |f_hz: &f64| (f_hz / TOP_HZ - 1.0).abs() < 1e-3;
        assert!(lines.iter().any(is_it), "seed {seed}: {lines:?}");
    }
}
