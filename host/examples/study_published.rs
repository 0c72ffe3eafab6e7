//! The published, the weighted and the likelihood fit on data simulated from the published table.
//!
//! Simulates records of 1.5 h at 2000 samples a second from each axis of the table, applies all
//! three fits to each, and prints bias, scatter and rms error of every coefficient, the rms over
//! the Cramér-Rao bound, and how often the 95 % interval holds the truth:
//!
//! ```text
//! cargo xtask study published [--records N]
//! cargo run --release -p inm-host --example study_published -- [RECORDS [FIRST_SEED]]
//! ```
//!
//! Estimates that are not resolved from zero enter with their best value; none is left out.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use inm_host::internals::analyse::{AnalysisOptions, Fits, analyse};
use inm_host::internals::fit::design::Design;
use inm_host::internals::fit::likelihood::{components::SEEN, information, whittle};
use inm_host::internals::model::published::{DURATION_S, PublishedAxis, RATE_HZ};
use inm_host::internals::model::whole::Model;
use inm_host::internals::model::{Coefficient, PerCoefficient};
use inm_host::internals::simulate::source::Simulation;

/// Distance of the axes' first seeds.
const SEEDS_PER_AXIS: u64 = 1_000_000;

/// Coefficients that the record tells, and their place in a table.
const TOLD: [Coefficient; 4] = [
    Coefficient::Q,
    Coefficient::N,
    Coefficient::B,
    Coefficient::K,
];

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default| {
        arguments
            .next()
            .map_or(Ok(default), |text| text.parse::<u64>())
            .unwrap_or(default)
    };
    let (records, first_seed) = (number(400), number(1));
    println!(
        "{records} records an axis of {DURATION_S} s at {RATE_HZ}/s, seeds from {first_seed}; \
         percent of the truth\n"
    );
    println!(
        "{:<6} {:>6} | {:>24} | {:>32} | {:>32}",
        "", "", "published fit", "weighted fit", "likelihood fit"
    );
    println!(
        "{:<6} {:>6} | {:>8} {:>8} {:>6} | {:>8} {:>8} {:>5} {:>8} | {:>8} {:>8} {:>5} {:>8}",
        "",
        "bound",
        "bias",
        "rms",
        "neg.",
        "bias",
        "rms",
        "/bnd",
        "covers",
        "bias",
        "rms",
        "/bnd",
        "covers"
    );
    // Squared ratios of rms to bound, over axes.
    let mut pooled = [[0.0; TOLD.len()]; 2];
    for (number, axis) in (0..).zip(PublishedAxis::ALL) {
        let truth = axis.coefficients();
        // Seeds of its own: the axes' errors are independent.
        let seeds = first_seed + number * SEEDS_PER_AXIS;
        let fits = simulate_and_fit(axis, seeds..seeds + records);
        let bounds = bounds(&truth);
        for (place, one) in TOLD.into_iter().enumerate() {
            let ratios = print_row(axis, one, *truth.get(one), *bounds.get(one), &fits);
            for (pooled, ratio) in pooled.iter_mut().zip(ratios) {
                pooled[place] += ratio * ratio / PublishedAxis::ALL.len() as f64;
            }
        }
        print_ramp(axis, truth.r, &fits);
    }
    for (name, squares) in ["weighted", "likelihood"].into_iter().zip(pooled) {
        let cells = TOLD.iter().zip(squares);
        let text: Vec<String> = cells
            .map(|(one, square)| format!("{} {:.3}", one.symbol(), square.sqrt()))
            .collect();
        println!(
            "rms over bound, pooled over axes, {name}: {}",
            text.join(", ")
        );
    }
    let scatter = 100.0 * (0.5 / records as f64).sqrt();
    let coverage = 300.0 * (0.95 * 0.05 / records as f64).sqrt();
    println!(
        "from {records} records an rms is known to {scatter:.1} % (one sigma), a coverage of 95 % to \
         {coverage:.1} points (three sigma)"
    );
}

/// Relative standard deviation of every coefficient at the Cramér-Rao bound, percent; zero for the
/// ramp.
fn bounds(truth: &PerCoefficient<f64>) -> PerCoefficient<f64> {
    let squares = PerCoefficient::from_fn(|one| truth.get(one).powi(2));
    let design = Design::new(RATE_HZ, None);
    let covariance = information::inverse(&whittle::information(&design, &squares, DURATION_S));
    PerCoefficient::from_fn(|one| {
        let place = SEEN.iter().position(|&seen| seen == one);
        // Half of the square's relative deviation is the coefficient's.
        place.map_or(0.0, |i| 50.0 * covariance[(i, i)].sqrt() / squares.get(one))
    })
}

