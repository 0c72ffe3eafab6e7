//! Whether a noisier stretch is noisier at all frequencies alike.

use std::ops::Range;

use crate::criticise::axis::Seen;
use crate::criticise::steadiness::strengths;
use crate::criticise::tail;

/// Ordinates of the narrowest band, and moments within the stretch that a band must have.
const LEAST_ORDINATES: usize = 64;
const LEAST_MOMENTS: usize = 8;

/// Probability of strengths in octave bands that differ as much, for a `stretch` of the record (in
/// samples) that is all of one factor.
///
/// The mean of `n` strengths follows a gamma law of shape `n`; twice the log-likelihood ratio of one
/// factor for each band against one for all is chi-squared with one degree less than bands.
pub fn p_value(seen: &Seen, stretch: &Range<usize>) -> f64 {
    let length = seen.whole.len();
    let mut bands = Vec::new();
    let mut top = seen.top - 1;
    while top >= 2 * LEAST_ORDINATES {
        let ordinates = top / 2..top;
        top /= 2;
        let moments = ordinates.len();
        let strengths = strengths(seen, ordinates);
        let at = |moment: usize| moment * length / moments;
        let inside: Vec<f64> = (0..moments)
            .filter(|&moment| stretch.contains(&at(moment)))
            .map(|moment| strengths[moment])
            .collect();
        let outside = strengths.iter().sum::<f64>() - inside.iter().sum::<f64>();
        let outside = outside / (moments - inside.len()).max(1) as f64;
        let count = inside.len() as f64;
        if inside.len() >= LEAST_MOMENTS && outside > 0.0 {
            bands.push((count, inside.iter().sum::<f64>() / count / outside));
        }
    }
    let total: f64 = bands.iter().map(|(count, _)| count).sum();
    let all = bands
        .iter()
        .map(|(count, ratio)| count * ratio)
        .sum::<f64>()
        / total;
    let ratio: f64 = bands
        .iter()
        .map(|(count, ratio)| 2.0 * count * (all / ratio).ln())
        .sum();
    if bands.len() < 2 {
        return 1.0;
    }
    tail::chi_squared(ratio, bands.len() as f64 - 1.0)
}
