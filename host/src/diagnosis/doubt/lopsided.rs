//! Whether noise is as often large on one side as on the other.
//!
//! The whitened record `z` of Gaussian noise is independent standard normal. The score
//!
//! ```text
//! s = sin(t z) - t e^(-t^2 / 2) z
//! ```
//!
//! has mean zero for every symmetric law and is orthogonal to the level; it grows no faster than `z`,
//! so that single outliers do not decide (after T. W. Epps and L. B. Pulley, Biometrika 70 (1983)). At
//! `t` = 1.2 it keeps 90 % of the efficiency of the third moment.

use realfft::num_complex::Complex64;

use super::{Doubt, Hearing};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::record::wave::Outlier;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::statistic::p_value;
use crate::diagnosis::statistic::sums::sums;
use crate::model::kind::Kind;
use crate::model::{clipping, outliers, rounding, telegraph};

/// Argument of the sine: at 1.2 it keeps 90 % of the efficiency of the third moment.
const T: f64 = 1.2;

/// How lopsided the noise of an axis is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lopsided {
    /// Skewness that would make as large a score, for a small one.
    pub skewness: f64,
    /// Probability of as large a score in symmetric noise.
    pub p_value: f64,
}

impl Lopsided {
    /// Whether most of these samples are no farther out than the longer side of such a law reaches.
    fn passes_for(&self, outliers: &[Outlier]) -> bool {
        /// Deviations that one normal number in a billion exceeds: more than a record has samples.
        const FARTHEST: f64 = 6.0;
        // What `z + skewness (z^2 - 1) / 6`, of that skewness where it is small, makes of them; a law that falls as an
        // exponential, of skewness 2, is exceeded as seldom there.
        let reach = FARTHEST + self.skewness.abs() * (FARTHEST * FARTHEST - 1.0) / 6.0;
        let is_of_it = |one: &&Outlier| {
            let z = one.size / one.size_sd * self.skewness.signum();
            (0.0..reach).contains(&z)
        };
        2 * outliers.iter().filter(is_of_it).count() >= outliers.len()
    }
}

/// Of what is left of an axis.
pub fn lopsided(axis: &AxisState) -> Lopsided {
    let seen = axis.whitened();
    let white = seen
        .transform
        .filtered(|k| Complex64::new(seen.density[k].sqrt().recip(), 0.0));
    let white = &*white;
    let counted = |n: usize| axis.usable(n).then(|| white[n]);
    let [count, square] = sums(0..white.len(), |n| {
        counted(n).map_or([0.0; 2], |z| [1.0, z * z])
    });
    let deviation = (square / count.max(1.0)).sqrt();
    let square = T * T;
    let linear = T * (-0.5 * square).exp();
    let score = |z: f64| (T * z).sin() - linear * z;
    let [sum, squares] = sums(0..white.len(), |n| {
        let score = counted(n).map_or(0.0, |z| score(z / deviation));
        [score, score * score]
    });
    let mean = sum / count.max(1.0);
    Lopsided {
        // To first order in the skewness the mean of sin(t z) is -t^3 e^(-t^2 / 2) skewness / 6.
        skewness: -6.0 * mean / (square * linear),
        // By its own scatter, which is that of every symmetric law; of no samples there is nothing to say.
        p_value: if squares > 0.0 {
            p_value::two_sided(sum / squares.sqrt())
        } else {
            1.0
        },
    }
}

/// A law of amplitudes that is not the same on both sides; outliers that belong to its longer side are taken back.
pub static DOUBT: Doubt = Doubt {
    tests: 1,
    why: "samples lie farther to one side than to the other",
    hear,
};

/// Kinds that bend the law of amplitudes themselves.
const BENDS: [Kind; 3] = [clipping::KIND, rounding::KIND, telegraph::KIND];

