//! What each command says of itself.

use std::path::Path;

use crate::{commands, inm, text};

/// Name of the snapshot of a command.
fn snapshot(words: &[String]) -> String {
    [&["help".to_owned()], words].concat().join("-")
}

#[test]
fn every_command_says_what_its_options_mean() {
    for command in commands() {
        let arguments = [&command.words[..], &["--help".to_owned()]].concat();
        let output = inm(Path::new("."), &arguments);
        assert!(output.status.success(), "{arguments:?}");
        assert!(output.stderr.is_empty(), "{arguments:?}");
        insta::assert_snapshot!(snapshot(&command.words), text(&output.stdout));
    }
}

#[test]
fn no_snapshot_is_of_a_command_that_went() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/command_line/snapshots");
    let known = commands();
    let known: Vec<String> = known
        .iter()
        .map(|command| format!("command_line__help__{}.snap", snapshot(&command.words)))
        .collect();
    for file in std::fs::read_dir(folder).expect("the snapshots") {
        let name = file.expect("a file").file_name();
        let name = name.to_string_lossy().into_owned();
        let is_optional =
            name == "command_line__help__help-flash.snap" && cfg!(not(feature = "flash"));
        let is_of_help = name.starts_with("command_line__help__");
        assert!(
            !is_of_help || is_optional || known.contains(&name),
            "{name}"
        );
    }
}
