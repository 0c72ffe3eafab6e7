use super::*;
use crate::diagnosis::statistic::allan_curve;
use crate::model::unnamed::Band;

const RATE_HZ: f64 = 100.0;

fn stretch(f_hz: f64, width_hz: f64) -> Stretch {
    Stretch {
        time_s: 50.0,
        duration_s: 13.0,
        step: 0.0,
        mean: 0.0,
        fade_s: 0.0,
        band: Band {
            f_hz,
            width_hz,
            amplitude: 2.0,
        },
    }
}

fn made(stretches: Vec<Stretch>, seed: u64, count: usize) -> Vec<f64> {
    let mut samples = vec![0.0; count];
    let seed = Seed { seed, stream: 3 };
    let mut generator = Motion::new(stretches).course(RATE_HZ, seed);
    for block in samples.chunks_mut(97) {
        generator.add_to(block);
    }
    samples
}

#[test]
fn nothing_is_outside_of_a_stretch_but_its_step() {
    let moved = Stretch {
        step: -3.0,
        ..stretch(2.0, 0.5)
    };
    let samples = made(vec![moved], 1, 20_000);
    assert!(samples[..5000].iter().all(|one| *one == 0.0));
    assert!(samples[6300..].iter().all(|one| *one == -3.0));
    let inside: Vec<f64> = (0..1300)
        .map(|n| samples[5000 + n] + 3.0 * (n as f64 + 0.5) / 1300.0)
        .collect();
    let square = inside.iter().map(|one| one * one).sum::<f64>() / inside.len() as f64;
    // Ten correlation times: known to half of it.
    assert!((1.0..9.0).contains(&square), "{square}");
}

#[test]
fn a_turn_has_its_rate_while_it_lasts_and_leaves_a_step() {
    let turned = Stretch {
        step: -3.0,
        mean: 5.0,
        ..stretch(2.0, 0.5)
    };
    let samples = made(vec![turned], 2, 20_000);
    assert!(samples[..5000].iter().all(|one| *one == 0.0));
    assert!(samples[6300..].iter().all(|one| *one == -3.0));
    let mean = samples[5000..6300].iter().sum::<f64>() / 1300.0;
    // The noise of the stretch has none, and the step is there for half of it.
    assert!((mean - (5.0 - 1.5)).abs() < 1e-9, "{mean}");
}

/// Files from before rows had a level of their own, however many rows they have.
#[test]
fn rows_without_a_level_are_read() {
    use crate::model::effect::in_order;
    for rows in [1, 6, 7, 50, 301] {
        let all = KIND.parameters(&vec![0.0; rows * ROW]);
        let named = all.iter().filter(|one| !one.optional);
        let named = named.map(|one| (one.name.to_string(), 1.0)).collect();
        let values = in_order(&Entry, &named).expect("a motion");
        assert_eq!(values.len(), rows * ROW, "{rows} rows");
        let levels = values.chunks(ROW).map(|row| row[MEAN]);
        assert_eq!(levels.sum::<f64>(), 0.0, "{rows} rows");
    }
}

#[test]
fn a_motion_beyond_the_end_of_time_adds_nothing() {
    let motion = Motion::new(vec![Stretch::of(&[
        5e107, 0.5, -0.02, 3.0, 1.0, 0.05, 0.1, 0.2,
    ])]);
    let mut samples = vec![0.0; 1000];
    let seed = Seed { seed: 1, stream: 0 };
    motion.course(RATE_HZ, seed).add_to(&mut samples);
    assert!(samples.iter().all(|sample| *sample == 0.0));
}

/// The mean over records comes to what is expected, from the shortest averages to those longer than the stretch.
#[test]
fn records_have_the_allan_variance_that_is_expected() {
    const RECORDS: u64 = 400;
    const LENGTH: usize = 16_384;
    let fading = Stretch {
        fade_s: 6.5,
        ..stretch(0.4, 0.1)
    };
    let lasting = Stretch {
        fade_s: 2.0,
        ..stretch(0.0, 0.3)
    };
    let sharp = [stretch(0.0, 0.3), stretch(1.5, 0.4), stretch(20.0, 12.0)];
    for one in sharp.into_iter().chain([fading, lasting]) {
        let mut sums: std::collections::BTreeMap<u64, [f64; 2]> = Default::default();
        for seed in 0..RECORDS {
            for point in allan_curve::allan(&made(vec![one], seed, LENGTH), RATE_HZ) {
                let sum = sums.entry(point.m).or_default();
                sum[0] += point.variance;
                sum[1] += point.variance.powi(2);
            }
        }
        let count = RECORDS as f64;
        // Those that fit in 20 times: longer ones see the ends of the record.
        for (m, [sum, squares]) in sums.into_iter().filter(|(m, _)| *m <= LENGTH as u64 / 20) {
            let mean = sum / count;
            let sd = ((squares / count - mean * mean) / count).sqrt();
            let expected = Motion::new(vec![one]).in_record(m, LENGTH as u64, RATE_HZ);
            // Five standard errors of the mean, of some hundred comparisons; and where a band that turns a few times has the
            // energy that it is told to have, each of its frequencies has a part of that which is not quite its own.
            let shared = if one.band.width_hz < one.band.f_hz {
                0.01
            } else {
                1e-9
            };
            assert!(
                (mean - expected).abs() < 5.0 * sd + shared * expected,
                "{one:?} {m}: {mean} for {expected}, {sd}"
            );
        }
    }
}

/// What happened once had the energy that it had, however few times it turned.
#[test]
fn what_turns_has_the_energy_that_it_was_told_to_have() {
    for seed in 1..=10 {
        let fading = Stretch {
            fade_s: 3.0,
            ..stretch(0.3, 0.1)
        };
        let samples = made(vec![fading], seed, 20_000);
        let square = samples.iter().map(|one| one * one).sum::<f64>() / 1300.0;
        assert!((square - 4.0).abs() < 1e-9, "seed {seed}: {square}");
    }
}

/// What comes up and fades is as strong over all that while as what begins and ends at once.
#[test]
fn it_comes_up_and_fades_without_a_jump() {
    for seed in 1..=10 {
        let largest = |fade_s: f64| {
            let one = Stretch {
                fade_s,
                ..stretch(0.3, 0.1)
            };
            let samples = made(vec![one], seed, 20_000);
            let changes = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
            changes.fold(0.0, f64::max)
        };
        // At most 5 or so of an angular frequency of 1.9/s, in 0.01 s.
        assert!(largest(2.0) < 0.3, "seed {seed}: {}", largest(2.0));
    }
}
