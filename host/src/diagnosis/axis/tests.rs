//! Everything about an axis follows from the list of its explanations: taking one off the list undoes it.

mod left_out;

use std::ops::Range;

use super::*;
use crate::diagnosis::explanation::{Change, Snapshot};
use crate::diagnosis::record::wave::{Replaced, Side, Wave};
use crate::diagnosis::trial::{
    NOTHING, RATE_HZ, axis, excluded, jump, law, line, made_up, numbers, ringing, short, spike,
    take_in,
};
use crate::model::effect::Part;
use crate::model::{
    averaging, burst, markov, outliers, resonance, sinusoid, steps, telegraph, unnamed, warmup,
};

const SEED: u64 = 1;

/// A stretch of another noise.
const STRETCH: Range<usize> = 3000..3200;

fn noise() -> AxisState {
    axis(SEED, short(SEED), |_, noise| noise)
}

/// A jump, a stretch and a line, one after the other.
fn explained() -> AxisState {
    let mut axis = noise();
    take_in(&mut axis, steps::KIND, jump(5000, 1.0).into());
    take_in(&mut axis, burst::KIND, Change::Mask(vec![STRETCH]));
    take_in(&mut axis, sinusoid::KIND, line(50.0, 0.1).into());
    axis
}

/// The waveforms of every snapshot.
fn snapshots(axis: &AxisState) -> Vec<[Vec<Wave>; 2]> {
    let waves = |one: &Snapshot| one.waves().cloned().collect();
    let all = axis.explanations().iter();
    all.map(|one| [waves(&one.without), waves(&one.with)])
        .collect()
}

#[test]
fn what_is_taken_in_is_taken_out_of_the_record() {
    let axis = explained();
    assert_eq!(axis.kinds(), [steps::KIND, burst::KIND, sinusoid::KIND]);
    let values = axis.residual.values();
    let mut expected = axis.residual.measured().to_vec();
    jump(5000, 1.0).take_out(&mut expected);
    line(50.0, 0.1).take_out(&mut expected);
    for (n, (value, expected)) in values.iter().zip(&expected).enumerate() {
        let same = value == expected || (STRETCH.contains(&n) && value.is_nan());
        assert!(same, "seed {SEED}: {value} for {expected} at {n}");
    }
    // Nor is a moment near the stretch judged by itself.
    assert!(!axis.usable(STRETCH.start - 1) && !axis.usable(STRETCH.end));
    let (jump, line) = (jump(5000, 1.0), line(50.0, 0.1));
    assert_eq!(
        snapshots(&axis),
        [
            [vec![], vec![jump.clone()]],
            [vec![jump.clone()], vec![jump.clone()]],
            [vec![jump.clone()], vec![jump, line]],
        ]
    );
}

#[test]
fn withdrawing_removes_waves_from_the_residual_and_all_snapshots() {
    let mut axis = explained();
    assert!(axis.withdraw(steps::KIND));
    assert!(!axis.withdraw(steps::KIND), "there is no other");
    axis.refresh().expect("a fit");
    assert_eq!(axis.kinds(), [burst::KIND, sinusoid::KIND]);
    let line = line(50.0, 0.1);
    assert_eq!(axis.residual.waves(), std::slice::from_ref(&line));
    let left = [[vec![], vec![]], [vec![], vec![line]]];
    assert_eq!(snapshots(&axis), left);
}

#[test]
fn withdrawing_gives_back_what_was_masked() {
    let mut axis = explained();
    let bins = axis.data.dof.iter().sum::<f64>();
    axis.withdraw(burst::KIND);
    axis.refresh().expect("a fit");
    assert!(axis.residual.values().iter().all(|value| value.is_finite()));
    assert!(axis.usable(STRETCH.start));
    assert!(axis.data.dof.iter().sum::<f64>() > bins, "seed {SEED}");
}

#[test]
fn an_axis_without_its_explanations_is_as_it_was() {
    let mut axis = explained();
    let fresh = noise();
    axis.withdraw_where(|_| true);
    axis.refresh().expect("a fit");
    assert_eq!(axis.residual.values(), fresh.residual.values());
    assert_eq!(axis.data.psd, fresh.data.psd);
    let likelihoods = [&axis, &fresh].map(|axis| axis.fit.log_likelihood);
    // A search that begins elsewhere ends within its own precision.
    assert!(
        (likelihoods[0] - likelihoods[1]).abs() < 1e-3,
        "{likelihoods:?}"
    );
}

#[test]
fn what_takes_the_place_of_others_moves_up_as_they_go() {
    let mut axis = noise();
    take_in(&mut axis, outliers::KIND, spike(6000, 1.0).into());
    take_in(&mut axis, steps::KIND, jump(5000, 1.0).into());
    take_in(&mut axis, warmup::KIND, jump(7000, 0.1).into());
    take_in(&mut axis, sinusoid::KIND, line(50.0, 0.1).into());
    let mut amending = made_up(telegraph::KIND, jump(5000, 2.0).into());
    amending.amends = Some(1);
    amending.supersedes = vec![outliers::KIND, sinusoid::KIND];
    axis.accept(amending).expect("a fit");
    assert_eq!(axis.kinds(), [telegraph::KIND, warmup::KIND]);
    assert_eq!(*axis.residual.waves(), [jump(5000, 2.0), jump(7000, 0.1)]);
}

