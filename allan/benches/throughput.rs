//! Nanoseconds a sample of the streaming bins, for codes like a converter's and for adversarial
//! ones. Prints a table; `cargo bench -p inm-allan [--features simd] [-- PART-OF-NAME]`.

use std::hint::black_box;
use std::time::Instant;

use inm_allan::{AllanBins, BoardBins, FloatBins, HostBins, Statistic, fixed_point::FixedPoint};

/// Short enough that some runs of a busy machine's time slices hold a whole one.
const SAMPLES: usize = 200_000;
const REPEATS: usize = 200;

/// The best of many runs, in nanoseconds a sample.
fn time(name: &str, mut run: impl FnMut()) {
    if std::env::args()
        .skip(1)
        .any(|only| !only.starts_with('-') && !name.contains(&only))
    {
        return;
    }
    let best = (0..REPEATS)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e9 / SAMPLES as f64
        })
        .fold(f64::INFINITY, f64::min);
    println!("{name:<50} {best:7.2} ns/sample");
}

/// Normal-looking noise of the given standard deviation on an offset, from a fixed seed.
fn noise(sigma: f64) -> Vec<i32> {
    let mut state = 0x1234_5678_9ABC_DEF1_u64;
    (0..SAMPLES)
        .map(|_| {
            let mut sum = 0.0;
            for _ in 0..4 {
                state ^= state >> 12;
                state ^= state << 25;
                state ^= state >> 27;
                sum +=
                    (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64;
            }
            (9_000_000.0 + sigma * (sum - 2.0) * 3.0_f64.sqrt()) as i32
        })
        .collect()
}

fn main() {
    let quiet = noise(3000.0);
    let loud = noise(3e7);
    let extreme: Vec<i32> = (0..SAMPLES).map(|i| [i32::MIN, i32::MAX][i % 2]).collect();
    let samples: Vec<f64> = quiet.iter().map(|&code| f64::from(code) * 1e-7).collect();

    for (name, codes) in [
        ("noise of 3e3 counts", &quiet),
        ("noise of 3e7 counts", &loud),
        ("full scale alternating", &extreme),
    ] {
        time(&format!("one code at a time, Allan, {name}"), || {
            let mut bins = Box::new(BoardBins::new());
            codes.iter().for_each(|&code| bins.push(code));
            black_box(bins.digest());
        });
        time(&format!("slices, Allan, {name}"), || {
            let mut bins = Box::new(AllanBins::<25>::new());
            bins.push_slice(codes);
            black_box(bins.digest());
        });
        time(&format!("slices, all three, {name}"), || {
            let mut bins = Box::new(HostBins::new());
            bins.push_slice(codes);
            black_box(bins.points(Statistic::Modified).count());
        });
    }
    time("slices, all three, f64", || {
        let grid = FixedPoint::covering(samples.iter().copied(), 1.0);
        let mut bins = Box::new(FloatBins::<25>::new(grid));
        bins.push_slice(&samples).expect("the grid covers them");
        black_box(bins.points(Statistic::Modified).count());
    });
}
