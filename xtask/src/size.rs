//! `cargo xtask size`: what the images take of the chip, held to a budget.
//!
//! The budgets of the programs are no limits of the chip, which has a megabyte of flash: they are what the
//! program is known to need, and some room. Going over one is a reason to look, not to raise
//! it. That of the loader is one: its sector.

use anyhow::{Result, ensure};

use crate::elf::Elf;
use crate::image::Image;
use crate::tools::ensure_target;

/// Symbols shown of each image.
const LARGEST: usize = 12;

/// Most that an image may take, bytes.
struct Budget {
    flash: u64,
    /// Without the stack, whose size memory.x sets.
    ram: u64,
}

/// The bins of three axes, 16 KiB each at most.
const BINS: u64 = 3 * 16 * 1024;

/// The board's program: 66 KB until each axis was proved, identified at its defaults and able to drive the reading, which
/// takes 4 KB. The messages that it shares with the host have the text of a mark among them since 2026-11-23, which it never
/// sends: half a KB. 10 KB since it keeps a calibration: its messages both ways, the two copies, the flash's driver. Half
/// a KB since a loader starts it: asking for it, and the word that says that the program is sound. 2 KB since it logs each
/// trouble for a probe. 2 KB since it tells a pulse a second: one more message to be framed, the timer's capture, and the
/// flash's cache emptied behind what is kept.
const PROGRAM: u64 = 87 * 1024 + 512;

/// What the emulator's filters and their tables add to it where there is no converter, and the machine below it: 13 KB, as
/// before the program grew.
const EMULATOR: u64 = 13 * 1024;

/// What an image says of itself (`inm_protocol::image`), and the code that keeps it there.
const MARK: u64 = 256;

/// The first sector of the flash, which the loader has to itself.
const LOADER: u64 = 16 * 1024;

const fn budget(image: Image) -> Budget {
    match image {
        Image::Board | Image::SecondSlot => Budget {
            flash: PROGRAM + MARK,
            ram: BINS + 16 * 1024,
        },
        Image::Loader => Budget {
            flash: LOADER,
            ram: 8 * 1024,
        },
        Image::Qemu | Image::Count | Image::Overflow => Budget {
            flash: PROGRAM + EMULATOR,
            ram: BINS + 32 * 1024,
        },
    }
}

/// Builds both images and shows what they take.
///
/// # Errors
/// A build fails, or an image is over its budget.
pub fn run() -> Result<()> {
    ensure_target()?;
    for image in [Image::Board, Image::Loader, Image::Qemu] {
        let elf = Elf::read(&image.build()?, image.origin())?;
        show(image, &elf);
        check(image, &elf)?;
    }
    Ok(())
}

/// Compares an image with its budget.
///
/// # Errors
/// It is over it.
pub fn check(image: Image, elf: &Elf) -> Result<()> {
    let Budget { flash, ram } = budget(image);
    let name = image.name();
    let (flash_used, ram_used) = (elf.flash(), elf.ram());
    ensure!(
        flash_used <= flash,
        "{name} takes {flash_used} bytes of flash, budget {flash}"
    );
    ensure!(
        ram_used <= ram,
        "{name} takes {ram_used} bytes of RAM, budget {ram}"
    );
    println!(
        "{name}: {flash_used} of {flash} bytes of flash, {ram_used} of {ram} of RAM, {} of stack \
         beside them",
        elf.stack
    );
    Ok(())
}

fn show(image: Image, elf: &Elf) {
    println!("\n{}", image.name());
    println!(
        "  {:<16} {:>10} {:>8} {:>8}",
        "section", "address", "flash", "RAM"
    );
    for section in &elf.sections {
        let (name, address) = (&section.name, section.address);
        println!(
            "  {name:<16} {address:#010x} {:>8} {:>8}",
            section.flash, section.ram
        );
    }
    println!(
        "  {:<16} {:>10} {:>8} {:>8}",
        "sum",
        "",
        elf.flash(),
        elf.ram()
    );
    println!("  largest symbols");
    for symbol in elf.symbols.iter().take(LARGEST) {
        println!("  {:>8}  {}", symbol.size, symbol.name);
    }
}
