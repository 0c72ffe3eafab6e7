//! Stamps as drivers and loggers make them, with and without losses.

use rand_distr::{Distribution, Exp1, StandardNormal, StandardUniform};
use rand_pcg::Pcg64Mcg;

use super::*;

/// Indices of the samples that are left of `rows` where `lost` (first index, number) are not.
fn left(rows: usize, lost: &[(usize, usize)]) -> Vec<f64> {
    (0..rows)
        .filter(|&index| {
            !lost
                .iter()
                .any(|&(from, count)| (from..from + count).contains(&index))
        })
        .map(|index| index as f64)
        .collect()
}

/// The losses as first index and number.
fn lost(grid: &Grid) -> Vec<(usize, usize)> {
    let mut before = 0;
    grid.losses
        .iter()
        .map(|loss| {
            let from = loss.row + before;
            before += loss.samples as usize;
            (from, loss.samples as usize)
        })
        .collect()
}

fn uniform(random: &mut Pcg64Mcg) -> f64 {
    StandardUniform.sample(random)
}

#[test]
fn regular_stamps_with_losses_far_apart_and_close_together() {
    let missing = [(100, 1), (110, 2), (5000, 700), (5710, 1), (19_998, 1)];
    let times: Vec<f64> = left(20_000, &missing)
        .iter()
        .map(|i| 0.01 * i + 7.0)
        .collect();
    let grid = fit(&times).expect("a grid");
    assert!((grid.period / 0.01 - 1.0).abs() < 1e-12, "{}", grid.period);
    assert_eq!(lost(&grid), missing);
}

#[test]
fn jitter_makes_no_gap_and_hides_none() {
    let mut random = Pcg64Mcg::new(1);
    let missing = [(3000, 1), (7000, 25)];
    for spread in [0.1, 0.3, 0.8] {
        let times: Vec<f64> = left(10_000, &missing)
            .iter()
            .map(|i| 0.005 * (i + spread * uniform(&mut random)))
            .collect();
        let grid = fit(&times).expect("a grid");
        // Five deviations of the slope of a line through uniform errors.
        let allowed = 5.0 * spread / (9975_f64.powi(3)).sqrt();
        assert!((grid.period / 0.005 - 1.0).abs() < allowed, "{grid:?}");
        assert_eq!(lost(&grid), missing, "{spread}");
    }
}

#[test]
fn delays_of_a_busy_computer_make_no_gap() {
    let mut random = Pcg64Mcg::new(2);
    for seed in 0..20 {
        let missing = [(4321 + seed, 3)];
        let mut last: f64 = 0.0;
        let times: Vec<f64> = left(20_000, &missing)
            .iter()
            .map(|i| {
                let delay: f64 = Exp1.sample(&mut random);
                let stall = if (*i as usize) % 1700 < 2 { 40.0 } else { 0.0 };
                // What arrived is handed on in order.
                last = last.max(i + 0.3 * delay + stall);
                1e-3 * last
            })
            .collect();
        let grid = fit(&times).expect("a grid");
        assert!((grid.period / 1e-3 - 1.0).abs() < 1e-4, "{}", grid.period);
        assert_eq!(grid.losses.len(), 1, "{:?}", grid.losses);
        assert_eq!(grid.losses[0].samples, 3);
        assert!(grid.losses[0].row.abs_diff(4321 + seed) <= 4, "{grid:?}");
    }
}

#[test]
fn a_fifo_read_in_bursts_has_the_rate_of_its_sensor() {
    // Stamped when it is read, or counted on by a thousandth within a burst.
    for within in [0.0, 0.01] {
        for burst in [5_usize, 10, 32, 100] {
            let missing = [(12_000, 2 * burst)];
            let times: Vec<f64> = left(24_000, &missing)
                .iter()
                .map(|i| {
                    let index = *i as usize;
                    0.01 * ((index / burst * burst + burst) as f64
                        + within * (index % burst) as f64)
                })
                .collect();
            let grid = fit(&times).expect("a grid");
            assert!((grid.period / 0.01 - 1.0).abs() < 1e-4, "{}", grid.period);
            let expected: Vec<_> = missing
                .iter()
                .map(|&(from, count)| (from / burst * burst, count))
                .collect();
            assert_eq!(lost(&grid), expected, "{burst} {within}");
        }
    }
}

