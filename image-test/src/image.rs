//! The image: what a probe would write into the flash, and where its names lie.

use std::path::Path;

use object::read::elf::{ElfFile32, ProgramHeader as _};
use object::{Endianness, Object as _, ObjectSymbol as _};

/// Environment variable that names the ELF; `cargo xtask test` sets it.
pub const VARIABLE: &str = "INM_BOARD_IMAGE";

/// Start of the flash (RM0090, 2.3, memory map).
pub const FLASH: u32 = 0x0800_0000;

/// Size of the flash of an STM32F405RG.
pub const FLASH_LEN: usize = 1 << 20;

/// An image.
pub struct Image {
    /// The whole flash; erased bytes are ones.
    pub flash: Vec<u8>,
    symbols: Vec<(String, u32)>,
}

impl Image {
    /// The image that [`VARIABLE`] names.
    ///
    /// # Panics
    /// There is none, or it is none.
    #[must_use]
    pub fn built() -> Self {
        let path = std::env::var_os(VARIABLE)
            .unwrap_or_else(|| panic!("{VARIABLE} is not set; run: cargo xtask test"));
        Self::read(Path::new(&path))
    }

    fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let elf = ElfFile32::<Endianness>::parse(&*bytes).expect("a 32-bit ELF");
        let mut flash = vec![0xff; FLASH_LEN];
        for segment in elf.elf_program_headers() {
            let endian = elf.endian();
            let data = segment.data(endian, &*bytes).expect("within the file");
            // By load address, as a probe writes it: initial values of statics lie in the flash.
            let at = segment.p_paddr(endian).wrapping_sub(FLASH) as usize;
            if !data.is_empty() {
                flash[at..at + data.len()].copy_from_slice(data);
            }
        }
        let symbols = elf
            .symbols()
            .filter_map(|symbol| Some((symbol.name().ok()?.to_owned(), symbol.address() as u32)));
        Self {
            flash,
            symbols: symbols.collect(),
        }
    }

    /// Address of a name, without the bit that says Thumb.
    ///
    /// # Panics
    /// The image has no such name.
    #[must_use]
    pub fn address(&self, name: &str) -> u32 {
        let found = self.symbols.iter().find(|(known, _)| known == name);
        found
            .unwrap_or_else(|| panic!("the image has no `{name}`"))
            .1
            & !1
    }

    /// The word of the flash at an address.
    #[must_use]
    pub fn word(&self, address: u32) -> u32 {
        let at = (address - FLASH) as usize;
        u32::from_le_bytes([0, 1, 2, 3].map(|byte| self.flash[at + byte]))
    }
}
