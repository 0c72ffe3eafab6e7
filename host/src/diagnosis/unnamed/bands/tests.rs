//! Bands that a spectrum without any scatter is made of are found.

use super::*;
use crate::diagnosis::trial::{axis, short};

/// Frequency, width and amplitude of the bands that the spectrum of an axis lacks if it has these.
fn found(seed: u64, bands: &[[f64; 3]]) -> Vec<[f64; 3]> {
    found_in(seed, bands, |_| {})
}

/// The same where chance makes of that spectrum what it does.
fn found_in(seed: u64, bands: &[[f64; 3]], chance: impl FnOnce(&mut [f64])) -> Vec<[f64; 3]> {
    let axis = axis(seed, short(seed), |_, noise| noise);
    let bins = laws::behind(&axis.bins, &axis.laws);
    let component = |[f_hz, width_hz, _]: &[f64; 3]| {
        let (f_hz, width_hz) = (*f_hz, *width_hz);
        Band { f_hz, width_hz }.component(&bins)
    };
    let components: Vec<Vec<f64>> = bands.iter().map(component).collect();
    let squared: Vec<f64> = bands.iter().map(|band| band[2] * band[2]).collect();
    let mut psd = axis.fit.expected.clone();
    add_mixture(&mut psd, &components, &squared);
    chance(&mut psd);
    let completed = fitted(&axis, &axis.data.with_psd(psd), &[], &[]);
    let completed = completed.unwrap_or_else(|| panic!("seed {seed}: nothing"));
    let squared = &completed.fit.squared[completed.fit.squared.len() - completed.laws.len()..];
    let both = completed.laws.iter().zip(squared);
    both.map(|(law, squared)| [law.values[0], law.values[1], squared.sqrt()])
        .collect()
}

#[test]
fn a_band_is_moved_to_where_it_is() {
    // Far from the middles that are tried first, which are half a width apart, and from their widths.
    for (seed, f_hz) in (1..).zip([97.3, 103.0, 111.0]) {
        let all = found(seed, &[[f_hz, 8.4, 3.0]]);
        let [[found_hz, width_hz, amplitude], ..] = all[..] else {
            panic!("seed {seed}: nothing");
        };
        // The last moves are by a twenty-fifth of the width, on the width by twice that.
        assert!(
            ((found_hz - f_hz) / 8.4).abs() < 0.04,
            "seed {seed}: {all:?}"
        );
        assert!((width_hz / 8.4).ln().abs() < 0.08, "seed {seed}: {all:?}");
        assert!((amplitude / 3.0 - 1.0).abs() < 0.05, "seed {seed}: {all:?}");
    }
}

#[test]
fn a_band_that_others_stand_for_is_none_any_more() {
    for (seed, apart_hz) in (4..).zip([10.0, 14.0, 18.0, 24.0]) {
        let two = [[100.0, 5.0, 3.0], [100.0 + apart_hz, 5.0, 3.0]];
        let all = found(seed, &two);
        assert!(all.iter().all(|band| band[2] > 0.0), "seed {seed}: {all:?}");
    }
}

#[test]
fn the_first_bands_are_moved_again_beside_the_later_ones() {
    for (seed, apart_hz) in (12..).zip([10.0, 14.0, 18.0]) {
        let axis = axis(seed, short(seed), |_, noise| noise);
        let bins = laws::behind(&axis.bins, &axis.laws);
        let own = |f_hz| Band {
            f_hz,
            width_hz: 5.0,
        };
        let there = [100.0, 100.0 + apart_hz];
        let components = there.map(|f_hz| own(f_hz).component(&bins));
        let mut psd = axis.fit.expected.clone();
        add_mixture(&mut psd, &components, &[9.0; 2]);
        let data = axis.data.with_psd(psd);
        let mut search = Search::new(&axis, &data, &[], &[]);
        // The first made up for a part of the other before that was taken in.
        search.bands = vec![own(there[0] + 2.0), own(there[1] + 1.0)];
        for band in &search.bands {
            search.components.push(band.component(&bins));
            search.squared.push(9.0);
        }
        // Each turn leaves a part of what the other was off by.
        for _ in 0..8 {
            search.move_all().expect("a fit");
        }
        for (band, f_hz) in search.bands.iter().zip(there) {
            let off = ((band.f_hz - f_hz) / 5.0).abs();
            assert!(off < 0.04, "seed {seed}, {f_hz} Hz: {band:?}");
            let wider = (band.width_hz / 5.0).ln().abs();
            assert!(wider < 0.08, "seed {seed}, {f_hz} Hz: {band:?}");
        }
    }
}

#[test]
fn a_bin_that_is_nothing_by_chance_hides_no_band() {
    // A bin of one or two values at the lowest frequencies, where one record in some hundreds has it.
    for (seed, f_hz) in (22..).zip([0.9, 1.4, 2.3]) {
        let wide = [f_hz, f_hz, 4.0];
        let all = found_in(seed, &[wide], |psd| psd[2] *= 1e-8);
        let [[found_hz, width_hz, amplitude], ..] = all[..] else {
            panic!("seed {seed}: nothing");
        };
        // The last moves are by a twenty-fifth of the width, on the width by twice that.
        assert!(
            ((found_hz - f_hz) / f_hz).abs() < 0.04,
            "seed {seed}: {all:?}"
        );
        assert!((width_hz / f_hz).ln().abs() < 0.08, "seed {seed}: {all:?}");
        assert!((amplitude / 4.0 - 1.0).abs() < 0.05, "seed {seed}: {all:?}");
    }
}

#[test]
fn a_band_that_is_not_worth_its_cost_beside_later_ones_goes() {
    for seed in 32..35 {
        let axis = axis(seed, short(seed), |_, noise| noise);
        let bins = laws::behind(&axis.bins, &axis.laws);
        let own = |f_hz| Band {
            f_hz,
            width_hz: 20.0,
        };
        let component = own(100.0).component(&bins);
        let mut psd = axis.fit.expected.clone();
        add_mixture(&mut psd, &[component], &[1.0]);
        let data = axis.data.with_psd(psd);
        // Two to the sides stand for it; one of them alone does nearly as well.
        let with = |bands: &[Band]| {
            let mut search = Search::new(&axis, &data, &[], &[]);
            search.begin_with(bands).expect("sizes");
            search
        };
        let mut both = with(&[own(97.0), own(103.0)]);
        assert_eq!(both.bands.len(), 2, "seed {seed}");
        let alone = with(&[own(97.0)]).log_likelihood();
        let worth = both.log_likelihood() - alone;
        both.drop_worthless(0.5 * worth);
        assert_eq!(both.bands.len(), 2, "seed {seed}: {worth} nats");
        both.drop_worthless(2.0 * worth);
        assert_eq!(both.bands.len(), 1, "seed {seed}: {worth} nats");
    }
}
