//! A level that switches between two, moment by moment.

/// A level that goes to and fro between half a height above and half a height below.
#[derive(Debug, Clone, PartialEq)]
pub struct Switching {
    /// First sample after each jump, ascending; up and down by turns.
    pub moments: Vec<usize>,
    /// The first jump, in the unit of the record: the distance of the levels, below zero where it goes down.
    pub first: f64,
    /// How a jump comes about.
    pub edge: Edge,
}

/// The course of a jump from 0 to 1.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Edge {
    /// What of it differs from a jump between two samples: sample by sample, as many ahead of the first sample after it as
    /// behind. Empty for a sharp one.
    pub beside: Vec<f64>,
    /// Samples on either side of a moment at which jumps differ from one another by more than the noise does.
    pub unsure: usize,
}

impl Switching {
    /// Takes it out of `values`, whose first sample has index 0.
    pub fn take_out(&self, values: &mut [f64]) {
        let mut level = -0.5 * self.first;
        let mut begin = 0;
        for &moment in self.moments.iter().chain(std::iter::once(&values.len())) {
            let end = moment.min(values.len());
            values[begin.min(end)..end]
                .iter_mut()
                .for_each(|value| *value -= level);
            level = -level;
            begin = end;
        }
        let reach = self.edge.beside.len() / 2;
        let mut jump = self.first;
        for &moment in &self.moments {
            for (n, part) in self.edge.beside.iter().enumerate() {
                let at = (moment + n).checked_sub(reach);
                if let Some(value) = at.and_then(|at| values.get_mut(at)) {
                    *value -= jump * part;
                }
            }
            jump = -jump;
        }
    }

    /// Samples of a record of so many that a jump may leave anything of, where jumps differ.
    pub fn unsure(&self, samples: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
        let reach = self.edge.unsure;
        let about =
            move |moment: &usize| moment.saturating_sub(reach)..(moment + reach).min(samples);
        self.moments.iter().filter(move |_| reach > 0).map(about)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_and_edges_are_taken_out_up_to_the_end() {
        let edge = Edge {
            beside: vec![0.0, 0.25, -0.25, 0.0],
            unsure: 1,
        };
        let switching = Switching {
            moments: vec![3, 10, 19],
            first: -4.0,
            edge,
        };
        let mut values = vec![0.0; 20];
        switching.take_out(&mut values);
        let up_to = |values: &[f64]| values.iter().map(|one| -one).collect::<Vec<f64>>();
        assert_eq!(up_to(&values[..5]), [2.0, 2.0, 1.0, -1.0, -2.0]);
        assert_eq!(up_to(&values[8..12]), [-2.0, -1.0, 1.0, 2.0]);
        assert_eq!(up_to(&values[17..]), [2.0, 1.0, -1.0]);
        let unsure: Vec<_> = switching.unsure(values.len()).collect();
        assert_eq!(unsure, [2..4, 9..11, 18..20]);
    }

    #[test]
    fn what_is_unsure_of_the_last_jump_ends_with_the_record() {
        let switching = Switching {
            moments: vec![3, 50, 96],
            first: 1.0,
            edge: Edge {
                beside: Vec::new(),
                unsure: 8,
            },
        };
        let unsure: Vec<_> = switching.unsure(100).collect();
        assert_eq!(unsure, [0..11, 42..58, 88..100]);
    }
}
