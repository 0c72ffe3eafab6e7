//! Where a model's spectrum is looked at: Gauss-Legendre nodes on panels one bin wide.
//!
//! The spectral window of a segment repeats about once a bin, which six nodes resolve to 1e-6. A
//! spectrum that changes within a bin, such as a resonance narrower than half of one, is seen at
//! the nodes only.

/// Six-point Gauss-Legendre rule on 0..1: place and weight.
const RULE: [(f64, f64); 6] = [
    (0.033_765_242_898_424, 0.085_662_246_189_585),
    (0.169_395_306_766_868, 0.180_380_786_524_069),
    (0.380_690_406_958_402, 0.233_956_967_286_346),
    (0.619_309_593_041_598, 0.233_956_967_286_346),
    (0.830_604_693_233_132, 0.180_380_786_524_069),
    (0.966_234_757_101_576, 0.085_662_246_189_585),
];

/// One node: `panel + offsets[offset]` bins, with its weight in bins.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// Whole bins.
    pub panel: usize,
    /// Index of the fraction of a bin in [`Nodes::offsets`].
    pub offset: usize,
    /// Share of the integral, bins.
    pub weight: f64,
}

/// Nodes over `0..panels` bins. All share six fractions of a bin, so that windows need to be
/// transformed only for these.
#[derive(Debug, Clone)]
pub struct Nodes {
    /// The distinct fractions of a bin.
    pub offsets: [f64; RULE.len()],
    /// The nodes, ascending.
    pub nodes: Vec<Node>,
}

impl Nodes {
    /// Nodes over `panels` bins.
    pub fn new(panels: usize) -> Self {
        let weights = RULE.iter().enumerate();
        let node = |panel, (offset, &(_, weight))| Node {
            panel,
            offset,
            weight,
        };
        Self {
            offsets: RULE.map(|(place, _)| place),
            nodes: (0..panels)
                .flat_map(|panel| weights.clone().map(move |one| node(panel, one)))
                .collect(),
        }
    }

    /// Place of a node, bins.
    pub fn place(&self, node: &Node) -> f64 {
        node.panel as f64 + self.offsets[node.offset]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrates_what_repeats_once_a_bin() {
        let nodes = Nodes::new(40);
        let integral: f64 = nodes
            .nodes
            .iter()
            .map(|node| {
                let place = nodes.place(node);
                node.weight * place * (1.0 + (std::f64::consts::TAU * place).cos())
            })
            .sum();
        // The integral of x cos(2 pi x) over whole periods is zero.
        let exact = 0.5 * 40.0_f64.powi(2);
        // The rule's error for a cosine of one turn a panel: (2 pi)^12 6!^4 / (13 12!^3), 7e-7.
        assert!(
            (integral / exact - 1.0).abs() < 7.2e-7,
            "{integral} {exact}"
        );
    }
}
