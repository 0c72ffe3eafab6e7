//! The likelihood fit as a user meets it: units, rate labels, odd records, and the signal chain.

use inm_host::internals::analyse::{Analysis, AnalysisOptions, LikelihoodFit, analyse, summarise};
use inm_host::internals::bins::record::{Overlap, Record};
use inm_host::internals::fit::design::Design;
use inm_host::internals::fit::likelihood::terms;
use inm_host::internals::model::axis::ModelAxis;
use inm_host::internals::model::published::PublishedAxis;
use inm_host::internals::model::whole::{Model, SCHEMA};
use inm_host::internals::model::{Coefficient, PerCoefficient};
use inm_host::internals::signal::{Axis, Signal, Unit};
use inm_host::internals::simulate::source::Simulation;
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::{Block, Chunk, Column, Source, SourceError, Values};
use inm_host::internals::spectrum::{Cascade, Estimate, Settings};
use inm_host::internals::virtual_board::VirtualConnect;

const RATE_HZ: f64 = 100.0;

/// Walk, flicker and white noise that all show in a few minutes, and some quantisation noise.
const TRUTH: PerCoefficient<f64> = PerCoefficient {
    r: 0.0,
    k: 0.3,
    b: 0.5,
    n: 0.2,
    q: 0.004,
};

fn simulated(seed: u64, length: usize) -> Vec<f64> {
    let model = Model {
        schema: SCHEMA,
        rate_hz: RATE_HZ,
        axes: vec![ModelAxis {
            name: "X".into(),
            unit: Unit::MetrePerSecondSquared,
            mean: 0.0,
            chain: None,
            coefficients: TRUTH,
            effects: Vec::new(),
        }],
        correlation: None,
    };
    Simulation::new(&model, length as u64, seed)
        .expect("a sound model")
        .next_columns(length)
        .remove(0)
}

fn fit(samples: &[f64], rate_hz: f64, units_per_count: f64) -> LikelihoodFit {
    let mut cascade = Cascade::default();
    cascade.push_values(0, samples).expect("in order");
    let estimate = Estimate::new(&cascade, rate_hz, &Settings::default());
    let design = Design::new(rate_hz, None);
    terms::fit(&cascade, &estimate, units_per_count, &design).expect("a fit")
}

/// `other` is `one` with every coefficient multiplied by `factor`.
fn assert_scaled(
    what: &str,
    one: &LikelihoodFit,
    other: &LikelihoodFit,
    factor: impl Fn(Coefficient) -> f64,
) {
    for coefficient in Coefficient::ALL {
        let (a, b) = (
            one.coefficients.get(coefficient),
            other.coefficients.get(coefficient),
        );
        let factor = factor(coefficient);
        assert_eq!(a.identified, b.identified, "{what}, {coefficient:?}");
        let pairs = [
            (a.value, b.value),
            (Some(a.lo), Some(b.lo)),
            (a.hi, b.hi),
            (a.upper, b.upper),
        ];
        for (a, b) in pairs {
            let (a, b) = (a.unwrap_or(0.0) * factor, b.unwrap_or(0.0));
            // Ends of intervals are searched for to one part in a thousand.
            assert!(
                (a - b).abs() <= 2e-3 * a.abs(),
                "{what}, {coefficient:?}: {a:e} {b:e}"
            );
        }
        assert_eq!(
            a.record_longer_by.is_some(),
            b.record_longer_by.is_some(),
            "{what}, {coefficient:?}"
        );
    }
    assert_eq!(one.tied, other.tied, "{what}");
}

#[test]
fn units_and_rate_labels_change_only_what_they_must() {
    let samples = simulated(3, 60_000);
    let plain = fit(&samples, RATE_HZ, 1.0);
    for scale in [1e-9, 1e-4, 1e5, 1e9] {
        let scaled: Vec<f64> = samples.iter().map(|x| x * scale).collect();
        assert_scaled(
            &format!("data times {scale:e}"),
            &plain,
            &fit(&scaled, RATE_HZ, 1.0),
            |_| scale,
        );
        assert_scaled(
            &format!("{scale:e} units a count"),
            &plain,
            &fit(&samples, RATE_HZ, scale),
            |_| scale,
        );
    }
    for rate_hz in [1.0, 1e6] {
        let faster = rate_hz / RATE_HZ;
        // Each is the signal's unit times its own power of time.
        let factor = |coefficient| match coefficient {
            Coefficient::R => faster,
            Coefficient::K => faster.sqrt(),
            Coefficient::B => 1.0,
            Coefficient::N => 1.0 / faster.sqrt(),
            Coefficient::Q => 1.0 / faster,
        };
        let what = format!("{rate_hz} samples a second");
        assert_scaled(&what, &plain, &fit(&samples, rate_hz, 1.0), factor);
    }
}

