//! What is judged no more, and what is again.

use super::*;
use crate::diagnosis::trial::long;

#[test]
fn where_noise_was_taken_out_with_a_course_nothing_is_judged() {
    let mut axis = noise();
    let drift = crate::model::drift::Drift {
        duration_s: axis.residual.len() as f64 / axis.rate_hz,
        levels: vec![0.0; 5],
    };
    let course = Wave::Drift {
        rate_hz: axis.rate_hz,
        absorbs_hz: 0.5,
        drift: Arc::new(drift),
    };
    take_in(&mut axis, crate::model::drift::KIND, course.into());
    assert_eq!(axis.excluded_hz(), [0.0..0.5], "seed {SEED}");
}

#[test]
fn what_goes_for_a_statement_is_back_in_the_record() {
    let mut axis = noise();
    take_in(&mut axis, outliers::KIND, spike(6000, 1.0).into());
    let mut grid = made_up(crate::model::rounding::KIND, NOTHING);
    grid.supersedes = vec![outliers::KIND];
    axis.accept(grid).expect("a fit");
    assert_eq!(
        axis.residual.values()[..],
        *axis.residual.measured(),
        "seed {SEED}"
    );
}

#[test]
fn a_converters_filter_remembers_a_cut_for_longer() {
    let chain: Chain = "ads1281:linear".parse().expect("a chain");
    let mut white = numbers(SEED, 0);
    let values: Arc<Vec<f64>> = Arc::new((0..1 << 14).map(|_| white.draw()).collect());
    // Far from the stretch for white noise, near for the filter.
    let away = STRETCH.end + 1000;
    for (chain, is_usable) in [(None, true), (Some(&chain), false)] {
        let axis = AxisState::new(Arc::clone(&values), 1000.0, chain);
        let mut axis = axis.expect("a spectrum");
        take_in(&mut axis, burst::KIND, Change::Mask(vec![STRETCH]));
        assert_eq!(axis.usable(away), is_usable, "seed {SEED}");
        assert!(axis.usable(STRETCH.end + 3000), "seed {SEED}");
    }
}

#[test]
fn what_lies_beyond_a_rail_is_drawn_there_and_counts() {
    let limit = 1.0;
    let mut white = numbers(SEED, 3);
    let truth: Vec<f64> = (0..(1 << 15) + 1).map(|_| white.draw()).collect();
    let measured: Vec<f64> = truth.iter().map(|value| value.min(limit)).collect();
    let at: Vec<usize> = (0..truth.len()).filter(|n| truth[*n] > limit).collect();
    let known = |side: Side| {
        let axis = AxisState::new(Arc::new(measured.clone()), 100.0, None);
        let mut axis = axis.expect("a spectrum");
        let replaced = Replaced::bridged(&axis.residual.values(), &at, side);
        let waves = Change::Waves(vec![Wave::Replaced(replaced)]);
        take_in(&mut axis, crate::model::clipping::KIND, waves);
        axis
    };
    let axis = known(Side::Above);
    let short = at.iter().filter(|n| axis.filled[**n] < limit);
    assert_eq!(short.count(), 0, "seed {SEED}: drawn below the rail");
    let inside = 2000..truth.len() - 2000;
    let counts = |axis: &AxisState| at.iter().all(|n| !inside.contains(n) || axis.usable(*n));
    assert!(counts(&axis), "seed {SEED}");
    let square = |values: &[f64]| values.iter().map(|one| one * one).sum::<f64>();
    let ratio = square(&axis.filled) / square(&truth);
    // A sixth of the squares are drawn, of deviation 2 each: five deviations.
    let sd = 2.0 * (0.16 / truth.len() as f64).sqrt();
    assert!((ratio - 1.0).abs() < 5.0 * sd, "seed {SEED}: {ratio}");
    // Samples of which nothing is known do not count, and may be anything.
    let axis = known(Side::Any);
    assert!(!counts(&axis), "seed {SEED}");
    assert!(at.iter().any(|n| axis.filled[*n] < limit), "seed {SEED}");
}

#[test]
fn bins_that_hold_what_leaks_out_of_an_excluded_band_say_nothing() {
    // A line next to a hundredth of the rate shows in bins that are measured at a lower rate.
    let line_hz = 0.0123 * RATE_HZ;
    let left_out = |amplitude: f64| {
        let mut axis = axis(SEED, long(SEED), |n, noise| {
            noise + amplitude * (std::f64::consts::TAU * line_hz / RATE_HZ * n as f64).cos()
        });
        axis.exclude(excluded(0.9 * line_hz, 1.1 * line_hz));
        axis.refresh().expect("a fit");
        let below = axis.data.f_hz.iter().zip(&axis.data.dof);
        let below = below.filter(|(f_hz, _)| **f_hz < 0.5 * line_hz);
        below.filter(|(_, dof)| **dof < 1e-3).count()
    };
    assert_eq!(left_out(1.0), 0, "seed {SEED}");
    assert!(left_out(1e5) > 0, "seed {SEED}");
}
