//! What is left of a record once what has been explained is taken out of it.
//!
//! Waveforms are subtracted, single bad samples replaced, stretches that follow another law excluded.
//! All of it follows from the explanations of the axis: none of it is kept by itself.

use std::ops::Range;
use std::sync::Arc;

use crate::diagnosis::record::short_gaps::ShortGaps;
use crate::diagnosis::record::wave::{Jump, Outlier, Wave};
use crate::model::shock::Shock;

/// What is done to a record.
#[derive(Debug, Clone, Default)]
pub struct TakenOut {
    /// Waveforms that are subtracted.
    pub waves: Vec<Wave>,
    /// Stretches of another noise, which the stationary law does not speak for.
    pub masked: Vec<Range<usize>>,
    /// Moments at which samples were lost.
    pub cut: Vec<Range<usize>>,
}

/// A record and what is done to it.
#[derive(Debug, Clone)]
pub struct Residual {
    /// As measured, about the mean; missing samples are NaN.
    measured: Arc<Vec<f64>>,
    /// The same, short gaps filled.
    whole: Arc<Vec<f64>>,
    taken: TakenOut,
    /// Jumps as wide as a converter's filter spreads them, and where those of a switching are not known to the noise.
    spread: Vec<Range<usize>>,
}

impl Residual {
    /// A record as measured and as it is with its short gaps filled, with nothing done to it.
    pub fn new(measured: Arc<Vec<f64>>, whole: Arc<Vec<f64>>) -> Self {
        Self {
            measured,
            whole,
            taken: TakenOut::default(),
            spread: Vec::new(),
        }
    }

    /// What is left of the same record when this is `taken` out; a jump is spread over `spread` samples on
    /// either side, where a converter's filter stands before them.
    pub fn after(&self, taken: TakenOut, spread: Option<usize>) -> Self {
        let mut left = Self {
            taken,
            ..Self::new(Arc::clone(&self.measured), Arc::clone(&self.whole))
        };
        left.spread = spread.map_or_else(Vec::new, |samples| left.about_jumps(samples).collect());
        let samples = left.measured.len();
        let of_switching = left.taken.waves.iter().filter_map(|wave| match wave {
            Wave::Switching(switching) => Some(switching.unsure(samples)),
            _ => None,
        });
        left.spread.extend(of_switching.flatten());
        left
    }

    /// The same record with other waveforms taken out, and the same stretches excluded.
    pub fn with(&self, waves: impl IntoIterator<Item = Wave>) -> Self {
        let mut other = self.clone();
        other.taken.waves = waves.into_iter().collect();
        other
    }

    /// The waveforms that are taken out.
    pub fn waves(&self) -> &[Wave] {
        &self.taken.waves
    }

    /// Single samples that are taken out of it.
    pub fn outliers(&self) -> &[Outlier] {
        let all = self.taken.waves.iter().find_map(|wave| match wave {
            Wave::Outliers(all) => Some(all.as_slice()),
            _ => None,
        });
        all.unwrap_or_default()
    }

    /// The record as it was measured, in the unit of the signal; NaN where a sample is missing.
    pub fn measured(&self) -> &[f64] {
        &self.measured
    }

    /// The same with its short gaps filled; NaN where more is missing.
    pub fn whole(&self) -> &[f64] {
        &self.whole
    }

    /// Fills the samples `at` these places anew, so that `left` is left of them: missing ones, and those that are no
    /// measurement.
    pub fn refill(&mut self, at: &[usize], left: &[f64]) {
        let before = self.values();
        let whole = Arc::make_mut(&mut self.whole);
        for &place in at.iter().filter(|&&place| before[place].is_finite()) {
            let by = left[place] - before[place];
            if !self.measured[place].is_finite() {
                whole[place] += by;
            } else if let Some(size) = Wave::size_at(&mut self.taken.waves, place) {
                *size -= by;
            }
        }
    }

    /// Places of the samples that were replaced as no measurements, ascending.
    pub fn replaced(&self) -> Vec<usize> {
        let of_waves = self.taken.waves.iter().filter_map(Wave::replaced);
        let mut places: Vec<usize> = of_waves
            .flat_map(|all| all.iter().map(|one| one.index))
            .collect();
        places.sort_unstable();
        places.dedup();
        places
    }

    /// Gaps of few samples that are missing, and those of what was replaced.
    pub fn short_gaps(&self) -> Option<ShortGaps> {
        ShortGaps::of(&self.measured, &self.replaced())
    }

