//! A word of RAM by which the program asks for the loader: it survives a reset, and memory.x keeps its place
//! free of all else for both.
#![allow(unsafe_code)]

use inm_firmware::update::ASKED;

unsafe extern "C" {
    /// The word, from memory.x.
    static mut _loader_asked: u32;
}

/// After the next reset the loader stays.
pub fn for_loader() {
    // SAFETY: an aligned word of RAM that memory.x keeps free, and no reference to it exists; the program
    // writes it only here, with nothing to come but the reset.
    unsafe { (&raw mut _loader_asked).write_volatile(ASKED) }
}
