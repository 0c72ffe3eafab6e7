//! Expectations against exact sums over innovations.
//!
//! An estimate is a quadratic form of the samples, and a linear process is its innovations through
//! a filter. So its expectation is exactly the sum, over all places an innovation can have, of the
//! estimate of one unit innovation's response: no quadrature, no spectrum, no statistics.

use super::{
    binning::{Origin, Settings},
    cascade::Cascade,
    cosine::Run,
    estimate::{Bin, Estimate},
    expected::{Operator, Path, SegmentWindows, level_kernels},
    quadrature::Nodes,
    segments::LEN,
    window::Window,
};
use crate::numeric::peak::Peak;
use std::f64::consts::PI;

/// Response of the record `0..len` to a unit innovation at `at`.
type Response = fn(len: usize, at: i64) -> Vec<f64>;

fn impulse(len: usize, at: i64) -> Vec<f64> {
    (0..len as i64)
        .map(|n| f64::from(u8::from(n == at)))
        .collect()
}

fn step(len: usize, at: i64) -> Vec<f64> {
    (0..len as i64)
        .map(|n| f64::from(u8::from(n >= at)))
        .collect()
}

fn doublet(len: usize, at: i64) -> Vec<f64> {
    (0..len as i64)
        .map(|n| f64::from(u8::from(n == at)) - f64::from(u8::from(n == at + 1)))
        .collect()
}

/// Pole radius and angle of the resonance: half width half a bin of a segment.
const RADIUS: f64 = 1.0 - PI / LEN as f64;
const ANGLE: f64 = 2.0 * PI * 0.123_4;

fn resonance(len: usize, at: i64) -> Vec<f64> {
    (0..len as i64)
        .map(|n| {
            let age = n - at;
            if age < 0 {
                0.0
            } else {
                RADIUS.powi(age as i32) * (ANGLE * (age + 1) as f64).sin() / ANGLE.sin()
            }
        })
        .collect()
}

fn resonance_density(cycles: f64) -> f64 {
    let pole = |angle: f64| 1.0 - 2.0 * RADIUS * angle.cos() + RADIUS * RADIUS;
    1.0 / (pole(2.0 * PI * cycles - ANGLE) * pole(2.0 * PI * cycles + ANGLE))
}

fn sine_squared(cycles: f64) -> f64 {
    4.0 * (PI * cycles).sin().powi(2)
}

/// Density per cycle a sample, at a frequency in cycles a sample.
type Density = fn(f64) -> f64;

/// The processes: response to an innovation, density per cycle a sample.
const PROCESSES: [(&str, Response, Density); 3] = [
    ("white", impulse, |_| 1.0),
    ("walk", step, |cycles| 1.0 / sine_squared(cycles)),
    ("differenced white", doublet, sine_squared),
];

/// Mean power at bins `ks` of the segments of a level, summed over the innovations at `places`.
fn segments_exactly(
    level: usize,
    len: usize,
    ks: &[usize],
    places: impl Iterator<Item = i64>,
    response: Response,
) -> Vec<f64> {
    let plan = super::segments::Plan::new();
    let mut totals = vec![0.0; ks.len()];
    for at in places {
        let mut cascade = Cascade::new(&plan);
        cascade.push_values(0, &response(len, at)).unwrap();
        let power = cascade.levels()[level].power();
        let scale = 8.0_f64.powi(level as i32) / (power.segments as f64 * 0.5 * LEN as f64);
        for (total, &k) in totals.iter_mut().zip(ks) {
            *total += power.at(k) * scale;
        }
    }
    totals
}

fn segments_expected(level: usize, ks: &[usize], density: Density) -> Vec<f64> {
    segments_operator(level, ks).expected(density)
}

