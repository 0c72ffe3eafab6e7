//! Motions sample by sample: each stretch's noise about its own level, its step in the middle.

use crate::model::random::Generator;

pub(super) struct Passing {
    pub(super) from: u64,
    pub(super) to: u64,
    pub(super) step: f64,
    pub(super) level: f64,
    /// Mean of its noise, which is taken out.
    pub(super) mean: f64,
    pub(super) noise: Box<dyn Generator>,
}

/// Mean of the first `count` samples of some noise.
pub(super) fn mean(mut noise: Box<dyn Generator>, count: u64) -> f64 {
    /// Samples that are made at once: a choice.
    const BLOCK: u64 = 4096;
    let blocks = (0..count).step_by(BLOCK as usize).map(|from| {
        let mut block = vec![0.0; (count - from).min(BLOCK) as usize];
        noise.add_to(&mut block);
        block.iter().sum::<f64>()
    });
    blocks.sum::<f64>() / count as f64
}

pub(super) struct Moved {
    pub(super) stretches: Vec<Passing>,
    pub(super) index: u64,
}

impl Generator for Moved {
    fn add_to(&mut self, samples: &mut [f64]) {
        let first = self.index;
        let end = first + samples.len() as u64;
        for one in &mut self.stretches {
            let (from, to) = (one.from.max(first), one.to.min(end));
            if from < to {
                let part = &mut samples[(from - first) as usize..(to - first) as usize];
                one.noise.add_to(part);
                part.iter_mut()
                    .for_each(|sample| *sample += one.level - one.mean);
            }
            // The level goes over in the middle of it.
            let middle = one.from.midpoint(one.to).clamp(first, end);
            let after = &mut samples[(middle - first) as usize..];
            after.iter_mut().for_each(|sample| *sample += one.step);
        }
        self.index = end;
    }
}
