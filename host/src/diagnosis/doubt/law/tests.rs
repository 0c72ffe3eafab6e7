//! Each of what speaks against a law, and each exemption, by a record in which it alone decides.

use std::f64::consts::TAU;

use super::*;
use crate::diagnosis::doubt::left_over;
use crate::diagnosis::trial::{
    LEVEL, RATE_HZ, axis, excluded, heard, law, long, markov as wander, ringing, swinging, take_in,
};
use crate::model::{markov, rolloff};

/// Markov noise of four samples, which makes most of the lower half of the spectrum.
const WANDER: [f64; 2] = [1.0, 0.004];

/// A resonance in the middle of the spectrum.
const BELL: [f64; 3] = [100.0, 10.0, 1.0];

/// White noise beside a Markov noise of deviation 2 whose size swings by the share `swing`.
fn wandering(seed: u64, swing: f64) -> AxisState {
    let len = long(seed);
    let (mut wander, swings) = (wander(seed, 4.0), swinging(swing, 9.0, len));
    axis(seed, len, |n, noise| noise + 2.0 * swings(n) * wander())
}

/// White noise beside noise that rings.
fn rung(seed: u64) -> AxisState {
    let mut rings = ringing(seed, 100.0, 10.0);
    axis(seed, long(seed), |_, noise| noise + rings())
}

/// White noise and noise that rings, both of a strength that swings by half.
fn swung(seed: u64) -> AxisState {
    let len = long(seed);
    let (mut rings, swings) = (ringing(seed, 100.0, 10.0), swinging(0.5, 40.0, len));
    axis(seed, len, |n, noise| swings(n) * (noise + rings()))
}

/// Takes in a law under a name.
fn named(axis: &mut AxisState, name: Kind, effect: Kind, values: &[f64]) {
    take_in(axis, name, law(effect, values));
}

/// What is said of the only law of an axis, and whether it keeps its name.
fn verdict(axis: &mut AxisState, strength_moves: bool) -> (bool, Vec<Remark>) {
    let remarks = heard(&DOUBT, axis, strength_moves);
    assert_eq!(axis.laws.len(), axis.explanations().len());
    (!axis.laws.is_empty(), remarks)
}

/// The first law of an axis, by its own name, .
fn case(axis: &AxisState, strength_moves: bool) -> Case<'_> {
    Case {
        axis,
        level: LEVEL,
        strength_moves,
        which: 0,
        kind: axis.laws[0].effect,
    }
}

#[test]
fn laws_of_steady_noise_keep_their_names() {
    let mut axis = wandering(1, 0.0);
    named(&mut axis, markov::KIND, markov::KIND, &WANDER);
    assert_eq!(verdict(&mut axis, false), (true, vec![]), "seed 1");
    let mut axis = rung(2);
    named(&mut axis, resonance::KIND, resonance::KIND, &BELL);
    assert_eq!(verdict(&mut axis, false), (true, vec![]), "seed 2");
}

#[test]
fn a_resonance_beside_an_excluded_band_goes_without_a_word() {
    let mut near = rung(2);
    named(&mut near, resonance::KIND, resonance::KIND, &BELL);
    let mut far = near.clone();
    // Its width reaches to 110 Hz.
    near.exclude(excluded(107.0, 120.0));
    assert_eq!(verdict(&mut near, false), (false, vec![]), "seed 2");
    far.exclude(excluded(120.0, 130.0));
    assert_eq!(verdict(&mut far, false), (true, vec![]), "seed 2");
}

#[test]
fn only_a_resonance_is_the_skirt_of_a_band() {
    let mut axis = wandering(1, 0.0);
    named(&mut axis, markov::KIND, markov::KIND, &WANDER);
    // Its values, taken for a frequency and a width, would lie within.
    axis.exclude(excluded(0.5, 1.5));
    assert_eq!(verdict(&mut axis, false), (true, vec![]), "seed 1");
}

#[test]
fn a_law_whose_size_moves_is_given_back() {
    let mut axis = wandering(1, 0.4);
    named(&mut axis, markov::KIND, markov::KIND, &WANDER);
    for strength_moves in [false, true] {
        let (keeps, remarks) = verdict(&mut axis.clone(), strength_moves);
        assert!(!keeps, "seed 1: {remarks:?}");
        assert_eq!(remarks.len(), 1, "seed 1: {remarks:?}");
        assert_eq!(remarks[0].test, "steadiness", "seed 1");
        let said = &remarks[0].description;
        let moved = said.contains("as a markov whose amplitude moved by");
        assert!(moved, "seed 1: {said}");
    }
}

#[test]
fn little_movement_is_said_and_takes_no_name_back() {
    // A swing is a deviation of its part by the root of two: about 0.11 and 0.42.
    for (swing, keeps) in [(0.15, true), (0.6, false)] {
        let mut axis = wandering(1, swing);
        named(&mut axis, markov::KIND, markov::KIND, &WANDER);
        let (kept, remarks) = verdict(&mut axis, false);
        assert_eq!(kept, keeps, "seed 1: {remarks:?}");
        assert!(remarks.len() == 1, "seed 1: {remarks:?}");
    }
}

