//! What a chain makes of the ends of a shock: a filter answers to ringing with the same ringing, but for the time of its own
//! response, and that is not of any simple form.

use std::ops::Range;

use super::about::About;
use super::fit::{Fitted, Form, ONE_MORE, known, settle};
use crate::model::shock::Shock;
use crate::numeric::product::dot;

/// The same where what a chain makes of its beginning, and of the end of a bump, says nothing, if that is worth what it
/// costs; and what is left about the event then. A filter answers to ringing with the same ringing, but for the time of its
/// own response.
pub fn beside_ends(about: &About, fitted: &Fitted) -> Option<(About, Fitted)> {
    /// Means on either side of an end that say nothing: a choice. A converter's filter answers for some 27 samples.
    const REACHES: [usize; 4] = [4, 8, 16, 32];
    let shock = &fitted.shock;
    let rings = shock.f_hz > 0.0;
    let ends = [shock.time_s, shock.time_s + shock.duration_s];
    let square = |about: &About| dot(about.errors(), about.errors());
    let tried = REACHES.iter().filter_map(|reach| {
        let reach = (reach * about.factor()) as f64;
        let near_of =
            |end: f64| (end - reach).max(about.from() as f64) as usize..(end + reach) as usize;
        let near = ends.iter().filter(|end| end.is_finite());
        let near: Vec<Range<usize>> = near.map(|end| near_of(*end)).collect();
        let rest = about.without(&near)?;
        let later = if rings {
            let first = [shock.time_s, shock.f_hz.ln(), shock.decay_s.ln()];
            begun(
                about,
                &rest,
                &settle(&rest, Form::Ringing, &first)?,
                &near[0],
            )?
        } else {
            settle(&rest, Form::Bump, &[shock.time_s, shock.duration_s.ln()])?
        };
        let count = (about.count() - rest.count()) as f64;
        let taken = square(about) - square(&rest);
        // A course is told of what it explains, not of what it leaves out.
        let is_most = taken < later.score;
        is_most.then_some((taken + later.score - ONE_MORE * count, rest, later))
    });
    let best = tried.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > fitted.score).then_some((best.1, best.2))
}

/// Ringing that is known from `rest` alone, begun at that half of a turn within a `range` of samples which leaves least of
/// their values: whitened, what a filter shuts out would decide.
fn begun(about: &About, rest: &About, later: &Fitted, range: &Range<usize>) -> Option<Fitted> {
    let Fitted { shock, .. } = later;
    let half = 0.5 / shock.f_hz;
    let first = ((range.start as f64 - shock.time_s) / half).ceil();
    let last = ((range.end as f64 - shock.time_s) / half).floor();
    let left = |time_s: f64| {
        let unit = Shock {
            time_s,
            peak: 1.0,
            ..*shock
        };
        let peak = rest.explained(&rest.of_shock(&unit)).size;
        about.left(&Shock { peak, ..unit }, range)
    };
    let begins = (first as i64..=last as i64).map(|halves| shock.time_s + half * halves as f64);
    let (begins, _) = begins
        .map(|begins| (begins, left(begins)))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    known(
        rest,
        Form::Ringing,
        &[begins, shock.f_hz.ln(), shock.decay_s.ln()],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::shock::fit;
    use crate::diagnosis::detect::shock::trial::{self, bump, ringing};
    use crate::diagnosis::detect::trial::noise;

    /// What is about an event that came through a filter that answers up to `reach` samples from the middle on.
    fn filtered(seed: u64, shock: &Shock, reach: usize) -> About {
        let mut course = vec![0.0; 10_000];
        shock.add_to(0, &mut course, 1.0);
        let mut values = noise(seed);
        let weight = |aside: usize| (reach - aside) as f64 / (reach * reach) as f64;
        for n in 8900..9400 {
            let near =
                (1..reach).map(|aside| weight(aside) * (course[n - aside] + course[n + aside]));
            values[n] += weight(0) * course[n] + near.sum::<f64>();
        }
        trial::about(&values)
    }

    fn later(seed: u64, about: &About) -> (Fitted, Fitted) {
        let first = fit::fit(about).unwrap_or_else(|| panic!("seed {seed}: no fit"));
        let later = beside_ends(about, &first);
        let (_, later) = later.unwrap_or_else(|| panic!("seed {seed}: nothing at its ends"));
        (first, later)
    }

    #[test]
    fn ringing_behind_a_filter_is_told_by_what_follows_its_beginning() {
        for seed in 0..3 {
            let shock = ringing(9020.3, 1e3, 0.03, 40.0);
            let (first, later) = later(seed, &filtered(seed, &shock, 5));
            let off = |one: &Fitted| (one.shock.decay_s / shock.decay_s - 1.0).abs();
            assert!(
                off(&later) < off(&first),
                "seed {seed}: {first:?} {later:?}"
            );
            // A size of a thousand, which rings for n = 40 samples a decay, is known to 1 / (1000 sqrt(n / 4)), the decay to
            // twice that.
            assert!(off(&later) < 5e-3, "seed {seed}: {later:?}");
            // What dies away is shifted by a filter that shifts no tone: by a tenth of a sample here.
            let late = later.shock.time_s - shock.time_s;
            assert!(late.abs() < 0.2, "seed {seed}: {late}");
        }
    }

    #[test]
    fn a_bump_behind_a_filter_is_told_by_what_is_between_its_ends() {
        for seed in 3..6 {
            let shock = bump(9020.3, 1e4, 90.0);
            let (first, later) = later(seed, &filtered(seed, &shock, 13));
            let off = |one: &Fitted| (one.shock.duration_s / shock.duration_s - 1.0).abs();
            assert!(
                off(&later) < off(&first),
                "seed {seed}: {first:?} {later:?}"
            );
            assert!(off(&later) < 2e-3, "seed {seed}: {later:?}");
        }
    }

    #[test]
    fn ringing_without_a_filter_is_all_there_is() {
        for seed in 6..9 {
            let mut values = noise(seed);
            ringing(9020.3, 100.0, 0.053, 40.0).add_to(0, &mut values, 1.0);
            let about = trial::about(&values);
            let fitted = fit::fit(&about).unwrap_or_else(|| panic!("seed {seed}: no fit"));
            assert!(beside_ends(&about, &fitted).is_none(), "seed {seed}");
        }
    }
}
