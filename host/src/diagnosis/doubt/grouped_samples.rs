//! Large samples that come in groups: something that rings, or a tone that is switched on, goes beyond the
//! threshold several times. They are no outliers, and what they are has no name.

use super::{Doubt, Hearing};
use crate::diagnosis::axis::NoFit;
use crate::diagnosis::detect::outliers::filter;
use crate::diagnosis::record::wave::Outlier;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::steady::band_events::is_of_excluded;

/// Remarks on groups that were seen on the way and are there still. Their test is that of outliers.
pub static DOUBT: Doubt = Doubt {
    tests: 0,
    why: "large samples come in groups",
    hear,
};

/// Samples on either side of the largest that are its group.
const GROUP: usize = 1024;

fn hear(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    if !hearing.large_samples_in_groups {
        return Ok(());
    }
    let axis = &*hearing.axis;
    let seen = axis.whitened();
    let usable = |index: usize| axis.usable(index);
    let (transform, density) = (&seen.transform, &seen.density);
    let found = filter::outliers(transform, density, hearing.level, usable, |_| 1.0);
    let grouped = filter::together(&found.outliers, axis.ring_len());
    let samples = found.outliers.iter().map(|one| one.index..one.index + 1);
    let samples: Vec<_> = samples.collect();
    // What belongs to an excluded band is remarked on with it.
    if grouped >= hearing.level || is_of_excluded(axis, &samples) {
        return Ok(());
    }
    let by_size = |a: &&Outlier, b: &&Outlier| a.size.abs().total_cmp(&b.size.abs());
    if let Some(largest) = found.outliers.iter().max_by(by_size) {
        let near = |one: &&Outlier| one.index.abs_diff(largest.index) <= GROUP;
        let group: Vec<&Outlier> = found.outliers.iter().filter(near).collect();
        let at_s = |index: usize| index as f64 / axis.rate_hz;
        let ends = group.first().zip(group.last());
        let (first, last) = ends.map_or((largest, largest), |(first, last)| (*first, *last));
        hearing.remarks.push(Remark {
            test: "samples".into(),
            place: Place::Stretch([at_s(first.index), at_s(last.index)]),
            p_value: found.p_value.max(grouped),
            description: format!(
                "{} samples far out, in groups rather than by themselves, the largest {:.1} \
                 deviations: something that rings, a knock, or a tone that is switched",
                found.outliers.len(),
                (largest.size / largest.size_sd).abs()
            ),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::axis::AxisState;
    use crate::diagnosis::trial::{LEVEL, RATE_HZ, axis, excluded, short};

    const SEED: u64 = 1;

    /// Places far from one another.
    const APART: [usize; 4] = [4001, 7500, 11_111, 15_002];

    /// Noise with samples that are too large at some places and `more` beyond that after 20 samples, the second of
    /// the places further out than the others.
    fn values(more: f64) -> AxisState {
        axis(SEED, short(SEED), |n, noise| {
            let size = |place: usize| if place == APART[1] { 16.0 } else { 14.0 };
            let of = |place: &usize| match n.wrapping_sub(*place) {
                0 => size(*place),
                20 => more,
                _ => 0.0,
            };
            noise + APART.iter().map(of).sum::<f64>()
        })
    }

    fn heard(axis: &mut AxisState, large_samples_in_groups: bool) -> Vec<Remark> {
        let mut hearing = Hearing {
            axis,
            level: LEVEL,
            strength_moves: false,
            large_samples_in_groups,
            remarks: Vec::new(),
            no_course: None,
        };
        (DOUBT.hear)(&mut hearing).expect("nothing is fitted");
        hearing.remarks
    }

    #[test]
    fn groups_are_remarked_on_where_the_largest_is() {
        let mut pairs = values(14.0);
        let [remark] = &heard(&mut pairs, true)[..] else {
            panic!("seed {SEED}: no remark, or more than one");
        };
        let ends_s = [APART[1], APART[1] + 20].map(|n| n as f64 / RATE_HZ);
        assert_eq!(remark.place, Place::Stretch(ends_s), "seed {SEED}");
        // Not seen on the way.
        assert_eq!(heard(&mut pairs, false), [], "seed {SEED}");
        // By themselves.
        assert_eq!(heard(&mut values(0.0), true), [], "seed {SEED}");
    }

    #[test]
    fn groups_where_an_excluded_band_is_loud_are_its_own() {
        // A tone of 200 Hz, switched on for 400 samples about each of the places.
        let loud = |n: usize| APART.iter().any(|place| n.abs_diff(*place) < 200);
        let tone = |n: usize| 2.0 * (std::f64::consts::TAU * 0.2 * n as f64).cos();
        let large = |n: usize| APART.iter().any(|place| n == *place || n == *place + 20);
        let mut tones = axis(SEED, short(SEED), |n, noise| {
            noise + if loud(n) { tone(n) } else { 0.0 } + if large(n) { 14.0 } else { 0.0 }
        });
        assert_eq!(
            heard(&mut tones, true).len(),
            1,
            "seed {SEED}: not excluded"
        );
        tones.exclude(excluded(180.0, 220.0));
        tones.refresh().expect("a fit");
        assert_eq!(heard(&mut tones, true), [], "seed {SEED}");
    }
}
