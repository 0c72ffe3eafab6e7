//! Jumps of the level that stay: the matched filter for a step, at every moment.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::axis::profile::{Joint, Profile};
use crate::diagnosis::record::wave::{Jump, Outlier};
use crate::diagnosis::statistic::matched_filter::{
    Match, Step, Transform, Transformer, matched_behind,
};
use crate::diagnosis::statistic::p_value;

/// The largest jump, significant or not.
pub fn largest_jump(
    axis: &AxisState,
    whole: &Transform,
    density: &[f64],
    usable: impl Fn(usize) -> bool,
) -> Option<Jump> {
    let (jump, _) = largest(axis, whole, density, usable)?;
    Some(jump)
}

/// The largest jump as it is with walk and flicker fitted anew, which may have been taken for it;
/// `first` is where it was seen.
pub fn beside_walk(
    axis: &AxisState,
    mut whole: Transform,
    density: &[f64],
    first: &Jump,
    usable: impl Fn(usize) -> bool,
) -> Option<Jump> {
    let profile = Profile::new(axis, &whole, density);
    let joint = joint(axis, &whole, &profile, first.index);
    let density = profile.density(&joint);
    whole.close(&density, &axis.seam(whole.rate_hz()));
    let (jump, filter) = largest(axis, &whole, &density, usable)?;
    Some(Jump {
        z: joint.z,
        p_value: p_value::highest(joint.z, whole.len(), filter.crossings),
        ..jump
    })
}

/// Whether a jump is significant at a `level` beside walk and flicker that are fitted anew with it and without it: where the
/// record is too short to tell how strong these are, what they do looks like a jump in the noise that was fitted.
pub fn is_no_walk(
    axis: &AxisState,
    whole: &Transform,
    density: &[f64],
    jump: &Jump,
    level: f64,
) -> bool {
    let crossings = statistic(axis, whole, density).crossings;
    let joint = joint(axis, whole, &Profile::new(axis, whole, density), jump.index);
    p_value::highest(joint.z, whole.len(), crossings) < level
}

/// A jump at `index` together with walk and flicker.
fn joint(axis: &AxisState, whole: &Transform, profile: &Profile<'_>, index: usize) -> Joint {
    let wave = Transformer::new(whole.len()).waveform_at(&Step, index, whole.rate_hz());
    profile.fit(&wave.behind(axis.passed(whole).as_deref()))
}

/// The largest jump, and the statistic of all.
fn largest(
    axis: &AxisState,
    whole: &Transform,
    density: &[f64],
    usable: impl Fn(usize) -> bool,
) -> Option<(Jump, Match)> {
    let filter = statistic(axis, whole, density);
    // On the ring, what happens at the ends is no event of the record.
    let margin = whole.len() / 200 + 16;
    let index = (margin..whole.len() - margin)
        .filter(|&index| usable(index))
        .max_by(|&a, &b| filter.z[a].abs().total_cmp(&filter.z[b].abs()))?;
    let z = filter.z[index];
    let jump = Jump {
        index,
        height: z * filter.size_sd,
        height_sd: filter.size_sd,
        index_sd: spread(&filter, index),
        z,
        p_value: p_value::highest(z, whole.len(), filter.crossings),
    };
    Some((jump, filter))
}

/// The statistic of a jump at every moment: one that came about ahead of what filters, and passed it without delay.
pub fn statistic(axis: &AxisState, whole: &Transform, density: &[f64]) -> Match {
    let passed = axis.passed(whole);
    let passed = |k: usize| passed.as_ref().map_or(1.0, |passed| passed[k]);
    matched_behind(whole, density, &Step, passed)
}

/// Whether what looks like an outlier is rather a jump, by the statistic of jumps.
pub fn is_jump(statistic: &Match, outlier: &Outlier) -> bool {
    /// Samples on either side that a jump may be placed at: a choice.
    const PLACING: usize = 4;
    /// Difference of squared statistics that is no chance: eight nats, odds of 3000 to 1.
    const PLAINLY: f64 = 16.0;
    let near = outlier.index.saturating_sub(PLACING)..=outlier.index + PLACING;
    // The last few samples may be left over of the ring.
    let there = near.filter_map(|n| statistic.z.get(n));
    let jump = there.fold(0.0, |most: f64, z| most.max(z.abs()));
    // The waveform that is there has the larger statistic; by several nats, as both have chance.
    jump * jump > (outlier.size / outlier.size_sd).powi(2) + PLAINLY
}

/// A jump known to within `reach` samples, placed among the samples themselves.
pub fn place(filter: &Match, jump: Jump, reach: usize) -> Jump {
    let from = jump.index.saturating_sub(reach);
    let to = (jump.index + reach).min(filter.z.len() - 1);
    let index = (from..=to)
        .max_by(|&a, &b| {
            let along = |index: usize| filter.z[index] * jump.z.signum();
            along(a).total_cmp(&along(b))
        })
        .unwrap_or(jump.index);
    // Among larger ones that are still there a jump may show less than where it was found.
    let index_sd = spread(filter, index).clamp(0.5, jump.index_sd.max(reach as f64));
    Jump {
        index,
        index_sd,
        ..jump
    }
}

/// Uncertainty of the moment of a jump, as a standard deviation: the moments at which the
/// likelihood ratio has fallen by less than 7.35 are a 95 % set (B. E. Hansen, Econometrica 68
/// (2000) 575, table 1).
fn spread(filter: &Match, index: usize) -> f64 {
    const FALL: f64 = 7.35;
    let top = filter.z[index];
    let inside = |z: &f64| z * top > 0.0 && top * top - z * z < FALL;
    let before = filter.z[..index]
        .iter()
        .rev()
        .take_while(|z| inside(z))
        .count();
    let after = filter.z[index + 1..]
        .iter()
        .take_while(|z| inside(z))
        .count();
    before.max(after) as f64 / 1.96
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::record::wave::Wave;

    /// Noise with a jump by 4 at 9000.
    fn with_jump(seed: u64) -> Trial {
        let mut values = noise(seed);
        trial::add(&mut values, &Wave::Steps(vec![trial::jump(9000, 4.0)]));
        Trial::new(values)
    }

    #[test]
    fn no_jump_is_looked_for_where_moments_do_not_count() {
        let trial = with_jump(1);
        let seen = trial.axis.whitened();
        let at = |usable: fn(usize) -> bool| {
            let jump = largest_jump(&trial.axis, &seen.transform, &seen.density, usable);
            jump.expect("a record longer than its margins").index
        };
        assert!(at(|_| true).abs_diff(9000) < 10, "seed 1");
        assert!(
            at(|n| n.abs_diff(9000) > 500).abs_diff(9000) > 500,
            "seed 1"
        );
    }

    #[test]
    fn a_jump_must_be_plainer_than_an_outlier_by_more_than_chance() {
        let trial = with_jump(2);
        let seen = trial.axis.whitened();
        let statistic = statistic(&trial.axis, &seen.transform, &seen.density);
        let z = (8996..=9004).map(|n| statistic.z[n].abs());
        let z = z.fold(0.0, f64::max);
        let less_by = |nats: f64| {
            let size = (z * z - 2.0 * nats).sqrt();
            is_jump(&statistic, &trial::outlier(9000, size))
        };
        assert!(less_by(9.0) && !less_by(7.0), "seed 2: {z}");
    }
}
