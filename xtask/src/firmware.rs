//! `cargo xtask firmware`: the image for the board.

use anyhow::Result;
use inm_protocol::slot::ROOM;

use crate::elf::Elf;
use crate::image::{BINARY, Image};
use crate::tools::ensure_target;

/// Builds the image, loader included, and says where it is and how large the program is.
///
/// # Errors
/// The build fails, or makes something that is no image.
pub fn run() -> Result<()> {
    ensure_target()?;
    let path = Image::Board.build()?;
    let elf = Elf::read(&path, Image::Board.origin())?;
    println!("{}", path.display());
    println!(
        "{}, the same byte by byte",
        path.with_file_name(BINARY).display()
    );
    println!(
        "{} of {ROOM} bytes of a slot, {} of RAM beside the stack",
        elf.flash(),
        elf.ram()
    );
    Ok(())
}