fn segments_operator(level: usize, ks: &[usize]) -> Operator {
    let path = Path::new(1.0, level);
    let bin = path.level_rate_hz() / LEN as f64;
    let nodes = Nodes::new(LEN / 2);
    let windows = SegmentWindows::new(&Window::new(LEN), &nodes.offsets);
    let ranges: Vec<_> = ks.iter().map(|&k| k..=k).collect();
    let centres: Vec<f64> = ks.iter().map(|&k| k as f64 * bin).collect();
    let (places, kernels) = level_kernels(&windows, &nodes, &path, &ranges);
    let mut operator = Operator::default();
    operator.add(&places, &kernels, &centres);
    operator.add_aliases(0, &centres, &path);
    operator
}

fn assert_close(what: &str, ks: &[usize], exact: &[f64], expected: &[f64]) {
    for ((k, exact), expected) in ks.iter().zip(exact).zip(expected) {
        let error = expected / exact - 1.0;
        assert!(error.abs() < 1e-4, "{what}, bin {k}: {error:e}");
    }
}

#[test]
fn segments_at_the_sample_rate() {
    let ks = [2, 6, 7, 12, 51, 128, 300, 509];
    for (name, response, density) in PROCESSES {
        let exact = segments_exactly(0, LEN, &ks, -1..LEN as i64, response);
        assert_close(name, &ks, &exact, &segments_expected(0, &ks, density));
    }
}

#[test]
fn segments_of_the_next_level() {
    // The first whole segment of level 1 starts at half its length, as the filters reach ahead.
    let len = 8 * (LEN + LEN / 2 + 30);
    let ks = [6, 51, 200, 409];
    for (name, response, density) in PROCESSES {
        let reaches: Vec<i64> = (-1..len as i64).step_by(3).collect();
        // Every third place, three times its weight: the sum over places is band-limited.
        let exact: Vec<f64> = segments_exactly(1, len, &ks, reaches.into_iter(), response)
            .into_iter()
            .map(|total| 3.0 * total)
            .collect();
        assert_close(name, &ks, &exact, &segments_expected(1, &ks, density));
    }
}

#[test]
fn segments_of_a_narrow_resonance() {
    let ks = [120, 124, 126, 127, 130, 200];
    // The response has fallen to e^-24 of its power after four thousand samples.
    let exact = segments_exactly(0, LEN, &ks, -4_000..LEN as i64, resonance);
    let expected = segments_expected(0, &ks, resonance_density);
    assert_close("resonance", &ks, &exact, &expected);
}

#[test]
fn flicker_agrees_with_a_fine_sum() {
    let window = Window::new(LEN);
    for k in [3_usize, 6, 20] {
        let expected = segments_expected(0, &[k], |cycles| 1.0 / cycles)[0];
        let line = |bins: f64| -> f64 {
            let step = 2.0 * PI * bins / LEN as f64;
            let centred = window.line().iter().zip(-(LEN as i64) / 2..);
            centred.map(|(w, n)| w * (step * n as f64).sin()).sum()
        };
        let mean_at = window.transform(k as f64) / window.sum();
        let slope_at = line(k as f64) / window.sum_of_line();
        let steps = 64;
        let fine: f64 = (0..steps * 200)
            .map(|i| {
                let place = (f64::from(i) + 0.5) / f64::from(steps);
                let mean = window.transform(place) * mean_at;
                let slope = line(place) * slope_at;
                let up = window.transform(place - k as f64) - mean - slope;
                let down = window.transform(place + k as f64) - mean + slope;
                (up * up + down * down) / place
            })
            .sum::<f64>()
            / (f64::from(steps) * window.sum_of_squares());
        assert!(
            (expected / fine - 1.0).abs() < 1e-4,
            "bin {k}: {expected} {fine}"
        );
    }
}