#[test]
fn what_may_have_been_found_for_another_is_looked_for_again() {
    let mut axis = explained();
    let mut reopening = made_up(outliers::KIND, spike(6000, 1.0).into());
    reopening.reopens = vec![steps::KIND, burst::KIND];
    axis.accept(reopening).expect("a fit");
    assert_eq!(axis.kinds(), [sinusoid::KIND, outliers::KIND]);
    assert_eq!(*axis.residual.waves(), [line(50.0, 0.1), spike(6000, 1.0)]);
    assert_eq!(axis.residual.left_out().count(), 0);
}

#[test]
fn single_waves_go_and_an_explanation_with_its_last() {
    let mut axis = noise();
    let both = Change::Waves(vec![line(50.0, 0.1), line(60.0, 0.1)]);
    take_in(&mut axis, sinusoid::KIND, both);
    assert!(!axis.withdraw_waves(|wave| *wave == line(70.0, 0.1)));
    assert!(axis.withdraw_waves(|wave| *wave == line(50.0, 0.1)));
    assert_eq!(axis.explanations()[0].waves(), [line(60.0, 0.1)]);
    assert!(axis.withdraw_waves(|_| true));
    assert_eq!(axis.kinds(), []);
}

#[test]
fn laws_are_withdrawn_by_their_own_numbers() {
    let mut rings = [100.0, 200.0, 300.0].map(|f_hz| ringing(SEED, f_hz, 10.0));
    let mut axis = axis(SEED, short(SEED), |_, noise| {
        noise + rings.iter_mut().map(|rings| rings()).sum::<f64>()
    });
    // What is no law does not count.
    take_in(&mut axis, steps::KIND, jump(5000, 0.1).into());
    for f_hz in [100.0, 200.0, 300.0] {
        let bell = law(resonance::KIND, &[f_hz, 10.0, 1.0]);
        take_in(&mut axis, resonance::KIND, bell);
    }
    let number = |place: usize| axis.law_number(&axis.explanations()[place]);
    assert_eq!([0, 1, 3].map(number), [None, Some(0), Some(2)]);
    axis.withdraw_laws(&[0, 2]);
    axis.refresh().expect("a fit");
    assert_eq!(axis.kinds(), [steps::KIND, resonance::KIND]);
    assert_eq!(axis.laws.len(), 1);
    // The fit moves it by a share of its width.
    let f_hz = axis.laws[0].values[0];
    assert!((f_hz - 200.0).abs() < 2.0, "seed {SEED}: {f_hz}");
}

#[test]
fn laws_have_the_values_of_the_last_fit() {
    let mut rings = ringing(SEED, 100.0, 10.0);
    let mut axis = axis(SEED, short(SEED), |_, noise| noise + rings());
    let bell = law(resonance::KIND, &[97.0, 14.0, 1.0]);
    take_in(&mut axis, resonance::KIND, bell);
    assert_eq!(axis.explanations()[0].law(), axis.laws.first());
    let f_hz = axis.laws[0].values[0];
    // 10 Hz of noise for a quarter of a minute tell the middle to 0.3 Hz.
    assert!((f_hz - 100.0).abs() < 1.5, "seed {SEED}: {f_hz}");
}

#[test]
fn a_record_that_is_left_out_altogether_has_no_fit() {
    let mut axis = noise();
    let all = 0..axis.residual.len();
    let greedy = made_up(burst::KIND, Change::Mask(vec![all]));
    assert_eq!(axis.accept(greedy), Err(NoFit));
}

#[test]
fn excluded_bands_beside_one_another_are_joined() {
    let mut axis = noise();
    axis.exclude(excluded(100.0, 110.0));
    // 10 Hz away, which is no more than its own width.
    assert_eq!(axis.excluded_with(&(119.0..130.0)), [100.0..130.0]);
    axis.exclude(excluded(119.0, 130.0));
    assert_eq!(axis.excluded_hz(), [100.0..130.0]);
    let place = &axis.excluded()[0].remark.place;
    assert_eq!(*place, (100.0..130.0).into());
    let apart = [100.0..130.0, 135.0..137.0];
    assert_eq!(axis.excluded_with(&(135.0..137.0)), apart);
    axis.exclude(excluded(135.0, 137.0));
    assert_eq!(axis.excluded_hz(), apart);
}

#[test]
fn a_line_is_excluded_beside_a_band() {
    let mut axis = noise();
    axis.exclude(excluded(100.0, 110.0));
    axis.exclude_line(excluded(110.0, 112.0));
    assert_eq!(axis.excluded_hz(), [100.0..110.0, 110.0..112.0]);
}

