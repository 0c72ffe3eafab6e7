//! What it refuses, with place and remedy.

use std::fs;

use super::{fail, npy};

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
