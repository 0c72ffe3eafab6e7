//! Each way of holding data out: what is there gains, and what is not there gains nothing. That of
//! stretches is tested with their detector.

use super::laws::Ordinates;
use super::size::Sizes;
use super::*;
use crate::diagnosis::detect::trial::jump;
use crate::diagnosis::explanation::{Change, Snapshot};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::matched_filter::{Impulse, Transformer, held_out_gain};
use crate::diagnosis::trial::{
    NOTHING, RATE_HZ, axis, excluded, law, line, long, made_up, numbers, ringing, short, take_in,
};
use crate::model::PerCoefficient;
use crate::model::axis::ModelAxis;
use crate::model::shock::{self, Shock};
use crate::model::{burst, markov, resonance, sinusoid, steps};
use crate::signal::Unit;

fn plain(seed: u64) -> AxisState {
    axis(seed, short(seed), |_, noise| noise)
}

/// What a line at 50 Hz gains, taken out with an `amplitude`, in a record that has one of 0.3.
fn nats_of_line(seed: u64, amplitude: f64, freedom: f64) -> f64 {
    let mut axis = axis(seed, short(seed), |n, noise| {
        let turn = std::f64::consts::TAU * 50.0 * n as f64 / RATE_HZ;
        noise + 0.3 * turn.cos()
    });
    let mut one = made_up(sinusoid::KIND, line(50.0, amplitude).into());
    one.freedom = freedom;
    axis.accept(one).expect("a fit");
    let halves = Halves::new(&axis).expect("halves");
    halves.nats(&axis.explanations()[0]).expect("a fit")
}

#[test]
fn a_line_gains_what_it_is_worth_and_pays_for_its_numbers() {
    let there = nats_of_line(1, 0.3, 3.0);
    assert!(there > 10.0, "seed 1: {there}");
    let paid = there - nats_of_line(1, 0.3, 7.0);
    assert!((paid - 4.0 * SEEN_COST).abs() < 1e-9, "seed 1: {paid}");
    // Three times as much leaves a line of twice its size.
    let worse = nats_of_line(1, 0.9, 3.0);
    assert!(worse < -10.0, "seed 1: {worse}");
}

#[test]
fn a_line_gains_in_a_wide_band_that_is_excluded() {
    let mut axis = axis(3, short(3), |n, noise| {
        let turn = std::f64::consts::TAU * 50.0 * n as f64 / RATE_HZ;
        noise + 0.3 * turn.cos()
    });
    axis.exclude(excluded(15.0, 190.0));
    axis.exclude(excluded(300.0, 320.0));
    let mut one = made_up(sinusoid::KIND, line(50.0, 0.3).into());
    one.effect = Estimate::new(sinusoid::KIND, [50.0, 0.3].map(Value::exact));
    axis.accept(one).expect("a fit");
    let line = &axis.explanations()[0];
    let nats = |halves: Option<Halves>| halves.expect("halves").nats(line).expect("a fit");
    let there = nats(Halves::of_hidden(&axis, line));
    assert!(there > 10.0, "seed 3: {there}");
    // Some of it leaks into the other bins.
    let elsewhere = nats(Halves::new(&axis));
    assert!(elsewhere < 0.1 * there, "seed 3: {elsewhere} of {there}");
    // What is as narrow as a tone that wanders is of the line, and elsewhere none is hidden.
    for band in [excluded(40.0, 60.0), excluded(60.0, 200.0)] {
        axis.readmit_all();
        axis.exclude(band);
        let halves = Halves::of_hidden(&axis, &axis.explanations()[0]);
        assert!(halves.is_none(), "seed 3");
    }
}

#[test]
fn a_law_gains_what_it_is_worth_and_pays_for_its_shape() {
    let nats = |axis: &AxisState| Ordinates::new(axis).and_then(|ordinates| ordinates.nats(0));
    let mut rings = ringing(2, 100.0, 10.0);
    let mut axis = axis(2, long(2), |_, noise| noise + rings());
    let bell = law(resonance::KIND, &[100.0, 10.0, 1.0]);
    take_in(&mut axis, resonance::KIND, bell);
    let there = nats(&axis).expect("a fit");
    assert!(there > 100.0, "seed 2: {there}");
    let absent: Vec<f64> = (10..16)
        .map(|seed| {
            let mut axis = plain(seed);
            take_in(&mut axis, markov::KIND, law(markov::KIND, &[1.0, 0.01]));
            nats(&axis).expect("a fit")
        })
        .collect();
    // Half a nat for its time; the size is none in every other record, and gains less than half a nat by chance.
    let losing = absent.iter().filter(|nats| **nats <= 0.0).count();
    assert!(losing >= 4, "seeds 10 to 15: {absent:?}");
    let paying = |nats: &&f64| (**nats + SEEN_COST).abs() < 1e-3;
    assert!(absent.iter().any(|nats| paying(&nats)), "{absent:?}");
}

