//! Which samples the filter sees, and in what noise.

use super::*;
use crate::diagnosis::record::wave::{Replaced, Side};

#[test]
fn what_was_drawn_beside_an_outlier_is_none() {
    for seed in 20..23 {
        let mut values = noise(seed);
        // A fifth is missing, one beside each outlier too.
        (3..values.len())
            .step_by(5)
            .for_each(|n| values[n] = f64::NAN);
        let places: Vec<usize> = (1..40).map(|n| 500 * n + 2).collect();
        for &place in &places {
            values[place] = 30.0;
        }
        assert!(
            places.iter().all(|place| values[place + 1].is_nan()),
            "seed {seed}"
        );
        assert_eq!(
            named_at(Trial::new(values).ask(&DETECTOR)),
            places,
            "seed {seed}"
        );
    }
}

#[test]
fn outliers_at_the_ends_stay_out_of_what_the_filter_sees() {
    // So far out that what the filter makes of them reaches over the ring's seam.
    for seed in 24..27 {
        let mut values = noise(seed);
        let end = values.len() - 700;
        let places = [700, 1000, 9000, 12_000, end];
        places.iter().for_each(|&place| values[place] += 3e4);
        let mut trial = Trial::new(values);
        // One look raises the noise that the next one sees.
        for _ in 0..3 {
            let Some(found) = trial::candidate(trial.ask(&DETECTOR)) else {
                break;
            };
            trial.accept(found);
        }
        let known = trial.axis.residual.outliers();
        let known: Vec<usize> = known.iter().map(|one| one.index).collect();
        assert_eq!(known, places, "seed {seed}");
    }
}

#[test]
fn an_outlier_beside_a_single_gap_is_seen() {
    for seed in 28..31 {
        let with = |size: f64| {
            let mut values = noise(seed);
            // The reader lost one, and the next is torn; another is lost by itself.
            values[9001] = f64::NAN;
            values[9000] += size;
            values[4000] = f64::NAN;
            named_at(Trial::new(values).ask(&DETECTOR))
        };
        assert_eq!(with(20.0), [9000], "seed {seed}");
        assert!(with(0.0).is_empty(), "seed {seed}");
    }
}

#[test]
fn where_the_noise_is_known_to_be_loud_an_outlier_is_further_out() {
    let (loud, quiet) = (8000, 12_000);
    // From 0.8 to 1.2 of its mean; the threshold is some 5.8 of that.
    let swing = Envelope {
        depth: 0.2,
        period: 8000.0,
        phase_rad: 0.0,
    };
    let mut values = noise(32);
    for (n, value) in values.iter_mut().enumerate() {
        *value *= swing.factor(n);
    }
    [loud, quiet].iter().for_each(|&place| values[place] = 6.5);
    let mut trial = Trial::new(values);
    assert_eq!(named_at(trial.ask(&DETECTOR)), [loud, quiet], "seed 32");
    let depth = [0.2, 80.0, 0.0];
    trial.know(crate::model::cyclic::KIND, depth, Change::Strength(swing));
    assert_eq!(named_at(trial.ask(&DETECTOR)), [quiet], "seed 32");
}

#[test]
fn what_was_drawn_in_the_place_of_others_is_no_outlier_and_nor_is_what_lies_beside_it() {
    for missing in [0, 3] {
        let mut values = noise(33);
        for (n, value) in values.iter_mut().enumerate() {
            if missing > 0 && n % missing == 1 {
                *value = f64::NAN;
            }
        }
        let mut trial = Trial::new(values);
        let at = [9000];
        let replaced = Replaced::bridged(&trial.axis.residual.values(), &at, Side::Above);
        let waves = Change::Waves(vec![Wave::Replaced(replaced)]);
        trial.know(crate::model::clipping::KIND, [1.0, 1.0], waves);
        let is_filtered = filtered(&trial.axis);
        assert!(trial.axis.usable(9000), "its power counts, seed 33");
        assert!(!is_filtered(9000) && !is_filtered(9002) && !is_filtered(8996));
        assert!(is_filtered(9012), "{missing}: far from it");
        assert_eq!(is_filtered(9010), missing == 0 || 9010 % missing != 1);
    }
}