#[test]
fn an_offset_does_not_matter() {
    let samples = simulated(4, 30_000);
    let plain = fit(&samples, RATE_HZ, 1.0);
    let lifted: Vec<f64> = samples.iter().map(|x| x + 1e6).collect();
    assert_scaled("mean of 1e6", &plain, &fit(&lifted, RATE_HZ, 1.0), |_| 1.0);
}

/// A record in memory, with gaps where the numbers are not.
struct Given {
    signal: Signal,
    blocks: Vec<Block>,
}

impl Given {
    fn new(rate_hz: f64, blocks: Vec<(u64, Vec<f64>)>) -> Self {
        let axis = Axis {
            name: "X".into(),
            unit: Unit::MetrePerSecondSquared,
            scale: 1.0,
            zero: 0.0,
            chain: None,
        };
        let block = |(first, values)| Block {
            first,
            columns: vec![Column {
                values: Values::Floats(values),
                invalid: Vec::new(),
            }],
        };
        Self {
            signal: Signal {
                name: "given".into(),
                rate_hz,
                axes: vec![axis],
                start: None,
            },
            blocks: blocks.into_iter().rev().map(block).collect(),
        }
    }

    fn analyse(self) -> Analysis {
        self.tried().expect("memory does not fail")
    }

    fn tried(mut self) -> Result<Analysis, SourceError> {
        analyse(&mut self, &AnalysisOptions::default(), |_| {})
    }
}

impl Source for Given {
    fn signal(&self) -> &Signal {
        &self.signal
    }

    fn expected_len(&self) -> Option<u64> {
        None
    }

    fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
        Ok(self.blocks.pop().map(Chunk::Samples))
    }
}

/// Every number of a fit is one, and intervals are in order.
fn assert_sound(what: &str, fit: &LikelihoodFit) {
    for coefficient in Coefficient::ALL {
        let value = fit.coefficients.get(coefficient);
        let numbers = [value.value, value.hi, value.upper, value.record_longer_by];
        assert!(
            numbers.iter().flatten().all(|number| number.is_finite()),
            "{what}, {coefficient:?}: {value:?}"
        );
        assert!(value.lo.is_finite() && value.squared.is_finite(), "{what}");
        assert_eq!(value.value.is_some(), value.identified, "{what}");
        let (lo, hi) = (value.lo, value.hi.unwrap_or(f64::MAX));
        let best = value.value.unwrap_or(lo);
        assert!(lo <= best && best <= hi, "{what}: {value:?}");
    }
    assert!(
        fit.expected().iter().all(|density| *density > 0.0),
        "{what}"
    );
}

