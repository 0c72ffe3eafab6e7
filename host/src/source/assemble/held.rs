//! Samples and gaps that wait for what is still to be said about them.

use std::collections::VecDeque;
use std::ops::Range;

use super::super::{Block, Chunk, Column, Gap, Values};
use super::building::Building;
use super::ranges::split_ranges;

/// Whatever is held, from the oldest on. The last piece, if it holds samples, is still growing.
#[derive(Debug, Default)]
pub(super) struct Held(VecDeque<Piece>);

#[derive(Debug)]
enum Piece {
    Samples(Building),
    Gap(Gap),
}

impl Held {
    /// The samples that are being gathered; `first` is the index of the next one.
    pub fn growing(&mut self, first: u64) -> &mut Building {
        if !matches!(self.0.back(), Some(Piece::Samples(_))) {
            self.0.push_back(Piece::Samples(Building {
                first,
                codes: Default::default(),
                invalid: Default::default(),
            }));
        }
        match self.0.back_mut() {
            Some(Piece::Samples(building)) => building,
            _ => unreachable!("pushed above"),
        }
    }

    /// Samples are missing behind those that are there.
    pub fn gap(&mut self, gap: Gap) {
        self.0.push_back(Piece::Gap(gap));
    }

    /// Marks what of `suspect` (in samples of the record) is held of an axis.
    pub fn mark_suspect(&mut self, axis: usize, suspect: &Range<u64>) {
        for piece in &mut self.0 {
            if let Piece::Samples(building) = piece {
                building.mark_suspect(axis, suspect);
            }
        }
    }

    /// Index of the oldest sample.
    pub fn oldest(&self) -> Option<u64> {
        self.0.iter().find_map(|piece| match piece {
            Piece::Samples(building) => Some(building.first),
            Piece::Gap(_) => None,
        })
    }

    /// Hands on the samples before index `until`, and the gaps ahead of it.
    pub fn release(&mut self, until: u64, done: &mut VecDeque<Chunk>) {
        while let Some(piece) = self.0.pop_front() {
            match piece {
                Piece::Gap(gap) => done.push_back(Chunk::Gap(gap)),
                Piece::Samples(mut building) => {
                    let before = until.saturating_sub(building.first);
                    let len = building
                        .len()
                        .min(usize::try_from(before).unwrap_or(usize::MAX));
                    let whole = len == building.len();
                    if len > 0 {
                        done.push_back(Chunk::Samples(split(&mut building, len)));
                    }
                    if !whole {
                        self.0.push_front(Piece::Samples(building));
                        return;
                    }
                }
            }
        }
    }
}

/// Takes the first `len` samples away.
fn split(building: &mut Building, len: usize) -> Block {
    let columns = building
        .codes
        .iter_mut()
        .zip(&mut building.invalid)
        .map(|(codes, invalid)| {
            let tail = codes.split_off(len);
            let values = Values::Codes(std::mem::replace(codes, tail));
            Column {
                values,
                invalid: split_ranges(invalid, len),
            }
        })
        .collect();
    let first = building.first;
    building.first += len as u64;
    Block { first, columns }
}
