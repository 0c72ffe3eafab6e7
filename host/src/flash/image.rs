//! What an ELF file puts into flash.

use std::io;
use std::path::{Path, PathBuf};

use object::Endianness;
use object::elf::{self, FileHeader32};
use object::read::elf::{FileHeader, ProgramHeader};

use super::FLASH_ORIGIN;

/// A firmware image, read and checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Bytes for the flash, by address, ascending.
    pub segments: Vec<(u64, Vec<u8>)>,
}

/// Why a file is not an image for the board.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file cannot be read.
    #[error("{}: the file cannot be read", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        source: io::Error,
    },
    /// Not a 32-bit ELF file, or damaged.
    #[error("{}: not a 32-bit ELF file: {source}; build one with `cargo xtask firmware`", path.display())]
    NotElf {
        /// The file.
        path: PathBuf,
        /// What the reader found.
        #[source]
        source: object::Error,
    },
    /// A segment lies beyond the end of the file.
    #[error("{}: the file ends at byte {len}, inside a segment; build or copy it again", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
        /// Its length.
        len: usize,
    },
    /// For another processor.
    #[error("{}: built for ELF machine {machine}, the board is Arm (40); build one with `cargo xtask firmware`", path.display())]
    NotArm {
        /// The file.
        path: PathBuf,
        /// Its `e_machine`.
        machine: u16,
    },
    /// Nothing at the origin of the flash, where the processor looks for its vector table.
    #[error(
        "{}: no vector table at {FLASH_ORIGIN:#010x}: the linker script was lost (is RUSTFLAGS \
         set?); build it with `cargo xtask firmware`",
        path.display()
    )]
    NoVectorTable {
        /// The file.
        path: PathBuf,
    },
}

/// Initial stack pointer and reset vector: less cannot start.
const SMALLEST_TABLE: usize = 8;

impl Image {
    /// Reads the loadable segments of the ELF file at `path`.
    ///
    /// # Errors
    /// [`ImageError`] if the file cannot be read, is not an ELF file for a 32-bit Arm, or has
    /// no vector table at the origin of the flash.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let data = std::fs::read(path).map_err(|source| ImageError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&data, path)
    }

    /// As [`Image::read`], from bytes; `path` is for messages.
    ///
    /// # Errors
    /// As [`Image::read`].
    pub fn parse(data: &[u8], path: &Path) -> Result<Self, ImageError> {
        let not_elf = |source| ImageError::NotElf {
            path: path.to_owned(),
            source,
        };
        let header = FileHeader32::<Endianness>::parse(data).map_err(not_elf)?;
        let endian = header.endian().map_err(not_elf)?;
        let machine = header.e_machine(endian);
        if machine != elf::EM_ARM {
            return Err(ImageError::NotArm {
                path: path.to_owned(),
                machine,
            });
        }
        let mut segments = Vec::new();
        for segment in header.program_headers(endian, data).map_err(not_elf)? {
            if segment.p_type(endian) != elf::PT_LOAD {
                continue;
            }
            let bytes = segment.data(endian, data).map_err(|()| ImageError::Cut {
                path: path.to_owned(),
                len: data.len(),
            })?;
            if !bytes.is_empty() {
                segments.push((u64::from(segment.p_paddr(endian)), bytes.to_vec()));
            }
        }
        segments.sort_by_key(|&(address, _)| address);
        let has_table = segments
            .first()
            .is_some_and(|(at, bytes)| *at == FLASH_ORIGIN && bytes.len() >= SMALLEST_TABLE);
        if !has_table {
            return Err(ImageError::NoVectorTable {
                path: path.to_owned(),
            });
        }
        Ok(Self { segments })
    }

    /// Bytes to program.
    pub fn len(&self) -> usize {
        self.segments.iter().map(|(_, bytes)| bytes.len()).sum()
    }

    /// Whether there is nothing to program; never so for an image that was read.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