#[test]
fn odd_records_give_a_sensible_fit_or_none() {
    let noise = simulated(5, 120_000);
    let nothing = Given::new(RATE_HZ, vec![(0, Vec::new())]).tried();
    assert!(nothing.is_err(), "of nothing there is no analysis");
    for length in [1, 2, 5, 10, 20, 40, 100, 300, 1000, 1025, 8193] {
        let analysis = Given::new(RATE_HZ, vec![(0, noise[..length].to_vec())]).analyse();
        let fit = &analysis.axes[0].fits.likelihood;
        let what = format!("{length} samples");
        fit.iter().for_each(|fit| assert_sound(&what, fit));
        assert!(fit.is_some() || length < 40, "{what}");
    }
    for (what, samples) in [
        ("constant", vec![9.80665; 20_000]),
        ("zeros", vec![0.0; 20_000]),
    ] {
        let analysis = Given::new(RATE_HZ, vec![(0, samples)]).analyse();
        assert!(analysis.axes[0].fits.likelihood.is_none(), "{what}");
    }
    let two_levels = (0..20_000)
        .map(|n| f64::from(u8::from(n > 9_000)))
        .collect();
    let analysis = Given::new(RATE_HZ, vec![(0, two_levels)]).analyse();
    let fit = &analysis.axes[0].fits.likelihood;
    fit.iter().for_each(|fit| assert_sound("one step", fit));
    for rate_hz in [1.0, 1e6] {
        let analysis = Given::new(rate_hz, vec![(0, noise.clone())]).analyse();
        let fit = analysis.axes[0].fits.likelihood.clone().expect("a fit");
        assert_sound("rate", &fit);
    }
    // Nine tenths missing: in long stretches there is a spectrum, in short ones there is none.
    for (run, sees) in [(4_000, true), (100, false)] {
        let stretches = noise
            .chunks(run)
            .enumerate()
            .map(|(number, chunk)| ((10 * number * run) as u64, chunk.to_vec()))
            .collect();
        let analysis = Given::new(RATE_HZ, stretches).analyse();
        let fit = &analysis.axes[0].fits.likelihood;
        let what = format!("stretches of {run}");
        assert_eq!(fit.is_some(), sees, "{what}");
        let Some(fit) = fit else { continue };
        assert_sound(&what, fit);
        let white = fit.coefficients.n;
        let sigma = (white.hi.expect("known") - white.lo) / 3.92;
        assert!(
            (white.squared.sqrt() - TRUTH.n).abs() < 4.0 * sigma,
            "{what}: {white:?}"
        );
    }
}

/// Converter filter and sensor pole on: with the chain the coefficients are those of the sensor,
/// without it they are not.
#[test]
fn the_chain_of_the_virtual_board_is_seen_through() {
    let seed = 11;
    let plan = Plan {
        samples: Some(120_000),
        ..Plan::default()
    };
    let connect = Box::new(VirtualConnect::published(seed, 0.0));
    let mut source =
        BoardSource::start(connect, plan, None, Stop::default()).expect("the board starts");
    let signal = source.signal().clone();
    let mut record = Record::new(signal.axes.len(), Overlap::Strided);
    while let Some(chunk) = source.next_chunk().expect("the board sends") {
        record.push(chunk);
    }
    let mut chainless = signal.clone();
    chainless.axes.iter_mut().for_each(|axis| axis.chain = None);
    let options = AnalysisOptions::default();
    let with = summarise(&signal, &record, &options);
    let without = summarise(&chainless, &record, &options);
    for ((axis, with), without) in PublishedAxis::ALL
        .into_iter()
        .zip(with.axes)
        .zip(without.axes)
    {
        let truth = axis.coefficients();
        let with = with.fits.likelihood.expect("a fit");
        let without = without.fits.likelihood.expect("a fit");
        for one in [Coefficient::Q, Coefficient::N] {
            let (truth, value) = (*truth.get(one), with.coefficients.get(one));
            let sigma = (value.hi.expect("known") - value.lo) / 3.92;
            let error = value.squared.sqrt() - truth;
            assert!(
                error.abs() < 4.0 * sigma,
                "seed {seed}, {axis:?} {one:?}: {error:e}, sigma {sigma:e}"
            );
        }
        for one in [Coefficient::B, Coefficient::K] {
            // A minute bounds them at best.
            let (truth, value) = (*truth.get(one), with.coefficients.get(one));
            let most = value.upper.or(value.hi).unwrap_or(f64::INFINITY);
            assert!(
                truth < 1.5 * most,
                "seed {seed}, {axis:?} {one:?}: {value:?}"
            );
        }
        assert_eq!(with.allowance_percent, 0.0, "seed {seed}, {axis:?}");
        assert!(with.left_out_hz.is_empty(), "seed {seed}, {axis:?}");
        // Blind to the chain, the fit says that something is wrong, and is.
        assert!(
            without.allowance_percent > 0.0 && !without.left_out_hz.is_empty(),
            "seed {seed}, {axis:?}"
        );
        let aware = with.coefficients.q;
        let sigma = (aware.hi.expect("known") - aware.lo) / 3.92;
        let blind = without.coefficients.q.squared.sqrt();
        println!(
            "{axis:?}: without the chain Q is {:+.1} % off, {:.0} standard deviations of the fit with it",
            100.0 * (blind / truth.q - 1.0),
            (blind - truth.q) / sigma
        );
        assert!(
            (blind - truth.q).abs() > 10.0 * sigma,
            "seed {seed}, {axis:?}: {blind:e} without the chain"
        );
    }
}
