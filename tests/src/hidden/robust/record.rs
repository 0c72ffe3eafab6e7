//! A random record: its samples, and how it gets into a file.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::{content, damage};
use crate::hidden::case::Files;
use crate::hidden::draw::Draw;
use crate::hidden::npy;

/// Longest record, samples, unless a study says otherwise.
pub const LONGEST: usize = 1 << 17;

/// Rates of loggers and converters, samples a second.
const RATES_HZ: [f64; 12] = [
    1.0, 10.0, 25.0, 50.0, 100.0, 125.0, 200.0, 250.0, 819.2, 1000.0, 2000.0, 4000.0,
];

/// How the numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Doubles.
    Double,
    /// Doubles that are multiples of a step.
    Codes,
    /// Single precision.
    Single,
    /// Integers of 16 bits.
    Short,
    /// Integers of 32 bits.
    Long,
    /// Text, a row a sample.
    Text,
    /// Text with a column of stamps.
    Stamped,
}

/// A record of any kind.
#[derive(Debug, Clone)]
pub struct Record {
    /// What settles it, with the length of the longest.
    pub seed: u64,
    /// Samples a second.
    pub rate_hz: f64,
    /// How its numbers are written.
    pub form: Form,
    /// As they stand in the file: codes where it holds codes.
    pub columns: Vec<Vec<f64>>,
    /// What a unit in the file stands for.
    pub scale: f64,
    /// Whether a converter is declared that it has never seen.
    pub chain: bool,
}

impl Record {
    /// The record of this seed, of at most `longest` samples an axis.
    pub fn draw(seed: u64, longest: usize) -> Self {
        let mut draw = Draw::new(seed, "robust");
        let samples = length(longest, &mut draw);
        let rate_hz = match draw.chance(0.6) {
            true => draw.pick(&RATES_HZ),
            false => draw.log_uniform(1e-3, 1e6),
        };
        let axes = if draw.chance(0.7) {
            1
        } else {
            1 + draw.index(8)
        };
        let form = match draw.index(16) {
            0..=6 => Form::Double,
            7 | 8 => Form::Codes,
            9 | 10 => Form::Single,
            11 | 12 => Form::Short,
            13 => Form::Long,
            14 => Form::Text,
            _ => Form::Stamped,
        };
        let alike = draw.chance(0.6);
        let common = size(&mut draw);
        let columns = (0..axes)
            .map(|_| {
                let size = if alike { common } else { size(&mut draw) };
                column(samples, rate_hz, form, size, &mut draw)
            })
            .collect();
        let integers = matches!(form, Form::Short | Form::Long);
        Self {
            seed,
            rate_hz,
            form,
            columns,
            scale: match integers && draw.chance(0.5) {
                true => draw.log_uniform(1e-9, 1e3),
                false => 1.0,
            },
            chain: draw.chance(0.1),
        }
    }

    /// In a line.
    pub fn describe(&self) -> String {
        format!(
            "{} x {} at {:.6}/s, {:?}{}",
            self.columns.len(),
            self.columns[0].len(),
            self.rate_hz,
            self.form,
            if self.chain { ", a chain declared" } else { "" }
        )
    }

