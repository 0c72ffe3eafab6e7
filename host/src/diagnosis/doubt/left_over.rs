//! What is significant still when nothing in the catalogue explains more.

use super::Doubt;
use crate::diagnosis::axis::{AxisState, NoFit, SHUT_OUT};
use crate::diagnosis::detect::lines::{self, Group};
use crate::diagnosis::laws::departure::{self, Departure};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::steady::strength::{self, Wander};
use crate::model::rounding;

/// What is left of the spectrum, of lines and of the strength over time. One test; those of lines and of the
/// strength are counted with their detectors.
pub static DOUBT: Doubt = Doubt {
    tests: 1,
    why: "more is left",
    hear: |hearing| {
        let mut remarks = left_over(hearing.axis, hearing.level);
        remarks.append(&mut hearing.remarks);
        hearing.remarks = remarks;
        Ok::<(), NoFit>(())
    },
};

/// Share of a course that its law may be off by: a choice. No sensor follows its thermometer, and nothing settles, by a formula to
/// better than a hundredth; far enough above the noise that is significant, and says nothing of the noise.
const TOLERANCE: f64 = 0.01;

/// Factor by which a spectrum may be off where the chain shuts all out: a choice. What was drawn for samples that are missing, and
/// what codes round off behind the filter, are of another law there, a thousandth of what passes.
const WHERE_SHUT_OUT: f64 = 2.0;

/// Where the spectrum of an axis departs from its model by more than the laws of what was taken out may be off by, if it does at
/// a `level`.
pub fn of_spectrum(axis: &AxisState, level: f64) -> Option<Departure> {
    let mut expected = axis.fit.expected.clone();
    if !axis.residual.waves().is_empty() {
        let present = axis.bins.measure(&axis.residual.with_waves()).psd;
        for ((expected, present), left) in expected.iter_mut().zip(&present).zip(&axis.data.psd) {
            let most = *expected + TOLERANCE.powi(2) * (present - left).max(0.0);
            *expected = left.clamp(*expected, most);
        }
    }
    let bins = expected.iter_mut().zip(&axis.data.psd).zip(&axis.data.f_hz);
    for ((expected, left), &f_hz) in bins {
        if axis.bins.chain_power(f_hz) < SHUT_OUT {
            *expected = left.clamp(*expected / WHERE_SHUT_OUT, *expected * WHERE_SHUT_OUT);
        }
    }
    let departure = departure::departure(&axis.data, &expected);
    departure.filter(|one| one.p_value < level)
}

/// What there is to say of a departure of the spectrum.
pub fn spectrum_remark(departure: &Departure) -> Remark {
    Remark {
        test: "spectrum".into(),
        place: (departure.from_hz..departure.to_hz).into(),
        p_value: departure.p_value,
        description: format!(
            "{:.3} times the power that the model expects there",
            departure.ratio
        ),
    }
}

fn left_over(axis: &AxisState, level: f64) -> Vec<Remark> {
    let departure = of_spectrum(axis, level);
    let spectrum = departure.as_ref().map(spectrum_remark);
    let mut remarks: Vec<Remark> = spectrum.into_iter().collect();
    remarks.extend(of_lines(axis, level));
    remarks.extend(of_strength(axis, level));
    remarks
}

/// Lines too close to one another to be separate.
fn of_lines(axis: &AxisState, level: f64) -> impl Iterator<Item = Remark> {
    let mut known = lines::resonances_hz(axis);
    known.extend(axis.excluded_hz());
    let groups = lines::lines(axis, level).into_iter();
    groups.filter_map(move |group| match group {
        Group::Cluster {
            f_hz,
            width_hz,
            lines,
        } if !known.iter().any(|band| band.contains(&f_hz)) => {
            let p_values = lines.iter().map(|line| line.false_alarm);
            Some(Remark {
                test: "lines".into(),
                place: (f_hz - 0.5 * width_hz..f_hz + 0.5 * width_hz).into(),
                p_value: p_values.fold(1.0, f64::min),
                description: format!(
                    "power in {} narrow lines that stand too close to be separate: {}",
                    lines.len(),
                    lines::wandering(f_hz)
                ),
            })
        }
        _ => None,
    })
}