    /// Leaves the samples missing that are in none of these gaps, and bridges those that are and were not.
    pub fn fill_only(&mut self, gaps: Option<&ShortGaps>) {
        let places = gaps.map_or(&[][..], ShortGaps::places);
        let mut bridged = self.whole.to_vec();
        if let Some(gaps) = gaps {
            gaps.bridge(&mut bridged);
        }
        let missing: Vec<usize> = (0..self.len())
            .filter(|n| !self.measured[*n].is_finite())
            .collect();
        let whole = Arc::make_mut(&mut self.whole);
        for n in missing {
            if places.binary_search(&n).is_err() {
                whole[n] = f64::NAN;
            } else if whole[n].is_nan() {
                whole[n] = bridged[n];
            }
        }
    }

    /// How many samples there are, missing ones included.
    pub fn len(&self) -> usize {
        self.measured.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.measured.is_empty()
    }

    /// What is left, short gaps filled; NaN where more is missing or excluded. The record itself if nothing was taken out.
    pub fn values(&self) -> Arc<Vec<f64>> {
        self.where_it_counts(&self.taken.waves)
    }

    /// The same with all that was taken out in it.
    pub fn with_waves(&self) -> Arc<Vec<f64>> {
        self.where_it_counts(&[])
    }

    /// What is left, short gaps filled, of what is excluded too; NaN where more is missing.
    pub fn everywhere(&self) -> Arc<Vec<f64>> {
        self.without(&self.taken.waves)
    }

    /// The record without some waves.
    fn without(&self, waves: &[Wave]) -> Arc<Vec<f64>> {
        let mut left = Arc::clone(&self.whole);
        for wave in waves {
            wave.take_out(Arc::make_mut(&mut left).as_mut_slice());
        }
        left
    }

    /// The record without some waves, NaN where it is excluded.
    fn where_it_counts(&self, waves: &[Wave]) -> Arc<Vec<f64>> {
        let mut left = self.without(waves);
        for mask in self.left_out() {
            let end = mask.end.min(left.len());
            Arc::make_mut(&mut left)[mask.start.min(end)..end].fill(f64::NAN);
        }
        left
    }

    /// What is left of the samples that were measured; NaN where one is missing or no measurement, drawn or not, or
    /// excluded.
    pub fn seen(&self) -> Arc<Vec<f64>> {
        let mut left = self.values();
        for place in self.replaced() {
            Arc::make_mut(&mut left)[place] = f64::NAN;
        }
        if !Arc::ptr_eq(&self.whole, &self.measured) {
            let pairs = Arc::make_mut(&mut left)
                .iter_mut()
                .zip(self.measured.iter());
            let drawn = pairs.filter(|(_, measured)| !measured.is_finite());
            drawn.for_each(|(left, _)| *left = f64::NAN);
        }
        left
    }

    /// All ranges that are excluded.
    pub fn left_out(&self) -> impl Iterator<Item = &Range<usize>> {
        self.masked_or_cut().chain(&self.spread)
    }

    /// The same without what a filter makes of jumps.
    pub fn masked_or_cut(&self) -> impl Iterator<Item = &Range<usize>> {
        self.taken.masked.iter().chain(&self.taken.cut)
    }

    /// Whether stretches of it are masked.
    pub fn is_masked(&self) -> bool {
        !self.taken.masked.is_empty()
    }

    /// What a converter's filter makes of the jumps.
    pub fn spread(&self) -> &[Range<usize>] {
        &self.spread
    }

    /// All that is taken out of it, as it is in the record.
    pub fn waveform(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.measured.len()];
        for wave in &self.taken.waves {
            wave.take_out(&mut values);
        }
        values.iter_mut().for_each(|value| *value = -*value);
        values
    }

    /// Transients that were taken out.
    pub fn shocks(&self) -> impl Iterator<Item = &Shock> {
        self.taken.waves.iter().flat_map(|wave| match wave {
            Wave::Shocks { shocks, .. } => shocks.as_slice(),
            _ => &[],
        })
    }

    /// Jumps that are taken out of it.
    pub fn jumps(&self) -> impl Iterator<Item = &Jump> {
        self.taken.waves.iter().flat_map(|wave| match wave {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_are_taken_out_and_given_back() {
        let measured: Vec<f64> = (0..1000).map(|n| f64::from(n % 7)).collect();

        let jump = |index, height| Jump {
            index,
            height,
            height_sd: 1.0,
            index_sd: 1.0,
            z: 10.0,
            p_value: 0.0,
        };
        let waves = vec![
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
        let taken_out = TakenOut {
            waves,
            masked: vec![10..20],
            cut: Vec::new(),
        };
        let record = Residual::new(Arc::new(measured.clone()), Arc::new(measured.clone()))
            .after(taken_out, None);
        let (left, mut taken) = (record.values(), vec![0.0; 1000]);
        for wave in record.waves() {
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
}
