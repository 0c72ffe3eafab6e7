//! What each command refuses, in which words: a file that is not there, a value that cannot be, a port that
//! nobody knows. More of it, command by command, is beside the tests of that command.

use crate::{assert_all_of, inm, text};

/// A command, and options that it cannot carry out.
const CASES: &[(&str, &str)] = &[
    ("demo", "--duration 0"),
    ("demo", "--output taken"),
    ("record", "--source /dev/ttyNOPE -o run.inmcap"),
    ("record", "--source virtual"),
    ("record", "--source virtual --rate 3000 -o run.inmcap"),
    (
        "record",
        "--source virtual --duration 1 -o no/such/run.inmcap",
    ),
    ("live", "--source /dev/ttyNOPE"),
    ("live", "--source virtual --page=localhost"),
    ("live", "--source virtual --speed -1"),
    ("live", "--source virtual --no-record -o run.inmcap"),
    ("analyze", "missing.npy --rate 1"),
    ("analyze", "taken --unit furlong"),
    ("diagnose", "missing.inmcap"),
    ("diagnose", "taken"),
    ("diagnose", "taken --level 2"),
    ("simulate", "--model W -o out.npy"),
    ("simulate", "-o out.npy"),
    ("simulate", "--model published --duration 0 -o out.npy"),
    ("export", "missing.json --to kalibr -o -"),
    ("export", "taken --to kalibr -o -"),
    ("export", "published --to word -o -"),
    ("replay", "missing.inmcap"),
    ("replay", "taken"),
    ("board ports", "--json no/such/ports.json"),
    ("board info", "--port /dev/ttyNOPE"),
    ("board selftest", "--port /dev/ttyNOPE"),
    ("board update", "--port /dev/ttyNOPE"),
    ("board update", "missing.elf --port virtual"),
    ("board update", "taken --port virtual"),
    ("board reset", "--port /dev/ttyNOPE"),
    ("board reset", ""),
    ("board log", "--port /dev/ttyNOPE"),
    ("board log", "--port virtual --duration never"),
    ("calibrate", "--port /dev/ttyNOPE"),
    ("calibrate", "--port virtual --positions few"),
    #[cfg(feature = "flash")]
    ("flash", "missing.elf"),
    #[cfg(feature = "flash")]
    ("flash", "taken --dry-run"),
    #[cfg(feature = "flash")]
    ("flash", "--dry-run --list"),
];

/// Command lines that come to no command.
const USAGE: [&str; 3] = ["", "nonsense", "board"];

#[test]
fn every_command_says_what_is_wrong_where_and_what_would_do() {
    let known: Vec<&str> = CASES.iter().map(|(command, _)| *command).collect();
    assert_all_of(|command| command.is_leaf, &known);
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("taken"), "a list of words\n").expect("written");
    let mut settings = insta::Settings::clone_current();
    for ports in [
        r"ports of this machine: [^\n]*?(, and try again)?\n",
        r"this machine has no serial port[^\n]*?(, and try again)?\n",
    ] {
        settings.add_filter(ports, "ports of this machine: [ports]$1\n");
    }
    let mut transcripts: Vec<(String, String)> = Vec::new();
    let cases = CASES
        .iter()
        .map(|(command, options)| (command.replace(' ', "-"), format!("{command} {options}")));
    let usage = USAGE.map(|line| ("usage".to_owned(), line.to_owned()));
    for (name, line) in cases.chain(usage) {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let output = inm(folder.path(), &arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{line}: {said}");
        assert!(output.stdout.is_empty(), "{line}: {}", text(&output.stdout));
        let told = format!("$ inm {}\n{said}\n", line.trim());
        match transcripts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, transcript)) => *transcript += &told,
            None => transcripts.push((name, told)),
        }
    }
    // Nothing was written.
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("a folder").count(),
        1
    );
    settings.bind(|| {
        for (name, transcript) in transcripts {
            insta::assert_snapshot!(format!("refused-{name}"), transcript);
        }
    });
}
