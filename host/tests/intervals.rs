//! Do the 95 % intervals hold the truth in 95 % of records?
//!
//! The short form runs with the other tests; `cargo xtask study intervals` runs the long one,
//! which prints a table.

use inm_allan::Statistic;
use inm_allan::edf::{Noise, edf};
use inm_host::internals::bins::point::{interval, points};
use inm_host::internals::bins::strided::Strided;
use inm_host::internals::model::{Coefficient, Seed};

/// Samples of a record; above averaging factor 40 the bins are strided.
const SAMPLES: usize = 1024;

const NOISES: [(Coefficient, Noise); 4] = [
    (Coefficient::Q, Noise::Quantisation),
    (Coefficient::N, Noise::White),
    (Coefficient::B, Noise::Flicker),
    (Coefficient::K, Noise::Walk),
];

const STATISTICS: [Statistic; 3] = [Statistic::Allan, Statistic::Modified, Statistic::Hadamard];

/// What became of one averaging time over all records.
struct Coverage {
    statistic: Statistic,
    noise: Noise,
    m: u64,
    edf: f64,
    /// Percent of records whose interval holds the truth, the noise type being known.
    known: f64,
    /// The same where the type is identified from the record.
    identified: f64,
}

/// The estimate of one record, and the ends of its interval with the noise type identified.
struct Drawn {
    variance: f64,
    lo: f64,
    hi: f64,
}

/// Simulates `records` of one noise and tries every statistic and averaging time.
fn coverage(coefficient: Coefficient, noise: Noise, records: usize, seed: u64) -> Vec<Coverage> {
    let mut drawn: Vec<Vec<Vec<Drawn>>> = STATISTICS.map(|_| Vec::new()).into();
    let mut degrees: Vec<Vec<(u64, f64)>> = STATISTICS.map(|_| Vec::new()).into();
    for record in 0..records as u64 {
        let stream = Seed {
            seed,
            stream: record,
        };
        let mut samples = vec![0.0; SAMPLES];
        coefficient
            .term(1.0)
            .generator(1.0, stream)
            .add_to(&mut samples);
        let mut bins = Strided::default();
        bins.push_floats(&samples);
        for (k, statistic) in STATISTICS.into_iter().enumerate() {
            let estimates = bins.estimates(statistic);
            if record == 0 {
                let of = |one: &inm_allan::Estimate| {
                    (one.m, edf(statistic, noise, one.m, one.stride, one.terms))
                };
                degrees[k] = estimates.iter().map(of).collect();
                drawn[k].resize_with(estimates.len(), Vec::new);
            }
            for (all, point) in drawn[k]
                .iter_mut()
                .zip(points(statistic, &estimates, 1.0, 1.0))
            {
                all.push(Drawn {
                    variance: point.variance,
                    lo: point.lo,
                    hi: point.hi,
                });
            }
        }
    }
    let mut result = Vec::new();
    for ((statistic, degrees), drawn) in STATISTICS.into_iter().zip(degrees).zip(drawn) {
        for ((m, edf), drawn) in degrees.into_iter().zip(drawn) {
            // The mean of thousands of records is the truth to a few percent of an interval,
            // which moves the coverage by less than a tenth of a point.
            let truth = drawn.iter().map(|one| one.variance).sum::<f64>() / drawn.len() as f64;
            let (lo, hi) = interval(1.0, edf);
            let percent = |holds: &dyn Fn(&Drawn) -> bool| {
                100.0 * drawn.iter().filter(|one| holds(one)).count() as f64 / drawn.len() as f64
            };
            result.push(Coverage {
                statistic,
                noise,
                m,
                edf,
                known: percent(&|one| {
                    (one.variance * lo * lo..=one.variance * hi * hi).contains(&truth)
                }),
                identified: percent(&|one| (one.lo * one.lo..=one.hi * one.hi).contains(&truth)),
            });
        }
    }
    result
}

/// How far from 95 % the coverage may be where the noise type is known, in points.
fn allowance(edf: f64) -> Option<f64> {
    match edf {
        10.0.. => Some(1.5),
        3.0.. => Some(3.5),
        _ => None,
    }
}

/// Least coverage, percent, where the type is identified.
const LEAST_IDENTIFIED: f64 = 88.0;

/// Standard deviation, in points, of a coverage of 95 % found from `records`.
fn sampling_error(records: usize) -> f64 {
    100.0 * (0.95 * 0.05 / records as f64).sqrt()
}

#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    const RECORDS: usize = 400;
    const SEED: u64 = 7;
    // Of some hundred coverages, none should lie four sampling errors beyond what is allowed.
    let slack = 4.0 * sampling_error(RECORDS);
    for (coefficient, noise) in NOISES {
        for one in coverage(coefficient, noise, RECORDS, SEED) {
            let Coverage {
                statistic,
                m,
                edf,
                known,
                identified,
                ..
            } = one;
            let Some(allowance) = allowance(edf) else {
                continue;
            };
            assert!(
                (known - 95.0).abs() < allowance + slack,
                "{noise:?} {statistic:?} m={m} edf={edf:.1}: {known} %, seed {SEED}"
            );
            assert!(
                identified > LEAST_IDENTIFIED - slack,
                "{noise:?} {statistic:?} m={m} edf={edf:.1}: {identified} % identified, seed {SEED}"
            );
        }
    }
}

#[test]
#[ignore = "minutes; run by `cargo xtask study intervals`"]
fn study() {
    const RECORDS: usize = 8000;
    const SEED: u64 = 1;
    println!(
        "coverage of the 95 % interval over {RECORDS} records of {SAMPLES} samples, seed {SEED}, \
         percent (sampling error {:.2} points)",
        sampling_error(RECORDS)
    );
    println!(
        "{:<13}{:<10}{:>7}{:>8}  known: {:>6}{:>7}{:>7}  identified: {:>6}{:>7}",
        "noise", "statistic", "edf", "points", "least", "most", "off", "least", "at m"
    );
    let mut failed = 0;
    for (coefficient, noise) in NOISES {
        let all = coverage(coefficient, noise, RECORDS, SEED);
        for statistic in STATISTICS {
            for (name, class) in [("10 on", 10.0..f64::INFINITY), ("3 to 10", 3.0..10.0)] {
                let here: Vec<_> = all
                    .iter()
                    .filter(|one| one.statistic == statistic && class.contains(&one.edf))
                    .collect();
                let Some(worst) = here
                    .iter()
                    .min_by(|a, b| a.identified.total_cmp(&b.identified))
                else {
                    continue;
                };
                let least = here.iter().map(|one| one.known).fold(100.0, f64::min);
                let most = here.iter().map(|one| one.known).fold(0.0, f64::max);
                let off = (95.0 - least).max(most - 95.0);
                println!(
                    "{:<13}{:<10}{name:>7}{:>8}  {:>13.2}{most:>7.2}{off:>7.2}  {:>18.2}{:>7}",
                    format!("{:?}", worst.noise),
                    format!("{statistic:?}"),
                    here.len(),
                    least,
                    worst.identified,
                    worst.m
                );
                let allowed = allowance(class.start).unwrap_or(0.0);
                failed += usize::from(off > allowed || worst.identified < LEAST_IDENTIFIED);
            }
        }
    }
    assert_eq!(failed, 0, "lines beyond what is claimed");
}
