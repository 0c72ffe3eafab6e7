//! What it says: printed digits, JSON, the whole path from simulation to report.

use std::fs;

use serde_json::Value;

use super::{nbs_set, npy, succeed};

/// Table 31 of NIST SP 1065: deviations at 1, 10 and 100 samples, every overlap, seven digits.
#[test]
fn nbs_set_to_the_printed_digits() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let text: String = nbs_set()
        .iter()
        .map(|value| format!("{value:?}\n"))
        .collect();
    fs::write(folder.path().join("nbs.txt"), text).expect("written");
    let json = succeed(
        folder.path(),
        &[
            "analyze", "nbs.txt", "--rate", "1", "--unit", "counts", "--taus", "1,10,100",
            "--json", "-",
        ],
    );
    let json: Value = serde_json::from_str(&json).expect("JSON");
    let axis = &json["axes"][0];
    assert_eq!(axis["overlap"], "full");
    for (curve, published) in [
        ("allan", [0.292_231_9, 0.091_599_53, 0.032_413_43]),
        ("modified", [0.292_231_9, 0.061_723_76, 0.021_709_21]),
        ("hadamard", [0.294_388_3, 0.095_810_83, 0.032_376_38]),
    ] {
        for (point, published) in axis[curve]
            .as_array()
            .expect("points")
            .iter()
            .zip(published)
        {
            let relative = point["adev"].as_f64().expect("number") / published - 1.0;
            assert!(relative.abs() < 5e-7, "{curve} {point}: {relative:e}");
        }
    }
}

#[test]
fn the_json_result() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let samples: Vec<u8> = (0..64_i32)
        .flat_map(|i| (i * i * 37 % 101 - 50).to_le_bytes())
        .collect();
    fs::write(
        folder.path().join("small.npy"),
        npy("'<i4'", "False", "(64,)", &samples),
    )
    .expect("written");
    let json = succeed(
        folder.path(),
        &[
            "analyze",
            "small.npy",
            "--rate",
            "10",
            "--scale",
            "0.5",
            "--unit",
            "g",
            "--taus",
            "octave",
            "--json",
            "-",
        ],
    );
    insta::assert_snapshot!(rounded(&json));
}

/// The same text, its numbers with five significant digits.
///
/// Sixty-four samples leave the top of the likelihood flat: from one start or another, on one
/// processor or another, its coefficients agree to a millionth.
fn rounded(json: &str) -> String {
    json.lines()
        .map(|line| {
            let place = line.rfind([' ', ':']).map_or(0, |space| space + 1);
            let (key, value) = line.split_at(place);
            let number = value.trim_end_matches(',');
            match number.parse::<f64>() {
                Ok(parsed) if number.contains(['.', 'e']) => {
                    format!("{key}{parsed:.4e}{}\n", &value[number.len()..])
                }
                _ => format!("{line}\n"),
            }
        })
        .collect()
}

/// The same seed gives the same bytes, another seed others; page and bitmap are whole.
#[test]
fn simulate_and_report() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let simulate = |name: &str, seed: &str| {
        succeed(
            folder.path(),
            &[
                "simulate",
                "--model",
                "published",
                "-o",
                name,
                "--seed",
                seed,
                "--duration",
                "20",
            ],
        );
        fs::read(folder.path().join(name)).expect("written")
    };
    let (first, again, other) = (
        simulate("a.npy", "7"),
        simulate("b.npy", "7"),
        simulate("c.npy", "8"),
    );
    assert_eq!(first, again);
    assert_ne!(first, other);
    succeed(
        folder.path(),
        &[
            "analyze", "a.npy", "--rate", "2000", "--unit", "m/s^2", "--report", "r.html", "--png",
            "r.png",
        ],
    );
    let page = fs::read_to_string(folder.path().join("r.html")).expect("written");
    assert!(
        page.ends_with("</html>\n") && page.matches("<section>").count() == 4,
        "three axes"
    );
    assert!(!page.contains("http"), "nothing from elsewhere");
    let bitmap = fs::read(folder.path().join("r.png")).expect("written");
    assert!(bitmap.starts_with(b"\x89PNG\r\n\x1a\n") && bitmap.len() > 20_000);
}
