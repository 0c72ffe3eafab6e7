//! What an image takes in flash and RAM, read from its ELF.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

/// Vectors that every image has: stack pointer, reset, 14 exceptions and the interrupts of an
/// STM32F405 up to the last, the 82nd.
const VECTORS_SIZE: u64 = 4 * (16 + 82);

/// One section that ends up on the chip.
pub struct Section {
    /// Its name.
    pub name: String,
    /// Where it is when the program runs.
    pub address: u64,
    /// Bytes.
    pub size: u64,
    /// Bytes of flash.
    pub flash: u64,
    /// Bytes of RAM.
    pub ram: u64,
}

/// A function or a static.
pub struct Symbol {
    /// Name, demangled by the compiler's legacy scheme only as far as it is readable.
    pub name: String,
    /// Bytes.
    pub size: u64,
}

/// An image.
pub struct Elf {
    /// Sections on the chip, in address order.
    pub sections: Vec<Section>,
    /// Functions and statics, largest first.
    pub symbols: Vec<Symbol>,
    /// Bytes reserved for the stack.
    pub stack: u64,
}

impl Elf {
    /// Reads an ELF whose vector table is to lie at `origin`.
    ///
    /// # Errors
    /// The file cannot be read, or is no image with a vector table: an image linked without
    /// its linker script is an ELF all the same, and empty.
    pub fn read(path: &Path, origin: u32) -> Result<Self> {
        let shown = path.display();
        let bytes = fs::read(path).with_context(|| format!("cannot read {shown}"))?;
        let file = object::File::parse(&*bytes).with_context(|| format!("{shown} is no ELF"))?;
        let mut sections: Vec<Section> = file.sections().filter_map(|s| on_chip(&s)).collect();
        sections.sort_by_key(|section| section.address);
        let vectors = sections
            .iter()
            .find(|section| section.name == ".vector_table");
        let Some(vectors) = vectors else {
            bail!("{shown} has no vector table")
        };
        ensure!(
            vectors.address == u64::from(origin) && vectors.size >= VECTORS_SIZE,
            "{shown}: the vector table has {} bytes at {:#010x}; expected {VECTORS_SIZE} or more \
             at {origin:#010x}",
            vectors.size,
            vectors.address,
        );
        let mut symbols: Vec<Symbol> = file
            .symbols()
            .filter(|symbol| matches!(symbol.kind(), SymbolKind::Text | SymbolKind::Data))
            .filter_map(|symbol| {
                let name = symbol.name().ok()?.to_owned();
                Some(Symbol {
                    name,
                    size: symbol.size(),
                })
            })
            .collect();
        symbols.sort_by(|a, b| b.size.cmp(&a.size).then_with(|| a.name.cmp(&b.name)));
        let address = |name: &str| file.symbol_by_name(name).map(|symbol| symbol.address());
        let stack = match (address("_stack_start"), address("_stack_end")) {
            (Some(start), Some(end)) if start > end => start - end,
            _ => bail!("{shown} does not say where its stack is"),
        };
        Ok(Self {
            sections,
            symbols,
            stack,
        })
    }

    /// Bytes of flash.
    pub fn flash(&self) -> u64 {
        self.sections.iter().map(|section| section.flash).sum()
    }

    /// Bytes of RAM without the stack.
    pub fn ram(&self) -> u64 {
        self.sections.iter().map(|section| section.ram).sum()
    }
}

/// The section's share of the chip; `None` for what stays in the file.
fn on_chip(section: &object::Section<'_, '_>) -> Option<Section> {
    let size = section.size();
    let (flash, ram) = match section.kind() {
        SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => (size, 0),
        // Initial values are kept in flash and copied.
        SectionKind::Data => (size, size),
        SectionKind::UninitializedData => (0, size),
        _ => return None,
    };
    let name = section.name().ok()?.to_owned();
    // defmt's strings have addresses that mean nothing and no place on the chip.
    if size == 0 || section.address() == 0 || name.starts_with(".defmt") {
        return None;
    }
    Some(Section {
        name,
        address: section.address(),
        size,
        flash,
        ram,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As with an image whose linker script was dropped: a good ELF, and no vectors.
    #[test]
    fn a_program_without_vectors_is_no_image() {
        let this = std::env::current_exe().expect("a test is a file");
        let error = Elf::read(&this, 0)
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default();
        assert!(error.contains("has no vector table"), "{error:?}");
    }

    #[test]
    fn a_text_is_no_elf() {
        let text = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let error = Elf::read(&text, 0)
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default();
        assert!(error.contains("is no ELF"), "{error:?}");
    }
}
