//! A capture against the words that the converters made.

use std::io;
use std::path::Path;

use inm_host::internals::source::capture::CaptureSource;
use inm_host::internals::source::{Block, Chunk, Source, Values};
use inm_protocol::AXES;

use super::truth::Words;

/// Words that have to agree for a place to be found: one of 32 bits, of which noise moves some
/// seventeen, is found by chance among the millions of a night, four are not.
const AGREE: usize = 4;

/// A conversion may have ended at either side of a gap's end.
const SLACK: u64 = 2;

/// Words looked through behind a gap of unknown length: two hours.
const LONGEST: u64 = 2 * 3600 * 4000;

/// What became of the samples of an axis.
#[derive(Debug, Clone, Copy, Default)]
pub struct Account {
    /// The converter's own word, in its order, and no later than there was time for.
    pub right: u64,
    /// Flagged by the board, or excluded by the host.
    pub flagged: u64,
    /// In gaps of known length.
    pub missing: u64,
    /// Taken for good, and not the converter's word.
    pub wrong: u64,
    /// Gaps of unknown length.
    pub unknown_gaps: u64,
    /// Runs behind a gap or a flag whose index agrees with the words to the sample.
    pub exact: u64,
    /// Runs where the converter had made fewer words meanwhile, as it was reset.
    pub fewer: u64,
    /// Index behind the last sample.
    pub end: u64,
}

/// How far an axis has come.
struct Axis {
    account: Account,
    words: Words,
    /// Index of the next word in `words`; `None` where that is not known.
    next: Option<u64>,
    /// A gap of unknown length has just been.
    is_anew: bool,
}

/// Reads the capture to its end.
pub fn compare(capture: &Path, folder: &Path) -> io::Result<[Account; AXES]> {
    let mut source = CaptureSource::open(capture).map_err(io::Error::other)?;
    let mut axes = Vec::new();
    for axis in 0..AXES {
        axes.push(Axis {
            account: Account::default(),
            words: Words::open(folder, axis)?,
            next: None,
            is_anew: false,
        });
    }
    while let Some(chunk) = source.next_chunk().map_err(io::Error::other)? {
        match chunk {
            Chunk::Samples(block) => {
                for (place, axis) in axes.iter_mut().enumerate() {
                    axis.samples(&block, place)?;
                }
            }
            Chunk::Gap(gap) => axes.iter_mut().for_each(|axis| axis.gap(gap.to)),
            Chunk::News(_) => {}
        }
    }
    let accounts: Vec<Account> = axes.iter().map(|axis| axis.account).collect();
    accounts.try_into().map_err(|_| io::ErrorKind::Other.into())
}

impl Axis {
    fn gap(&mut self, to: Option<u64>) {
        match to {
            Some(to) => {
                self.account.missing += to - self.account.end;
                self.account.end = to;
            }
            None => {
                self.account.unknown_gaps += 1;
                self.next = None;
                self.is_anew = true;
            }
        }
    }

    fn samples(&mut self, block: &Block, place: usize) -> io::Result<()> {
        // What is in no gap has to be there; a gap of unknown length stands for one sample or more.
        if std::mem::take(&mut self.is_anew) {
            self.account.missing += block.first - self.account.end;
        } else {
            assert_eq!(block.first, self.account.end, "neither sample nor gap");
        }
        self.account.end = block.end();
        let column = &block.columns[place];
        let Values::Codes(codes) = &column.values else {
            return Err(io::ErrorKind::InvalidData.into());
        };
        let mut from = 0;
        let end = codes.len()..codes.len();
        for bad in column.invalid.iter().chain([&end]) {
            self.run(&codes[from..bad.start], block.first + from as u64)?;
            self.account.flagged += bad.len() as u64;
            from = bad.end;
        }
        Ok(())
    }

    /// Good samples in a row, the first at `index`.
    fn run(&mut self, mut codes: &[i32], mut index: u64) -> io::Result<()> {
        while !codes.is_empty() {
            if self.next != Some(index) && !self.find(codes, index)? {
                self.account.wrong += 1;
                (codes, index) = (&codes[1..], index + 1);
                continue;
            }
            let mut same = 0;
            while same < codes.len() && self.words.peek(same)? == Some(codes[same] as u32) {
                same += 1;
            }
            self.words.pass(same);
            self.account.right += same as u64;
            index += same as u64;
            codes = &codes[same..];
            self.next = Some(index);
            if let Some((_, rest)) = codes.split_first() {
                self.account.wrong += 1;
                index += 1;
                codes = rest;
            }
        }
        Ok(())
    }

    /// Goes to the place of these words, if they are among those that there was time for.
    fn find(&mut self, codes: &[i32], index: u64) -> io::Result<bool> {
        let expected = self.next.map(|next| index - next);
        let most = expected.map_or(LONGEST, |words| words + SLACK);
        let agree = &codes[..codes.len().min(AGREE)];
        for at in 0..=most as usize {
            let mut same = 0;
            while same < agree.len() && self.words.peek(at + same)? == Some(agree[same] as u32) {
                same += 1;
            }
            if same == agree.len() {
                self.words.pass(at);
                match expected {
                    Some(words) if words == at as u64 => self.account.exact += 1,
                    Some(_) => self.account.fewer += 1,
                    None => {}
                }
                return Ok(true);
            }
        }
        Ok(false)
    }
}
