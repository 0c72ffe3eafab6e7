//! Every command of `inm`, as the program itself lists them: its help, the shape of its JSON, what it refuses.
//! A command that is new and in none of these fails them.

mod help;
mod refused;
mod shape;

use std::path::Path;
use std::process::{Command, Output};

use inm_host::internals::command_line;

/// A command by the words that call it, none for the program itself.
struct Listed {
    words: Vec<String>,
    /// It does something itself: it has no commands below.
    is_leaf: bool,
    /// It has the option `--json`.
    writes_json: bool,
}

impl Listed {
    fn name(&self) -> String {
        self.words.join(" ")
    }
}

/// All of them, the program first.
fn commands() -> Vec<Listed> {
    let mut all = Vec::new();
    walk(&command_line(), &[], &mut all);
    all
}

fn walk(command: &clap::Command, words: &[String], all: &mut Vec<Listed>) {
    all.push(Listed {
        words: words.to_owned(),
        is_leaf: !command.has_subcommands(),
        writes_json: command
            .get_arguments()
            .any(|argument| argument.get_long() == Some("json")),
    });
    for below in command.get_subcommands() {
        let more = [words, &[below.get_name().to_owned()]].concat();
        walk(below, &more, all);
    }
}

/// Runs `inm` in a folder.
fn inm<T: AsRef<std::ffi::OsStr>>(folder: &Path, arguments: &[T]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_inm"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("inm runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The commands for which `is_one` holds must be those of `cases`, each at least once.
#[track_caller]
fn assert_all_of(is_one: impl Fn(&Listed) -> bool, cases: &[&str]) {
    let mut expected: Vec<String> = commands()
        .iter()
        .filter(|command| is_one(command))
        .map(Listed::name)
        .collect();
    let mut cases: Vec<String> = cases.iter().map(|case| (*case).to_owned()).collect();
    for list in [&mut expected, &mut cases] {
        list.sort();
        list.dedup();
    }
    assert_eq!(cases, expected, "the cases here, and the commands of `inm`");
}
