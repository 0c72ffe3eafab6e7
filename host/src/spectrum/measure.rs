//! What the spectrum costs at full size; run by hand:
//! `cargo test --release -p inm-host --lib spectrum::measure -- --ignored --nocapture --test-threads 1`

use super::{
    binning::Settings,
    cascade::Cascade,
    estimate::{Estimate, bins},
    line_tests::white,
    record_lines::search,
};
use std::time::Instant;

/// One and a half hours at 2000/s.
const LEN: usize = 10_800_000;

fn report(what: &str, start: Instant, samples: usize) {
    let elapsed = start.elapsed();
    println!(
        "{what}: {elapsed:.3?}, {:.2} ns a sample",
        elapsed.as_nanos() as f64 / samples as f64
    );
}

#[test]
#[ignore = "a measurement"]
fn speed() {
    let noise = white(1, LEN);
    let codes: Vec<i32> = noise
        .iter()
        .map(|x| (1000.0 * x) as i32 + 260_000_000)
        .collect();
    for _ in 0..5 {
        let mut cascade = Cascade::default();
        let start = Instant::now();
        // Parts of 64 blocks: on a shared machine their lower decile is the program's own time.
        let mut parts = Vec::new();
        for (part, blocks) in codes.chunks(128_000).enumerate() {
            let begin = Instant::now();
            for (index, block) in blocks.chunks(2000).enumerate() {
                cascade
                    .push_codes((128_000 * part + 2000 * index) as u64, block)
                    .unwrap();
            }
            parts.push(begin.elapsed().as_nanos() as f64 / blocks.len() as f64);
        }
        report("cascade", start, LEN);
        parts.sort_by(f64::total_cmp);
        println!(
            "cascade, lower decile of parts: {:.2} ns a sample",
            parts[parts.len() / 10]
        );
        let start = Instant::now();
        let count = bins(&cascade, 2000.0, &Settings::default()).len();
        report(&format!("{count} bins"), start, LEN);
        let start = Instant::now();
        let estimate = Estimate::new(&cascade, 2000.0, &Settings::default());
        report("estimate with operator and covariance", start, LEN);
        let nodes = estimate.operator.nodes_hz().len();
        let start = Instant::now();
        std::hint::black_box(estimate.expected(|f_hz| 1.0 / f_hz));
        report(&format!("expectation over {nodes} nodes"), start, LEN);
    }
    let start = Instant::now();
    search(&codes[..], 2000.0, 0.05).unwrap();
    report("whole-record lines", start, LEN);
}
