//! Compares full overlap with tables that Stable32 printed.
//!
//! `stable32 SERIES phase|frequency NOMINAL TABLE...`: SERIES has a number a line, of phase, or of
//! frequency as a multiple of NOMINAL; each TABLE is a result file. Prints the largest relative
//! deviation of each table, and where; sigma there has five digits, so half a unit of the last is
//! up to 5e-5. Tables of statistics that have no estimator here are named and left out.

use std::process::ExitCode;

use inm_allan::{Statistic, full};

/// What a table holds, by its header.
enum Kind {
    /// A deviation that full overlap gives.
    Deviation(Statistic),
    /// Time deviation: the modified Allan deviation times tau over the root of three.
    Time,
}

fn kind(table: &str) -> Result<Kind, &str> {
    let line = table
        .lines()
        .find_map(|line| line.strip_prefix("# Sigma Type:"));
    match line.map_or("", str::trim) {
        "Overlapping Allan" => Ok(Kind::Deviation(Statistic::Allan)),
        "Modified Allan" => Ok(Kind::Deviation(Statistic::Modified)),
        "Overlapping Hadamard" => Ok(Kind::Deviation(Statistic::Hadamard)),
        "Time" => Ok(Kind::Time),
        other => Err(other),
    }
}

/// The numbers of each line that is not a comment.
fn numbers(text: &str) -> impl Iterator<Item = Vec<f64>> + '_ {
    text.lines()
        .filter(|line| !line.trim_start().starts_with('#') && !line.trim().is_empty())
        .map(|line| {
            line.split_whitespace()
                .filter_map(|word| word.parse().ok())
                .collect()
        })
}

/// One table's worst line.
fn compare(samples: &[f64], table: &str, kind: &Kind) -> String {
    let (mut lines, mut counts_differ) = (0, 0);
    let (mut worst, mut at) = (0.0_f64, String::new());
    for row in numbers(table) {
        let [factor, tau_s, count, _alpha, _low, sigma, ..] = row[..] else {
            continue;
        };
        let statistic = match kind {
            Kind::Deviation(statistic) => *statistic,
            Kind::Time => Statistic::Modified,
        };
        let Some(estimate) = full::floats(statistic, &[samples], factor as u64) else {
            at += &format!(" nothing at m = {factor};");
            continue;
        };
        let deviation = match kind {
            Kind::Deviation(_) => estimate.deviation(),
            Kind::Time => estimate.deviation() * tau_s / 3.0_f64.sqrt(),
        };
        lines += 1;
        counts_differ += u32::from(estimate.terms != count as u64);
        let relative = (deviation / sigma - 1.0).abs();
        if relative > worst {
            worst = relative;
            at = format!("m = {factor}: {deviation:.6e}, table {sigma:.4e}");
        }
    }
    format!(
        "{lines:>4} lines, {counts_differ} with another number of terms, worst {worst:.1e} at {at}"
    )
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [series, form, nominal, tables @ ..] = &arguments[..] else {
        eprintln!("usage: stable32 SERIES phase|frequency NOMINAL TABLE...");
        return ExitCode::from(2);
    };
    let (Ok(text), Ok(nominal)) = (std::fs::read_to_string(series), nominal.parse::<f64>()) else {
        eprintln!("stable32: cannot read {series}, or {nominal} is no number");
        return ExitCode::from(2);
    };
    let values: Vec<f64> = numbers(&text)
        .filter_map(|row| row.first().copied())
        .collect();
    let samples: Vec<f64> = if form == "phase" {
        values.windows(2).map(|pair| pair[1] - pair[0]).collect()
    } else {
        values.iter().map(|value| value / nominal).collect()
    };
    println!("{series}: {} values", values.len());
    for path in tables {
        let Ok(table) = std::fs::read_to_string(path) else {
            println!("  {path}: cannot be read");
            continue;
        };
        let name = path.rsplit('/').next().unwrap_or(path);
        match kind(&table) {
            Ok(kind) => println!("  {name:<28} {}", compare(&samples, &table, &kind)),
            Err(other) => println!("  {name:<28} `{other}`: no estimator here"),
        }
    }
    ExitCode::SUCCESS
}
