//! What stands out, and where.

use super::*;

fn stretch(samples: Range<usize>, z: f64) -> Stretch {
    Stretch {
        samples,
        z,
        frequency: 0.1,
        window: 16,
        longest: 28,
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
    assert_eq!(by_length, [stretch(0..40, 9.0)]);
}

/// Noise with every seventh sample missing, or one stretch of a hundred.
fn with_gaps(everywhere: bool) -> Vec<f64> {
    let mut values = crate::diagnosis::detect::trial::noise(1);
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
    let mut values = crate::diagnosis::detect::trial::noise(2);
    values[9000..9008].iter_mut().for_each(|one| *one += 1e6);
    let filled = values.clone();
    let mut scan = Scan::new(&values, &filled).expect("long enough");
    let found = scan.stretches(1e-4, 100.0);
    assert_eq!(found.len(), 1, "seed 2: {found:?}");
    // Windows of 16 samples that touch it.
    assert!(found[0].samples.len() <= 48, "seed 2: {found:?}");
}

/// Something that swells, lasts and fades is one stretch from where it begins to show to where it ends, though chance explains
/// its ends.
#[test]
fn what_stands_out_lasts_until_nothing_is_left() {
    let mut values = crate::diagnosis::detect::trial::noise(3);
    let scale = values.iter().map(|one| one * one).sum::<f64>() / values.len() as f64;
    for n in 8000..10_000 {
        let far = (n as f64 - 9000.0) / 300.0;
        let course = (-0.5 * far * far).exp() * (0.9 * n as f64).sin();
        values[n] += 30.0 * scale.sqrt() * course;
    }
    let filled = values.clone();
    let mut scan = Scan::new(&values, &filled).expect("long enough");
    let found = scan.stretches(1e-9, 100.0);
    assert_eq!(found.len(), 1, "seed 3: {found:?}");
    let high = 30.0 * (0.5_f64 * (800.0_f64 / 300.0).powi(2)).exp().recip();
    // At 800 samples from its middle it has nine tenths of a deviation: of windows of 16 samples one in 10 000 is as loud.
    assert!((0.5..1.0).contains(&high), "{high}");
    assert!(found[0].samples.len() > 1200, "seed 3: {found:?}");
}
