//! What a capture is written to: something that can be brought to the disk.

use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Takes bytes in order, and brings to the disk what it has taken.
pub trait Durable: Write + Send {
    /// Waits until everything written so far survives a loss of power.
    ///
    /// # Errors
    /// What the operating system says; what was written since the last call may then be lost.
    fn sync(&mut self) -> io::Result<()>;

    /// Waits until the name survives a loss of power, too.
    ///
    /// # Errors
    /// What the operating system says.
    fn sync_name(&mut self) -> io::Result<()>;
}

/// A new file.
#[derive(Debug)]
pub struct NewFile {
    file: File,
    folder: PathBuf,
}

impl NewFile {
    /// Creates it.
    ///
    /// # Errors
    /// If it exists, or cannot be created.
    pub fn create(path: &Path) -> io::Result<Self> {
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty());
        Ok(Self {
            file: File::create_new(path)?,
            folder: folder.unwrap_or(Path::new(".")).to_owned(),
        })
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Durable for NewFile {
    fn sync(&mut self) -> io::Result<()> {
        let_pass(self.file.sync_data())
    }

    fn sync_name(&mut self) -> io::Result<()> {
        // Elsewhere a folder is no file that could be opened.
        if cfg!(unix) {
            return let_pass(File::open(&self.folder).and_then(|folder| folder.sync_all()));
        }
        Ok(())
    }
}

/// Some network and user-space file systems know no such call; theirs is the promise then.
fn let_pass(synced: io::Result<()>) -> io::Result<()> {
    match synced {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::Unsupported | ErrorKind::InvalidInput
            ) =>
        {
            Ok(())
        }
        synced => synced,
    }
}
