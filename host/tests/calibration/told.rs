//! `inm calibrate` in words: refusals, results.

use crate::bench::{inm, text};

#[test]
fn refusals_say_what_is_meant() {
    let mut transcript = String::new();
    for arguments in [
        &["--positions", "11"][..],
        &["--seconds", "1"],
        &["--gravity", "1"],
        &["--range", "8"],
        &["--show", "--erase"],
        &["--cube", "--positions", "18"],
        &["--cube", "--tilt", "50"],
        &["--tilt", "0.5"],
        &["--port", "/dev/ttyNOPE"],
    ] {
        let mut command = vec!["calibrate"];
        if !arguments.contains(&"--port") {
            command.extend(["--port", "virtual"]);
        }
        command.extend(arguments);
        let output = inm(&command);
        assert_eq!(output.status.code(), Some(2), "{command:?}");
        transcript += &format!("$ inm {}\n{}\n", command.join(" "), text(&output.stderr));
    }
    let mut steady = insta::Settings::clone_current();
    for ports in [
        r"ports of this machine: .*",
        r"this machine has no serial port.*",
    ] {
        steady.add_filter(ports, "ports of this machine: [ports]");
    }
    steady.bind(|| insta::assert_snapshot!(transcript));
}

/// Keys, units and words of a result; the numbers are judged elsewhere.
#[test]
fn a_result_is_told_as_text_and_as_json() {
    let mut transcript = String::new();
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("found.json");
    let file = file.to_str().expect("plain");
    for options in [&["--show"][..], &["--positions", "12", "--seconds", "2"]] {
        let board = ["calibrate", "--port", "virtual", "--seed", "3"];
        let output = inm(&[&board, options, &["--json", file]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        transcript += &text(&output.stdout);
        transcript += &std::fs::read_to_string(file).expect("written");
        std::fs::remove_file(file).expect("its own");
    }
    let mut steady = insta::Settings::clone_current();
    steady.add_filter(" +", " ");
    steady.add_filter(r"([^\^\w.-])[-+]?\d+(\.\d+)?(e-?\d+)?\b", "$1[n]");
    steady.bind(|| insta::assert_snapshot!(transcript));
}
