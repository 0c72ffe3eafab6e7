//! Commands that take time: start and calibrations, and how the self-test (`self_test`) begins.
//!
//! All begin alike: RESET, configuration, verification, one common SYNC, settling. A converter
//! that does not do as told gets a rest and two more attempts before the command is refused.

use ads1281::calibrate::{AVERAGED_READINGS, Calibration};
use ads1281::register::FSC_UNITY;
use ads1281::{IDLE_READINGS, RESET_US, SETTLING_READINGS};
use inm_protocol::{AXES, Answer, Filter, Refusal, Reply, Settings, Trouble};

use super::{Instrument, Stage};
use crate::Platform;
use crate::converters::{config, trouble};

/// Attempts to configure the converters before a command is refused.
const ATTEMPTS: u8 = 3;

/// Rest between two attempts, microseconds: [`IDLE_READINGS`] of a converter at 250/s. What it was
/// told in the wrong place, or a brown-out, may have left it at any rate.
const REST_US: u32 = IDLE_READINGS * 4000;

/// A command being carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Job {
    /// Number of the command.
    pub id: u16,
    pub task: Task,
    /// Attempts made.
    pub attempt: u8,
}

/// What is to be done once the converters have settled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Task {
    Start,
    Calibrate(Kind),
    SelfTest,
}

/// Kind of calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Offset,
    Gain,
}

impl<P: Platform> Instrument<P> {
    pub(super) fn begin_job(&mut self, id: u16, task: Task, now: u64) {
        let settings = match task {
            Task::Start => self.settings,
            // The high-pass would delete the offset and the step.
            Task::Calibrate(_) | Task::SelfTest => without_high_pass(self.settings),
        };
        self.configs = self.calibration.map(|calibration| {
            let calibration = match task {
                Task::Start | Task::SelfTest => calibration,
                Task::Calibrate(Kind::Offset) => Calibration::default(),
                Task::Calibrate(Kind::Gain) => Calibration {
                    gain: FSC_UNITY,
                    ..calibration
                },
            };
            config(settings, calibration)
        });
        let job = Job {
            id,
            task,
            attempt: 0,
        };
        self.drive_by(0, now);
        self.reset_all(job, now);
    }

    pub(super) fn reset_all(&mut self, job: Job, now: u64) -> bool {
        self.send_reset_to_all();
        self.stage = Stage::Reset {
            until: now + self.clock.micros(RESET_US),
            job,
        };
        true
    }

    pub(super) fn configure_all(&mut self, job: Job, now: u64) -> bool {
        for axis in 0..AXES {
            let written = self.identify(axis);
            if let Err(trouble) = written.and_then(|()| self.write_configuration(axis)) {
                self.attempt_failed(job, axis, trouble, now);
                return true;
            }
        }
        if matches!(job.task, Task::Start) {
            self.prepare_stream(job);
        }
        self.synchronise(Some(job));
        true
    }

    pub(super) fn attempt_failed(&mut self, job: Job, axis: usize, trouble: Trouble, now: u64) {
        let attempt = job.attempt + 1;
        if attempt < ATTEMPTS {
            self.stage = Stage::Rest {
                until: now + self.clock.micros(REST_US),
                job: Job { attempt, ..job },
            };
        } else {
            self.refuse_job(job, axis, trouble);
        }
    }

    pub(super) fn refuse_job(&mut self, job: Job, axis: usize, trouble: Trouble) {
        self.finish(
            job,
            Err(Refusal::Converter {
                axis: axis as u8,
                trouble,
            }),
        );
    }

    pub(super) fn answer_started(&mut self, job: Job) {
        self.outbox.reply(Reply {
            id: job.id,
            result: Ok(Answer::Settings(self.settings)),
        });
    }

    #[inline(never)]
    pub(super) fn finish(&mut self, job: Job, result: Result<Answer, Refusal>) {
        self.outbox.reply(Reply { id: job.id, result });
        self.stage = Stage::Idle;
    }

    pub(super) fn begin_calibration(&mut self, job: Job, kind: Kind, now: u64) {
        for axis in 0..AXES {
            let converter = &mut self.converters[axis];
            let sent = match kind {
                Kind::Offset => converter.calibrate_offset(),
                Kind::Gain => converter.calibrate_gain(),
            };
            if let Err(error) = sent {
                self.refuse_job(job, axis, trouble(error));
                return;
            }
        }
        // The command may restart the filter, before the readings and after them.
        let longest = 2 * (SETTLING_READINGS + AVERAGED_READINGS) + 16;
        self.stage = Stage::Calibrate {
            until: now + self.clock.periods(longest),
            job,
            done: [false; AXES],
        };
    }

    pub(super) fn await_calibration(
        &mut self,
        now: u64,
        until: u64,
        job: Job,
        mut done: [bool; AXES],
    ) -> bool {
        for (done, converter) in done.iter_mut().zip(&mut self.converters) {
            *done |= converter.take_edge();
        }
        if done == [true; AXES] {
            self.end_calibration(job);
            return true;
        }
        if now < until {
            self.stage = Stage::Calibrate { until, job, done };
            return false;
        }
        let axis = done.iter().position(|done| !done).unwrap_or(0);
        self.refuse_job(job, axis, Trouble::Stalled);
        true
    }

    fn end_calibration(&mut self, job: Job) {
        let mut found = [0; AXES];
        for (axis, found) in found.iter_mut().enumerate() {
            // A bus that is stuck, or a converter that has reset itself, would give any words.
            if let Err(trouble) = self.look(axis) {
                return self.refuse_job(job, axis, trouble);
            }
            let read = match self.converters[axis].read_calibration() {
                Ok(read) => read,
                Err(error) => return self.refuse_job(job, axis, trouble(error)),
            };
            let kept = &mut self.calibration[axis];
            *found = if job.task == Task::Calibrate(Kind::Gain) {
                kept.gain = read.gain;
                // 24 bits: the sign stays clear.
                read.gain.cast_signed()
            } else {
                kept.offset = read.offset;
                read.offset
            };
        }
        self.finish(job, Ok(Answer::Calibration(found)));
    }
}

fn without_high_pass(settings: Settings) -> Settings {
    Settings {
        filter: match settings.filter {
            Filter::Fir { phase, .. } => Filter::Fir {
                phase,
                high_pass: None,
            },
            other => other,
        },
        ..settings
    }
}
