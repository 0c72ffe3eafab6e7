//! Waveforms that are taken out of a record, and the events that they are made of.

use std::sync::Arc;

use realfft::num_complex::Complex64;

use crate::diagnosis::record::bridge::bridge;
use crate::diagnosis::record::switching::Switching;
use crate::fft::phasor::Phasor;
use crate::model::drift::Drift;
use crate::model::motion::Level;
use crate::model::random::Generator;
use crate::model::shock::Shock;
use crate::model::steps::Staircase;
use crate::model::warmup::Settling;

/// A sample that does not belong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlier {
    /// Index of the sample in the record.
    pub index: usize,
    /// How much it is too large, in the unit of the record.
    pub size: f64,
    /// Standard deviation of the size.
    pub size_sd: f64,
}

/// A jump of the level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Index of the first sample after it.
    pub index: usize,
    /// Its height, in the unit of the record.
    pub height: f64,
    /// Standard deviation of the height.
    pub height_sd: f64,
    /// Standard deviation of the index, samples.
    pub index_sd: f64,
    /// Its height, in standard deviations of that height.
    pub z: f64,
    /// Probability of as large a statistic anywhere without a jump.
    pub p_value: f64,
}

/// Deviations of a height from which no slow noise is taken for a jump, and from which a jump raised the noise that it was
/// first measured in: a choice. A jump shows from some five on.
const STRONG: f64 = 20.0;

impl Jump {
    /// Whether it is no fit to noise, and known better once it is taken out of the noise.
    pub fn is_strong(&self) -> bool {
        self.height.abs() > STRONG * self.height_sd
    }
}

/// A waveform in the record.
#[derive(Debug, Clone, PartialEq)]
pub enum Wave {
    /// Jumps of the level that stay.
    Steps(Vec<Jump>),
    /// A level that switches between two.
    Switching(Arc<Switching>),
    /// Levels on the way to others, beside the [steps](Self::Steps) that are in the middle of each way.
    Meanwhile(Vec<Level>),
    /// Exponential settling from the start of the record.
    WarmUp {
        /// Distance from the final level at the start, in the unit of the signal.
        amplitude: f64,
        /// Time constant, samples.
        samples: f64,
    },
    /// A line: `cosine cos(w n) + sine sin(w n)`.
    Line {
        /// Frequency, cycles a sample.
        cycles: f64,
        /// Size of the cosine.
        cosine: f64,
        /// Size of the sine.
        sine: f64,
        /// Samples that were lost on the way, and the first index after them: from there on the
        /// phase is that many samples ahead.
        lost: Option<(usize, u32)>,
    },
    /// A covariate, one value a sample, times a gain.
    Follows {
        /// Gain, unit of the signal a unit of the covariate.
        gain: f64,
        /// The covariate, about its mean.
        column: Arc<Vec<f32>>,
        /// Frequency below which the covariate's own noise is louder than that of the signal, hertz.
        absorbs_hz: f64,
    },
    /// A slow course.
    Drift {
        /// The course, in seconds and in the unit of the record.
        drift: Arc<Drift>,
        /// Samples a second.
        rate_hz: f64,
        /// Frequency below which it takes more than half of the noise's own power out with it, hertz.
        absorbs_hz: f64,
    },
    /// Short transients.
    Shocks {
        /// Each of them, in seconds and in the unit of the record.
        shocks: Vec<Shock>,
        /// Samples a second.
        rate_hz: f64,
    },
    /// Single samples that do not belong.
    Outliers(Arc<Vec<Outlier>>),
    /// Single samples that were not measured (repeats of the one before), ascending, in place of which stands what the law
    /// draws, given the others.
    Replaced(Replaced),
}

/// On which side of what was recorded a sample lies that was no measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Anywhere.
    Any,
    /// It is larger.
    Above,
    /// It is smaller.
    Below,
}

/// What stands in the place of some samples, ascending. Two are the same where they stand in the place of the same samples: what
/// is drawn changes with every law.
#[derive(Debug, Clone)]
pub struct Replaced {
    /// Each of them: how much what was recorded is too large.
    pub all: Arc<Vec<Outlier>>,
    /// On which side of what was recorded they lie.
    pub side: Side,
}