#[test]
fn a_sample_lost_within_a_burst_is_missed_at_the_burst() {
    let times: Vec<f64> = left(4000, &[(2005, 1)])
        .iter()
        .map(|i| 0.01 * (i / 10.0).floor() * 10.0)
        .collect();
    let grid = fit(&times).expect("a grid");
    assert_eq!(grid.losses.len(), 1, "{grid:?}");
    assert_eq!(grid.losses[0].samples, 1);
    assert!(grid.losses[0].row.abs_diff(2005) <= 10, "{grid:?}");
}

#[test]
fn milliseconds_at_about_a_thousand_a_second() {
    // Rounded down, the stamps of 999.7/s skip a millisecond every three thousand rows.
    for missing in [vec![], vec![(40_000, 100)]] {
        let times: Vec<f64> = left(100_000, &missing)
            .iter()
            .map(|i| (1.0003 * i).floor())
            .collect();
        let grid = fit(&times).expect("a grid");
        assert_eq!(lost(&grid), missing);
        // Rounding all up at one end and down at the other tilts a line by less.
        let allowed = 1.5 / times.len() as f64;
        assert!((grid.period / 1.0003 - 1.0).abs() < allowed, "{grid:?}");
    }
}

#[test]
fn a_clock_that_wanders_loses_nothing() {
    let mut random = Pcg64Mcg::new(3);
    let mut phase = 0.0;
    let times: Vec<f64> = left(100_000, &[(50_000, 2)])
        .iter()
        .map(|i| {
            // A part in a thousand, to and fro within the record.
            phase += 1e-3 * (i * 6e-5).sin();
            let noise: f64 = StandardNormal.sample(&mut random);
            0.01 * (i + phase + 0.02 * noise)
        })
        .collect();
    assert_eq!(lost(&fit(&times).expect("a grid")), [(50_000, 2)]);
}

#[test]
fn what_is_no_grid_is_refused() {
    assert_eq!(fit(&[]), Err(NoGrid::TooFew));
    assert_eq!(fit(&[1.0]), Err(NoGrid::TooFew));
    assert_eq!(fit(&[1.0, 1.0, 1.0]), Err(NoGrid::StandStill));
    let mut twice: Vec<f64> = (0..1000).map(|i| 0.01 * f64::from(i)).collect();
    twice.insert(500, twice[500]);
    let Err(NoGrid::Crowded(row)) = fit(&twice) else {
        panic!("a row stands there twice");
    };
    assert_eq!(row, 501);
}

#[test]
fn every_hundredth_sample_lost_is_no_slower_rate() {
    for step in [0.01, 0.005, 1.0 / 128.0] {
        let kept = (0..20_000).filter(|index| index % 100 != 50);
        let times: Vec<f64> = kept.map(|index| step * f64::from(index)).collect();
        let grid = fit(&times).expect("a grid");
        assert!((grid.period / step - 1.0).abs() < 1e-9, "{}", grid.period);
        assert_eq!(grid.losses.len(), 200);
    }
}

#[test]
fn thousandths_of_a_second_at_a_little_above_a_thousand_a_second() {
    let times = (0..20_000).map(|index| (0.9993 * f64::from(index)).floor() / 1000.0);
    let grid = fit(&times.collect::<Vec<_>>()).expect("a grid");
    assert_eq!(grid.losses, []);
    assert!(
        (grid.period / 0.000_999_3 - 1.0).abs() < 1.5 / 20_000.0,
        "{grid:?}"
    );
}
