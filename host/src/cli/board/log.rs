//! `inm board log`: what goes wrong on a board, in words, as it says it over the serial port; through a debug probe:
//! `probed`.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Args;
use inm_protocol::{Identity, Request};

use super::super::recording::parse_positive;
use super::super::{interrupt, output};
#[cfg(feature = "flash")]
use super::probed::ProbeOptions;
use super::sink::{LONGEST_S, Sink};
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
    #[cfg(feature = "flash")]
    #[command(flatten)]
    probe: ProbeOptions,
    /// End after this many seconds; until Ctrl-C where not given.
    #[arg(long, value_name = "S", value_parser = parse_positive)]
    duration: Option<f64>,
    /// Write each entry as a line of JSON to this file; - is standard output, in place of the text.
    #[arg(long, value_name = "OUT")]
    json: Option<String>,
}

impl LogCommand {
    /// Runs the subcommand. Ctrl-C ends it.
    ///
    /// # Errors
    /// What the port or the board says, and the file that it writes.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        output::check(&[self.json.as_deref()], &[])?;
        let mut sink = Sink::open(self.json.as_deref())?;
        #[cfg(feature = "flash")]
        if self.probe.is_asked_for() {
            return self.probe.run(self.duration, &mut sink);
        }
        let stop = interrupt::stop_on_signal()?;
        let mut found = self.which.find()?;
        let mut log = Log::new(found.identity.timer_hz);
        write(
            &mut sink,
            &log.say(format!(
                "{}: board {}, firmware {} for {}; it started: {}",
                found.port,
                serial(&found.identity),
                found.identity.firmware,
                found.identity.platform,
                restarted(&found.identity.restart)
            )),
        )?;
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
                write(sink, &log.say(format!("the board restarted: {cause}")))?;
            }
            for entry in log.take(&heard) {
                write(sink, &entry)?;
            }
        }
        let damaged = found.session.damaged();
        if damaged > self.damaged {
            let more = damaged - self.damaged;
            write(
                sink,
                &log.say(format!("{more} frames of the board arrived damaged")),
            )?;
            self.damaged = damaged;
        }
        let silence = Patience::default().silence;
        if !self.silent && found.session.now() > self.heard + silence {
            self.silent = true;
            write(
                sink,
                &log.say(format!("nothing intact for {} s", silence.as_secs())),
            )?;
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

/// Writes an entry.
fn write(sink: &mut Sink, entry: &Entry) -> anyhow::Result<()> {
    sink.write(entry, &line(entry))
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
