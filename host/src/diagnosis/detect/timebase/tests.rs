//! Which lines of a record say something of its clock, and what is told of it.

use std::f64::consts::TAU;

use super::*;
use crate::diagnosis::detect::trial::{self, LEVEL, RATE_HZ, noise};
use crate::diagnosis::record::samples::AxisSamples;
use crate::model::random::{Gaussian, Seed};
use crate::signal::{Axis, Signal, Unit};

fn mark(f_hz: f64) -> Mark {
    Mark {
        f_hz,
        f_sd_hz: 1e-3,
        wanders: false,
    }
}

#[test]
fn what_several_axes_see_is_one_mark() {
    let axes = [vec![mark(20.0)], vec![mark(20.002), mark(31.0)]];
    assert_eq!(merged(&axes), [mark(20.0), mark(31.0)]);
}

#[test]
fn lines_of_one_source_may_as_well_be_a_machine() {
    for (sources, is_rivalled) in [(1, true), (2, false)] {
        let rate = Rate {
            ratio: 1.01,
            ratio_sd: 1e-5,
            matched: 3,
            sources,
            p_value: 1e-9,
            nats: 20.0,
        };
        let rivals = finding(&rate).rivals;
        assert_eq!(!rivals.is_empty(), is_rivalled, "{sources} sources");
    }
}

/// A record of one axis for each of these.
fn samples(axes: Vec<Vec<f64>>) -> Samples {
    let axis = |name: usize| Axis {
        name: name.to_string(),
        unit: Unit::default(),
        scale: 1.0,
        zero: 0.0,
        chain: None,
    };
    Samples {
        signal: Signal {
            name: "trial".into(),
            rate_hz: RATE_HZ,
            axes: (0..axes.len()).map(axis).collect(),
            start: None,
        },
        axes: axes.into_iter().map(AxisSamples::from).collect(),
        unknown_gaps: Vec::new(),
    }
}

/// Noise with steady lines of amplitude 1.
fn with_lines(seed: u64, f_hz: &[f64]) -> Vec<f64> {
    let mut values = noise(seed);
    for f_hz in f_hz {
        trial::add(&mut values, &trial::line(*f_hz, 1.0));
    }
    values
}

#[test]
fn only_axes_whose_lines_say_so_have_another_clock() {
    let lines_hz = [7.3, 31.0];
    let moved_hz = lines_hz.map(|f_hz| f_hz / 1.01);
    let record = samples(vec![with_lines(1, &moved_hz), noise(2)]);
    let reference = samples(vec![with_lines(3, &lines_hz), noise(4)]);
    let found = clock(&record, &reference, LEVEL);
    let axes: Vec<usize> = found.iter().map(|(axis, _)| *axis).collect();
    assert_eq!(axes, [0], "seeds 1 to 4: {found:?}");
}

/// Frequencies at which an axis has marks, hertz, and whether each wanders.
fn marks(seed: u64, make: impl Fn(&mut [f64])) -> Vec<(f64, bool)> {
    let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
    let mut values: Vec<f64> = (0..1 << 17).map(|_| noise.draw()).collect();
    make(&mut values);
    let marks = marks_of(&samples(vec![values]), 0, LEVEL).expect("an axis");
    let marks = marks.iter().map(|mark| (mark.f_hz.round(), mark.wanders));
    marks.collect()
}

#[test]
fn a_line_is_a_steady_mark_where_it_keeps_its_size_and_holds_most_of_the_power_about_it() {
    let line = |values: &mut [f64], size: &dyn Fn(f64) -> f64| {
        let length = values.len() as f64;
        for (n, value) in values.iter_mut().enumerate() {
            *value += size(n as f64 / length) * (TAU * 0.2 * n as f64).cos();
        }
    };
    let plain = marks(5, |values| line(values, &|_| 1.0));
    assert_eq!(plain, [(20.0, false)], "seed 5");
    let fading = marks(5, |values| {
        line(values, &|turns| 0.5 - 0.5 * (TAU * turns).cos());
    });
    assert_eq!(fading, [(20.0, true)], "seed 5: fading");
    let in_band = marks(5, |values| {
        trial::add_band(values, 5, 1.2, |_| 1.0);
        line(values, &|_| 0.3);
    });
    assert_eq!(in_band, [(20.0, true)], "seed 5: in a band");
    // So faint a band does not move it.
    let in_faint_band = marks(5, |values| {
        trial::add_band(values, 5, 0.35, |_| 1.0);
        line(values, &|_| 0.1);
    });
    assert_eq!(in_faint_band, [(20.0, true)], "seed 5: in a faint band");
}
