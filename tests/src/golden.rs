//! Files as a release wrote them, which every later one has to read with the same meaning.
//!
//! `tests/golden` holds a capture of each protocol version, of a virtual board with every kind of message in it, and its
//! analysis, a model with every effect of the catalogue and its law, an analysis, and a diagnosis
//! with its model. Files are added to it, never written anew: what was written once stays readable.

use std::fs;
use std::path::{Path, PathBuf};

use inm_host::Model;
use serde_json::{Value, json};

/// Frequencies of a law, as shares of the rate: both ends and between.
const SHARES: [f64; 5] = [1e-4, 1e-3, 0.01, 0.1, 0.45];

/// Averages of a law, samples.
const AVERAGES: [u64; 4] = [1, 10, 100, 1000];

/// A file of the folder.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("golden")
        .join(name)
}

/// A JSON file.
///
/// # Panics
/// If it cannot be read, with its name.
pub fn json(path: &Path) -> Value {
    let text = fs::read_to_string(path);
    let text = text.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// What a model means: densities, lines and Allan variances of its axes, and their true rates.
pub fn law(model: &Model) -> Value {
    let axes = model.axes.iter().map(|axis| {
        let law = axis.law(model.rate_hz);
        let lines = law.lines();
        let lines: Vec<[f64; 2]> = lines.iter().map(|line| [line.f_hz, line.power]).collect();
        json!({
            "name": axis.name,
            "clock": axis.clock(),
            "density": SHARES.map(|share| law.density(share * model.rate_hz)),
            "lines": lines,
            "allan_variance": AVERAGES.map(|m| law.allan_variance(m)),
        })
    });
    axes.collect()
}
