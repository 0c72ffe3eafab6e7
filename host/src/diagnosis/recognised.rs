//! A converter whose filter a record shows, where no signal chain is declared.
//!
//! The digital filter of an ADS1281 passes all up to 0.41 of the data rate and next to nothing from 0.5 of it on: a wall that
//! noise of no sensor has by itself, and that every law of the catalogue would be tried on in vain. So it is looked for
//! before anything else: the upper end of the spectrum is fitted as white noise behind a pole, with the filter and without.

use inm_protocol::Phase;

use crate::chain::Chain;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws::{self, Law};
use crate::diagnosis::record::bins::SpectralBins;
use crate::fit::likelihood::{Data, Fit};
use crate::model::rolloff;

/// Share of the data rate from which the spectrum is looked at: half an octave below the wall shows the pole that may be
/// ahead of it, and little of what moves slowly.
const FROM: f64 = 0.25;

/// Share of the data rate where the wall begins: the filter's corner, at -3 dB, is 0.413 (ADS1281 data sheet, SBAS378, digital
/// filter).
const WALL: f64 = 0.41;

/// Least fall in power from the mean below the wall to the end of the spectrum without which no filter is tried: 10 dB are
/// far less than the filter's, and more than a pole's (4 dB from a third to half of the rate).
const LEAST_FALL: f64 = 10.0;

/// How far off a bin of the wall may be, as a share, beside what chance makes of it: a choice, less than half of what
/// the filter of the other phase is off by at its end (39 % at 0.489 of the rate).
const TOLERANCE: f64 = 0.15;

/// Deviations of a bin that chance may make of it: passed once in 16 000 by a bin, of which there are five.
const BY_CHANCE: f64 = 4.0;

/// By how much likelier the record has to be with the filter, nats: twenty are one in 5e8, for two filters that are tried.
const LEAST_NATS: f64 = 20.0;

/// Corner over rate at which the search of a pole ahead of the filter begins.
const STARTS: [f64; 3] = [0.1, 0.3, 1.0];

/// First move of the pole, as a logarithm.
const STEP: f64 = 0.3;

/// The chain with which the upper end of an axis's spectrum agrees, where none is declared; its poles are found as
/// [`rolloff`]. What was filled in the place of missing samples is that of an axis `behind` the chain in question.
pub fn chain(axis: &AxisState, behind: impl Fn(&Chain) -> Option<AxisState>) -> Option<Chain> {
    let is_filled = axis.filled_samples() > 0;
    if axis.chain.is_some() || !(is_filled || falls(&axis.data, axis.rate_hz)) {
        return None;
    }
    let phases = [Phase::Linear, Phase::Minimum];
    let fits = phases.into_iter().filter_map(|phase| {
        let chain = Chain {
            converter: Some(phase),
            poles_hz: Vec::new(),
        };
        let (data, bins) = if is_filled {
            let behind = behind(&chain)?;
            (behind.data, behind.bins)
        } else {
            let mut bins = SpectralBins::new(&axis.residual.values(), axis.rate_hz, Some(&chain))?;
            bins.leave_out(&axis.excluded_hz());
            (axis.data.clone(), bins)
        };
        if !falls(&data, axis.rate_hz) {
            return None;
        }
        let fit = fitted(&bins, &data)?;
        let gain = fit.log_likelihood - fitted(&axis.bins, &data)?.log_likelihood;
        agrees(&data, &fit, axis.rate_hz).then_some((chain, gain))
    });
    let (chain, gain) = fits.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (gain > LEAST_NATS).then_some(chain)
}

/// Whether the spectrum falls by more than a pole at its end.
fn falls(data: &Data, rate_hz: f64) -> bool {
    let below = |from: f64, to: f64| {
        let band = from * rate_hz..to * rate_hz;
        let bins = data.f_hz.iter().zip(&data.psd);
        let inside = bins.filter(|(f_hz, _)| band.contains(f_hz));
        inside.fold((0.0, 0.0), |(sum, count), (_, psd)| {
            (sum + psd, count + 1.0)
        })
    };
    let ((level, count), end) = (below(FROM, WALL), data.psd.last());
    end.is_some_and(|end| count > 0.0 && level > LEAST_FALL * count * end)
}

