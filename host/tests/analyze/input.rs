//! What it reads: layouts of arrays, standard streams, gaps.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{inm, npy, succeed};

/// Every element type, byte order and memory order gives the same result.
#[test]
fn array_layouts_agree() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let columns: [Vec<i16>; 2] = [1, 5].map(|k| {
        (0..300_i32)
            .map(|i| ((i * 37 + k * i * i) % 101) as i16)
            .collect()
    });
    let rows = || (0..300).flat_map(|row| columns.iter().map(move |column| column[row]));
    let by_column = || columns.iter().flatten().copied();
    let files = [
        (
            "a.npy",
            npy(
                "'<i2'",
                "False",
                "(300, 2)",
                &rows().flat_map(i16::to_le_bytes).collect::<Vec<_>>(),
            ),
        ),
        (
            "b.npy",
            npy(
                "'>i2'",
                "True",
                "(300, 2)",
                &by_column().flat_map(i16::to_be_bytes).collect::<Vec<_>>(),
            ),
        ),
        (
            "c.npy",
            npy(
                "'>f4'",
                "False",
                "(300, 2)",
                &rows()
                    .flat_map(|v| f32::from(v).to_be_bytes())
                    .collect::<Vec<_>>(),
            ),
        ),
        (
            "d.npy",
            npy(
                "'<f8'",
                "True",
                "(300, 2)",
                &by_column()
                    .flat_map(|v| f64::from(v).to_le_bytes())
                    .collect::<Vec<_>>(),
            ),
        ),
        (
            "e.npy",
            npy(
                "'<i8'",
                "False",
                "(300, 2)",
                &rows()
                    .flat_map(|v| i64::from(v).to_le_bytes())
                    .collect::<Vec<_>>(),
            ),
        ),
    ];
    let analyse = |name: &str| {
        let json = succeed(
            folder.path(),
            &[
                "analyze",
                name,
                "--rate",
                "50",
                "--unit",
                "counts",
                "--columns",
                "1,0",
                "--json",
                "-",
            ],
        );
        let json: Value = serde_json::from_str(&json).expect("JSON");
        json["axes"].clone()
    };
    for (name, bytes) in &files {
        fs::write(folder.path().join(name), bytes).expect("written");
    }
    let text: String = (0..300)
        .map(|row| format!("{},{}\n", columns[0][row], columns[1][row]))
        .collect();
    fs::write(folder.path().join("f.csv"), format!("# two axes\n{text}")).expect("written");
    let first = analyse("a.npy");
    for name in ["b.npy", "c.npy", "d.npy", "e.npy", "f.csv"] {
        for axis in 0..2 {
            // Codes and floats are summed on different grids: equal to rounding.
            let points = |axes: &Value| -> Vec<f64> {
                let curve = axes[axis]["allan"].as_array().expect("points").clone();
                curve
                    .iter()
                    .map(|point| point["adev"].as_f64().expect("number"))
                    .collect()
            };
            for (a, b) in points(&first).into_iter().zip(points(&analyse(name))) {
                assert!((a / b - 1.0).abs() < 1e-9, "{name} axis {axis}: {a} {b}");
            }
        }
    }
}

/// A gap of known length, in the table and in the JSON, and NaN in the middle of one axis.
#[test]
fn gaps_and_missing_values_are_counted() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut text = String::from("t,x,y\n");
    for row in 0..400 {
        let time = f64::from(row) * 0.01 + if row >= 200 { 1.0 } else { 0.0 };
        let y = if (50..53).contains(&row) {
            "nan".into()
        } else {
            (row * 13 % 7).to_string()
        };
        text.push_str(&format!("{time:.2},{},{y}\n", row * 29 % 11));
    }
    fs::write(folder.path().join("gap.csv"), text).expect("written");
    let json = succeed(
        folder.path(),
        &[
            "analyze", "gap.csv", "--time", "t", "--unit", "g", "--json", "-",
        ],
    );
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["source"]["samples"], 400);
    assert_eq!(json["source"]["lost_samples"], 100);
    assert_eq!(json["source"]["gaps"][0]["samples"], 100);
    assert_eq!(json["axes"][0]["invalid_samples"], 0);
    assert_eq!(json["axes"][1]["invalid_samples"], 3);
    let table = succeed(
        folder.path(),
        &["analyze", "gap.csv", "--time", "t", "--unit", "g"],
    );
    assert!(
        table.contains("1 gap, 100 samples known to be missing"),
        "{table}"
    );
    assert!(table.contains("3 unusable samples left out"), "{table}");
}

/// Standard input works like a file; a reader that goes away is no error.
#[test]
fn standard_streams() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let bytes = succeed_bytes(
        folder.path(),
        &[
            "simulate",
            "--model",
            "published:Y",
            "-o",
            "-",
            "--duration",
            "3",
        ],
    );
    let output = inm(
        folder.path(),
        &["analyze", "-", "--rate", "2000", "--unit", "m/s^2"],
    )
    .write_stdin(bytes)
    .assert()
    .success()
    .get_output()
    .clone();
    let table = String::from_utf8(output.stdout).expect("text");
    assert!(
        table.starts_with("standard input: 6 000 samples an axis at 2000/s"),
        "{table}"
    );
}

fn succeed_bytes(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    inm(folder, arguments)
        .assert()
        .success()
        .get_output()
        .stdout
        .clone()
}
