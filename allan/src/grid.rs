//! The averaging times of the streaming estimators, how far apart their differences lie, and how many
//! knots these take.
//!
//! Four averaging times an octave, `m` in {1, 2, 3} and {4, 5, 6, 7} * 2^k. The 17 shortest form
//! the *ground* and use every overlap. Above it, *level* `l` (from 1) takes the four averaging
//! times {24, 28, 32, 40} * 2^l, looks only at absolute indices that are multiples of `2^l`, and so
//! has 24 to 40 differences an averaging time. Against full overlap that costs at most 0.6 % of
//! the degrees of freedom for white, flicker and walk noise in records of at least 8 averaging
//! times (tested below); half of it is the last, incomplete stride. Differenced white noise
//! has nearly independent neighbours, so there the loss is the whole factor `2^l`; the degrees of
//! freedom that [`edf`](crate::edf::edf) gives for the stride account for it.

/// Averaging times of the ground, at full overlap.
pub(crate) const GROUND_LAGS: [u64; 17] =
    [1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40];

/// Averaging times of a level in units of its stride.
pub(crate) const LEVEL_LAGS: [u64; 4] = [24, 28, 32, 40];

/// Samples of a block. 2^11, which the kernels' partial sums allow for; and the sum of sums of that
/// many codes below 2^42 is below 2^63.
pub(crate) const BLOCK: usize = 2048;

/// Knots that the longest difference reaches back: three of the longest lag, in the row of the
/// ground as in that of a level.
pub(crate) const REACH: u64 = 3 * GROUND_LAGS[GROUND_LAGS.len() - 1];

/// Knots of a block's row: those from before it, the last of which may itself be new, and its own.
pub(crate) const LONGEST: usize = REACH as usize + 1 + BLOCK;

/// Knots of a level's row: from before the block likewise, and every second of the block at most.
pub(crate) const LEVEL: usize = REACH as usize + 1 + BLOCK / 2;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Statistic;
    use crate::edf::{Noise, edf};

    const STATISTICS: [Statistic; 3] = [Statistic::Allan, Statistic::Modified, Statistic::Hadamard];

    #[test]
    #[cfg_attr(miri, ignore = "long sums of plain floating-point numbers")]
    fn striding_costs_what_is_stated() {
        let mut worst = (0.0, Statistic::Allan, Noise::White, 0, 0);
        for statistic in STATISTICS {
            for noise in [Noise::White, Noise::Flicker, Noise::Walk] {
                // At level 1 a stride is two samples, where every record length of some octaves can
                // be tried; at level 10 sampling is fine and the last stride may be nearly lost.
                for (level, lag) in [1, 10]
                    .into_iter()
                    .flat_map(|l| LEVEL_LAGS.map(|lag| (l, lag)))
                {
                    let (m, stride) = (lag << level, 1 << level);
                    let span = statistic.span(m);
                    let lengths = (8 * m..16 * m).step_by(if level == 1 { 3 } else { 5 << level });
                    for samples in lengths.map(|length| length + stride - 1) {
                        let full = edf(statistic, noise, m, 1, samples - span + 1);
                        // The least favourable alignment of the record to the stride.
                        let terms = (samples - span + 1) / stride;
                        let loss = 1.0 - edf(statistic, noise, m, stride, terms) / full;
                        if loss > worst.0 {
                            worst = (loss, statistic, noise, m, samples);
                        }
                    }
                }
            }
        }
        assert!(worst.0 < 0.006, "{worst:?}");
        // Stated above; if the grid changes for the better, so should the statement.
        assert!(worst.0 > 0.005, "{worst:?}");
    }

    #[test]
    fn quantisation_noise_loses_the_stride() {
        let full = edf(Statistic::Allan, Noise::Quantisation, 48, 1, 10_000);
        let strided = edf(Statistic::Allan, Noise::Quantisation, 48, 2, 5_000);
        assert!(
            (full / strided / 2.0 - 1.0).abs() < 1e-3,
            "{full} {strided}"
        );
    }
}
