//! Where a model's spectrum is looked at: Gauss-Legendre nodes on panels one bin wide.
//!
//! The spectral window of a segment repeats about once a bin, which six nodes resolve to 1e-6. A
//! spectrum that changes within a bin, such as a resonance narrower than half of one, is seen at
//! the nodes only, unless it is [spread](Panel::spread) over them.

use crate::numeric::peak::Peak;

/// Six-point Gauss-Legendre rule on 0..1: place and weight.
pub const RULE: [(f64, f64); 6] = [
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

/// A panel of six nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Panel {
    /// Where it begins, hertz.
    pub from_hz: f64,
    /// How wide it is, hertz.
    pub width_hz: f64,
}

/// A place at which a spectrum is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The frequency, hertz.
    pub f_hz: f64,
    /// The panel whose node it is, and which of its six; `None` where it stands by itself.
    pub of: Option<(Panel, usize)>,
}

impl Panel {
    /// Whether a peak is as narrow as this panel or narrower, and stands in it or in one beside it: further off, what is
    /// left of it is smooth.
    pub fn hides(&self, peak: &Peak) -> bool {
        let middle_hz = self.from_hz + 0.5 * self.width_hz;
        peak.half_width_hz < self.width_hz && (peak.f_hz - middle_hz).abs() < 1.5 * self.width_hz
    }

    /// Densities at the six nodes that stand for the `density` with this peak: with the rule's weights any window that the
    /// nodes resolve sums up what it lets through of all of it. Each is the integral of the density with the polynomial
    /// that is 1 at the node and 0 at the others, over the node's weight; one may be below zero.
    pub fn spread(&self, peak: &Peak, density: impl Fn(f64) -> f64) -> [f64; RULE.len()] {
        /// Steps: even ones of the area tangent of half widths, so that any peak is seen as finely as its skirts.
        const STEPS: usize = 128;
        let half_hz = peak.half_width_hz;
        let at = |f_hz: f64| ((f_hz - peak.f_hz) / half_hz).asinh();
        let (from, to) = (at(self.from_hz), at(self.from_hz + self.width_hz));
        let step = (to - from) / STEPS as f64;
        let mut sums = [0.0; RULE.len()];
        for number in 0..STEPS {
            let u = from + (number as f64 + 0.5) * step;
            let f_hz = peak.f_hz + half_hz * u.sinh();
            let share = density(f_hz) * half_hz * u.cosh() * step / self.width_hz;
            let place = (f_hz - self.from_hz) / self.width_hz;
            for (node, sum) in sums.iter_mut().enumerate() {
                *sum += share * lagrange(node, place) / RULE[node].1;
            }
        }
        sums
    }
}

/// The polynomial that is 1 at a node of the rule and 0 at the others.
pub fn lagrange(node: usize, place: f64) -> f64 {
    let own = RULE[node].0;
    let others = RULE.iter().enumerate().filter(|(other, _)| *other != node);
    others
        .map(|(_, (other, _))| (place - other) / (own - other))
        .product()
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

    /// The places of all nodes where a bin is so wide.
    pub fn places(&self, bin_hz: f64) -> impl Iterator<Item = Place> {
        self.nodes.iter().map(move |node| {
            let panel = Panel {
                from_hz: node.panel as f64 * bin_hz,
                width_hz: bin_hz,
            };
            Place {
                f_hz: self.place(node) * bin_hz,
                of: Some((panel, node.offset)),
            }
        })
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
