//! The published fit and the weighted fit on data simulated from the published table.
//!
//! Simulates records of 1.5 h at 2000 samples a second from each axis of the table, fits both,
//! and prints bias, scatter and rms error of every coefficient, and how often the weighted
//! fit's interval covers the truth:
//!
//! ```text
//! cargo run --release -p inm-host --example study_published -- [RECORDS [FIRST_SEED [OVERLAP]]]
//! ```

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use inm_host::analyse::{AnalysisOptions, Fits, Overlap, analyse};
use inm_host::model::published::{DURATION_S, PublishedAxis, RATE_HZ};
use inm_host::model::whole::Model;
use inm_host::model::{Coefficient, PerCoefficient};
use inm_host::simulate::source::Simulation;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default| {
        arguments
            .next()
            .map_or(Ok(default), |text| text.parse::<u64>())
            .unwrap_or(default)
    };
    let (records, first_seed) = (number(50), number(1));
    let full = number(0) == 1;
    let options = AnalysisOptions {
        overlap: if full {
            Overlap::Full
        } else {
            Overlap::Strided
        },
        ..Default::default()
    };
    println!("{records} records an axis of {DURATION_S} s at {RATE_HZ}/s, seeds from {first_seed}");
    for axis in PublishedAxis::ALL {
        let truth = axis.coefficients();
        let fits = simulate_and_fit(axis, first_seed..first_seed + records, &options);
        print_axis(axis, &truth, &fits);
    }
}

fn simulate_and_fit(
    axis: PublishedAxis,
    seeds: std::ops::Range<u64>,
    options: &AnalysisOptions,
) -> Vec<Fits> {
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
            let analysis =
                analyse(&mut simulation, options, |_| {}).expect("a simulation does not fail");
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

fn print_axis(axis: PublishedAxis, truth: &PerCoefficient<f64>, fits: &[Fits]) {
    println!("\naxis {}: relative to the truth, percent", axis.name());
    println!(
        "  {:<2} {:>10} | {:>9} {:>9} {:>9} {:>8} | {:>9} {:>9} {:>9} {:>7} {:>8}",
        "", "truth", "published", "", "", "negative", "weighted", "", "", "at zero", "interval"
    );
    println!(
        "  {:<2} {:>10} | {:>9} {:>9} {:>9} {:>8} | {:>9} {:>9} {:>9} {:>7} {:>8}",
        "", "", "bias", "scatter", "rms", "squares", "bias", "scatter", "rms", "", "covers"
    );
    for coefficient in Coefficient::ALL.into_iter().rev() {
        let truth = *truth.get(coefficient);
        // A negative square enters as the coefficient of its size, a clamped one as zero.
        let published = fits.iter().filter_map(|fits| {
            fits.published
                .as_ref()
                .map(|fit| fit.get(coefficient).squared.abs().sqrt())
        });
        let negative = fits
            .iter()
            .filter(|fits| {
                fits.published
                    .as_ref()
                    .is_some_and(|fit| fit.get(coefficient).squared < 0.0)
            })
            .count();
        let weighted: Vec<_> = fits
            .iter()
            .filter_map(|fits| fits.weighted.as_ref().map(|fit| *fit.get(coefficient)))
            .collect();
        let zero = weighted
            .iter()
            .filter(|value| value.value.is_none())
            .count();
        let covered = weighted
            .iter()
            .filter(|value| (value.lo..=value.hi).contains(&truth))
            .count();
        let p = statistics(published, truth);
        let w = statistics(weighted.iter().map(|value| value.squared.sqrt()), truth);
        println!(
            "  {:<2} {truth:>10.3e} | {:>9.3} {:>9.3} {:>9.3} {negative:>8} | {:>9.3} {:>9.3} {:>9.3} {zero:>7} {covered:>5}/{}",
            coefficient.symbol(),
            p[0],
            p[1],
            p[2],
            w[0],
            w[1],
            w[2],
            weighted.len()
        );
    }
}

/// Bias, scatter and rms of the relative error, percent.
fn statistics(values: impl Iterator<Item = f64>, truth: f64) -> [f64; 3] {
    let errors: Vec<f64> = values.map(|value| 100.0 * (value / truth - 1.0)).collect();
    let n = errors.len() as f64;
    let bias = errors.iter().sum::<f64>() / n;
    let square = errors.iter().map(|error| error * error).sum::<f64>() / n;
    [bias, (square - bias * bias).max(0.0).sqrt(), square.sqrt()]
}
