//! The files that the program gets, and the program as a process.

use std::collections::BTreeMap;
use std::time::Duration;

use inm_tests::hidden::case::{Case, Files, Plan};
use inm_tests::hidden::effect::{self, find};
use inm_tests::hidden::judge::allan::{ModelError, Sides};
use inm_tests::hidden::judge::allan_table::{Mean, table};
use inm_tests::hidden::judge::answer::{
    Answer, Axis, Finding, Held, Interval, Last, Modelled, Remark, Views,
};
use inm_tests::hidden::judge::place::is_right;
use inm_tests::hidden::judge::program::{Diagnose, Failure, Outcome, Program};
use inm_tests::hidden::judge::score::{Score, score};
use inm_tests::hidden::judge::tally;
use inm_tests::hidden::judge::trial::{Task, Trial, run_all};
use inm_tests::hidden::outside::{self, Place};
use inm_tests::hidden::strength::Strength;
use inm_tests::hidden::truth::Truth;
use serde_json::json;

use super::plan;

/// Nothing in the files tells: same name, same header, whatever is hidden.
#[test]
fn the_files_do_not_tell() {
    let write = |names: &[&str]| {
        let folder = tempfile::tempdir().expect("a folder");
        let case = Case::draw(&plan(names), 3);
        let files = case.write(folder.path()).expect("it writes");
        let bytes = std::fs::read(&files.record).expect("it is there");
        let name = files.record.file_name().map(ToOwned::to_owned);
        (bytes, name, case)
    };
    let (markov, name, case) = write(&["markov"]);
    let (clean, clean_name, _) = write(&[]);
    assert_eq!(name, clean_name);
    let header = usize::from(u16::from_le_bytes([clean[8], clean[9]])) + 10;
    assert_eq!(header % 64, 0);
    assert_eq!(clean.len(), header + 8 * SAMPLES);
    assert_eq!(markov[..header], clean[..header]);
    assert_ne!(markov[header..], clean[header..]);
    let first = f64::from_le_bytes(markov[header..header + 8].try_into().expect("eight bytes"));
    assert_eq!(first.to_bits(), case.columns[0][0].to_bits());
    let (again, ..) = write(&["markov"]);
    assert!(markov == again, "the same seed gives the same bytes");
}

/// The program is told of everything, its answer is read, and its failure is none of its own.
#[cfg(unix)]
#[test]
fn the_program_is_run_as_a_process() {
    use std::os::unix::fs::PermissionsExt as _;

    let folder = tempfile::tempdir().expect("a folder");
    let script = folder.path().join("inm");
    let answer = r#"{"schema":1,"axes":[{"findings":[{"effect":"thermal","parameters":
        {"gain":{"value":1.0,"lo":0.5,"hi":null}}}],"unexplained":[],"final":null}]}"#;
    let text = format!(
        "#!/bin/sh\necho \"$@\" > {0}/said\nwhile [ $# -gt 1 ]; do shift; done\n\
         cat > \"$1\" <<'END'\n{answer}\nEND\nexit $(cat {0}/status)\n",
        folder.path().display()
    );
    std::fs::write(&script, text).expect("it writes");
    std::fs::set_permissions(&script, std::fs::Permissions::from_mode(0o755)).expect("its mode");
    let status = |status: &str| std::fs::write(folder.path().join("status"), status);
    let case = Case::draw(&plan(&["thermal"]), 1);
    let files = case.write(folder.path()).expect("it writes");
    let program = Program(script.clone());

    status("1").expect("it writes");
    let outcome = program.diagnose(&files).expect("status 1 is an answer");
    assert!(score(&case, &outcome.answer).is_right());
    let said = std::fs::read_to_string(folder.path().join("said")).expect("it was run");
    assert!(said.starts_with("diagnose "), "{said}");
    assert!(
        said.contains("record.npy --rate 2000 --unit m/s^2 "),
        "{said}"
    );
    assert!(said.contains("--columns 0 --temperature 1"), "{said}");

    status("2").expect("it writes");
    let failure = program.diagnose(&files).expect_err("status 2 is a failure");
    assert!(failure.to_string().contains("exit status: 2"), "{failure}");
}
