//! One contender of `cargo xtask bench`, which runs each as a process of its own.
//!
//! `contender NAME SAMPLES` feeds the same synthetic samples, chunk by chunk as a source would, and
//! prints processor time a sample, peak memory and the Allan deviation at an averaging factor that
//! all contenders evaluate. Making the samples is not timed.
//! `contender write SAMPLES FILE` writes them as an .npy array of f64, for contenders in other
//! languages.

use std::io::{BufWriter, Write};

use allan::{Allan, Config, DataType, Style};
use inm_allan::fixed_point::FixedPoint;
use inm_allan::{AllanBins, BoardBins, Estimate, FloatBins, HostBins, Statistic};

/// Samples handed over at a time.
const CHUNK: usize = 8192;

/// Averaging factor of the deviation that shows that all compute the same.
const COMMON: u64 = 80;

/// Size of a code in the unit of the floating-point samples.
const STEP: f64 = 1e-6;

/// Offset of the codes: about gravity, as an accelerometer has it.
const OFFSET: i32 = 9_806_650;

/// Codes like those of a converter: noise on an offset, from a fixed seed.
struct Codes {
    state: u64,
    left: u64,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    /// Nearly normal noise with steps of the given power of two: deviations of 2^15.2 steps.
    Noise(u32),
    /// Full scale alternating.
    Extreme,
}

impl Codes {
    fn new(kind: Kind, samples: u64) -> Self {
        Self {
            state: 0x9E37_79B9_7F4A_7C15,
            left: samples,
            kind,
        }
    }

    /// Fills `chunk` with the next codes; false at the end.
    fn next(&mut self, chunk: &mut Vec<i32>) -> bool {
        chunk.clear();
        let len = self.left.min(CHUNK as u64);
        self.left -= len;
        for index in 0..len {
            // xorshift64* (Vigna 2016); the sum of four uniform parts is nearly normal.
            self.state ^= self.state >> 12;
            self.state ^= self.state << 25;
            self.state ^= self.state >> 27;
            let random = self.state.wrapping_mul(0x2545_F491_4F6C_DD1D);
            chunk.push(match self.kind {
                Kind::Noise(shift) => {
                    let sum: i64 = (0..4).map(|k| (random >> (16 * k) & 0xFFFF) as i64).sum();
                    let noise = (sum - 131_070) << shift >> 4;
                    OFFSET.saturating_add(noise as i32)
                }
                Kind::Extreme => [i32::MIN, i32::MAX][index as usize % 2],
            });
        }
        len > 0
    }
}

/// Processor time of this process, seconds: other work on the machine does not count, except for
/// what it takes of caches and memory.
fn clock() -> f64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
}

/// Peak resident memory, KiB, where the system tells.
fn peak_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// Feeds all codes to `push`; seconds spent in there.
fn feed(kind: Kind, samples: u64, mut push: impl FnMut(&[i32])) -> f64 {
    let mut codes = Codes::new(kind, samples);
    let mut chunk = Vec::with_capacity(CHUNK);
    let mut seconds = 0.0;
    while codes.next(&mut chunk) {
        let begin = clock();
        push(&chunk);
        seconds += clock() - begin;
    }
    seconds
}

/// Feeds all samples, as floating-point numbers.
fn feed_floats(samples: u64, mut push: impl FnMut(&[f64])) -> f64 {
    let mut floats = Vec::with_capacity(CHUNK);
    let mut converting = 0.0;
    let all = feed(Kind::Noise(0), samples, |chunk| {
        let begin = clock();
        floats.clear();
        floats.extend(chunk.iter().map(|&code| f64::from(code) * STEP));
        converting += clock() - begin;
        push(&floats);
    });
    all - converting
}

fn common(points: impl Iterator<Item = Estimate>, step: f64) -> Option<f64> {
    let mut points = points.filter(|point| point.m == COMMON);
    points.next().map(|point| point.deviation() * step)
}

/// Seconds and the common deviation of one run.
fn run(name: &str, samples: u64) -> Option<(f64, Option<f64>)> {
    let allan = |kind: Kind| {
        let mut bins = Box::new(AllanBins::<25>::new());
        let seconds = feed(kind, samples, |chunk| bins.push_slice(chunk));
        (seconds, common(bins.points(), STEP))
    };
    let three = |kind: Kind| {
        let mut bins = Box::new(HostBins::new());
        let seconds = feed(kind, samples, |chunk| bins.push_slice(chunk));
        (seconds, common(bins.points(Statistic::Allan), STEP))
    };
    // Of the rival: its densest logarithmic spacing, nine averaging times a decade, up to the
    // longest one that a quarter of the record allows.
    let longest = (samples / 4) as usize;
    let rival = Config::new()
        .style(Style::DecadeDeci)
        .max_tau(longest)
        .data_type(DataType::Frequency);
    Some(match name {
        "allan" => allan(Kind::Noise(0)),
        "allan-loud" => allan(Kind::Noise(14)),
        "allan-extreme" => allan(Kind::Extreme),
        "allan-board" => {
            let mut bins = Box::new(BoardBins::new());
            let seconds = feed(Kind::Noise(0), samples, |chunk| {
                chunk.iter().for_each(|&code| bins.push(code));
            });
            (seconds, common(bins.points(), STEP))
        }
        "three" => three(Kind::Noise(0)),
        "three-loud" => three(Kind::Noise(14)),
        "three-extreme" => three(Kind::Extreme),
        "three-floats" => {
            let grid = FixedPoint::covering([9.7, 9.9], 1.0);
            let mut bins = Box::new(FloatBins::<25>::new(grid));
            let seconds = feed_floats(samples, |chunk| {
                bins.push_slice(chunk).expect("the grid covers the noise");
            });
            (seconds, common(bins.points(Statistic::Allan), 1.0))
        }
        "rival" => {
            let mut bins = Allan::with_config(rival);
            let seconds = feed_floats(samples, |chunk| {
                chunk.iter().for_each(|&sample| bins.record(sample));
            });
            let tau = bins.get(COMMON as usize);
            (seconds, tau.and_then(|tau| tau.deviation()))
        }
        _ => return None,
    })
}

/// An .npy file (version 1.0) of the samples.
fn write(samples: u64, path: &str) -> std::io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({samples},), }}");
    // Magic, version and length take ten bytes; the whole is a multiple of 64.
    while !(10 + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    file.write_all(b"\x93NUMPY\x01\x00")?;
    file.write_all(&(header.len() as u16).to_le_bytes())?;
    file.write_all(header.as_bytes())?;
    let mut codes = Codes::new(Kind::Noise(0), samples);
    let mut chunk = Vec::new();
    while codes.next(&mut chunk) {
        for &code in &chunk {
            file.write_all(&(f64::from(code) * STEP).to_le_bytes())?;
        }
    }
    file.flush()
}

fn main() -> std::process::ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let samples = words.get(1).and_then(|word| word.parse::<u64>().ok());
    let done = match (words.as_slice(), samples) {
        (["write", _, path], Some(samples)) => write(samples, path).is_ok(),
        ([name, _], Some(samples)) => {
            let done = run(name, samples);
            if let Some((seconds, deviation)) = done {
                println!(
                    "{} {} {}",
                    seconds * 1e9 / samples as f64,
                    peak_kib().unwrap_or(0),
                    deviation.unwrap_or(f64::NAN)
                );
            }
            done.is_some()
        }
        _ => false,
    };
    if done {
        std::process::ExitCode::SUCCESS
    } else {
        eprintln!("usage: contender NAME SAMPLES | contender write SAMPLES FILE");
        std::process::ExitCode::from(2)
    }
}
