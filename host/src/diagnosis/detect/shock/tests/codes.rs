//! What goes to and fro between two codes, and single samples that come together: no shocks.

use super::*;
use crate::diagnosis::detect::shock::alone::come_together;
use crate::diagnosis::detect::shock::leaves_two_codes;
use crate::diagnosis::detect::shock::scan::Scan;
use crate::model::kind::Kind;
use crate::model::random::{Gaussian, Seed, random};
use crate::model::{burst, motion};
use rand_distr::{Distribution, Uniform};

/// Noise that spans a fifth of a step, on a level that climbs from the middle of one to the border of the next; what it is
/// worth between them.
fn to_and_fro(seed: u64, height: f64) -> Vec<f64> {
    let values = noise(seed);
    let length = values.len() as f64;
    let level = |n: usize| 0.5 * n as f64 / length;
    let rounded = values.iter().enumerate().map(|(n, value)| {
        let blow = if (9000..9400).contains(&n) {
            height * (PI * (n - 9000) as f64 / 400.0).sin()
        } else {
            0.0
        };
        (0.18 * value + level(n) + blow).round()
    });
    rounded.collect()
}

#[test]
fn what_goes_to_and_fro_between_two_codes_is_no_event() {
    for seed in 170..173 {
        let leaves = |height: f64| {
            let values = to_and_fro(seed, height);
            let scan = Scan::new(&values, &values).expect("long enough");
            leaves_two_codes(&scan, &(9000..9400), 1.0)
        };
        assert!(!leaves(0.0), "seed {seed}");
        assert!(leaves(4.0), "seed {seed}: four steps for four seconds");
        let trial = Trial::new(to_and_fro(seed, 4.0));
        let found = trial.ask(&DETECTOR);
        assert!(!found.is_empty(), "seed {seed}: what leaves them is seen");
    }
}

/// Noise with four samples in a thousand far off, each by chance.
fn with_singles(seed: u64, mut values: Vec<f64>, size: f64) -> Vec<f64> {
    let mut draw = random(Seed { seed, stream: 11 });
    let chance = Uniform::new(0.0, 1.0).expect("a range");
    let mut normal = Gaussian::new(Seed { seed, stream: 12 }, size);
    for value in &mut values {
        if chance.sample(&mut draw) < 0.004 {
            *value += normal.draw();
        }
    }
    values
}

#[test]
fn how_many_single_samples_come_together_by_chance_the_rest_of_the_record_says() {
    for seed in 190..193 {
        // Two of five within 400 samples that stand next to one another.
        let is_chance = |values: Vec<f64>| {
            let scan = Scan::new(&values, &values).expect("long enough");
            come_together(&scan, 1, 5, 400)
        };
        assert!(
            is_chance(with_singles(seed, noise(seed), 300.0)),
            "seed {seed}"
        );
        assert!(!is_chance(noise(seed)), "seed {seed}: no others");
        let trial = Trial::new(with_singles(seed, noise(seed), 300.0));
        let found = trial::kinds(&trial.ask(&DETECTOR));
        let is_event = |kind: &Kind| [burst::KIND, motion::KIND].contains(kind);
        assert!(!found.iter().any(is_event), "seed {seed}: {found:?}");
    }
}

#[test]
fn a_bump_whose_ends_show_in_short_windows_is_one_shock() {
    for seed in 179..183 {
        let mut values = noise(seed);
        add(&mut values, &[bump(90.0, 20.0, 2.2)]);
        let found = told(values);
        assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
        assert!(
            (found[0].duration_s / 2.2).ln().abs() < 0.1,
            "seed {seed}: {found:?}"
        );
    }
}
