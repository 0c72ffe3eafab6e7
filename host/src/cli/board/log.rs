//! `inm board log`: what goes wrong on a board, in words, as it says it.

use std::fs::File;
use std::io::Write;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Context;
use clap::Args;
use inm_protocol::{Identity, Request};

use super::super::recording::parse_positive;
use super::super::{interrupt, output};
use super::which::{Found, Which};
use crate::inspect::log::{Entry, Log};
use crate::inspect::serial;
use crate::link::{LinkError, Patience, restarted};
use crate::source::SourceError;

/// Arguments of `inm board log`.
#[derive(Debug, Args)]
pub struct LogCommand {
    #[command(flatten)]
    which: Which,
    /// End after this many seconds; until Ctrl-C where not given.
    #[arg(long, value_name = "S", value_parser = parse_positive)]
    duration: Option<f64>,
    /// Write each entry as a line of JSON to this file; - is standard output, in place of the text.
    #[arg(long, value_name = "OUT")]
    json: Option<String>,
}

/// Longest duration, seconds: a century, which is for ever and still a time.
const LONGEST_S: f64 = 3.2e9;

impl LogCommand {
    /// Runs the subcommand. Ctrl-C ends it.
    ///
    /// # Errors
    /// What the port or the board says, and the file that it writes.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        output::check(&[self.json.as_deref()], &[])?;
        let mut sink = Sink::open(self.json.as_deref())?;
        let stop = interrupt::stop_on_signal()?;
        let mut found = self.which.find()?;
        let mut log = Log::new(found.identity.timer_hz);
        sink.write(&log.say(format!(
            "{}: board {}, firmware {} for {}; it started: {}",
            found.port,
            serial(&found.identity),
            found.identity.firmware,
            found.identity.platform,
            restarted(&found.identity.restart)
        )))?;
        let begun = found.session.now();
        let ends = self
            .duration
            .map(|s| begun + Duration::from_secs_f64(s.min(LONGEST_S)));
        let mut watch = Watch {
            heard: begun,
            silent: false,
            // What was under way when the port was opened is no trouble.
            damaged: found.session.damaged(),
        };
        while !stop.requested() && ends.is_none_or(|end| found.session.now() < end) {
            found.session.listen().map_err(SourceError::from)?;
            watch.look(&mut found, &mut log, &mut sink)?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// What is known of a board that is listened to.
struct Watch {
    /// When something intact last came.
    heard: Instant,
    /// Whether it was said that nothing comes.
    silent: bool,
    /// Frames that arrived damaged so far.
    damaged: u64,
}

impl Watch {
    /// Writes what there is to say since the last look.
    fn look(&mut self, found: &mut Found, log: &mut Log, sink: &mut Sink) -> anyhow::Result<()> {
        while let Some(heard) = found.session.heard() {
            self.heard = heard.at;
            self.silent = false;
            if log.has_restarted(&heard) {
                let cause = cause(found)?;
                sink.write(&log.say(format!("the board restarted: {cause}")))?;
            }
            for entry in log.take(&heard) {
                sink.write(&entry)?;
            }
        }
        let damaged = found.session.damaged();
        if damaged > self.damaged {
            let more = damaged - self.damaged;
            sink.write(&log.say(format!("{more} frames of the board arrived damaged")))?;
            self.damaged = damaged;
        }
        let silence = Patience::default().silence;
        if !self.silent && found.session.now() > self.heard + silence {
            self.silent = true;
            sink.write(&log.say(format!("nothing intact for {} s", silence.as_secs())))?;
        }
        Ok(())
    }
}

/// Why the board started, as it says.
fn cause(found: &mut Found) -> anyhow::Result<String> {
    match found.session.ask::<Identity>(Request::Identify) {
        Ok(identity) => Ok(restarted(&identity.restart)),
        Err(LinkError::NoReply { .. }) => Ok("it does not say why".to_owned()),
        Err(error) => Err(SourceError::from(error).into()),
    }
}

/// Where entries go.
enum Sink {
    /// The terminal, in words.
    Text,
    /// The terminal, as JSON.
    Json,
    /// A file as JSON, and the terminal in words.
    Both(String, File),
}

impl Sink {
    fn open(json: Option<&str>) -> anyhow::Result<Self> {
        Ok(match json {
            None => Self::Text,
            Some("-") => Self::Json,
            Some(path) => {
                let file =
                    File::create(path).with_context(|| format!("{path}: cannot be created"))?;
                Self::Both(path.to_owned(), file)
            }
        })
    }

    fn write(&mut self, entry: &Entry) -> anyhow::Result<()> {
        let json = format!("{}\n", serde_json::to_string(entry)?);
        if let Self::Both(path, file) = self {
            file.write_all(json.as_bytes())
                .with_context(|| format!("{path}: cannot be written"))?;
        }
        match self {
            Self::Json => output::say(&json)?,
            Self::Text | Self::Both(..) => output::say(&line(entry))?,
        }
        Ok(())
    }
}

/// An entry on a line: wall clock, time since the board's start, axis, conversion, words.
fn line(entry: &Entry) -> String {
    let up = entry
        .up_s
        .map_or(String::new(), |up_s| format!("{up_s:.1} s"));
    let axis = entry.axis.as_deref().unwrap_or("");
    let conversion = entry
        .conversion
        .map_or(String::new(), |index| format!("conversion {index}: "));
    format!(
        "{}  {up:>10}  {axis:<1}  {conversion}{}\n",
        entry.at, entry.what
    )
}
