//! Why the board started: a note in RAM that survives a reset, and the ways to die.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use heapless::Vec;
use inm_protocol::Restart;

use super::{ask, stack};

/// Length of the file name that [`Restart::Panic`] carries.
const FILE_LEN: usize = 32;

/// What the last run left behind.
#[repr(C)]
#[derive(Clone, Copy)]
struct Note {
    kind: u32,
    line: u32,
    file: [u8; FILE_LEN],
    file_len: u32,
    /// [`Note::check`] of the rest: RAM after power-on holds anything.
    check: u32,
}

const COMMAND: u32 = 1;
const PANIC: u32 = 2;

impl Note {
    const EMPTY: Self = Self {
        kind: 0,
        line: 0,
        file: [0; FILE_LEN],
        file_len: 0,
        check: 0,
    };

    fn command() -> Self {
        Self {
            kind: COMMAND,
            ..Self::EMPTY
        }
        .checked()
    }

    /// Keeps the end of `file`, the part that tells.
    fn panic(line: u32, file: &[u8]) -> Self {
        let mut note = Self {
            kind: PANIC,
            line,
            ..Self::EMPTY
        };
        let end = &file[file.len().saturating_sub(FILE_LEN)..];
        note.file[..end.len()].copy_from_slice(end);
        note.file_len = end.len() as u32;
        note.checked()
    }

    fn checked(mut self) -> Self {
        self.check = self.sum();
        self
    }

    /// FNV-1a over the words and the name, from an offset that all-zero RAM does not meet.
    fn sum(&self) -> u32 {
        let words = [self.kind, self.line, self.file_len];
        let bytes = words
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .chain(self.file);
        bytes.fold(0x811c_9dc5, |sum, byte| {
            (sum ^ u32::from(byte)).wrapping_mul(0x0100_0193)
        })
    }

    fn restart(&self) -> Option<Restart> {
        if self.check != self.sum() {
            return None;
        }
        match self.kind {
            COMMAND => Some(Restart::Command),
            PANIC => {
                let name = self.file.get(..self.file_len as usize).unwrap_or_default();
                // Cannot fail: the note's name and the message's are of one size.
                let file = Vec::from_slice(name).unwrap_or_default();
                Some(Restart::Panic {
                    line: self.line,
                    file,
                })
            }
            _ => None,
        }
    }
}

/// The note's place: RAM that the start-up code leaves as it is.
mod place {
    #![allow(unsafe_code)]

    use core::mem::MaybeUninit;

    use super::Note;

    #[unsafe(link_section = ".uninit.inm_restart")]
    static mut NOTE: MaybeUninit<Note> = MaybeUninit::uninit();

    pub(super) fn write(note: Note) {
        // SAFETY: a plain store through a raw pointer to a static that nothing holds a
        // reference to; called at the start and just before a reset, with interrupts off.
        unsafe { (&raw mut NOTE).write_volatile(MaybeUninit::new(note)) }
    }

    pub(super) fn read() -> Note {
        // SAFETY: every bit pattern is a `Note` (integers only), and RAM holds some pattern;
        // volatile, so that the compiler does not reason about where it came from.
        unsafe { (&raw const NOTE).cast::<Note>().read_volatile() }
    }
}

/// Reads the note and erases it. `watchdog`: the reset flags name the watchdog, which leaves
/// no note.
pub fn reason(watchdog: bool) -> Restart {
    let note = place::read();
    place::write(Note::EMPTY);
    if watchdog {
        Restart::Watchdog
    } else {
        note.restart().unwrap_or(Restart::Power)
    }
}

/// Restarts on the host's command.
pub fn on_command() -> ! {
    defmt::info!("restart by command");
    leave(Note::command())
}

/// Restarts into the loader; to the program that comes after it that was a command.
pub fn into_loader() -> ! {
    defmt::info!("restart into the loader");
    ask::for_loader();
    leave(Note::command())
}

fn leave(note: Note) -> ! {
    cortex_m::interrupt::disable();
    place::write(note);
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let (line, file) = info
        .location()
        .map_or((0, ""), |place| (place.line(), place.file()));
    defmt::error!("panic at {=str}:{=u32}", file, line);
    leave(Note::panic(line, file.as_bytes()))
}

/// What the note says where the program's stack has overflowed.
const OVERFLOW: &[u8] = b"stack overflow";

/// A fault has no source line: the note says at which address it happened. Runs on the handlers' own
/// stack; where the program's had no room for the frame there is nothing to read.
#[exception]
#[allow(unsafe_code)]
// SAFETY: the signature that the exception demands; the frame is only read, and only where it is.
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    if stack::overflows(core::ptr::from_ref(frame).addr()) {
        defmt::error!("stack overflow");
        leave(Note::panic(0, OVERFLOW))
    }
    let mut text = *b"hard fault at 00000000";
    for (place, digit) in text.iter_mut().rev().take(8).enumerate() {
        let nibble = (frame.pc() >> (4 * place) & 0xf) as usize;
        *digit = b"0123456789abcdef"[nibble];
    }
    defmt::error!("hard fault at {=u32:08x}", frame.pc());
    leave(Note::panic(0, &text))
}
