//! The strings of an image's log: symbols of the section `.defmt`, whose names are the strings and whose addresses are the
//! numbers by which the board names them.

use std::collections::HashMap;
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol};
use serde::Deserialize;

/// Encoding and version that are known, as defmt's symbols name them.
const ENCODING: &str = "_defmt_encoding_ = rzcobs";
const VERSION: &str = "_defmt_version_ = 4";

/// Why the log of an image cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// It was stripped of it, or never had one.
    #[error(
        "{path}: the image has no log table (section `.defmt`); take the ELF file that `cargo xtask firmware` builds"
    )]
    None {
        /// The file.
        path: String,
    },
    /// Of another version of defmt.
    #[error(
        "{path}: the image's log is not of defmt's version 4 in rzCOBS; take the `inm` of its release"
    )]
    Version {
        /// The file.
        path: String,
    },
    /// An entry is no text that defmt writes.
    #[error(
        "{path}: the image's log table has `{name}`, which is no entry of defmt's; build the image again"
    )]
    Entry {
        /// The file.
        path: String,
        /// The entry.
        name: String,
    },
}

/// An entry, as defmt names its symbol.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Entry {
    /// What it is: `defmt_warn`, `defmt_derived`, ...
    pub(super) tag: String,
    /// The format string.
    pub(super) data: String,
    /// The crate that it is in; older versions did not say.
    pub(super) crate_name: Option<String>,
}

/// Strings of an image's log.
#[derive(Debug)]
pub struct LogTable {
    entries: HashMap<u16, Entry>,
    /// Format of the time that each frame has.
    timestamp: Option<String>,
}

impl LogTable {
    /// Of the ELF file that was read from `path`.
    ///
    /// # Errors
    /// [`TableError`] if it holds none that can be read.
    pub fn parse(elf: &[u8], path: &Path) -> Result<Self, TableError> {
        let path = path.display().to_string();
        let Ok(file) = object::File::parse(elf) else {
            return Err(TableError::None { path });
        };
        let sections: Vec<_> = file
            .sections()
            .filter(|section| section.name().is_ok_and(|name| name.starts_with(".defmt")))
            .map(|section| section.index())
            .collect();
        if sections.is_empty() {
            return Err(TableError::None { path });
        }
        let names = || file.symbols().filter_map(|symbol| symbol.name().ok());
        // LLD keeps the quotes of a linker script.
        let named = |wanted: &str| names().any(|name| name.trim_matches('"') == wanted);
        if !named(ENCODING) || !named(VERSION) {
            return Err(TableError::Version { path });
        }
        let (mut entries, mut timestamp) = (HashMap::new(), None);
        for symbol in file.symbols() {
            let within = symbol
                .section_index()
                .is_some_and(|section| sections.contains(&section));
            let Some(name) = symbol
                .name()
                .ok()
                .filter(|name| within && name.starts_with('{'))
            else {
                continue;
            };
            let Ok(entry) = serde_json::from_str::<Entry>(name) else {
                let name = name.to_owned();
                return Err(TableError::Entry { path, name });
            };
            if entry.tag == "defmt_timestamp" {
                timestamp = Some(entry.data);
            } else if let Ok(number) = u16::try_from(symbol.address()) {
                entries.insert(number, entry);
            }
        }
        Ok(Self { entries, timestamp })
    }

    /// The entry with a number.
    pub(super) fn entry(&self, number: u16) -> Option<&Entry> {
        self.entries.get(&number)
    }

    /// Format of the time that each frame has.
    pub(super) fn timestamp(&self) -> Option<&str> {
        self.timestamp.as_deref()
    }

    /// Numbers of the lines whose text contains `text`, for tests.
    #[cfg(test)]
    pub(super) fn find(&self, text: &str) -> Option<u16> {
        let found = self
            .entries
            .iter()
            .find(|(_, entry)| entry.data.contains(text));
        found.map(|(number, _)| *number)
    }
}
