//! Whether a board measures: each check a number against its limits, and where they come from.
//!
//! | check | what it takes | limits |
//! |---|---|---|
//! | step | mean words with the sensors' self-test pin low and high | the sensor's sheet |
//! | rest | the mean word at rest: gravity, zero-g error of the sensor and offset of the converter together (an ADS1281 has no switch that would tell them apart) | the sensor's sheet, a board lying in any position |
//! | noise | Allan deviation at 0.1 s of a short stream | between the converter's own and the sensor's |
//! | supply | the board's measurement of the sensors' supply | the sensor's sheet |
//! | clock | stamps of the health records against the host's clock | `clock::CLOCK_LIMIT_PPM` |

mod clock;
mod noise;

use std::time::Duration;

use inm_firmware::mma7331l::{STANDARD_GRAVITY, Scaling};
use inm_protocol::{AXES, Identity, Refusal, Request, SelfTestStep};
use serde::Serialize;

use self::clock::clock;
use self::noise::noise;
use super::{AXIS_NAMES, Session, serial};
use crate::data_sheet;
use crate::link::{Connect, LinkError};
use crate::source::SourceError;

/// What a self-test found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SelfTest {
    /// Port that the board is on.
    pub port: String,
    /// Unique number of its microcontroller, 24 hexadecimal digits.
    pub serial: String,
    /// Release of its firmware.
    pub firmware: String,
    /// Whether no check failed.
    pub passed: bool,
    /// The checks, in the order in which they were made.
    pub checks: Vec<Check>,
}

/// A number against its limits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What was measured: `step`, `rest`, `noise`, `supply`, `clock`.
    pub name: &'static str,
    /// X, Y or Z; `None` of what is the whole board's.
    pub axis: Option<&'static str>,
    /// The number; `None` where it could not be measured.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: &'static str,
    /// Smallest value that passes.
    pub at_least: f64,
    /// Largest value that passes.
    pub at_most: f64,
    /// Whether it passes.
    pub verdict: Verdict,
    /// What there is to say of it, in words; may be empty.
    pub remark: String,
}

/// Outcome of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Within its limits.
    Ok,
    /// Outside its limits, or not to be measured because something does not work.
    Failed,
    /// Not measured, or not closely enough to tell; no failure.
    Open,
}

impl Check {
    /// A value against its limits.
    fn of(
        name: &'static str,
        axis: Option<usize>,
        value: f64,
        unit: &'static str,
        [at_least, at_most]: [f64; 2],
    ) -> Self {
        let within = (at_least..=at_most).contains(&value);
        Self {
            name,
            axis: axis.map(|axis| AXIS_NAMES[axis]),
            value: Some(value),
            unit,
            at_least,
            at_most,
            verdict: if within { Verdict::Ok } else { Verdict::Failed },
            remark: String::new(),
        }
    }

    /// A check without a value, and why.
    fn without(self, verdict: Verdict, remark: String) -> Self {
        Self {
            value: None,
            verdict,
            remark,
            ..self
        }
    }

    /// With `remark`, if it failed.
    fn explained(mut self, remark: &str) -> Self {
        if self.verdict == Verdict::Failed {
            self.remark = remark.to_owned();
        }
        self
    }
}

impl SelfTest {
    /// Stops the board's stream if there is one, and makes all checks but that of the noise, for which
    /// [`noise`] records. The clock is watched for `watch`.
    ///
    /// # Errors
    /// What the link says. A converter that does not do as it is told is no error but a failed check.
    fn run(
        port: String,
        session: &mut Session,
        identity: &Identity,
        watch: Duration,
    ) -> Result<Self, LinkError> {
        let () = session.ask(Request::Stop)?;
        let mut checks = match session.ask::<[SelfTestStep; AXES]>(Request::SelfTest) {
            Ok(steps) => measured(identity, &steps),
            Err(refused @ LinkError::Refused { refusal, .. }) => {
                not_measured(identity, refusal, &refused)
            }
            Err(error) => return Err(error),
        };
        let (clock, supply_mv) = clock(session, identity, watch)?;
        checks.extend(supply_mv.map(|mv| {
            let volts = f64::from(mv) / 1000.0;
            Check::of("supply", None, volts, "V", data_sheet::SENSOR_SUPPLY_V).explained(
                "the supply of the accelerometers is outside what they are specified for",
            )
        }));
        checks.push(clock);
        Ok(Self {
            port,
            serial: serial(identity),
            firmware: identity.firmware.to_string(),
            passed: false,
            checks,
        }
        .judged())
    }

