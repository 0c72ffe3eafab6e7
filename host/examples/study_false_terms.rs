//! How often the likelihood fit claims a term that is not there, and whether its intervals and
//! bounds hold the truth where a term is absent, barely there, or clearly there.
//!
//! ```text
//! cargo xtask study false-terms [--records N]
//! cargo run --release -p inm-host --example study_false_terms -- [RECORDS [FIRST_SEED]]
//! ```

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use inm_host::internals::analyse::LikelihoodFit;
use inm_host::internals::fit::design::Design;
use inm_host::internals::fit::likelihood::{components::SEEN, information, terms, whittle};
use inm_host::internals::model::axis::ModelAxis;
use inm_host::internals::model::whole::{Model, SCHEMA};
use inm_host::internals::model::{Coefficient, PerCoefficient};
use inm_host::internals::signal::Unit;
use inm_host::internals::simulate::source::Simulation;
use inm_host::internals::spectrum::{Cascade, Estimate, Plan, Settings};

const RATE_HZ: f64 = 100.0;

/// A truth to simulate.
struct Case {
    name: String,
    truth: PerCoefficient<f64>,
    length: u64,
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default| {
        arguments
            .next()
            .map_or(Ok(default), |text| text.parse::<u64>())
            .unwrap_or(default)
    };
    let (records, first_seed) = (number(1000), number(1));
    let three_sigma = 300.0 * (0.05 * 0.95 / records as f64).sqrt();
    println!(
        "{records} records a case at {RATE_HZ}/s, seeds from {first_seed}; 5 % and 95 % are known to \
         {three_sigma:.1} points (three sigma)\n"
    );
    println!(
        "{:<34} {:>9} | resolved from zero, percent              | interval holds, percent       | bound not overstepped, percent",
        "case", "samples"
    );
    let heads: Vec<String> = Coefficient::ALL
        .iter()
        .map(|one| format!("{:>5}", one.symbol()))
        .collect();
    let heads = heads.join(" ");
    println!(
        "{:<34} {:>9} | {heads}  any false | {heads} | {heads}",
        "", ""
    );
    for case in cases() {
        let fits = simulate_and_fit(&case, first_seed..first_seed + records);
        print_case(&case, &fits);
    }
}

fn cases() -> Vec<Case> {
    let white = PerCoefficient {
        n: 1.0,
        ..Default::default()
    };
    let mut cases: Vec<Case> = [2_000, 20_000, 200_000]
        .map(|length| Case {
            name: "white noise".into(),
            truth: white,
            length,
        })
        .into();
    for (length, k) in [(20_000, 0.3), (200_000, 0.03), (200_000, 3.0)] {
        cases.push(Case {
            name: format!("white noise and walk, K = {k}"),
            truth: PerCoefficient { k, ..white },
            length,
        });
    }
    // A walk as large as its own uncertainty, and as twice that: at the edge of being seen.
    let length = 200_000;
    for sigmas in [1.0, 2.0] {
        cases.push(Case {
            name: format!("walk at {sigmas} standard deviations"),
            truth: PerCoefficient {
                k: barely(&white, length, sigmas),
                ..white
            },
            length,
        });
    }
    cases.push(Case {
        name: "all but the ramp".into(),
        truth: PerCoefficient {
            r: 0.0,
            k: 0.03,
            b: 0.3,
            n: 1.0,
            q: 0.01,
        },
        length,
    });
    cases.push(Case {
        name: "walk and a ramp four times its due".into(),
        truth: PerCoefficient {
            r: 4.0 * 0.03 / (length as f64 / RATE_HZ).sqrt(),
            k: 0.03,
            ..white
        },
        length,
    });
    cases
}

/// The walk whose square is `sigmas` times its standard deviation at the Cramér-Rao bound beside
/// white and flicker noise.
fn barely(white: &PerCoefficient<f64>, length: u64, sigmas: f64) -> f64 {
    let design = Design::new(RATE_HZ, None);
    let mut k: f64 = 1e-3;
    for _ in 0..50 {
        let squares = PerCoefficient {
            k: k * k,
            n: white.n * white.n,
            ..Default::default()
        };
        let information = whittle::information(&design, &squares, length as f64 / RATE_HZ);
        k = (sigmas * information::inverse(&information)[(0, 0)].sqrt()).sqrt();
    }
    k
}

fn simulate_and_fit(case: &Case, seeds: std::ops::Range<u64>) -> Vec<LikelihoodFit> {
    let next = AtomicU64::new(seeds.start);
    let fits = Mutex::new(Vec::new());
    let design = Design::new(RATE_HZ, None);
    let plan = Plan::new();
    let work = || {
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return;
            }
            let model = Model {
                schema: SCHEMA,
                rate_hz: RATE_HZ,
                axes: vec![ModelAxis {
                    name: "X".into(),
                    unit: Unit::MetrePerSecondSquared,
                    mean: 0.0,
                    chain: None,
                    coefficients: case.truth,
                    effects: Vec::new(),
                }],
                correlation: None,
            };
            let mut simulation = Simulation::new(&model, case.length, seed).expect("a sound model");
            let mut cascade = Cascade::new(&plan);
            let samples = simulation.next_columns(case.length as usize).remove(0);
            cascade.push_values(0, &samples).expect("in order");
            let estimate = Estimate::new(&cascade, RATE_HZ, &Settings::default());
            let fit = terms::fit(&cascade, &estimate, 1.0, &design).expect("a fit");
            fits.lock().expect("no thread panicked").push(fit);
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

fn print_case(case: &Case, fits: &[LikelihoodFit]) {
    let percent = |holds: &dyn Fn(&LikelihoodFit) -> bool| {
        100.0 * fits.iter().filter(|fit| holds(fit)).count() as f64 / fits.len() as f64
    };
    let claimed = Coefficient::ALL.map(|one| {
        let text = percent(&|fit| fit.coefficients.get(one).identified);
        format!("{text:>5.1}")
    });
    let holds = Coefficient::ALL.map(|one| {
        let truth = *case.truth.get(one);
        let text = percent(&|fit| {
            let value = fit.coefficients.get(one);
            value.lo <= truth && truth <= value.hi.unwrap_or(f64::INFINITY)
        });
        format!("{text:>5.1}")
    });
    let bounds = Coefficient::ALL.map(|one| {
        let truth = *case.truth.get(one);
        let text =
            percent(&|fit| truth <= fit.coefficients.get(one).upper.unwrap_or(f64::INFINITY));
        format!("{text:>5.1}")
    });
    let any_false = percent(&|fit| {
        let mut all = SEEN.iter().chain([&Coefficient::R]);
        all.any(|&one| *case.truth.get(one) == 0.0 && fit.coefficients.get(one).identified)
    });
    let misfits = percent(&|fit| fit.allowance_percent > 0.0 || !fit.left_out_hz.is_empty());
    println!(
        "{:<34} {:>9} | {}  {any_false:>9.1} | {} | {}{}",
        case.name,
        case.length,
        claimed.join(" "),
        holds.join(" "),
        bounds.join(" "),
        if misfits > 0.0 {
            format!("  ({misfits:.1} % called a misfit)")
        } else {
            String::new()
        }
    );
}