#[test]
fn a_law_of_noise_that_is_not_steady_is_given_back() {
    let mut axis = swung(4);
    named(&mut axis, resonance::KIND, resonance::KIND, &BELL);
    let (keeps, remarks) = verdict(&mut axis, false);
    assert!(!keeps, "seed 4: {remarks:?}");
    assert_eq!(remarks.len(), 1, "seed 4: {remarks:?}");
    assert_eq!(remarks[0].test, "steadiness", "seed 4");
    let said = &remarks[0].description;
    assert!(said.ends_with("but would be steady"), "seed 4: {said}");
}

#[test]
fn what_moves_everywhere_is_no_matter_of_the_law() {
    let mut axis = swung(4);
    named(&mut axis, resonance::KIND, resonance::KIND, &BELL);
    assert_eq!(verdict(&mut axis, true), (true, vec![]), "seed 4");
}

#[test]
fn what_moves_more_within_the_band_is_the_law_s_own() {
    let mut axis = wandering(1, 0.4);
    named(&mut axis, markov::KIND, markov::KIND, &WANDER);
    let case = case(&axis, true);
    let band_hz = case.main_band_hz();
    let unsteady = case.unsteady(&band_hz);
    assert!(unsteady.is_some(), "seed 1: {band_hz:?}");
}

#[test]
fn two_levels_are_neither_gaussian_nor_steady() {
    // The same records that speak against other names.
    let mut moving = wandering(1, 0.4);
    named(&mut moving, telegraph::KIND, markov::KIND, &WANDER);
    assert_eq!(verdict(&mut moving, false), (true, vec![]), "seed 1");
    let mut swung = swung(4);
    named(&mut swung, telegraph::KIND, resonance::KIND, &BELL);
    assert_eq!(verdict(&mut swung, false), (true, vec![]), "seed 4");
}

#[test]
fn a_filter_acts_on_unsteady_noise_as_well() {
    let len = long(5);
    let swings = swinging(0.5, 40.0, len);
    // One pole at 50 Hz.
    let keep = f64::exp(-TAU * 50.0 / RATE_HZ);
    let mut level = 0.0;
    let mut axis = axis(5, len, |n, noise| {
        level = keep * level + (1.0 - keep) * noise;
        swings(n) * level
    });
    named(&mut axis, rolloff::KIND, rolloff::KIND, &[50.0]);
    let case = case(&axis, false);
    let band_hz = case.main_band_hz();
    let unsteady = steady::noise::unsteady(&axis, band_hz.clone(), &[], LEVEL);
    assert!(unsteady.is_some(), "seed 5: {band_hz:?}");
    assert_eq!(case.unsteady(&band_hz), None, "seed 5");
}

#[test]
fn what_else_is_in_its_band_is_no_matter_of_the_law() {
    // Two that ring, one of them on the flank of the other.
    let mut rings =
        [(100.0, 10.0), (105.0, 1.0)].map(|(f_hz, width_hz)| ringing(7, f_hz, width_hz));
    let mut axis = axis(7, long(7), |_, noise| {
        noise + rings.iter_mut().map(|rings| rings()).sum::<f64>()
    });
    named(&mut axis, resonance::KIND, resonance::KIND, &BELL);
    assert!(left_over::of_spectrum(&axis, LEVEL).is_some(), "seed 7");
    assert_eq!(verdict(&mut axis, false), (true, vec![]), "seed 7");
}

#[test]
fn of_several_laws_the_one_that_is_spoken_against_goes() {
    let len = long(8);
    let swings = swinging(0.4, 9.0, len);
    let [mut moving, mut steady] = [60.0, 250.0].map(|f_hz| ringing(8, f_hz, 10.0));
    let mut axis = axis(8, len, |n, noise| noise + swings(n) * moving() + steady());
    named(
        &mut axis,
        resonance::KIND,
        resonance::KIND,
        &[60.0, 10.0, 1.0],
    );
    named(
        &mut axis,
        resonance::KIND,
        resonance::KIND,
        &[250.0, 10.0, 1.0],
    );
    let (_, remarks) = verdict(&mut axis, false);
    assert_eq!(axis.kinds(), [resonance::KIND], "seed 8: {remarks:?}");
    let f_hz = axis.laws[0].values[0];
    assert!((f_hz - 250.0).abs() < 3.0, "seed 8: {f_hz}");
    // Fitted without: the model holds what has a name, and no more.
    let terms = axis.bins.units().len();
    assert_eq!(axis.fit.squared.len(), terms + 1, "seed 8");
}

#[test]
fn what_moves_elsewhere_by_far_less_does_not_excuse_a_law() {
    let len = long(9);
    let [little, much] = [0.2, 0.8].map(|swing| swinging(swing, 40.0, len));
    let mut rings = ringing(9, 100.0, 10.0);
    let mut axis = axis(9, len, |n, noise| little(n) * noise + much(n) * rings());
    named(&mut axis, resonance::KIND, resonance::KIND, &BELL);
    let case = case(&axis, true);
    let band_hz = case.main_band_hz();
    let above = steady::noise::unsteady(&axis, band_hz.end..0.5 * RATE_HZ, &[], LEVEL);
    assert!(above.is_some(), "seed 9: {band_hz:?}");
    assert!(case.unsteady(&band_hz).is_some(), "seed 9: {band_hz:?}");
}
