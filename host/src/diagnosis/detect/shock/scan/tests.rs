//! What stands out, and where.

use super::*;
use crate::diagnosis::detect::trial::noise;
use crate::diagnosis::statistic::tails::Rare;
use crate::diagnosis::trial::markov;

fn stretch(samples: Range<usize>, z: f64) -> Stretch {
    Stretch {
        samples,
        z,
        frequency: 0.1,
        window: 16,
        longest: 28,
        nats: 0.5 * z * z,
    }
}

#[test]
fn stretches_are_joined_with_the_plainest_of_them() {
    let all = vec![
        stretch(0..10, 7.0),
        stretch(30..40, 9.0),
        stretch(12..20, 8.0),
    ];
    let by_length = joined(all, |a, b| a.samples.len().max(b.samples.len()));
    let nats = 0.5 * (49.0 + 81.0 + 64.0);
    assert_eq!(
        by_length,
        [Stretch {
            nats,
            ..stretch(0..40, 9.0)
        }]
    );
    assert_eq!(by_length[0].together(), 194_f64.sqrt());
    // One whose windows were counted in part is as plain as the plainest of them.
    let part = Stretch {
        nats: 20.0,
        ..stretch(0..10, 7.0)
    };
    assert_eq!(part.together(), 7.0);
}

/// Noise with every seventh sample missing, or one stretch of a hundred.
fn with_gaps(everywhere: bool) -> Vec<f64> {
    let mut values = noise(1);
    if everywhere {
        values.iter_mut().step_by(7).for_each(|one| *one = f64::NAN);
    } else {
        values[5000..5100].fill(f64::NAN);
    }
    values
}

#[test]
fn gaps_are_looked_across_where_they_are_everywhere() {
    let runs = |everywhere| {
        let values = with_gaps(everywhere);
        let bridged = vec![0.5; values.len()];
        let bridged: Vec<f64> = (bridged.iter().enumerate())
            .map(|(n, one)| one * n as f64)
            .collect();
        let scan = Scan::new(&values, &bridged).expect("long enough");
        scan.runs().len()
    };
    assert_eq!(runs(true), 1);
    assert_eq!(runs(false), 2);
}

#[test]
fn a_knock_does_not_fill_the_windows_of_a_minute() {
    let mut values = noise(2);
    values[9000..9008].iter_mut().for_each(|one| *one += 1e6);
    let filled = values.clone();
    let mut scan = Scan::new(&values, &filled).expect("long enough");
    let found = scan.stretches(1e-4, 100.0);
    assert_eq!(found.len(), 1, "seed 2: {found:?}");
    // Windows of 16 samples that touch it.
    assert!(found[0].samples.len() <= 48, "seed 2: {found:?}");
}

#[test]
fn what_stands_out_lasts_until_nothing_is_left() {
    let windows = vec![
        stretch(0..8, 4.5),
        stretch(8..16, 9.0),
        stretch(16..24, 4.1),
        stretch(40..48, 5.9),
    ];
    let nats = 0.5 * (4.5_f64.powi(2) + 81.0 + 4.1_f64.powi(2));
    let lasts = Stretch {
        nats,
        ..stretch(0..24, 9.0)
    };
    assert_eq!(lasting(windows, 6.0), [lasts]);
}

#[test]
fn how_rare_a_height_is_shorter_windows_say_where_there_are_too_few() {
    for seed in 3..6 {
        let mut strength = markov(seed, 1000.0);
        let mut values = noise(seed);
        values
            .iter_mut()
            .for_each(|value| *value *= (0.3 * strength()).exp());
        let mut scan = Scan::new(&values, &values).expect("long enough");
        scan.stretches(1e-4, 100.0);
        let rare: Vec<Option<Rare>> = scan.usual.iter().map(Usual::rare).collect();
        let lengths: Vec<usize> = scan.usual.iter().map(|one| one.windows.len()).collect();
        assert_eq!(lengths, [16, 64, 256], "seed {seed}");
        // Of 40 000 samples at most a hundred places of the longest windows are apart: the highest 160 are looked at.
        assert!(
            rare[1].is_some() && rare[2] == rare[1],
            "seed {seed}: {rare:?}"
        );
    }
}