fn hear(hearing: &mut Hearing<'_>) -> Result<(), NoFit> {
    let mut explanations = hearing.axis.explanations().iter();
    if explanations.any(|one| BENDS.contains(&one.kind())) {
        return Ok(());
    }
    let found = lopsided(hearing.axis);
    if found.p_value >= hearing.level {
        return Ok(());
    }
    if found.passes_for(hearing.axis.residual.outliers()) && hearing.axis.withdraw(outliers::KIND) {
        hearing.axis.refresh()?;
    }
    hearing.remarks.push(Remark {
        test: "amplitude".into(),
        place: if found.skewness > 0.0 {
            Place::UpperSide
        } else {
            Place::LowerSide
        },
        p_value: found.p_value,
        description: format!(
            "the law of amplitudes is lopsided, its tail longer on that side: skewness {:.2} \
             of the noise's whitened samples; something one-sided joins the noise behind all \
             filters",
            found.skewness
        ),
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::diagnosis::trial::{NOTHING, axis, heard, short, spike, take_in};
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    fn of(seed: u64, bend: impl Fn(f64) -> f64) -> Lopsided {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let values = (0..1 << 16).map(|_| bend(noise.draw())).collect();
        lopsided(&AxisState::new(Arc::new(values), 1000.0, None).expect("long enough"))
    }

    #[test]
    fn symmetric_noise_is_not_lopsided() {
        // Of 60 records 0.6 below 1 % are expected: 5 or more have a probability of 4e-4. Heavy tails
        // on both sides are no matter.
        for bend in [|z: f64| z, |z: f64| z + 0.05 * z.powi(3)] {
            let low: Vec<u64> = (0..60)
                .filter(|&seed| of(seed, bend).p_value < 0.01)
                .collect();
            assert!(low.len() < 5, "seeds {low:?}");
        }
    }

    #[test]
    fn where_no_sample_can_be_used_nothing_is_lopsided() {
        // Both ends of a ring so short reach its middle.
        let mut noise = Gaussian::new(Seed { seed: 8, stream: 0 }, 1.0);
        let values: Vec<f64> = (0..1 << 11).map(|_| noise.draw()).collect();
        let axis = AxisState::new(Arc::new(values), 1000.0, None).expect("a spectrum");
        assert!((0..1 << 11).all(|n| !axis.usable(n)));
        assert_eq!(lopsided(&axis).p_value, 1.0);
    }

    #[test]
    fn a_square_in_the_law_tells_its_skewness() {
        for side in [1.0, -1.0] {
            let found = of(7, |z| z + side * 0.05 * (z * z - 1.0));
            // z + e (z^2 - 1) has the third moment 6 e + 8 e^3; its score is seen to 2 %.
            let skewness = side * (6.0 * 0.05 + 8.0 * 0.05_f64.powi(3));
            assert!(found.p_value < 1e-12, "seed 7: {found:?}");
            assert!(
                (found.skewness / skewness - 1.0).abs() < 0.15,
                "seed 7: {found:?}"
            );
        }
    }

    /// An axis whose noise is bent to one side, with an outlier that was taken out of it.
    fn bent(seed: u64, by: f64) -> AxisState {
        let bend = |z: f64| z + by * (z * z - 1.0);
        let mut axis = axis(seed, short(seed), |_, noise| bend(noise));
        let size = 5.0_f64.copysign(by);
        take_in(&mut axis, outliers::KIND, spike(5000, size).into());
        axis
    }

    #[test]
    fn the_longer_tail_is_remarked_on_and_outliers_go_with_it() {
        for (seed, by, side) in [(1, 0.1, Place::UpperSide), (2, -0.1, Place::LowerSide)] {
            let mut axis = bent(seed, by);
            let remarks = heard(&DOUBT, &mut axis, false);
            assert_eq!(remarks.len(), 1, "seed {seed}: {remarks:?}");
            assert_eq!(remarks[0].test, "amplitude", "seed {seed}");
            assert_eq!(remarks[0].place, side, "seed {seed}");
            assert_eq!(axis.kinds(), [], "seed {seed}");
            assert_eq!(*axis.residual.waves(), [], "seed {seed}");
        }
    }

    #[test]
    fn what_no_lopsided_law_reaches_stays() {
        // Skewness 0.6: its longer side ends at ten deviations.
        for (size, is_of_it) in [(8.0, true), (-8.0, false), (30.0, false)] {
            let mut axis = axis(4, short(4), |_, z| z + 0.1 * (z * z - 1.0));
            take_in(&mut axis, outliers::KIND, spike(5000, size).into());
            assert_eq!(heard(&DOUBT, &mut axis, false).len(), 1, "seed 4");
            assert_eq!(axis.kinds().is_empty(), is_of_it, "seed 4: {size}");
        }
    }

    #[test]
    fn outliers_of_symmetric_noise_stay() {
        let mut axis = bent(3, 0.0);
        assert_eq!(heard(&DOUBT, &mut axis, false), [], "seed 3");
        assert_eq!(axis.kinds(), [outliers::KIND], "seed 3");
    }

    #[test]
    fn kinds_that_bend_amplitudes_are_exempt() {
        for kind in [clipping::KIND, rounding::KIND, telegraph::KIND] {
            let mut axis = bent(1, 0.1);
            take_in(&mut axis, kind, NOTHING);
            assert_eq!(heard(&DOUBT, &mut axis, false), [], "{kind}, seed 1");
            assert_eq!(axis.kinds(), [outliers::KIND, kind], "seed 1");
        }
    }
}
