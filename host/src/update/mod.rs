//! A new program onto a board over its serial line, by the loader in the first sector of its flash.
//!
//! ```text
//!   program that measures --Enter--> restart --> loader --Begin, Data .., Commit--> the free slot holds it
//!                                                   |
//!         the new program answers <-- restart <--Start
//! ```
//!
//! Who answers then says its release and not which program it is. Where the one before has the same release, or none is
//! known, the loader is asked once more which slot it starts: a program that understands a host has proved itself, so that
//! it is the new one's slot exactly where the new one answered.
//!
//! All that is said is frozen (`inm_protocol::update`), so that the versions of host and board do not matter.
//! The program that the board has stays until the new one is there and verified; whatever breaks off, the
//! board starts one of the two, and the same command again goes on or begins anew.

mod error;
mod talk;

pub use error::UpdateError;

use std::time::Duration;

use inm_protocol::Hello;
use inm_protocol::crc32;
use inm_protocol::image::BOARD;
use inm_protocol::slot::ROOM;
use inm_protocol::update::{
    CHUNK, FromLoader, LOADER, LoaderRefusal, LoaderStatus, NewProgram, ToLoader,
};
use serde::Serialize;

use crate::flash::{Image, Program};
use crate::link::Connect;
use talk::Talk;

/// What a board without hardware calls itself: it has the loader's own code on emulated flash, and takes
/// what the board takes.
const VIRTUAL: &str = "virtual";

/// How long a board may take until its loader or its program answers. A restart takes 0.2 s, the programs
/// are summed up within 0.3 s, and a crystal that does not start costs some tenths of a second: ten seconds
/// are a board that is not coming.
const THERE_WITHIN: Duration = Duration::from_secs(10);

/// Between two questions to a board that is restarting.
const ASK_EVERY: Duration = Duration::from_millis(500);

/// Wait for an answer that takes the loader no time: ten times that of the slowest USB adapter, and of what
/// a board without hardware keeps on the way.
const SOON: Duration = Duration::from_millis(1000);

/// Wait for a slot to be erased: two sectors, 4 s each at most.
const ERASED_WITHIN: Duration = Duration::from_secs(12);

/// How far an update has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The board restarts into its loader.
    Enter,
    /// The free slot is erased.
    Erase,
    /// So many bytes of all are written.
    Write {
        /// Bytes written.
        written: u32,
        /// Bytes of the program.
        of: u32,
    },
    /// All of it is verified.
    Verify,
    /// The board restarts into the new program.
    Start,
}

/// A board that has a new program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Updated {
    /// Port that it is on.
    pub port: String,
    /// Unique number of its microcontroller, 24 hexadecimal digits.
    pub serial: String,
    /// Release of the program that it had; `null` where its loader listened already.
    pub before: Option<String>,
    /// Release of the program that it runs.
    pub firmware: String,
    /// Revision of its source.
    pub revision: String,
    /// Slot that it is in, 0 or 1.
    pub slot: u8,
    /// Its bytes.
    pub bytes: usize,
}

/// Brings the program of an image onto the board at a port, and waits until it answers.
///
/// # Errors
/// [`UpdateError`]: what the port, the board or its loader says. The board runs the program that it had, but
/// for [`UpdateError::NotBack`], of which that is not known.
pub fn update(
    connect: &mut dyn Connect,
    image: &Image,
    mut progress: impl FnMut(Progress),
) -> Result<Updated, UpdateError> {
    let mut talk = Talk::open(connect)?;
    progress(Progress::Enter);
    let (before, status) = enter(&mut talk)?;
    let serial = before.serial.map(|word| format!("{word:08x}")).concat();
    let slot = status.free;
    let mut programs = image.programs.iter();
    let program = programs.find(|program| program.address == status.address);
    let program = program.ok_or_else(|| UpdateError::NoSlot {
        port: talk.name(),
        address: status.address,
    })?;
    progress(Progress::Erase);
    write(&mut talk, program, &mut progress)?;
    progress(Progress::Verify);
    let done = talk.ask(&ToLoader::Commit, SOON)?;
    if done.starts != Some(slot) {
        return Err(UpdateError::NotBack { port: talk.name() });
    }
    progress(Progress::Start);
    let after = start(&mut talk)?;
    if *after.firmware != *image.version {
        return Err(UpdateError::Other {
            port: talk.name(),
            found: after.firmware.to_string(),
            wanted: image.version.clone(),
        });
    }
    let told_apart = before.version != LOADER && *before.firmware != *image.version;
    if !told_apart && starts(&mut talk)? != Some(slot) {
        return Err(UpdateError::FellBack {
            port: talk.name(),
            wanted: image.version.clone(),
        });
    }
    Ok(Updated {
        port: talk.name(),
        serial,
        before: (before.version != LOADER).then(|| before.firmware.to_string()),
        firmware: after.firmware.to_string(),
        revision: image.revision.clone(),
        slot,
        bytes: program.bytes.len(),
    })
}