#[test]
fn no_bin_of_an_excluded_band_is_fitted() {
    let mut axis = noise();
    let inside = |axis: &AxisState| {
        let bins = axis.data.f_hz.iter().zip(&axis.data.dof);
        let inside = bins.filter(|(f_hz, _)| (105.0..145.0).contains(*f_hz));
        inside.map(|(_, dof)| dof).sum::<f64>()
    };
    assert!(inside(&axis) > 100.0, "seed {SEED}");
    axis.exclude(excluded(100.0, 150.0));
    axis.refresh().expect("a fit");
    assert!(inside(&axis) < 1.0, "seed {SEED}: {}", inside(&axis));
    let seen = axis.whitened();
    let at = |f_hz: f64| seen.density[(f_hz / seen.transform.frequency(1)) as usize];
    assert!(at(125.0).is_infinite() && at(160.0).is_finite());
}

#[test]
fn a_law_is_told_from_a_name() {
    let mut axis = noise();
    take_in(&mut axis, telegraph::KIND, law(markov::KIND, &[1.0, 0.01]));
    assert!(axis.has(telegraph::KIND) && !axis.has(markov::KIND));
    assert_eq!(axis.laws[0].effect, markov::KIND);
}

/// A fit to huge values may give a wave that is no number: the search has to begin again without it.
#[test]
fn a_wave_that_is_no_number_cannot_be_fitted() {
    let mut axis = noise();
    let wave: Change = jump(5000, f64::NAN).into();
    assert_eq!(axis.accept(made_up(steps::KIND, wave)), Err(NoFit));
}

/// Beyond the band a peak would be seen by its flank alone, and mean nothing.
#[test]
fn a_peak_lies_inside_the_band() {
    let axis = noise();
    let peak = |f_hz, width_hz| {
        let values = vec![f_hz, width_hz, 1.0];
        let effect = resonance::KIND;
        crate::diagnosis::laws::Law { effect, values }.is_sound(&axis.bins)
    };
    let top_hz = 0.5 * axis.rate_hz;
    assert!(peak(0.5 * top_hz, 0.1 * top_hz));
    assert!(!peak(1.01 * top_hz, 0.1 * top_hz));
    assert!(!peak(0.5 * top_hz, 1e-3 / axis.residual.len() as f64));
}

#[test]
fn at_both_ends_and_in_bands_of_tones_nothing_is_judged() {
    let mut axis = noise();
    // The ring closes at the end of the samples that transform fast.
    let last = axis.fast.len() - 1;
    // Four times the 256 samples that the line through the ends rests on.
    for (index, is_usable) in [(0, false), (1023, false), (1024, true)] {
        assert_eq!(axis.usable(index), is_usable, "seed {SEED}: {index}");
        assert_eq!(axis.usable(last - index), is_usable, "seed {SEED}: {index}");
    }
    let band_hz = 100.0..110.0;
    let tone = Change::Tone(vec![band_hz.clone()]);
    take_in(&mut axis, crate::model::wandering_line::KIND, tone);
    assert_eq!(axis.excluded_hz(), [band_hz], "seed {SEED}");
}

#[test]
fn what_has_no_name_has_bands_where_it_is_half_of_the_noise() {
    let mut axis = axis(7, short(7), |_, noise| noise);
    assert_eq!(axis.unnamed_hz(), [], "seed 7: all is known");
    let middle_hz = 0.2 * RATE_HZ;
    let law = Law {
        effect: unnamed::KIND,
        values: vec![middle_hz, 0.02 * RATE_HZ, 1.0],
    };
    let part = law.effect.part(&law.values);
    let Part::Term(term) = part else {
        panic!("noise without a name is a term")
    };
    // Ten times the noise in its middle.
    let own = term.spectrum(middle_hz, RATE_HZ);
    let squared = 10.0 * axis.density(middle_hz) / own;
    let expected = axis.bins.unfiltered().expect(&*term);
    axis.add_law(law, squared, expected);
    let [band] = &axis.unnamed_hz()[..] else {
        panic!("seed 7: {:?}", axis.unnamed_hz())
    };
    assert!(band.contains(&middle_hz), "seed 7: {band:?}");
    let share = |f_hz: f64| axis.law_share(0, f_hz);
    // To a bin, a sixteenth of an octave.
    assert!(share(1.1 * band.end) < 0.5 && share(band.start / 1.1) < 0.5);
    assert!(share(band.end / 1.1) > 0.5 && share(1.1 * band.start) > 0.5);
}

#[test]
fn means_that_a_record_begins_with_are_left_out() {
    let mut axis = noise();
    // Over eleven and a half samples: the twelfth is the first that has them all.
    let mean = law(averaging::KIND, &[11.5 / RATE_HZ]);
    take_in(&mut axis, averaging::KIND, mean);
    let first = axis.residual.left_out().next().cloned();
    let samples = axis.laws[0].values[0] * RATE_HZ;
    assert_eq!(first, Some(0..samples.ceil() as usize - 1), "{samples}");
    axis.withdraw(averaging::KIND);
    axis.refresh().expect("a fit");
    assert_eq!(axis.residual.left_out().next(), None);
}
