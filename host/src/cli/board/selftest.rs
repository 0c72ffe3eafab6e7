//! `inm board selftest`: a table of checks against their limits.

use std::fmt::Write as _;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;

use super::super::recording::parse_positive;
use super::which::Which;
use super::{JsonOption, status};
use crate::inspect::self_test::{Check, SelfTest, Verdict, number};

/// Arguments of `inm board selftest`.
#[derive(Debug, Args)]
pub struct Selftest {
    #[command(flatten)]
    which: Which,
    /// Watch the board's clock for so long; the longer, the closer it is known.
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = parse_positive)]
    watch: f64,
    #[command(flatten)]
    json: JsonOption,
}

impl Selftest {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// What the port or the board says.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        self.json.check()?;
        let found = self.which.find()?;
        let watch = Duration::from_secs_f64(self.watch.min(LONGEST_WATCH_S));
        let again = self.which.connect(&found.port);
        let tested = SelfTest::whole(found.session, &found.identity, watch, again)?;
        self.json.write(&tested, &text(&tested))?;
        Ok(status(tested.passed))
    }
}

/// Longest time to watch a clock, seconds: a day tells it to a part in a million, and is a duration.
const LONGEST_WATCH_S: f64 = 86_400.0;

fn text(tested: &SelfTest) -> String {
    let mut text = format!(
        "board {} on {}, firmware {}\n\n{:<7}{:<6}{:>11}{:>12}{:>11}  {}\n",
        tested.serial,
        tested.port,
        tested.firmware,
        "check",
        "axis",
        "value",
        "at least",
        "at most",
        "unit"
    );
    for check in &tested.checks {
        text += &line(check);
    }
    let failed: Vec<String> = tested
        .checks
        .iter()
        .filter(|check| check.verdict == Verdict::Failed)
        .map(|check| {
            format!("{} {}", check.name, check.axis.unwrap_or(""))
                .trim_end()
                .to_owned()
        })
        .collect();
    let _ = match failed.is_empty() {
        true => writeln!(text, "\npassed"),
        false => writeln!(text, "\nFAILED: {}", failed.join(", ")),
    };
    text
}

fn line(check: &Check) -> String {
    let value = check.value.map_or_else(|| "-".to_owned(), number);
    let verdict = match check.verdict {
        Verdict::Ok => "ok",
        Verdict::Failed => "FAILED",
        Verdict::Open => "open",
    };
    let mut line = format!(
        "{:<7}{:<6}{value:>11}{:>12}{:>11}  {:<16}{verdict}",
        check.name,
        check.axis.unwrap_or(""),
        number(check.at_least),
        number(check.at_most),
        check.unit
    );
    if !check.remark.is_empty() {
        let _ = write!(line, ": {}", check.remark);
    }
    line.push('\n');
    line
}
