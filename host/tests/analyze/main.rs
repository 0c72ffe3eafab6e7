//! `inm analyze` and `inm simulate` as a user runs them: on files, through the command line.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

/// The program, in a folder of its own so that messages name files without their folders.
fn inm(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("inm"));
    command.current_dir(folder).args(arguments);
    command
}

/// Runs a command that must succeed and returns its standard output.
fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = inm(folder, arguments)
        .assert()
        .success()
        .get_output()
        .clone();
    String::from_utf8(output.stdout).expect("text")
}

/// Runs a command that must end with exit status 2 and returns its message.
fn fail(folder: &Path, arguments: &[&str]) -> String {
    let output = inm(folder, arguments).assert().code(2).get_output().clone();
    String::from_utf8(output.stderr).expect("text")
}

fn npy(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(
        u16::try_from(header.len())
            .expect("short header")
            .to_le_bytes(),
    );
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// The 1000-point frequency set of NIST SP 1065, section 12.4, from its recurrence
/// `n[i+1] = 16807 n[i] mod 2147483647`, `n[0] = 1234567890`, divided by the modulus.
fn nbs_set() -> Vec<f64> {
    let next = |&n: &u64| Some(16_807 * n % 2_147_483_647);
    std::iter::successors(Some(1_234_567_890_u64), next)
        .take(1000)
        .map(|n| n as f64 / 2_147_483_647.0)
        .collect()
}

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
    // Digits beyond the sixth may differ between machines.
    let mut settings = insta::Settings::clone_current();
    settings.add_filter(r"(\.\d{6})\d+", "$1");
    settings.bind(|| insta::assert_snapshot!(json));
}

#[test]
fn bad_input_is_named_with_place_and_remedy() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let write =
        |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).expect("written");
    let doubles: Vec<u8> = (0..8).flat_map(|i| f64::from(i).to_le_bytes()).collect();
    write("good.npy", &npy("'<f8'", "False", "(8,)", &doubles));
    write("cut.npy", &npy("'<f8'", "False", "(9,)", &doubles));
    write("header.npy", b"\x93NUMPY\x01\x00\x76\x00{'descr'");
    write("object.npy", &npy("'|O'", "False", "(8,)", &doubles));
    write("integer.npy", &npy("'<i4'", "False", "(16,)", &doubles));
    write("none.npy", &npy("'<f8'", "False", "(0,)", &[]));
    write(
        "transposed.npy",
        &npy("'<f8'", "False", "(1, 100)", &doubles),
    );
    write("empty.csv", b"");
    write("words.csv", b"x,y\n1,2\n3,four\n");
    write("ragged.csv", b"1.0,2\n3\n");
    write("backwards.csv", b"t,x\n0,1\n1,2\n2,3\n1.5,4\n");
    write("slow.csv", b"t,x\n0,1\n10,2\n20,3\n30,4\n");
    write("unsaid.csv", b"ax,ay\n1,2\n2,1\n");
    write("time.csv", b"time,ax\n0,2\n1,1\n");
    write("commas.csv", b"9,81\n9,80\n");
    write("binary.dat", b"\x00\x01\x02");
    let cases: &[&[&str]] = &[
        &["missing.npy", "--rate", "1", "--unit", "g"],
        &["cut.npy", "--rate", "1"],
        &["header.npy", "--rate", "1"],
        &["object.npy", "--rate", "1"],
        &["integer.npy", "--rate", "1"],
        &["none.npy", "--rate", "1"],
        &["transposed.npy", "--rate", "1"],
        &["empty.csv", "--rate", "1"],
        &["words.csv", "--rate", "1", "--unit", "g"],
        &["ragged.csv", "--rate", "1", "--unit", "g"],
        &["backwards.csv", "--time", "t:s", "--unit", "g"],
        &["slow.csv", "--time", "t", "--unit", "g"],
        &["good.npy", "--rate", "1", "--unit", "g", "--time", "0"],
        &["unsaid.csv", "--rate", "1"],
        &["time.csv", "--rate", "1", "--unit", "g"],
        &["commas.csv", "--rate", "1", "--unit", "g"],
        &["binary.dat", "--rate", "1"],
        &["good.npy", "--unit", "g"],
        &["good.npy", "--rate", "1"],
        &["good.npy", "--rate", "-5", "--unit", "g"],
        &["good.npy", "--rate", "1", "--columns", "3"],
        &["words.csv", "--rate", "1", "--columns", "z"],
        &["good.npy", "--rate", "1", "--scale", "1,2"],
        &["good.npy", "--rate", "1", "--unit", "g", "--from", "100"],
        &[
            "good.npy",
            "--rate",
            "1",
            "--overlap",
            "strided",
            "--taus",
            "3,9",
        ],
        &[
            "good.npy",
            "--rate",
            "1",
            "--unit",
            "g",
            "--json",
            "no/such/folder.json",
        ],
    ];
    let mut transcript = String::new();
    for case in cases {
        let arguments: Vec<&str> = ["analyze"].iter().chain(*case).copied().collect();
        let message = fail(folder.path(), &arguments);
        transcript.push_str(&format!("$ inm {}\n{message}\n", arguments.join(" ")));
    }
    insta::assert_snapshot!(transcript);
}

#[test]
fn usage_errors_say_what_would_do() {
    let folder = tempfile::tempdir().expect("temporary folder");
    for (arguments, expected) in [
        (
            &["analyze", "x", "--unit", "furlong"][..],
            "one of m/s^2, g, rad/s",
        ),
        (&["analyze", "x", "--taus", "often"], "is no averaging time"),
        (
            &["analyze", "x", "--chain", "ads9999"],
            "is no part of a signal chain",
        ),
        (&["simulate", "--model", "W", "-o", "x"], "no such model"),
        (
            &[
                "simulate",
                "--model",
                "published",
                "-o",
                "x",
                "--duration",
                "0",
            ],
            "gives no samples",
        ),
    ] {
        let message = fail(folder.path(), arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
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