#[test]
fn a_waveform_is_judged_by_ordinates_that_it_was_not_fitted_to() {
    const LEN: usize = 4095;
    let (ring, density) = (Transformer::new(LEN), vec![RATE_HZ.recip(); LEN]);
    let wave = ring.waveform(&Impulse, RATE_HZ);
    let gain = |seed: u64, height: f64| {
        let mut noise = numbers(seed, 0);
        let mut values: Vec<f64> = (0..LEN).map(|_| noise.draw()).collect();
        values[0] += height;
        held_out_gain(&ring.transform(&values, RATE_HZ), &density, &wave)
    };
    // Ten deviations are worth 50 nats, half of them on half of the ordinates, with a deviation of
    // the root of twice as many.
    let there = gain(3, 10.0);
    assert!(
        (there - 25.0).abs() < 5.0 * 50_f64.sqrt(),
        "seed 3: {there}"
    );
    // Where nothing is the halves are independent: `e o - e^2 / 2` of two normal numbers has the mean -1/2 and the
    // variance 3/2. On ordinates that it was fitted to it would gain as much as it loses.
    let mean = (10..210).map(|seed| gain(seed, 0.0)).sum::<f64>() / 200.0;
    let five_sigma = 5.0 * (1.5_f64 / 200.0).sqrt();
    assert!((mean + 0.5).abs() < five_sigma, "{mean}, seeds 10 to 209");
}

#[test]
fn a_mask_changes_nothing_that_a_likelihood_sees() {
    let mut axis = plain(3);
    take_in(&mut axis, burst::KIND, Change::Mask(vec![100..200]));
    take_in(&mut axis, sinusoid::KIND, line(50.0, 0.1).into());
    let nothing = [0, 1].map(|place| axis.explanations()[place].is_beside_noise());
    assert_eq!(nothing, [true, false], "seed 3");
}

/// How much the only explanation of an axis changes white noise of deviation 1, percent.
fn change_percent(axis: &AxisState) -> Option<f64> {
    let noise = ModelAxis {
        name: "X".into(),
        unit: Unit::default(),
        mean: 0.0,
        chain: None,
        coefficients: PerCoefficient {
            n: RATE_HZ.sqrt().recip(),
            ..PerCoefficient::default()
        },
        effects: Vec::new(),
    };
    let last = Snapshot::of(axis.explanations());
    Sizes::new(axis, &noise, &last).change_percent(&axis.explanations()[0])
}

#[test]
fn a_burst_changes_the_power_of_the_whole_record() {
    let mut axis = plain(7);
    let mut one = made_up(burst::KIND, Change::Mask(vec![1000..3000]));
    one.effect = Estimate::new(burst::KIND, [1.0, 3.0, 4.0].map(Value::exact));
    axis.accept(one).expect("a fit");
    // Two seconds of sixteen times the power.
    let more = 2.0 * 15.0 * RATE_HZ / axis.residual.len() as f64;
    let expected = 100.0 * ((1.0 + more).sqrt() - 1.0);
    let change = change_percent(&axis).expect("a change");
    assert!(
        (change / expected - 1.0).abs() < 1e-9,
        "seed 7: {change} of {expected}"
    );
}

#[test]
fn what_no_model_of_noise_and_waveforms_holds_has_no_size() {
    let mut axis = plain(8);
    take_in(&mut axis, steps::KIND, NOTHING);
    assert_eq!(change_percent(&axis), None, "seed 8");
}

#[test]
fn a_step_changes_the_record_in_whichever_half_it_is() {
    let axis = plain(12);
    let len = axis.residual.len();
    // In blocks of either half, and at the ends of them.
    for index in [len / 2, len / 2 + 1, len / 3, 2 * len / 3, len / 5] {
        let mut axis = axis.clone();
        let jump = Wave::Steps(vec![jump(index, 50.0)]);
        take_in(&mut axis, steps::KIND, jump.into());
        let change = change_percent(&axis).expect("a change");
        // At the longest time of ten degrees of freedom, `m` of some thirty parts of the record: 50^2 / 90 beside 1 / m.
        assert!(change > 1e3, "seed 12, {index}: {change} %");
    }
}

#[test]
fn what_happened_changes_the_record_though_no_fit_looks_at_it() {
    let row = [5.0, 1e3, 0.1, 0.0, 0.0];
    let wave = Wave::Shocks {
        shocks: vec![Shock::of(&row)],
        rate_hz: RATE_HZ,
    };
    let mut axis = plain(9);
    let mut one = made_up(
        shock::KIND,
        Change::Happened {
            masked: vec![5000..5100],
            waves: vec![wave],
        },
    );
    one.effect = Estimate::new(shock::KIND, row.map(Value::exact));
    axis.accept(one).expect("a fit");
    // A bump of a thousand deviations in a hundred of some 20 000 samples.
    let change = change_percent(&axis).expect("a change");
    assert!(change > 1e3, "seed 9: {change} %");
}

#[test]
fn no_bin_of_an_excluded_band_is_held_out() {
    let mut axis = plain(11);
    let inside = |axis: &AxisState| {
        let halves = Halves::new(axis).expect("halves");
        let values = axis.residual.values();
        [(halves.train, 0), (halves.held, 1)].map(|(bins, parity)| {
            let data = bins.measure_parts(half(&values, parity));
            let bins = data.f_hz.iter().zip(&data.dof);
            let inside = bins.filter(|(f_hz, _)| (105.0..145.0).contains(*f_hz));
            inside.map(|(_, dof)| dof).sum::<f64>()
        })
    };
    let before = inside(&axis);
    axis.exclude(excluded(100.0, 150.0));
    let left = inside(&axis);
    let mut both = before.iter().zip(&left);
    assert!(
        both.all(|(before, left)| *left < 0.01 * before),
        "seed 11: {left:?} of {before:?}"
    );
}