    /// Writes it, under a name that says nothing.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<Files> {
        let is_text = matches!(self.form, Form::Text | Form::Stamped);
        let record = folder.join(if is_text { "record.csv" } else { "record.npy" });
        match self.form {
            Form::Double | Form::Codes => self.array(&record, |value| value)?,
            Form::Single => self.array(&record, |value| value as f32)?,
            Form::Short => self.array(&record, |value| value as i16)?,
            Form::Long => self.array(&record, |value| value as i32)?,
            Form::Text | Form::Stamped => std::fs::write(&record, self.text())?,
        }
        let first = usize::from(self.form == Form::Stamped);
        let mut arguments = Vec::new();
        let mut say =
            |words: &[&str]| arguments.extend(words.iter().map(|word| (*word).to_owned()));
        match self.form {
            Form::Stamped => say(&["--time", "t:s"]),
            _ => say(&["--rate", &self.rate_hz.to_string()]),
        }
        say(&["--unit", "m/s^2"]);
        // A record may do nothing but rise, which would be taken for a counter.
        let columns: Vec<String> = (0..self.columns.len())
            .map(|one| format!("{}", one + first))
            .collect();
        say(&["--columns", &columns.join(",")]);
        if matches!(self.form, Form::Short | Form::Long) {
            say(&["--scale", &self.scale.to_string()]);
        }
        if self.chain {
            say(&["--chain", "ads1281:linear+400hz"]);
        }
        Ok(Files { record, arguments })
    }

    fn array<T: npy::Element>(&self, path: &Path, convert: impl Fn(f64) -> T) -> io::Result<()> {
        let one = |column: &Vec<f64>| column.iter().map(|value| convert(*value)).collect();
        let columns: Vec<Vec<T>> = self.columns.iter().map(one).collect();
        let columns: Vec<&[T]> = columns.iter().map(Vec::as_slice).collect();
        npy::write(path, &columns)
    }

    /// A missing value is an empty cell, or `nan`, by turns.
    fn text(&self) -> String {
        let mut text = String::new();
        let stamped = self.form == Form::Stamped;
        if stamped {
            text.push_str("t,");
        }
        let names: Vec<String> = (0..self.columns.len()).map(|i| format!("a{i}")).collect();
        let _ = writeln!(text, "{}", names.join(","));
        for row in 0..self.columns[0].len() {
            let cell = |column: &Vec<f64>| match column[row] {
                value if value.is_nan() && row % 2 == 0 => String::new(),
                value if value.is_nan() => "nan".to_owned(),
                value => value.to_string(),
            };
            let cells: Vec<String> = self.columns.iter().map(cell).collect();
            if stamped {
                let _ = write!(text, "{},", row as f64 / self.rate_hz);
            }
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    }
}

/// Long enough to be diagnosed in three of four; powers of two, primes, one more or less.
fn length(longest: usize, draw: &mut Draw) -> usize {
    let samples = match draw.index(12) {
        0 => draw.index(5),
        1 => draw.log_uniform(4.0, 1000.0) as usize,
        2 => draw.log_uniform(1000.0, 8192.0) as usize,
        _ => draw.log_uniform(8192.0, (longest as f64 + 1.0).max(8192.0)) as usize,
    };
    match draw.index(4) {
        0 => samples.next_power_of_two().min(longest),
        1 => prime_below(samples.min(longest)),
        2 => (samples.next_power_of_two() + 1).min(longest),
        _ => samples.min(longest),
    }
}

/// The largest prime of at most `limit`; `limit` itself where there is none.
pub fn prime_below(limit: usize) -> usize {
    let is_prime = |n: &usize| {
        (2..)
            .take_while(|d| d * d <= *n)
            .all(|d| !n.is_multiple_of(d))
    };
    (2..=limit).rev().find(is_prime).unwrap_or(limit)
}

/// Ordinary, or anything that a double can hold with its square or without.
fn size(draw: &mut Draw) -> f64 {
    match draw.index(10) {
        0..=6 => draw.log_uniform(1e-6, 1e3),
        7 | 8 => draw.log_uniform(1e-100, 1e100),
        _ => draw.log_uniform(1e-300, 1e300),
    }
}

fn column(samples: usize, rate_hz: f64, form: Form, size: f64, draw: &mut Draw) -> Vec<f64> {
    let mut column = content::draw(samples, rate_hz, draw);
    damage::happen(&mut column, draw);
    let offset = draw.pick(&[0.0, 1.0, 10.0, 1e4, -1e7]);
    // Deviations a code: fine, about one, or a few codes in all.
    let step = draw.log_uniform(1e-4, 10.0);
    let mixed = draw.chance(0.02);
    for (i, value) in column.iter_mut().enumerate() {
        *value += offset;
        match form {
            Form::Short => *value = (*value / step).round().clamp(-32768.0, 32767.0),
            Form::Long => *value = (*value / step).round().clamp(-2147483648.0, 2147483647.0),
            Form::Codes => *value = (*value / step).round() * size,
            // Parts of one axis of sizes that no double holds side by side.
            _ if mixed && i > samples / 2 => *value *= 1e-290,
            Form::Single => *value = f64::from((*value * size.clamp(1e-30, 1e30)) as f32),
            _ => *value *= size,
        }
    }
    match form {
        // Integers know no gaps: what is not a number is zero in the file.
        Form::Short | Form::Long => column.iter_mut().for_each(|value| {
            if value.is_nan() {
                *value = 0.0;
            }
        }),
        _ => damage::lose(&mut column, draw),
    }
    column
}
