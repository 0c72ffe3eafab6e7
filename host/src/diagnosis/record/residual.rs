//! A record with what has been explained taken out of it.
//!
//! Waveforms are subtracted, single bad samples bridged, stretches that follow another law masked.
//! What the measured record and the mended one differ by is the model's deterministic part.

use std::ops::Range;
use std::sync::Arc;

use realfft::num_complex::Complex64;

use crate::diagnosis::detect::outliers::Outlier;
use crate::diagnosis::detect::steps::Jump;
use crate::fft::phasor::Phasor;

/// A waveform in the record.
#[derive(Debug, Clone, PartialEq)]
pub enum Wave {
    /// Jumps of the level that stay.
    Steps(Vec<Jump>),
    /// Exponential settling from the start of the record.
    WarmUp {
        /// Size at the start.
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
        /// Gain.
        gain: f64,
        /// The covariate, about its mean.
        column: Arc<Vec<f32>>,
    },
    /// Single samples that do not belong.
    Outliers(Vec<Outlier>),
    /// Single samples that were not measured (repeats of the one before), in place of which the
    /// others' prediction stands.
    Replaced(Vec<Outlier>),
}

impl Wave {
    /// Takes the waveform out of `values`, whose first sample has index 0.
    pub fn take_out(&self, values: &mut [f64]) {
        match self {
            Self::Steps(jumps) => {
                let mut level = 0.0;
                let mut from = 0;
                for jump in jumps {
                    let end = jump.index.min(values.len());
                    values[from..end]
                        .iter_mut()
                        .for_each(|value| *value -= level);
                    level += jump.height;
                    from = end;
                }
                values[from..].iter_mut().for_each(|value| *value -= level);
            }
            Self::WarmUp { amplitude, samples } => {
                // Beyond 40 time constants nothing is left.
                let end = ((40.0 * samples) as usize).min(values.len());
                for (index, value) in values[..end].iter_mut().enumerate() {
                    *value -= amplitude * (-(index as f64) / samples).exp();
                }
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
            Self::Follows { gain, column } => {
                for (value, column) in values.iter_mut().zip(column.iter()) {
                    *value -= gain * f64::from(*column);
                }
            }
            Self::Outliers(outliers) | Self::Replaced(outliers) => {
                for outlier in outliers {
                    if let Some(value) = values.get_mut(outlier.index) {
                        *value -= outlier.size;
                    }
                }
            }
        }
    }
}

/// A record on its way to being explained.
#[derive(Debug, Clone)]
pub struct Mended {
    /// As measured, about the mean; missing samples are NaN.
    measured: Arc<Vec<f64>>,
    /// What is taken out.
    pub waves: Vec<Wave>,
    /// Stretches of other noise, which the stationary law does not speak for.
    pub masked: Vec<Range<usize>>,
    /// Moments at which samples were lost.
    pub lost: Vec<Range<usize>>,
    /// Jumps as wide as a converter's filter spreads them.
    pub spread: Vec<Range<usize>>,
}

impl Mended {
    /// A record as measured.
    pub fn new(measured: Arc<Vec<f64>>) -> Self {
        Self {
            measured,
            waves: Vec::new(),
            masked: Vec::new(),
            lost: Vec::new(),
            spread: Vec::new(),
        }
    }

    /// Single samples that are taken out of it.
    pub fn outliers(&self) -> &[Outlier] {
        let all = self.waves.iter().find_map(|wave| match wave {
            Wave::Outliers(all) => Some(all.as_slice()),
            _ => None,
        });
        all.unwrap_or_default()
    }

    /// As measured.
    pub fn measured(&self) -> &[f64] {
        &self.measured
    }

    /// Samples, missing ones included.
    pub fn len(&self) -> usize {
        self.measured.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.measured.is_empty()
    }

    /// What is left; NaN where missing or masked. The measured values themselves where nothing was
    /// taken out.
    pub fn values(&self) -> Arc<Vec<f64>> {
        let mut left = Arc::clone(&self.measured);
        for wave in &self.waves {
            wave.take_out(Arc::make_mut(&mut left).as_mut_slice());
        }
        for mask in self.left_out() {
            let end = mask.end.min(left.len());
            Arc::make_mut(&mut left)[mask.start.min(end)..end].fill(f64::NAN);
        }
        left
    }

    /// All that is left out.
    pub fn left_out(&self) -> impl Iterator<Item = &Range<usize>> {
        self.masked.iter().chain(&self.lost).chain(&self.spread)
    }

