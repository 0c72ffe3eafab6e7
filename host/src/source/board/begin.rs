//! The beginning of a recording: the board is set up and started, and the header says what it then
//! says of itself.

use inm_protocol::{AXES, Identity, REGISTERS, Request, SensorCalibration, SensorRange, Settings};
use jiff::Timestamp;

use super::plan::Plan;
use super::talk::{Failed, Keep, Talk};
use crate::capture::{CaptureError, Header, RegistersOf, Writer};
use crate::link::{Client, LinkError};
use crate::source::frames::Frames;

/// A board that streams.
pub(super) struct Begun {
    pub(super) identity: Identity,
    pub(super) header: Header,
    pub(super) frames: Frames,
    /// What has arrived since the start command.
    pub(super) early: Vec<u8>,
}

/// Checks the version, sets the board up and starts it.
pub(super) fn begin(client: &mut Client, plan: &Plan) -> Result<Begun, Failed> {
    let mut frames = Frames::default();
    let mut talk = Talk {
        client,
        frames: &mut frames,
        capture: None,
    };
    let _: Identity = talk.ask(Request::Identify)?;
    // A board left streaming by an earlier host first comes to rest.
    let () = talk.ask(Request::Stop)?;
    if let Some(settings) = plan.settings {
        let _: Settings = talk.ask(Request::Configure(settings))?;
    }
    if let Some(range) = plan.range {
        let () = talk.ask(Request::SelectRange(range))?;
    }
    let identity: Identity = talk.ask(Request::Identify)?;
    let (kept, before) = kept(&mut talk, identity.range)?;

    // Only what comes after the start command belongs to the record.
    let (mut frames, mut early) = (Frames::default(), Vec::new());
    let created = Timestamp::now().to_string();
    let mut talk = Talk {
        client,
        frames: &mut frames,
        capture: Some(&mut early as &mut dyn Keep),
    };
    let _: Settings = talk.ask(Request::Start)?;
    // The start resets the converters and writes the settings.
    let registers = match talk.ask(Request::ReadRegisters) {
        Ok(registers) => (registers, RegistersOf::Record),
        Err(Failed::Link(LinkError::Refused { .. })) => (before, RegistersOf::BeforeTheStart),
        Err(failed) => return Err(failed),
    };
    let header = Header::new(&identity, registers, created).calibrated(kept);
    frames.begin(&header.board);
    Ok(Begun {
        identity,
        header,
        frames,
        early,
    })
}

/// How often the board is asked for what it keeps: for a board that keeps something to be taken for one
/// that does not know the question, so many frames in a row must be lost between others that are not.
const QUESTIONS: u32 = 3;

/// What the board keeps of its accelerometers on this range, and the registers of its converters.
///
/// Firmware from before there was such a thing does not understand the question, and keeps nothing. The
/// question for the registers goes out right behind it, and a board answers in order: where only that one
/// is answered, nothing has to be waited for.
fn kept(
    talk: &mut Talk<'_>,
    range: SensorRange,
) -> Result<(Option<SensorCalibration>, [[u8; REGISTERS]; AXES]), Failed> {
    let request = Request::ReadSensorCalibration(range);
    let mut asked = 1;
    loop {
        let number = talk.client.tell(request)?;
        let registers = talk.ask(Request::ReadRegisters)?;
        match talk.frames.take_reply(number) {
            Some(reply) => return Ok((talk.said(request, reply)?, registers)),
            None if asked == QUESTIONS => return Ok((None, registers)),
            None => asked += 1,
        }
    }
}

/// The capture that `create` makes, with what has arrived before its header was known.
pub(super) fn keep_from(
    header: &Header,
    early: &[u8],
    create: impl FnOnce(&Header) -> Result<Writer, CaptureError>,
) -> Result<Writer, CaptureError> {
    let mut capture = create(header)?;
    capture.append(early)?;
    Ok(capture)
}