/// The likeliest fit of the upper end of a spectrum, with a pole or without.
fn fitted(bins: &SpectralBins, data: &Data) -> Option<Fit> {
    let rate_hz = bins.rate_hz();
    let below = 0.0..FROM * rate_hz;
    let data = Data {
        dof: bins.dof_beside(std::slice::from_ref(&below)),
        ..data.clone()
    };
    let pole = |start: f64| {
        let mut laws = vec![Law {
            effect: rolloff::KIND,
            values: vec![start * rate_hz],
        }];
        laws::search::polish(bins, &data, &mut laws, 0, STEP)
    };
    let fits = STARTS.into_iter().filter_map(pole);
    let fits = fits.chain(laws::fit(bins, &data, &[]));
    fits.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))
}

/// Whether every bin of the wall is what a fit expects there.
fn agrees(data: &Data, fit: &Fit, rate_hz: f64) -> bool {
    let bins = data.f_hz.iter().zip(&data.psd).zip(&data.dof);
    let mut wall = bins
        .zip(&fit.expected)
        .filter(|(((f_hz, _), _), _)| **f_hz >= WALL * rate_hz);
    wall.all(|(((_, psd), dof), expected)| {
        let deviation = (2.0 / dof).sqrt();
        (psd / expected - 1.0).abs() <= TOLERANCE + BY_CHANCE * deviation
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::model::whole::Model;
    use crate::simulate::source::Simulation;

    /// Samples a record: the bins of the wall then have hundreds of degrees of freedom.
    const SAMPLES: u64 = 1 << 16;

    /// Noise of a chain at a rate.
    fn record(chain: &str, rate_hz: f64, seed: u64) -> Vec<f64> {
        let text = format!(
            r#"{{ "schema": 1, "rate_hz": {rate_hz}, "axes": [ {{ "name": "X", "chain": "{chain}",
                "coefficients": {{ "K": 1e-3, "B": 5e-3, "N": 0.01 }} }} ] }}"#
        );
        let model = Model::from_json(&text).expect("a model");
        let mut simulation = Simulation::new(&model, SAMPLES, seed).expect("a model");
        simulation.next_columns(SAMPLES as usize).remove(0)
    }

    /// What is recognised in noise of this chain at a rate, undeclared.
    fn seen(chain: &str, rate_hz: f64, seed: u64) -> Option<String> {
        seen_without(chain, rate_hz, seed, 0)
    }

    /// The same without so many in a hundred of the samples.
    fn seen_without(chain: &str, rate_hz: f64, seed: u64, percent: u64) -> Option<String> {
        let mut values = record(chain, rate_hz, seed);
        // A sequence that is as good as random, and has each number once in a hundred.
        let numbers = (0..SAMPLES).map(|n| n * n * n % 101);
        let lost = values.iter_mut().zip(numbers).filter(|(_, n)| *n < percent);
        lost.for_each(|(value, _)| *value = f64::NAN);
        let values = Arc::new(values);
        let behind = |chain: Option<&Chain>| AxisState::new(Arc::clone(&values), rate_hz, chain);
        let behind_any = |chain: &Chain| behind(Some(chain));
        let declared = Chain {
            converter: None,
            poles_hz: vec![rate_hz],
        };
        let axis = behind(Some(&declared)).expect("a spectrum");
        assert_eq!(
            super::chain(&axis, behind_any),
            None,
            "seed {seed}: declared"
        );
        let axis = behind(None).expect("a spectrum");
        super::chain(&axis, behind_any).map(|chain| chain.to_string())
    }

    #[test]
    fn it_is_recognised_where_samples_are_missing() {
        for (seed, percent) in [(31, 1), (32, 8), (33, 30)] {
            let [converter, poles] = ["ads1281:linear", "500hz"];
            let found = seen_without(converter, 2000.0, seed, percent);
            // Which of its two filters, a third missing does not say any more. Nor does one in a hundred, of which the few
            // that are drawn decide: 6 of 16 such records have the other one, of those with 8 % missing none to one.
            let is_it = |one: &String| one == converter || percent != 8 && one == "ads1281:minimum";
            assert!(
                found.as_ref().is_some_and(is_it),
                "seed {seed}, {percent} %: {found:?}"
            );
            let found = seen_without(poles, 2000.0, seed, percent);
            assert_eq!(found, None, "seed {seed}, {percent} %, poles");
        }
    }

    #[test]
    fn the_converters_filter_is_recognised_with_a_pole_and_without() {
        for (seed, [converter, pole]) in (1..).zip([
            ["ads1281:linear", ""],
            ["ads1281:minimum", ""],
            ["ads1281:linear", "+400hz"],
            ["ads1281:minimum", "+150hz"],
            ["ads1281:linear", "+1507hz"],
        ]) {
            let rate_hz = [2000.0, 1000.0, 4000.0][seed as usize % 3];
            let found = seen(&format!("{converter}{pole}"), rate_hz, seed);
            assert_eq!(
                found.as_deref(),
                Some(converter),
                "seed {seed}, {rate_hz}/s, {pole}"
            );
        }
    }

    #[test]
    fn poles_alone_are_no_converter() {
        for (seed, poles) in (11..).zip(["400hz", "30hz", "30hz+40hz", "5hz+80hz+300hz"]) {
            assert_eq!(seen(poles, 2000.0, seed), None, "seed {seed}, {poles}");
        }
    }

    #[test]
    fn another_steep_filter_is_no_converter() {
        const SEED: u64 = 21;
        // Averages of neighbours fall to nothing at half the rate, but not as a wall.
        let mut noise = crate::diagnosis::trial::numbers(SEED, 0);
        let white: Vec<f64> = (0..SAMPLES + 8).map(|_| noise.draw()).collect();
        for order in [2, 4, 8] {
            let mut values = white.clone();
            for _ in 0..order {
                values = values.windows(2).map(|two| two[0] + two[1]).collect();
            }
            let axis = AxisState::new(Arc::new(values), 100.0, None).expect("a spectrum");
            assert_eq!(
                super::chain(&axis, |_| None),
                None,
                "seed {SEED}, order {order}"
            );
        }
    }

    #[test]
    fn behind_two_poles_the_converter_is_recognised_by_one_of_them() {
        // No mix of the five terms falls as steeply as two poles do.
        for (seed, poles) in (41..).zip(["+100hz+150hz", "+30hz+200hz", "+300hz+300hz"]) {
            let found = seen(&format!("ads1281:linear{poles}"), 2000.0, seed);
            assert_eq!(
                found.as_deref(),
                Some("ads1281:linear"),
                "seed {seed}, {poles}"
            );
        }
    }

    #[test]
    fn where_its_wall_is_excluded_the_likelihood_says_whether_there_is_one() {
        use crate::diagnosis::trial::{RATE_HZ, excluded, numbers, ringing};
        let is_seen = |values: Vec<f64>| {
            let axis = AxisState::new(Arc::new(values), RATE_HZ, None);
            let mut axis = axis.expect("a spectrum");
            axis.exclude(excluded(WALL * RATE_HZ, 0.5 * RATE_HZ));
            axis.refresh().expect("a fit");
            super::chain(&axis, |_| None).is_some()
        };
        for seed in 51..54 {
            // Louder at 0.44 of the rate, and shut out about half of it alone: a zero there beside a pole.
            let mut white = numbers(seed, 0);
            let mut rings = ringing(seed, 0.44 * RATE_HZ, 0.03 * RATE_HZ);
            let (mut before, mut passed) = (0.0, 0.0);
            let next = |_| {
                let value = white.draw() + 0.7 * rings();
                passed = value + before - 0.6 * passed;
                before = value;
                passed
            };
            assert!(!is_seen((0..SAMPLES).map(next).collect()), "seed {seed}");
            let converter = record("ads1281:linear", RATE_HZ, seed);
            assert!(is_seen(converter), "seed {seed}: the converter");
        }
    }
}