fn simulate_and_fit(axis: PublishedAxis, seeds: std::ops::Range<u64>) -> Vec<Fits> {
    let next = AtomicU64::new(seeds.start);
    let fits = Mutex::new(Vec::new());
    let work = || {
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return;
            }
            let length = (DURATION_S * RATE_HZ) as u64;
            let model = Model::published(Some(axis));
            let mut simulation = Simulation::new(&model, length, seed).expect("a sound model");
            let options = AnalysisOptions::default();
            let analysis =
                analyse(&mut simulation, &options, |_| {}).expect("a simulation does not fail");
            let found = analysis.axes.into_iter().map(|axis| axis.fits);
            fits.lock().expect("no thread panicked").extend(found);
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(work);
        }
    });
    fits.into_inner().expect("no thread panicked")
}

/// Prints one coefficient of one axis; the rms over the bound of the weighted and of the
/// likelihood fit.
fn print_row(
    axis: PublishedAxis,
    one: Coefficient,
    truth: f64,
    bound: f64,
    fits: &[Fits],
) -> [f64; 2] {
    let published: Vec<f64> = fits
        .iter()
        .filter_map(|fits| Some(fits.published.as_ref()?.get(one).squared))
        .collect();
    let weighted: Vec<_> = fits
        .iter()
        .filter_map(|fits| Some(*fits.weighted.as_ref()?.get(one)))
        .collect();
    let likelihood: Vec<_> = fits
        .iter()
        .filter_map(|fits| Some(*fits.likelihood.as_ref()?.coefficients.get(one)))
        .collect();
    assert!([published.len(), weighted.len(), likelihood.len()] == [fits.len(); 3]);
    // A negative square enters as the coefficient of its size.
    let p = statistics(published.iter().map(|squared| squared.abs().sqrt()), truth);
    let w = statistics(weighted.iter().map(|value| value.squared.sqrt()), truth);
    let l = statistics(likelihood.iter().map(|value| value.squared.sqrt()), truth);
    let negative = published.iter().filter(|squared| **squared < 0.0).count();
    let percent = |count: usize| 100.0 * count as f64 / fits.len() as f64;
    let held = |lo: f64, hi: f64| lo <= truth && truth <= hi;
    let of_weighted = weighted.iter().filter(|v| held(v.lo, v.hi)).count();
    let of_likelihood = likelihood
        .iter()
        .filter(|v| held(v.lo, v.hi.unwrap_or(f64::INFINITY)))
        .count();
    println!(
        "{:<2} {:<3} {bound:>6.3} | {:>8.2} {:>8.2} {:>5.0}% | {:>8.3} {:>8.3} {:>5.2} {:>7.1}% | \
         {:>8.3} {:>8.3} {:>5.2} {:>7.1}%",
        axis.name(),
        one.symbol(),
        p[0],
        p[1],
        percent(negative),
        w[0],
        w[1],
        w[1] / bound,
        percent(of_weighted),
        l[0],
        l[1],
        l[1] / bound,
        percent(of_likelihood),
    );
    [w[1] / bound, l[1] / bound]
}

fn print_ramp(axis: PublishedAxis, truth: f64, fits: &[Fits]) {
    let ramps: Vec<_> = fits
        .iter()
        .filter_map(|fits| Some(fits.likelihood.as_ref()?.coefficients.r))
        .collect();
    let count = |holds: &dyn Fn(&inm_host::internals::analyse::LikelihoodValue) -> bool| {
        100.0 * ramps.iter().filter(|ramp| holds(ramp)).count() as f64 / fits.len() as f64
    };
    let published: Vec<f64> = fits
        .iter()
        .filter_map(|fits| Some(fits.published.as_ref()?.r.squared.abs().sqrt() / truth))
        .collect();
    let mean_bound: f64 = ramps.iter().filter_map(|ramp| ramp.upper).sum::<f64>()
        / ramps.iter().filter(|ramp| ramp.upper.is_some()).count() as f64;
    println!(
        "{:<2} R   published fit {:.1} times the truth on average; likelihood: not resolved from zero in \
         {:.1} %, bound or interval holds in {:.1} %, mean bound {:.1} times the truth",
        axis.name(),
        published.iter().sum::<f64>() / published.len() as f64,
        count(&|ramp| !ramp.identified),
        count(&|ramp| truth <= ramp.upper.or(ramp.hi).unwrap_or(f64::INFINITY)),
        mean_bound / truth,
    );
}

/// Bias and rms of the relative error, percent.
fn statistics(values: impl Iterator<Item = f64>, truth: f64) -> [f64; 2] {
    let errors: Vec<f64> = values.map(|value| 100.0 * (value / truth - 1.0)).collect();
    let n = errors.len() as f64;
    let bias = errors.iter().sum::<f64>() / n;
    let square = errors.iter().map(|error| error * error).sum::<f64>() / n;
    [bias, square.sqrt()]
}
