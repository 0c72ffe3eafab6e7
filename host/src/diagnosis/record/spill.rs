//! Samples that are not needed for a while: in a spill file rather than in memory.

use std::fs::File;
use std::io::{self, Read, Seek, Write};

use bytemuck::Pod;

/// Numbers in memory, or in a spill file.
pub enum Spilled<T> {
    /// The numbers, in memory.
    Kept(Vec<T>),
    /// In a file that is gone when it is closed.
    Written {
        /// The file, which has no name.
        file: File,
        /// How many numbers it holds.
        len: usize,
    },
}

impl<T: Pod> Spilled<T> {
    /// Writes `values` to the folder for temporary files if `in_file`; where that does not work they
    /// stay in memory.
    pub fn new(values: Vec<T>, in_file: bool) -> Self {
        if !in_file {
            return Self::Kept(values);
        }
        let write = || -> io::Result<File> {
            let mut file = tempfile::tempfile()?;
            file.write_all(bytemuck::cast_slice(&values))?;
            Ok(file)
        };
        match write() {
            Ok(file) => Self::Written {
                file,
                len: values.len(),
            },
            Err(_) => Self::Kept(values),
        }
    }

    /// The numbers as they were, read back where they were written.
    ///
    /// # Errors
    /// If the file cannot be read any more.
    pub fn back(self) -> io::Result<Vec<T>> {
        match self {
            Self::Kept(values) => Ok(values),
            Self::Written { mut file, len } => {
                let mut values = vec![T::zeroed(); len];
                file.rewind()?;
                file.read_exact(bytemuck::cast_slice_mut(&mut values))?;
                Ok(values)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_aside_comes_back() {
        let values: Vec<f64> = (0..10_000).map(|n| f64::from(n).sqrt()).collect();
        for in_file in [true, false] {
            let aside = Spilled::new(values.clone(), in_file);
            assert_eq!(matches!(aside, Spilled::Written { .. }), in_file);
            assert_eq!(aside.back().expect("nothing has touched it"), values);
        }
    }
}
