//! Where a model's spectrum is looked at: Gauss-Legendre nodes on panels one bin wide.
//!
//! The spectral window of a segment repeats about once a bin, which six nodes resolve to 1e-9. A
//! spectrum that changes within a bin (a narrow resonance) needs more: the panels beside a
//! [`Peak`] are halved towards it until they are no wider than the peak.

/// A narrow feature of the model's spectrum that the quadrature must resolve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Where it is, hertz.
    pub frequency_hz: f64,
    /// Half its width at half its height, hertz.
    pub half_width_hz: f64,
}

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

/// Nodes over `0..panels` bins. Most share six fractions of a bin, so that windows need to be
/// transformed only for these and for the few beside peaks.
#[derive(Debug, Clone)]
pub struct Nodes {
    /// The distinct fractions of a bin.
    pub offsets: Vec<f64>,
    /// The nodes, in no particular order.
    pub nodes: Vec<Node>,
}

impl Nodes {
    /// Nodes over `panels` bins of `bin_hz` each.
    pub fn new(panels: usize, bin_hz: f64, peaks: &[Peak]) -> Self {
        let mut all = Self {
            offsets: RULE.map(|(place, _)| place).to_vec(),
            nodes: Vec::with_capacity(panels * RULE.len()),
        };
        for panel in 0..panels {
            let near: Vec<(f64, f64)> = peaks
                .iter()
                .map(|peak| {
                    let place = peak.frequency_hz / bin_hz - panel as f64;
                    (place, peak.half_width_hz / bin_hz)
                })
                .filter(|(place, width)| (-1.0..=2.0).contains(place) && *width < 1.0)
                .collect();
            if near.is_empty() {
                all.nodes
                    .extend(RULE.iter().enumerate().map(|(offset, &(_, weight))| Node {
                        panel,
                        offset,
                        weight,
                    }));
            } else {
                all.refine(panel, 0.0, 1.0, &near);
            }
        }
        all
    }

    /// Splits until the part is no wider than its distance from each peak, or than the peak.
    fn refine(&mut self, panel: usize, from: f64, width: f64, peaks: &[(f64, f64)]) {
        let too_wide = peaks.iter().any(|&(place, half_width)| {
            let distance = (from - place).max(place - from - width).max(0.0);
            width > distance.max(half_width) && width > 1e-9
        });
        if too_wide {
            let half = 0.5 * width;
            self.refine(panel, from, half, peaks);
            self.refine(panel, from + half, half, peaks);
            return;
        }
        for (place, weight) in RULE {
            self.nodes.push(Node {
                panel,
                offset: self.offsets.len(),
                weight: weight * width,
            });
            self.offsets.push(from + place * width);
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
    fn integrates_a_narrow_lorentzian_that_it_was_told_of() {
        let peak = Peak {
            frequency_hz: 17.3,
            half_width_hz: 1e-4,
        };
        let nodes = Nodes::new(40, 1.0, &[peak]);
        let integral: f64 = nodes
            .nodes
            .iter()
            .map(|node| {
                let x = (nodes.place(node) - peak.frequency_hz) / peak.half_width_hz;
                node.weight / (1.0 + x * x)
            })
            .sum();
        let half_width = peak.half_width_hz;
        let exact = half_width * ((22.7 / half_width).atan() + (17.3 / half_width).atan());
        assert!(
            (integral / exact - 1.0).abs() < 1e-6,
            "{integral:e} {exact:e}"
        );
    }
}
