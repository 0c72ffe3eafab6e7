//! A record folded for some residues of its ordinates' numbers.
//!
//! For `k = folds q + r` each of the short transforms of `points` needs
//! `sum_m x_{n + points m} e^{-2 pi i r m / folds}` (`record_lines`). Some folds are gathered before
//! they are added: the sums of all residues are far more than a cache holds, and adding is nothing
//! compared with fetching them.

use rustfft::num_complex::Complex64;

/// Folds that are added at a time.
const GATHERED: usize = 4;

/// Points whose folds are added before the next ones are looked at.
const TILE: usize = 512;

/// Sums for several residues in a row.
pub(super) struct Folded {
    points: usize,
    folds: usize,
    /// The first residue.
    first: usize,
    /// Those of each residue, in one piece, so that it goes back to the system when it is done with.
    sums: Vec<Complex64>,
    /// Folds that wait, the number of the first, and how many samples there are.
    gathered: Vec<f64>,
    fold: usize,
    count: usize,
}

impl Folded {
    /// For `residues` of transforms of `points`, a record being `folds` of them at most.
    pub(super) fn new(points: usize, folds: usize, residues: usize) -> Self {
        Self {
            points,
            folds,
            first: 0,
            sums: vec![Complex64::ZERO; points * residues],
            gathered: vec![0.0; GATHERED * points],
            fold: 0,
            count: 0,
        }
    }

    /// Begins with the residue `first`.
    pub(super) fn begin(&mut self, first: usize) {
        self.first = first;
        self.sums.fill(Complex64::ZERO);
        (self.fold, self.count) = (0, 0);
    }

    /// Takes the next samples of the record, from index `at` on; what was passed over is zero.
    pub(super) fn push(&mut self, at: usize, mut values: &[f64]) {
        while self.fold * self.points + self.count < at {
            let room = self.gathered.len() - self.count;
            let missing = at - self.fold * self.points - self.count;
            let end = self.count + room.min(missing);
            self.gathered[self.count..end].fill(0.0);
            self.gathered_to(end);
        }
        while !values.is_empty() {
            let room = self.gathered.len() - self.count;
            let (now, later) = values.split_at(room.min(values.len()));
            let end = self.count + now.len();
            self.gathered[self.count..end].copy_from_slice(now);
            self.gathered_to(end);
            values = later;
        }
    }

    fn gathered_to(&mut self, end: usize) {
        self.count = end;
        if self.count == self.gathered.len() {
            self.add();
        }
    }

    /// The sums of each residue, the record being at its end.
    pub(super) fn residues(&mut self) -> impl Iterator<Item = &mut [Complex64]> {
        self.gathered[self.count..].fill(0.0);
        self.add();
        self.sums.chunks_mut(self.points)
    }

    /// Adds what was gathered.
    fn add(&mut self) {
        let Self { points, folds, .. } = *self;
        let turn = |residue: usize, row: usize| {
            // Reduced in integers: the angle keeps its accuracy however long the record.
            let turn = residue * (self.fold + row) % folds;
            Complex64::cis(-std::f64::consts::TAU * turn as f64 / folds as f64)
        };
        let turns: Vec<[Complex64; GATHERED]> = (0..self.sums.len() / points)
            .map(|offset| std::array::from_fn(|row| turn(self.first + offset, row)))
            .collect();
        for start in (0..points).step_by(TILE) {
            let tile = start..(start + TILE).min(points);
            let rows: [&[f64]; GATHERED] = std::array::from_fn(|row| {
                &self.gathered[row * points + tile.start..row * points + tile.end]
            });
            for (sums, turns) in self.sums.chunks_mut(points).zip(&turns) {
                for (place, sum) in sums[tile.clone()].iter_mut().enumerate() {
                    for (row, turn) in rows.iter().zip(turns) {
                        *sum += turn * row[place];
                    }
                }
            }
        }
        self.fold += GATHERED;
        self.count = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folds_are_added_with_their_turns() {
        const POINTS: usize = 2 * TILE;
        const FOLDS: usize = 7;
        // Five folds and a part: more than are gathered at once, fewer than there may be.
        let mut record: Vec<f64> = (0..5 * POINTS + 100).map(|n| (n % 13) as f64).collect();
        record[..50].fill(0.0);
        record[2000..2100].fill(0.0);
        let mut folded = Folded::new(POINTS, FOLDS, 2);
        for first in [0, 2] {
            folded.begin(first);
            folded.push(50, &record[50..2000]);
            let parts = record[2100..].chunks(777).enumerate();
            parts.for_each(|(number, part)| folded.push(2100 + 777 * number, part));
            for (residue, sums) in (first..).zip(folded.residues()) {
                for (place, sum) in sums.iter().enumerate() {
                    let terms = record.iter().skip(place).step_by(POINTS).enumerate();
                    let expected: Complex64 = terms
                        .map(|(fold, value)| {
                            let turns = (residue * fold) as f64 / FOLDS as f64;
                            value * Complex64::cis(-std::f64::consts::TAU * turns)
                        })
                        .sum();
                    // Six terms of at most 12, each rounded a few times.
                    assert!((sum - expected).norm() < 1e-12, "{residue}, {place}");
                }
            }
        }
    }
}
