//! `cargo xtask firmware`: the image for the board.

use anyhow::Result;

use crate::elf::Elf;
use crate::image::Image;
use crate::tools::ensure_target;

/// Builds the image, and says where it is and how large.
///
/// # Errors
/// The build fails, or makes something that is no image.
pub fn run() -> Result<()> {
    ensure_target()?;
    let path = Image::Board.build()?;
    let elf = Elf::read(&path)?;
    println!("{}", path.display());
    println!(
        "{} bytes of flash, {} of RAM beside the stack",
        elf.flash(),
        elf.ram()
    );
    Ok(())
}
