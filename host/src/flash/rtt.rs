//! The board's log through a debug probe, while the board runs: a ring of bytes in its RAM (RTT), read by the probe
//! without stopping it.
//!
//! The ring is left as the board made it: what finds no room is given up. The other mode, in which the board waits for a reader,
//! would stop the measurement when the probe is pulled.

use std::thread;
use std::time::{Duration, Instant};

use probe_rs::rtt::{Error as RttError, Rtt};
use probe_rs::{Core, MemoryInterface, Session};

use super::Image;
use super::log::{Line, LogTable};

/// Time between two looks: the ring holds 1 KB, some fifty lines, and a board in trouble says one a second and axis.
const LOOK: Duration = Duration::from_millis(20);

/// How long the log may be missing after a restart: the start-up code takes milliseconds, of a board without its crystal a
/// tenth of a second.
const STARTS: Duration = Duration::from_secs(2);

/// Most bytes fetched in one look: the whole ring.
const RING: usize = 1024;

/// Where the processor keeps the address of the vector table that it uses, which says the program of which slot runs
/// (VTOR; ARMv7-M Architecture Reference Manual, B3.2.5).
const VECTORS: u64 = 0xE000_ED08;

/// The name of the ring among the symbols of an image.
const SYMBOL: &str = "_SEGGER_RTT";

/// Why the log cannot be followed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// The board runs something else than the strings are of.
    #[error(
        "the board runs another image than {image}: its log cannot be read by that; program the board with it \
         (`inm flash`), or name the image that it runs with `--image`"
    )]
    AnotherImage {
        /// What was to be the board's image, in words.
        image: String,
    },
    /// The image has no such symbol.
    #[error(
        "the image has no log ring (symbol `{SYMBOL}`): it is stripped of its symbols, or no firmware of this project"
    )]
    NoRing,
    /// Nothing in RAM, for seconds.
    #[error(
        "the board has no log in its RAM: does it start? (`inm board info` asks it over the serial line)"
    )]
    Silent,
    /// The probe does not read the board's memory any more.
    #[error(
        "the debug probe cannot read the board's memory any more; is it still connected, and the board powered?"
    )]
    Probe(#[source] RttError),
    /// The same, said by the probe itself.
    #[error("the debug probe cannot read the board's memory; is the board powered?")]
    Memory(#[source] probe_rs::Error),
}

/// Where the ring of an image lies in RAM.
///
/// # Errors
/// [`LogError::NoRing`].
pub fn ring(elf: &[u8]) -> Result<u64, LogError> {
    use object::{Object, ObjectSymbol};
    let file = object::File::parse(elf).map_err(|_| LogError::NoRing)?;
    let symbol = file.symbol_by_name(SYMBOL);
    symbol
        .map(|symbol| symbol.address())
        .ok_or(LogError::NoRing)
}

/// Refuses a board that runs another image than this.
///
/// # Errors
/// [`LogError`].
pub fn runs(session: &mut Session, image: &Image) -> Result<(), LogError> {
    let another = || LogError::AnotherImage {
        image: image.to_string(),
    };
    let mut core = session.core(0).map_err(LogError::Memory)?;
    let table = core.read_word_32(VECTORS).map_err(LogError::Memory)?;
    let program = image.programs.iter().find(|one| one.address == table);
    let Some((address, expected)) = program.ok_or_else(another)?.mark() else {
        return Ok(());
    };
    let mut found = vec![0; expected.len()];
    let read = core.read(address.into(), &mut found);
    read.map_err(LogError::Memory)?;
    if found == expected {
        Ok(())
    } else {
        Err(another())
    }
}

/// Restarts the board with the ring unknown: what the last program left there is not the next one's.
///
/// # Errors
/// [`LogError`].
pub fn restart(session: &mut Session, ring: u64) -> Result<(), LogError> {
    let restarted = session.core(0).and_then(|mut core| {
        core.write_32(ring, &[0; 4])?;
        core.reset()
    });
    restarted.map_err(LogError::Memory)
}

/// Follows the log until `stop` says so, and hands on each line.
///
/// # Errors
/// [`LogError`], and what `say` says.
pub fn follow<E: From<LogError>>(
    session: &mut Session,
    (table, ring): (&LogTable, u64),
    stop: impl Fn() -> bool,
    mut say: impl FnMut(Line) -> Result<(), E>,
) -> Result<(), E> {
    let mut core = session
        .core(0)
        .map_err(|error| E::from(LogError::Memory(error)))?;
    let mut first = true;
    while !stop() {
        let Some(mut rtt) = attach(&mut core, ring, &stop)? else {
            return Ok(());
        };
        if !std::mem::take(&mut first) {
            say(Line::say("the board restarted"))?;
        }
        let mut decoder = table.decoder();
        let mut bytes = [0; RING];
        while !stop() {
            let Some(channel) = rtt.up_channel(0) else {
                break;
            };
            match channel.read(&mut core, &mut bytes) {
                Ok(0) => thread::sleep(LOOK),
                Ok(read) => {
                    for line in decoder.take(&bytes[..read]) {
                        say(line)?;
                    }
                }
                // The board has set the ring up anew.
                Err(RttError::ReadPointerChanged | RttError::ControlBlockCorrupted(_)) => break,
                Err(error) => return Err(LogError::Probe(error).into()),
            }
        }
    }
    Ok(())
}

/// The ring, as soon as the board has set it up; `None` if it was stopped meanwhile.
fn attach(
    core: &mut Core<'_>,
    ring: u64,
    stop: &impl Fn() -> bool,
) -> Result<Option<Rtt>, LogError> {
    let begun = Instant::now();
    while !stop() {
        match Rtt::attach_at(core, ring) {
            Ok(rtt) => return Ok(Some(rtt)),
            Err(RttError::ControlBlockNotFound | RttError::ControlBlockCorrupted(_)) => {
                if begun.elapsed() > STARTS {
                    return Err(LogError::Silent);
                }
                thread::sleep(LOOK);
            }
            Err(error) => return Err(LogError::Probe(error)),
        }
    }
    Ok(None)
}