/// A remark on noise whose strength moves, where it does.
fn of_strength(axis: &AxisState, level: f64) -> Option<Remark> {
    if axis.has(rounding::KIND) {
        return None;
    }
    let Wander { cyclic, slow } = strength::wander(&axis.powers())?;
    let movements = [
        (
            cyclic,
            Place::Period as fn(f64) -> Place,
            "rises and falls in a cycle",
        ),
        (slow, Place::Slower, "changes in time"),
    ];
    // One movement shows in both: a cycle is the plainer of the two.
    let mut seen = movements.iter();
    let known_sd = axis.known_movement();
    let (movement, place, how) = seen.find(|(one, ..)| one.counts(level, known_sd))?;
    Some(Remark {
        test: "variance".into(),
        place: place(movement.period / axis.rate_hz),
        p_value: movement.p_value,
        description: format!("the strength of the noise {how}"),
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::diagnosis::doubt::Hearing;
    use crate::diagnosis::explanation::Change;
    use crate::diagnosis::trial::{
        LEVEL, NOTHING, RATE_HZ, axis, excluded, heard, law, line, long, remark, ringing, short,
        swinging, take_in,
    };
    use crate::model::{drift, resonance};

    /// What is said of an axis by one test.
    fn by(test: &str, axis: &mut AxisState) -> Vec<Remark> {
        let mut remarks = heard(&DOUBT, axis, false);
        remarks.retain(|one| one.test == test);
        remarks
    }

    #[test]
    fn nothing_is_left_of_plain_noise() {
        let mut axis = axis(1, long(1), |_, noise| noise);
        assert_eq!(heard(&DOUBT, &mut axis, false), [], "seed 1");
    }

    #[test]
    fn a_course_may_be_off_by_a_hundredth_of_itself() {
        // Ten times the power is left where a wave was taken out, a hundredth of which is as much, or a tenth of that.
        for (seed, (amplitude, is_left)) in (21..).zip([(100.0, false), (1.0, true), (0.0, true)]) {
            let mut axis = axis(seed, long(seed), |n, noise| {
                noise + amplitude * (TAU * 0.01 * n as f64).cos()
            });
            let line = line(10.0, amplitude);
            take_in(&mut axis, drift::KIND, Change::Waves(vec![line]));
            let bin = axis.data.f_hz.partition_point(|f_hz| *f_hz < 10.0);
            for psd in &mut axis.data.psd[bin - 1..=bin] {
                *psd *= 10.0;
            }
            let found = of_spectrum(&axis, LEVEL);
            assert_eq!(
                found.is_some(),
                is_left,
                "seed {seed}, {amplitude}: {found:?}"
            );
        }
    }

    #[test]
    fn what_a_chain_shuts_out_may_be_off_by_a_factor() {
        let chain: crate::chain::Chain = "ads1281:linear".parse().expect("a chain");
        let values = (0..long(31)).map({
            let mut normal = crate::diagnosis::trial::numbers(31, 0);
            move |_| normal.draw()
        });
        let values = std::sync::Arc::new(values.collect());
        let mut axis = AxisState::new(values, RATE_HZ, Some(&chain)).expect("a fit");
        let shut = |f_hz: f64, axis: &AxisState| axis.bins.chain_power(f_hz) < SHUT_OUT;
        let bins = axis.data.psd.len();
        for (factor, is_left) in [(1.0, false), (0.6, false), (1.8, false), (0.1, true)] {
            for bin in 0..bins {
                let is_shut = shut(axis.data.f_hz[bin], &axis);
                axis.data.psd[bin] = axis.fit.expected[bin] * if is_shut { factor } else { 1.0 };
            }
            let found = of_spectrum(&axis, LEVEL);
            assert_eq!(found.is_some(), is_left, "seed 31, {factor}: {found:?}");
        }
    }

    #[test]
    fn power_beyond_the_model_is_left_until_a_law_has_it() {
        let mut rings = ringing(2, 100.0, 10.0);
        let mut axis = axis(2, short(2), |_, noise| noise + rings());
        let remarks = by("spectrum", &mut axis);
        assert_eq!(remarks.len(), 1, "seed 2: {remarks:?}");
        let band_hz = remarks[0].place.band_hz().expect("a band");
        // At four widths on either side the ringing has an eighth of the power of the white noise.
        assert!(
            band_hz[0] > 60.0 && band_hz[1] < 140.0,
            "seed 2: {band_hz:?}"
        );
        let bell = law(resonance::KIND, &[100.0, 10.0, 1.0]);
        take_in(&mut axis, resonance::KIND, bell);
        assert_eq!(by("spectrum", &mut axis), [], "seed 2");
    }

    /// Lines a few parts of a hertz beside one another, in noise that rings there as loud as `ring` times 1.
    fn lines(seed: u64, count: usize, ring: f64) -> AxisState {
        let mut rings = ringing(seed, 100.0, 10.0);
        axis(seed, short(seed), |n, noise| {
            let turn = |line: usize| TAU * (100.0 + 0.3 * line as f64) * n as f64 / RATE_HZ;
            let lines = (0..count).map(|line| (turn(line) + line as f64).cos());
            noise + ring * rings() + 0.5 * lines.sum::<f64>()
        })
    }

    #[test]
    fn lines_too_close_to_be_separate_are_left_and_single_ones_are_not() {
        let remarks = by("lines", &mut lines(3, 3, 0.0));
        assert_eq!(remarks.len(), 1, "seed 3: {remarks:?}");
        let [from_hz, to_hz] = remarks[0].place.band_hz().expect("a band");
        // As many as there are, to a bin of the record's.
        assert!((from_hz - 100.0).abs() < 0.06, "seed 3: {from_hz}");
        assert!((to_hz - 100.6).abs() < 0.06, "seed 3: {to_hz}");
        assert_eq!(by("lines", &mut lines(3, 1, 0.0)), [], "seed 3");
    }

    #[test]
    fn lines_in_an_excluded_band_or_a_resonance_are_known() {
        let mut axis = lines(3, 3, 0.0);
        axis.exclude(excluded(99.0, 102.0));
        assert_eq!(by("lines", &mut axis), [], "seed 3");
        let mut axis = lines(3, 3, 0.5);
        assert_eq!(by("lines", &mut axis).len(), 1, "seed 3");
        let bell = law(resonance::KIND, &[100.0, 10.0, 1.0]);
        take_in(&mut axis, resonance::KIND, bell);
        assert_eq!(by("lines", &mut axis), [], "seed 3");
    }

    /// Noise whose strength swings by 40 %, so many times in the record.
    fn swung(seed: u64, len: usize, cycles: f64) -> AxisState {
        let swings = swinging(0.4, cycles, len);
        axis(seed, len, |n, noise| swings(n) * noise)
    }

    #[test]
    fn strength_that_moves_is_left_as_a_cycle_or_as_slow() {
        let mut axis = swung(4, short(4), 40.0);
        let remarks = by("variance", &mut axis);
        assert_eq!(remarks.len(), 1, "seed 4: {remarks:?}");
        let Place::Period(period_s) = remarks[0].place else {
            panic!("seed 4: {remarks:?}");
        };
        let cycle_s = axis.filled.len() as f64 / RATE_HZ / 40.0;
        // To a bin of forty.
        assert!(
            (period_s / cycle_s - 1.0).abs() < 0.025,
            "seed 4: {period_s}"
        );
        let remarks = by("variance", &mut swung(4, short(4), 3.0));
        assert_eq!(remarks.len(), 1, "seed 4: {remarks:?}");
        assert!(matches!(remarks[0].place, Place::Slower(_)), "{remarks:?}");
    }

    #[test]
    fn a_cycle_that_is_slow_as_well_is_said_once() {
        // Of 1536 blocks of 64 samples the 64 slowest ordinates are slow, and 40 is among them.
        let mut axis = swung(5, 3 * (1 << 15) + 1, 40.0);
        let wander = strength::wander(&axis.powers()).expect("blocks");
        assert!(wander.slow.p_value < LEVEL, "seed 5: {wander:?}");
        let remarks = by("variance", &mut axis);
        assert_eq!(remarks.len(), 1, "seed 5: {remarks:?}");
        assert!(matches!(remarks[0].place, Place::Period(_)), "{remarks:?}");
    }

    #[test]
    fn a_coarse_grid_silences_the_strength_alone() {
        let mut axis = swung(4, short(4), 40.0);
        take_in(&mut axis, rounding::KIND, NOTHING);
        assert_eq!(by("variance", &mut axis), [], "seed 4");
        let mut lines = lines(3, 3, 0.0);
        take_in(&mut lines, rounding::KIND, NOTHING);
        assert_eq!(by("lines", &mut lines).len(), 1, "seed 3");
    }

    #[test]
    fn what_is_left_comes_ahead_of_what_was_said() {
        let mut axis = swung(4, short(4), 40.0);
        let mut hearing = Hearing {
            axis: &mut axis,
            level: LEVEL,
            strength_moves: true,
            large_samples_in_groups: false,
            remarks: vec![remark(1.0, 2.0)],
            no_course: None,
        };
        assert!((DOUBT.hear)(&mut hearing).is_ok(), "seed 4");
        let tests: Vec<&str> = hearing.remarks.iter().map(|one| &*one.test).collect();
        assert_eq!(tests.last(), Some(&"trial"), "seed 4: {tests:?}");
        assert!(tests.contains(&"variance"), "seed 4: {tests:?}");
    }
}