    /// The same record with nothing explained but the stretches that are left out.
    pub fn bare(&self) -> Self {
        Self {
            waves: Vec::new(),
            ..self.clone()
        }
    }

    /// All that is taken out of it, as it is in the record.
    pub fn waveform(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.measured.len()];
        for wave in &self.waves {
            wave.take_out(&mut values);
        }
        values.iter_mut().for_each(|value| *value = -*value);
        values
    }

    /// Jumps that are taken out of it.
    pub fn jumps(&self) -> impl Iterator<Item = &Jump> {
        self.waves.iter().flat_map(|wave| match wave {
            Wave::Steps(jumps) => jumps.as_slice(),
            _ => &[],
        })
    }

    /// Where jumps were taken out, to within what their moments are known and `more` samples.
    pub fn about_jumps(&self, more: usize) -> impl Iterator<Item = Range<usize>> {
        self.jumps().map(move |jump| {
            let reach = (3.0 * jump.index_sd) as usize + more;
            jump.index.saturating_sub(reach)..(jump.index + reach).min(self.measured.len())
        })
    }
}

/// Bridges what is not finite by straight lines between means on either side, of more samples the
/// longer the bridge: the ends' own noise must not become a slow wave. Returns the ranges bridged.
pub fn bridge(values: &mut [f64]) -> Vec<Range<usize>> {
    /// Samples on either side that a line rests on, at least and at most.
    const FEW: usize = 16;
    const MANY: usize = 1 << 16;
    let mut gaps = Vec::new();
    let mut from = 0;
    while let Some(start) = (from..values.len()).find(|&index| !values[index].is_finite()) {
        let end = (start..values.len())
            .find(|&index| values[index].is_finite())
            .unwrap_or(values.len());
        let mean = |part: &[f64]| {
            let good: Vec<f64> = part.iter().copied().filter(|v| v.is_finite()).collect();
            (!good.is_empty()).then(|| good.iter().sum::<f64>() / good.len() as f64)
        };
        let count = (4 * (end - start)).clamp(FEW, MANY);
        let before = mean(&values[start.saturating_sub(count)..start]);
        let after = mean(&values[end..(end + count).min(values.len())]);
        let (a, b) = match (before, after) {
            (Some(a), Some(b)) => (a, b),
            (Some(a), None) | (None, Some(a)) => (a, a),
            (None, None) => (0.0, 0.0),
        };
        let length = (end - start + 1) as f64;
        for (step, value) in values[start..end].iter_mut().enumerate() {
            *value = a + (b - a) * (step + 1) as f64 / length;
        }
        gaps.push(start..end);
        from = end;
    }
    gaps
}

/// Means over `factor` samples each.
pub fn block_means(values: &[f64], factor: usize) -> Vec<f64> {
    values
        .chunks_exact(factor)
        .map(|block| block.iter().sum::<f64>() / factor as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_taken_out_and_given_back() {
        let measured: Vec<f64> = (0..1000).map(|n| f64::from(n % 7)).collect();
        let mut record = Mended::new(Arc::new(measured.clone()));
        let jump = |index, height| Jump {
            index,
            height,
            height_sd: 1.0,
            index_sd: 1.0,
            z: 10.0,
            p_value: 0.0,
        };
        record.waves = vec![
            Wave::Steps(vec![jump(100, 2.0), jump(400, -3.0)]),
            Wave::WarmUp {
                amplitude: 5.0,
                samples: 50.0,
            },
            Wave::Line {
                cycles: 0.01,
                cosine: 1.0,
                sine: 0.5,
                lost: None,
            },
        ];
        record.masked = vec![10..20];
        let (left, mut taken) = (record.values(), vec![0.0; 1000]);
        for wave in &record.waves {
            wave.take_out(&mut taken);
        }
        for n in 0..1000 {
            if (10..20).contains(&n) {
                assert!(left[n].is_nan());
            } else {
                assert!((left[n] - taken[n] - measured[n]).abs() < 1e-12, "{n}");
            }
        }
        // Between these the level rises by 2, the line by 2, and the settling falls.
        let settled = 5.0 * (f64::exp(-1.0) - f64::exp(-6.0));
        assert!((taken[50] - taken[300] - (4.0 - settled)).abs() < 1e-9);
    }

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

    #[test]
    fn bridges_are_straight() {
        let mut values = vec![1.0; 40];
        values[10..13].fill(f64::NAN);
        values[13..].fill(5.0);
        assert_eq!(bridge(&mut values), [10..13]);
        assert_eq!(&values[9..14], [1.0, 2.0, 3.0, 4.0, 5.0]);
    }
}
