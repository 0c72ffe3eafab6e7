//! The loader of a board without hardware: the loader's own code, on emulated flash, at the same line.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use inm_firmware::emulated::VirtualSlots;
use inm_firmware::keep::NotWritten;
use inm_firmware::update::{Loader, PROGRAM_AT, Slots};
use inm_protocol::Hello;
use inm_protocol::slot::{BLANK, HEADER, Header, PROVED, SLOT_STARTS, crc32_of_words};

use super::VirtualConnect;
use super::line::{Line, PARCEL, Parcel};

/// The flash that holds the programs.
pub type ProgramFlash = VirtualSlots<Vec<u32>>;

/// How often the loader looks at its line, in real time: without it the patience of a host and of the loader
/// would pass in one look of either.
const LOOK_EVERY: Duration = Duration::from_millis(1);

/// Flash whose first slot has a program that has proved itself: vectors and a word of code. What a virtual
/// board runs is the code of this program, whatever the slots hold.
pub(super) fn with_a_program() -> ProgramFlash {
    let start = SLOT_STARTS[0] + HEADER;
    let program = [0x2000_8000, start + 8 + 1, 0];
    let header = Header {
        number: 1,
        length: 4 * program.len() as u32,
        crc: crc32_of_words(program),
    };
    let mut words = vec![BLANK; ProgramFlash::WORDS];
    words[..header.words().len()].copy_from_slice(&header.words());
    words[PROVED] = 0;
    words[PROGRAM_AT..PROGRAM_AT + program.len()].copy_from_slice(&program);
    ProgramFlash::new(words)
}

/// The flash of a board, whoever has it open.
pub(super) fn flash(plan: &VirtualConnect) -> MutexGuard<'_, ProgramFlash> {
    plan.programs.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The flash as the loader has it.
struct Shared(Arc<Mutex<ProgramFlash>>);

impl Shared {
    fn flash(&self) -> MutexGuard<'_, ProgramFlash> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Slots for Shared {
    fn read(&self, slot: usize, word: usize) -> u32 {
        self.flash().read(slot, word)
    }

    fn erase(&mut self, slot: usize, words: usize) -> Result<(), NotWritten> {
        self.flash().erase(slot, words)
    }

    fn write(&mut self, slot: usize, word: usize, value: u32) -> Result<(), NotWritten> {
        self.flash().write(slot, word, value)
    }
}

/// Listens until a program is to be started, or the host is gone (`None`).
pub(super) fn listen(plan: &VirtualConnect, hello: Hello, line: &mut Line) -> Option<()> {
    let began = Instant::now();
    let mut loader = Loader::new(Shared(Arc::clone(&plan.programs)), hello, 0);
    let mut parcel = Parcel::default();
    // Where time is not real, a parcel counts as for who waits for the board.
    let mut passed = Duration::ZERO;
    loop {
        thread::sleep(LOOK_EVERY);
        passed = match plan.speed > 0.0 {
            true => began.elapsed(),
            false => passed + PARCEL,
        };
        let (now_ms, now_ps) = (passed.as_millis() as u64, passed.as_nanos() as u64 * 1000);
        parcel.at_ps = now_ps;
        let bytes = line.exchange(std::mem::take(&mut parcel))?;
        for byte in bytes {
            let said = |frame: &[u8]| frame.iter().for_each(|&byte| parcel.push(byte, now_ps));
            loader.take(byte, now_ms, said);
            if flash(plan).is_dark() {
                // What it said was never sent; and power is back.
                let on = flash(plan).clone().cut_after(None, BLANK);
                *flash(plan) = on;
                return Some(());
            }
        }
        if loader.is_over(now_ms) {
            line.exchange(parcel)?;
            return Some(());
        }
    }
}