impl Replaced {
    /// The samples at these places of `values`, ascending, with straight lines between means of those that are left in their
    /// places, as a law begins with that is then drawn from. One that is missing or excluded stays.
    pub fn bridged(values: &[f64], places: &[usize], side: Side) -> Self {
        let mut line = values.to_vec();
        for &place in places {
            line[place] = f64::NAN;
        }
        bridge(&mut line);
        let all = places.iter().map(|&index| Outlier {
            index,
            size: Some(values[index] - line[index])
                .filter(|size| size.is_finite())
                .unwrap_or(0.0),
            size_sd: 0.0,
        });
        Self {
            all: Arc::new(all.collect()),
            side,
        }
    }
}

impl PartialEq for Replaced {
    fn eq(&self, other: &Self) -> bool {
        let places = |one: &Self| one.all.iter().map(|one| one.index).collect::<Vec<usize>>();
        places(self) == places(other)
    }
}

impl Wave {
    /// The samples that it replaces, where it does.
    pub fn replaced(&self) -> Option<&[Outlier]> {
        match self {
            Self::Replaced(replaced) => Some(&replaced.all),
            _ => None,
        }
    }

    /// Frequency below which nothing is said of the noise once it is taken out, hertz, where there is one.
    pub const fn absorbs_hz(&self) -> Option<f64> {
        match self {
            Self::Drift { absorbs_hz, .. } | Self::Follows { absorbs_hz, .. } => Some(*absorbs_hz),
            _ => None,
        }
    }

    /// What some waves take out of the sample at `place`, where one of them replaces it.
    pub fn size_at(waves: &mut [Self], place: usize) -> Option<&mut f64> {
        waves.iter_mut().find_map(|wave| match wave {
            Self::Replaced(Replaced { all, .. }) => {
                let at = all.binary_search_by_key(&place, |one| one.index).ok()?;
                Some(&mut Arc::make_mut(all)[at].size)
            }
            _ => None,
        })
    }

    /// Takes the waveform out of `values`, whose first sample has index 0.
    pub fn take_out(&self, values: &mut [f64]) {
        match self {
            Self::Steps(jumps) => {
                let down = |jump: &Jump| (jump.index as u64, -jump.height);
                Staircase::new(jumps.iter().map(down)).add_to(values);
            }
            Self::Switching(switching) => switching.take_out(values),
            Self::Meanwhile(levels) => {
                for level in levels {
                    level.negated().add_to(0, values);
                }
                let middle = |level: &Level| (level.from.midpoint(level.to()), level.step);
                Staircase::new(levels.iter().map(middle)).add_to(values);
            }
            Self::WarmUp { amplitude, samples } => {
                // Beyond 40 time constants nothing is left.
                let end = ((40.0 * samples) as usize).min(values.len());
                Settling::new(-amplitude, *samples).add_to(&mut values[..end]);
            }
            Self::Line {
                cycles,
                cosine,
                sine,
                lost,
            } => {
                let (after, samples) = lost.unwrap_or((values.len(), 0));
                let (before, later) = values.split_at_mut(after.min(values.len()));
                let phasor = Phasor::new(*cycles);
                let amplitude = Complex64::new(*cosine, -sine);
                let out = |value: &mut f64, line: Complex64| *value -= line.re;
                phasor.zip(0, before, amplitude, out);
                phasor.zip(after + samples as usize, later, amplitude, out);
            }
            Self::Drift { drift, rate_hz, .. } => {
                drift.negated().spline(*rate_hz).add_to(values);
            }
            Self::Shocks { shocks, rate_hz } => {
                for shock in shocks {
                    let down = Shock {
                        peak: -shock.peak,
                        ..*shock
                    };
                    down.add_to(0, values, *rate_hz);
                }
            }
            Self::Follows { gain, column, .. } => {
                for (value, column) in values.iter_mut().zip(column.iter()) {
                    *value -= gain * f64::from(*column);
                }
            }
            Self::Outliers(outliers) | Self::Replaced(Replaced { all: outliers, .. }) => {
                for outlier in outliers.iter() {
                    if let Some(value) = values.get_mut(outlier.index) {
                        *value -= outlier.size;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_runs_ahead_after_a_loss() {
        let line = |lost| Wave::Line {
            cycles: 0.013,
            cosine: 1.0,
            sine: -2.0,
            lost,
        };
        let (mut whole, mut shorter) = (vec![0.0; 300], vec![0.0; 293]);
        line(None).take_out(&mut whole);
        line(Some((120, 7))).take_out(&mut shorter);
        whole.drain(120..127);
        for (n, (one, other)) in whole.iter().zip(&shorter).enumerate() {
            assert!((one - other).abs() < 1e-12, "{n}: {one} {other}");
        }
        assert_eq!(whole.len(), shorter.len());
    }
}
