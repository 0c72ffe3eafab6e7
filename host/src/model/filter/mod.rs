//! Filters on all of a record, by their power response, and where they are.

mod high_pass;
mod less_mean;
mod mirror;
mod poles;
mod running_means;
mod symmetric;

use std::f64::consts::PI;

use super::effect::Distorter;
pub use high_pass::HighPass;
pub use less_mean::LessMean;
use mirror::Mirror;
pub use poles::Poles;
pub use running_means::RunningMeans;
pub use symmetric::{REACH, SymmetricFilter};

/// Where a filter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Ahead of a converter that has a filter of its own: an RC, the pole of an analog sensor.
    Ahead,
    /// In a sensor, where it runs several times as fast as it is read, so that of white noise the images fold down.
    Within,
    /// At the record's own rate: a logger's, a driver's, a script's.
    Behind,
}

impl Place {
    /// By the value of a parameter `own_rate`, where there is one: behind where it is 1, else within.
    pub fn of(own_rate: Option<&f64>) -> Self {
        match own_rate {
            Some(own) if *own > 0.0 => Self::Behind,
            _ => Self::Within,
        }
    }
}

/// Nats that a sort of filter costs which is not the plainest: one record in seven has it, a choice.
const OTHER_SORT: f64 = 2.0;

/// The least power of a filter, as a part of what it lets through: a choice that keeps logarithms finite.
pub const DEEPEST: f64 = 1e-15;

/// What makes the values of a filter unlikely, nats: those of the plainest sort have no counts.
pub const fn surprise_nats(values: &[f64]) -> f64 {
    if values.len() > 1 { OTHER_SORT } else { 0.0 }
}

/// Values with which a search begins: each of `first` with the counts of each of these sorts.
pub fn starts(first: &[f64], sorts: &[&[f64]]) -> Vec<Vec<f64>> {
    let of_sort = |sort: &&[f64]| -> Vec<Vec<f64>> {
        let values = first.iter().map(|one| [&[*one], *sort].concat());
        values.collect()
    };
    sorts.iter().flat_map(of_sort).collect()
}

/// Time constants of the slowest pole that the recursion runs ahead of the record: what it began with is then `e^-8` of it,
/// 0.03 %.
const SETTLED: f64 = 8.0;

/// Samples that it runs ahead, at most, as they are held: 8 MB. A corner below a millionth of the rate begins unsettled.
const MOST_SETTLING: usize = 1 << 20;

/// Digital poles of the same decays, whose memory is as long as it has to be, behind a symmetric filter with what is
/// left of the amplitude response up to half the rate. Phases, which no spectrum shows, are the digital poles'.
pub struct Filter {
    symmetric: SymmetricFilter,
    poles: Poles,
    mirror: Mirror,
    /// Samples in which the poles settle.
    settling: usize,
    /// Values that are not the record's yet, once it has begun.
    unsettled: Option<usize>,
}

impl Filter {
    /// With this `power` at a frequency in hertz, one at zero; `poles` are what of it takes long to settle.
    pub fn new(poles: Poles, power: impl Fn(f64) -> f64, rate_hz: f64) -> Self {
        let gain = |share: f64| (power(0.5 * rate_hz * share) / poles.power(PI * share)).sqrt();
        let settling = settling(poles.slowest());
        Self {
            symmetric: SymmetricFilter::new(gain),
            poles,
            mirror: Mirror::new(settling + REACH),
            settling,
            unsettled: None,
        }
    }

    /// Power response at an angular frequency, radians a sample.
    #[cfg(test)]
    pub fn power(&self, radians: f64) -> f64 {
        self.symmetric.power(radians) * self.poles.power(radians)
    }
}

impl Distorter for Filter {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        let Some(came) = self.mirror.before(std::mem::take(samples)) else {
            return;
        };
        let mut unsettled = self.unsettled.unwrap_or_else(|| {
            self.poles.rest_at(came[0]);
            self.settling
        });
        for value in self.symmetric.pass(&came) {
            let value = self.poles.follow(value);
            if unsettled > 0 {
                unsettled -= 1;
            } else {
                samples.push(value);
            }
        }
        self.unsettled = Some(unsettled);
    }
}

/// Samples in which a filter settles whose slowest decay is so many nepers a sample.
fn settling(slowest: f64) -> usize {
    ((SETTLED / slowest).ceil() as usize).min(MOST_SETTLING)
}