    /// All checks of the board at the far end of `session`. That of the noise records, and opens the
    /// port `again` for it.
    ///
    /// # Errors
    /// What the link says.
    pub fn whole(
        mut session: Session,
        identity: &Identity,
        watch: Duration,
        again: Box<dyn Connect>,
    ) -> Result<Self, SourceError> {
        let mut tested = Self::run(again.name(), &mut session, identity, watch)?;
        // The port is closed before it is opened to record.
        drop(session);
        if tested.measures() {
            tested.checks.extend(noise(again, identity)?);
        }
        Ok(tested.judged())
    }

    /// Whether the converters did what they were told, so that more can be asked of them.
    fn measures(&self) -> bool {
        self.checks
            .iter()
            .all(|check| check.name != "step" || check.value.is_some())
    }

    fn judged(mut self) -> Self {
        let failed = |check: &Check| check.verdict == Verdict::Failed;
        self.passed = !self.checks.iter().any(failed);
        self
    }
}

/// A value as a table has it: three figures behind the point, or behind the first digit of a small number.
pub fn number(value: f64) -> String {
    if value == 0.0 || (1e-2..1e6).contains(&value.abs()) {
        format!("{value:.3}")
    } else {
        format!("{value:.3e}")
    }
}

/// Limits of the step of an axis: that of Z has a sign, X and Y may go either way.
fn step_check(axis: usize, step_g: f64) -> Check {
    let limits = data_sheet::self_test_step_g(axis);
    let value = if axis == 2 { step_g } else { step_g.abs() };
    Check::of("step", Some(axis), value, "g", limits)
}

fn rest_check(identity: &Identity, axis: usize, rest_g: f64) -> Check {
    let limit = data_sheet::rest_g(axis, identity.range);
    Check::of("rest", Some(axis), rest_g, "g", [-limit, limit])
}

/// Checks of the words that were measured.
fn measured(identity: &Identity, steps: &[SelfTestStep; AXES]) -> Vec<Check> {
    let scaling = Scaling::new(
        identity.reference_uv,
        identity.range,
        identity.sensor_supply_uv,
    );
    let to_g = |code: f64| code * scaling.scale() / STANDARD_GRAVITY;
    let step = |axis: usize| {
        let SelfTestStep { rest, driven } = steps[axis];
        step_check(axis, to_g(f64::from(driven) - f64::from(rest))).explained(
            "the sensing element does not answer as it should: sensor, its supply, its self-test pin \
             or the wiring of its output",
        )
    };
    let rest = |axis: usize| {
        rest_check(identity, axis, to_g(f64::from(steps[axis].rest))).explained(
            "no position of the board gives such an output: sensor, wiring, reference, or a calibration \
             of the converter (`inm board info`)",
        )
    };
    (0..AXES).map(step).chain((0..AXES).map(rest)).collect()
}

/// Checks of which a converter that did not do as it was told left nothing.
fn not_measured(identity: &Identity, refusal: Refusal, error: &LinkError) -> Vec<Check> {
    let culprit = match refusal {
        Refusal::Converter { axis, .. } => Some(usize::from(axis)),
        _ => None,
    };
    let fate = |axis: usize, check: Check| match culprit {
        Some(culprit) if culprit != axis => check.without(
            Verdict::Open,
            format!("not measured because of {}", AXIS_NAMES[culprit.min(2)]),
        ),
        _ => check.without(Verdict::Failed, error.to_string()),
    };
    let step = |axis: usize| fate(axis, step_check(axis, 0.0));
    let rest = |axis: usize| fate(axis, rest_check(identity, axis, 0.0));
    (0..AXES).map(step).chain((0..AXES).map(rest)).collect()
}

#[cfg(test)]
mod tests;
