//! What the board says, in words for people.

use inm_protocol::{Hello, Refusal, Restart, Trouble};

/// A refusal in words.
pub(super) fn why(refusal: Refusal) -> String {
    match refusal {
        Refusal::Streaming => "it is streaming".to_owned(),
        Refusal::LinkTooSlow { needed, available } => {
            format!("these settings need {needed} byte/s and the link carries {available} byte/s")
        }
        Refusal::BusTooSlow { asked, readable } => format!(
            "{asked} conversions/s were asked for and the SPI buses can be read at {readable}/s"
        ),
        Refusal::Converter { axis, trouble } => {
            format!("converter {}: {}", axis_name(axis), describe(trouble))
        }
        Refusal::Unsound => {
            "what it was to keep is no calibration: a scale or gravity is not above zero".to_owned()
        }
        Refusal::NotKept => {
            "its flash could not be erased or written; it keeps what it kept before".to_owned()
        }
    }
}

/// Which board it is that speaks another version, as an addition to "the board".
pub(super) fn board_of(board: Option<&Hello>) -> String {
    board.map_or(String::new(), |hello| {
        // Bytes from the wire: nothing of them may act on a terminal.
        let [firmware, platform] =
            [&hello.firmware, &hello.platform].map(|text| text.escape_debug());
        let serial = hello.serial.map(|word| format!("{word:08x}")).concat();
        format!(" {serial} (firmware {firmware} for {platform})")
    })
}

/// Which program speaks to such a board.
pub(super) fn release_of(board: Option<&Hello>) -> String {
    board.map_or("that belongs to the board's".to_owned(), |hello| {
        format!("of release {}", hello.firmware.escape_debug())
    })
}

/// Why a board started, in words.
pub(crate) fn restarted(cause: &Restart) -> String {
    match cause {
        Restart::Power => "power came on, or its reset pin was pulled".to_owned(),
        Restart::Command => "on command".to_owned(),
        Restart::Watchdog => "its main loop hung and the watchdog bit".to_owned(),
        Restart::Panic { line, file } => panicked(*line, file),
        Restart::ClockFallback => FALLBACK.to_owned(),
        Restart::CommandClockFallback => format!("on command; {FALLBACK}"),
        Restart::WatchdogClockFallback => {
            format!("{}; {FALLBACK}", restarted(&Restart::Watchdog))
        }
        Restart::PanicClockFallback { line, file } => {
            format!("{}; {FALLBACK}", panicked(*line, file))
        }
    }
}

const FALLBACK: &str = "its crystal did not start: it runs on the internal oscillator";

/// A panic, or a fault, which has no line but a text.
fn panicked(line: u32, file: &[u8]) -> String {
    let file = String::from_utf8_lossy(file);
    // Bytes from the wire: nothing of them may act on a terminal.
    let file = file.escape_debug();
    if line == 0 {
        format!("its firmware stopped: {file}")
    } else {
        format!("its firmware panicked at {file}, line {line}")
    }
}

/// X, Y or Z.
pub(crate) fn axis_name(axis: u8) -> char {
    match axis {
        0 => 'X',
        1 => 'Y',
        2 => 'Z',
        _ => '?',
    }
}

/// Trouble in words.
pub(crate) fn describe(trouble: Trouble) -> String {
    match trouble {
        Trouble::Stalled => "DRDY stopped; the converter is being reset".to_owned(),
        Trouble::Stuck { ones } => format!(
            "the bus reads all {}; the converter is being reset",
            if ones { "ones" } else { "zeros" }
        ),
        Trouble::Slipped { doubled } => format!(
            "the level {} and stayed: a bit slipped; the converter is being reset",
            if doubled { "doubled" } else { "halved" }
        ),
        Trouble::OverRange => "the converter clips".to_owned(),
        Trouble::WrongId {
            found: found @ (0x00 | 0xFF),
        } => format!("its ID register reads {found:02X}h: nothing answers, or it is not up yet"),
        Trouble::WrongId { found } => {
            format!("its ID register reads {found:02X}h, an ADS1281 ends in 0h")
        }
        Trouble::RegisterLost {
            address,
            wrote,
            found,
        } => format!(
            "register {address:02X}h reads {found:02X}h where {wrote:02X}h was written (a \
             brown-out?); the converter is being reset"
        ),
        Trouble::Bus => "the SPI peripheral reports a fault".to_owned(),
        Trouble::LinkFull { batches } => {
            format!("the host did not keep up: {batches} batches were dropped")
        }
        Trouble::Recovered { lost } => {
            format!("running again after {lost} data periods without samples")
        }
        Trouble::Misaligned => "it does not understand its commands: a bit slipped; the converter \
                                is being reset"
            .to_owned(),
        _ => "trouble of a kind that this program does not know".to_owned(),
    }
}