/// A peak of nearly no width is a cosine of any phase, whose segments hold what the mean of two with a quarter of a turn
/// between them do.
#[test]
fn a_peak_narrower_than_a_bin_is_seen_as_a_line() {
    let ks = [95, 98, 100, 101, 102, 105, 140];
    let operator = segments_operator(0, &ks);
    let plan = super::segments::Plan::new();
    for bins in [100.0, 100.03, 100.4, 100.5, 100.97] {
        let f_hz = bins / LEN as f64;
        let mut exact = vec![0.0; ks.len()];
        for phase in [0.0, 0.5 * PI] {
            let turn = |n: usize| 2.0 * PI * f_hz * n as f64 + phase;
            let values: Vec<f64> = (0..LEN).map(|n| turn(n).cos()).collect();
            let mut cascade = Cascade::new(&plan);
            cascade.push_values(0, &values).unwrap();
            let power = cascade.levels()[0].power();
            let scale = 0.5 / (power.segments as f64 * plan.window.sum_of_squares());
            for (total, &k) in exact.iter_mut().zip(&ks) {
                *total += scale * power.at(k);
            }
        }
        // Lorentzian, of a half of the cosine's power on either side of zero.
        let half_width_hz = 1e-6 / LEN as f64;
        let density = |f: f64| {
            let off = (f - f_hz) / half_width_hz;
            0.25 / (PI * half_width_hz * (1.0 + off * off))
        };
        let peak = Peak {
            f_hz,
            half_width_hz,
        };
        let mut densities: Vec<f64> = operator.nodes_hz().iter().map(|&f| density(f)).collect();
        operator.resolve(&mut densities, &peak, density);
        let most = exact.iter().copied().fold(0.0, f64::max);
        for ((k, exact), seen) in ks.iter().zip(exact).zip(operator.apply(&densities)) {
            // Six nodes follow the sides of the window, a hundredth of its middle, to a hundredth; a millionth of the
            // Lorentzian's power lies beyond a bin.
            let allowed = 1e-3 * exact + 1e-4 * most;
            let error = (seen - exact).abs();
            assert!(
                error < allowed,
                "{bins} bins, bin {k}: {seen}, exactly {exact}"
            );
        }
    }
}

/// Several are as one after the other, in a pass and a half.
#[test]
fn several_densities_at_once_are_as_each_by_itself() {
    let operator = segments_operator(0, &[95, 100, 140]);
    let nodes = operator.nodes_hz();
    let density = |power: i32| nodes.iter().map(|f| (1.0 + f).powi(power)).collect();
    let densities: Vec<Vec<f64>> = (-6..6).map(density).collect();
    let each: Vec<Vec<f64>> = densities.iter().map(|one| operator.apply(one)).collect();
    assert_eq!(operator.apply_all(&densities), each);
    assert!(operator.apply_all(&[]).is_empty());
}

#[test]
fn cosines_of_the_whole_record() {
    let len = 700;
    let highest = 0.3;
    let settings = Settings::default();
    for (name, response, density) in PROCESSES {
        let mut exact = vec![0.0; Run::new(&vec![0.0; len], highest).ordinates.len()];
        for at in -1..len as i64 {
            let run = Run::new(&response(len, at), highest);
            for (total, ordinate) in exact.iter_mut().zip(&run.ordinates) {
                *total += ordinate.power;
            }
        }
        // The bins of a record this short are single ordinates at first.
        let mut cascade = Cascade::default();
        cascade.push_values(0, &step(len, 10)).unwrap();
        let estimate = Estimate::new(&cascade, 1.0, &settings);
        let expected = estimate.expected(density);
        let run = Run::new(&vec![0.0; len], highest);
        for (number, (ordinate, exact)) in run.ordinates.iter().zip(exact).enumerate().take(8) {
            let Bin { f_hz, origin, .. } = estimate.bins[number];
            assert_eq!(origin, Origin::Record);
            assert!(
                (f_hz - run.cycles(ordinate)).abs() < 1e-12,
                "{number}: {f_hz}"
            );
            let error = expected[number] / exact - 1.0;
            assert!(error.abs() < 1e-4, "{name}, ordinate {number}: {error:e}");
        }
    }
}
