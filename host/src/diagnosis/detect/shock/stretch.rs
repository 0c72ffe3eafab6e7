//! A stretch that stands out, and how windows and parts become one.

use std::ops::Range;

/// A stretch that stands out.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Its samples.
    pub samples: Range<usize>,
    /// How far its highest window does.
    pub z: f64,
    /// The frequency at which it does, cycles a sample.
    pub frequency: f64,
    /// Samples of that window.
    pub window: usize,
    /// Samples of the longest stretch that it is made of.
    pub longest: usize,
    /// What all its windows say together: half of the sum of their squared heights, windows that overlap in part.
    pub nats: f64,
}

impl Stretch {
    /// How far all of it stands out: an earthquake of minutes is plainer than each second of it.
    pub fn together(&self) -> f64 {
        (2.0 * self.nats).sqrt().max(self.z)
    }
}

/// Windows in which something is, touching ones as one, where they stand out as far as a `threshold` anywhere.
pub fn lasting(windows: Vec<Stretch>, threshold: f64) -> Vec<Stretch> {
    let mut all = joined(windows, |_, _| 0);
    all.retain(|one| one.z >= threshold);
    all
}

/// Stretches that touch, or lie no further apart than `reach` says of two, as one.
pub fn joined(
    mut stretches: Vec<Stretch>,
    reach: impl Fn(&Stretch, &Stretch) -> usize,
) -> Vec<Stretch> {
    stretches.sort_by_key(|one| one.samples.start);
    let mut all: Vec<Stretch> = Vec::new();
    for mut next in stretches {
        while let Some(last) =
            all.pop_if(|last| next.samples.start <= last.samples.end + reach(last, &next))
        {
            let samples =
                last.samples.start.min(next.samples.start)..last.samples.end.max(next.samples.end);
            let longest = last.longest.max(next.longest);
            let nats = last.nats + next.nats;
            let plainer = if last.z >= next.z { last } else { next };
            next = Stretch {
                samples,
                longest,
                nats,
                ..plainer
            };
        }
        all.push(next);
    }
    all
}
