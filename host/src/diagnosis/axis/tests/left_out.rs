//! What is judged no more, and what is again.

use super::*;

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
