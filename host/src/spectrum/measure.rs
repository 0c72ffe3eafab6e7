//! What the spectrum costs and reaches at full size; run by hand:
//! `cargo test --release -p inm-host --lib spectrum::measure -- --ignored --nocapture --test-threads 1`

use super::{
    binning::Settings,
    cascade::Cascade,
    estimate::{Estimate, bins},
    line_tests::{add_tone, ideal_amplitude, white},
    lines::LineSearch,
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
    let mut lines = LineSearch::default();
    let start = Instant::now();
    for (index, block) in codes.chunks(2000).enumerate() {
        lines.push_codes(2000 * index as u64, block).unwrap();
    }
    report("streaming lines", start, LEN);
    println!(
        "streaming lines: {} bytes in buffers besides the transform's tables",
        lines.buffer_bytes()
    );
    let start = Instant::now();
    search(&codes[..], 2000.0, 0.05).unwrap();
    report("whole-record lines", start, LEN);
}

#[test]
#[ignore = "a measurement"]
fn reach_of_the_streaming_search_after_one_and_a_half_hours() {
    let count = 60;
    let amplitude = ideal_amplitude(LEN, 0.05);
    for factor in [1.4, 1.5, 1.6] {
        let (mut found, mut alarms) = (0, 0);
        for seed in 0..count {
            let cycles = 0.05 + 0.4 * (0.618_033_99 * (seed + 1) as f64).fract();
            let mut record = white(1000 + seed, LEN);
            add_tone(&mut record, factor * amplitude, cycles, seed as f64);
            let mut search = LineSearch::default();
            search.push_values(0, &record).unwrap();
            let lines = search.lines(1.0, 0.05);
            let near = |f: f64| (f - cycles).abs() < 1e-5;
            found += u64::from(lines.iter().any(|line| near(line.frequency_hz)));
            alarms += u64::from(lines.iter().any(|line| !near(line.frequency_hz)));
        }
        println!("{factor} times the ideal amplitude: {found} of {count} found, {alarms} false");
    }
}