/// Has the loader listen. Who the board is as it said first, and how far the loader is.
fn enter(talk: &mut Talk) -> Result<(Hello, LoaderStatus), UpdateError> {
    let deadline = talk.now() + THERE_WITHIN;
    let mut before: Option<Hello> = None;
    while talk.now() < deadline {
        // Who is not to be restarted is asked who it is first.
        let message = match &before {
            None => ToLoader::Status,
            Some(_) => ToLoader::Enter,
        };
        talk.say(&message)?;
        let answer = talk.hear(ASK_EVERY)?;
        if before.is_none()
            && let Some(hello) = talk.hello()
        {
            if ![BOARD, VIRTUAL].contains(&hello.platform.as_str()) {
                return Err(UpdateError::OtherBoard {
                    port: talk.name(),
                    platform: hello.platform.to_string(),
                });
            }
            before = Some(hello.clone());
        }
        if let (Some(FromLoader::Status(status)), Some(hello)) = (answer, &before) {
            return Ok((hello.clone(), status));
        }
    }
    let port = talk.name();
    Err(match before {
        Some(hello) => UpdateError::NoLoader {
            port,
            firmware: hello.firmware.to_string(),
        },
        None => UpdateError::Nobody { port },
    })
}

/// Brings a program into the free slot.
fn write(
    talk: &mut Talk,
    program: &Program,
    progress: &mut impl FnMut(Progress),
) -> Result<(), UpdateError> {
    let length = program.bytes.len() as u32;
    let begin = ToLoader::Begin(NewProgram {
        address: program.address,
        length,
        crc: crc32(&program.bytes),
        // Cannot fail: it is short.
        platform: BOARD.try_into().unwrap_or_default(),
    });
    let mut written = talk.ask(&begin, ERASED_WITHIN)?.written;
    // Whatever the answers say, no more messages than parts, each once in vain.
    for _ in 0..2 * (ROOM as usize / CHUNK) {
        progress(Progress::Write {
            written,
            of: length,
        });
        if written >= length {
            return Ok(());
        }
        let rest = program.bytes.get(written as usize..).unwrap_or_default();
        let data = ToLoader::Data {
            offset: written,
            bytes: rest.iter().take(CHUNK).copied().collect(),
        };
        written = match talk.ask(&data, SOON) {
            Ok(status) => status.written,
            Err(UpdateError::Refused {
                refusal: LoaderRefusal::WrongPlace { expected },
                ..
            }) => expected,
            Err(error) => return Err(error),
        };
    }
    Err(UpdateError::Nobody { port: talk.name() })
}

/// The slot whose program the board starts, as its loader says; the program runs again then.
fn starts(talk: &mut Talk) -> Result<Option<u8>, UpdateError> {
    let (_, status) = enter(talk)?;
    start(talk)?;
    Ok(status.starts)
}

/// Restarts the board into its new program. Who it is then.
fn start(talk: &mut Talk) -> Result<Hello, UpdateError> {
    talk.ask(&ToLoader::Start, SOON)?;
    let deadline = talk.now() + THERE_WITHIN;
    while talk.now() < deadline {
        talk.forget_hello();
        // No message for a program, and the proof that a host understands it and it a host.
        talk.say(&ToLoader::Status)?;
        talk.hear(ASK_EVERY)?;
        if let Some(hello) = talk.hello().filter(|hello| hello.version != LOADER) {
            return Ok(hello.clone());
        }
    }
    Err(UpdateError::NotBack { port: talk.name() })
}
