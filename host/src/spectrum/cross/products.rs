//! Products of the transforms that two axes have in common, summed at each level.

use rustfft::num_complex::Complex64;

use super::CrossBin;
use crate::spectrum::segments::{HOP, LEN, Pair, Plan};

/// Last transform of an axis at a level.
#[derive(Debug, Clone)]
pub(super) struct Slot {
    pub(super) index: Option<u64>,
    pub(super) whole: [bool; 2],
    pub(super) transform: Vec<Complex64>,
}

/// Sums of two axes at a level.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    pub(super) products: Vec<Complex64>,
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
    pub(super) segments: u64,
}

impl Slot {
    pub(super) fn store(slots: &mut Vec<Self>, pair: &Pair<'_>) {
        while slots.len() <= pair.level {
            slots.push(Self {
                index: None,
                whole: [false; 2],
                transform: vec![Complex64::default(); LEN],
            });
        }
        let slot = &mut slots[pair.level];
        slot.index = Some(pair.index);
        slot.whole = pair.whole;
        slot.transform.copy_from_slice(pair.transform);
    }
}

impl Sums {
    pub(super) fn new() -> Self {
        Self {
            products: vec![Complex64::default(); LEN],
            first: vec![0.0; LEN],
            second: vec![0.0; LEN],
            segments: 0,
        }
    }

    pub(super) fn add(&mut self, plan: &Plan, one: &Slot, other: &Slot) {
        let common = [
            one.whole[0] && other.whole[0],
            one.whole[1] && other.whole[1],
        ];
        if one.whole == other.whole {
            let (products, first, second) = (&mut self.products, &mut self.first, &mut self.second);
            plan.arch().dispatch(|| {
                for k in 0..LEN {
                    let (x, y) = (one.transform[k], other.transform[k]);
                    products[k] += x * y.conj();
                    first[k] += x.norm_sqr();
                    second[k] += y.norm_sqr();
                }
            });
        } else if common[0] || common[1] {
            // Rare: one axis lacks a half, so the halves are treated one by one.
            let half = usize::from(common[1]);
            for k in 0..LEN {
                let x = separate(&one.transform, k, half);
                let y = separate(&other.transform, k, half);
                self.products[k] += x * y.conj();
                self.first[k] += x.norm_sqr();
                self.second[k] += y.norm_sqr();
            }
        }
        self.segments += common.iter().map(|&whole| u64::from(whole)).sum::<u64>();
    }

    pub(super) fn bin(&self, ks: std::ops::Range<usize>, rate_hz: f64, swapped: bool) -> CrossBin {
        let (mut product, mut first, mut second) = (Complex64::default(), 0.0, 0.0);
        for k in ks.clone() {
            product += 0.5 * (self.products[k] + self.products[LEN - k].conj());
            first += 0.5 * (self.first[k] + self.first[LEN - k]);
            second += 0.5 * (self.second[k] + self.second[LEN - k]);
        }
        let count = ks.len() as f64;
        let segments = self.segments as f64;
        let scale = 1.0 / (count * segments * HOP as f64 * rate_hz);
        let density = product * scale;
        // Neighbouring segments and frequencies share some of their noise: 1.11 in time, and a
        // bin's worth of 1.64 at the edges of the range.
        let averages = segments / 1.11 * (count / 1.64).max(1.0);
        CrossBin {
            f_hz: 0.5 * (ks.start + ks.end - 1) as f64 * rate_hz / LEN as f64,
            density: if swapped { density.conj() } else { density },
            coherence: if first * second > 0.0 {
                product.norm_sqr() / (first * second)
            } else {
                0.0
            },
            averages,
        }
    }
}

/// Transform of the first (0) or second (1) of the segments that share `z`.
fn separate(z: &[Complex64], k: usize, half: usize) -> Complex64 {
    let (at, mirror) = (z[k], z[(LEN - k) % LEN].conj());
    if half == 0 {
        0.5 * (at + mirror)
    } else {
        Complex64::new(0.0, -0.5) * (at - mirror)
    }
}
