//! The bench of `inm live`: one recording after the other, and what viewers ask for between them.

use std::thread;
use std::time::Duration;

use inm_protocol::Settings;

use super::captures::Captures;
use crate::bins::record::{Overlap, Record};
use crate::cli::recording::BoardOptions;
use crate::inspect::Session;
use crate::inspect::self_test::SelfTest;
use crate::link::Patience;
use crate::live::{Desk, Phase, Stage, Wish, watch_on};
use crate::plain::on_a_line;
use crate::signal::Signal;
use crate::source::board::{BoardSource, Stop};
use crate::source::{Source, SourceError};

/// How often a bench that rests looks whether something is wanted: nobody notices that it waits.
const TICK: Duration = Duration::from_millis(50);

/// How long a self-test watches the board's clock, as that of `inm board selftest`.
const WATCH: Duration = Duration::from_secs(10);

/// A board, and where its recordings go.
pub(super) struct Bench<'a> {
    board: &'a BoardOptions,
    captures: Captures,
    desk: Desk,
    /// Ends all of it.
    end: Stop,
    /// What there is to say of the recordings: a line each.
    told: String,
    /// No recording has a gap.
    complete: bool,
}

/// The last recording, as far as it went.
pub(super) struct Last {
    /// What it is of.
    pub signal: Signal,
    /// Its statistics.
    pub record: Record,
    /// What ended it early.
    pub ended: Result<(), SourceError>,
}

impl<'a> Bench<'a> {
    /// A bench that `end` ends, and for which viewers ask at `desk`.
    pub fn new(board: &'a BoardOptions, captures: Captures, desk: Desk, end: Stop) -> Self {
        Self {
            board,
            captures,
            desk,
            end,
            told: String::new(),
            complete: true,
        }
    }

    /// Starts the board.
    ///
    /// # Errors
    /// What the link or the capture says; nothing is recorded then.
    pub fn start(&mut self, settings: Settings) -> Result<BoardSource, SourceError> {
        let stop = self.end.within();
        let connect = self.board.connect(1.0);
        let plan = self.board.plan(settings);
        let source = self.captures.start(connect, plan, stop.clone())?;
        self.desk.records(stop, source.marks());
        Ok(source)
    }

    /// Records `first`, and whatever is asked for behind it, until the end is asked for. A recording that
    /// ends by itself, at its duration or because of what went wrong, is the last.
    pub fn run(&mut self, first: BoardSource, stage: &mut Stage) -> Last {
        let mut source = first;
        loop {
            let (last, stopped) = self.record(source, stage);
            if last.ended.is_err() || !stopped {
                return last;
            }
            match self.rest(stage) {
                Some(next) => source = next,
                None => return last,
            }
        }
    }

    /// A line for each recording, and whether none has a gap.
    pub fn told(self) -> (String, bool) {
        (self.told, self.complete)
    }

    /// Records to the end; whether a viewer asked for it.
    fn record(&mut self, mut source: BoardSource, stage: &mut Stage) -> (Last, bool) {
        let signal = source.signal().clone();
        let mut record = Record::new(signal.axes.len(), Overlap::Strided);
        let ended = watch_on(stage, &mut source, Some(&mut record));
        let stopped = self.desk.rests() && !self.end.requested();
        self.complete &= source.losses().gaps == 0;
        self.told += &told(&source);
        let last = Last {
            signal,
            record,
            ended,
        };
        (last, stopped)
    }

    /// Rests until another recording is started; `None` at the end.
    fn rest(&mut self, stage: &mut Stage) -> Option<BoardSource> {
        let mut said = String::new();
        while !self.end.requested() {
            match self.desk.take() {
                None => {
                    stage.idle(Phase::Resting, &said);
                    thread::sleep(TICK);
                    continue;
                }
                Some(Wish::Record(settings)) => {
                    stage.idle(Phase::Starting, "");
                    match self.start(settings) {
                        Ok(source) => return Some(source),
                        Err(error) => said = format!("not started: {error}"),
                    }
                }
                Some(Wish::Test) => {
                    stage.idle(Phase::Testing, "");
                    said = match self.test() {
                        Ok(tested) => {
                            stage.tested(tested);
                            String::new()
                        }
                        Err(error) => format!("not tested: {error}"),
                    };
                }
            }
            self.desk.rests();
        }
        None
    }

    fn test(&self) -> Result<SelfTest, SourceError> {
        let mut connect = self.board.connect(1.0);
        let (session, identity) = Session::open(connect.as_mut(), Patience::default())?;
        SelfTest::whole(session, &identity, WATCH, self.board.connect(1.0))
    }
}

/// A line about a recording that has ended, if it is kept.
fn told(source: &BoardSource) -> String {
    let Some(path) = source.capture_path() else {
        return String::new();
    };
    format!(
        "{}: {} samples an axis, {} lost, {} bytes\n",
        on_a_line(&path.display().to_string()),
        source.next_index(),
        source.losses().lost_samples,
        source.captured_bytes()
    )
}
