//! The words that a converter made, on disk and read in their order.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use inm_protocol::AXES;

/// Words read at a time.
const PART: usize = 1 << 14;

/// The file of an axis.
fn file(folder: &Path, axis: usize) -> PathBuf {
    folder.join(format!("words-{axis}"))
}

/// Where the words go.
pub struct Noted([BufWriter<File>; AXES]);

impl Noted {
    pub fn create(folder: &Path) -> io::Result<Self> {
        let [x, y, z] = [0, 1, 2].map(|axis| File::create(file(folder, axis)).map(BufWriter::new));
        Ok(Self([x?, y?, z?]))
    }

    /// Takes all words out of the lists.
    pub fn note(&mut self, lists: &mut [Vec<u32>; AXES]) -> io::Result<()> {
        for (output, list) in self.0.iter_mut().zip(lists) {
            for word in list.drain(..) {
                output.write_all(&word.to_le_bytes())?;
            }
        }
        Ok(())
    }

    pub fn finish(mut self) -> io::Result<()> {
        self.0.iter_mut().try_for_each(Write::flush)
    }
}

/// The words of an axis from a place on.
pub struct Words {
    input: BufReader<File>,
    ahead: VecDeque<u32>,
}

impl Words {
    pub fn open(folder: &Path, axis: usize) -> io::Result<Self> {
        let input = BufReader::new(File::open(file(folder, axis))?);
        let ahead = VecDeque::new();
        Ok(Self { input, ahead })
    }

    /// The word `at` places on; `None` behind the last.
    pub fn peek(&mut self, at: usize) -> io::Result<Option<u32>> {
        while self.ahead.len() <= at {
            let mut bytes = Vec::with_capacity(4 * PART);
            let most = 4 * PART as u64;
            if self.input.by_ref().take(most).read_to_end(&mut bytes)? == 0 {
                return Ok(None);
            }
            let words = bytes.as_chunks().0.iter();
            self.ahead
                .extend(words.map(|word| u32::from_le_bytes(*word)));
        }
        Ok(self.ahead.get(at).copied())
    }

    /// Goes on by so many words that were looked at.
    pub fn pass(&mut self, words: usize) {
        self.ahead.drain(..words.min(self.ahead.len()));
    }
}
