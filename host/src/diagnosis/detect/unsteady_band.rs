//! Bands of noise that no steady law speaks for: they are excluded from what fits and tests look at.

use std::ops::Range;

use super::{Detector, burst, spectral, telegraph, wandering_line};
use crate::diagnosis::axis::{AxisState, Excluded, NoFit};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::steady::band_events::is_of_band;
use crate::diagnosis::steady::noise::{self, Unsteady};
use crate::model::outliers::{self, Outliers};
use crate::model::steps;

/// Share of the ordinates that a band may hold: a wider one is not a band but all of the noise. A
/// quarter is a choice.
const NARROW: f64 = 0.25;

/// Bands that are excluded, at most: a choice. With more, the record is of another kind.
const MOST_BANDS: usize = 6;

/// Frequency, times the dwell, up to which jumps that were taken out one by one leave something: it
/// fades within some tens.
const LEFT_OF_JUMPS: f64 = 30.0;

/// Share of the density from which a law decides what the noise there looks like: a choice.
const DECIDES: f64 = 0.1;

/// Looks for the least steady band.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let axis = look.axis;
    if axis.excluded().len() == MOST_BANDS {
        return Ok(Vec::new());
    }
    let half_hz = 0.5 * axis.rate_hz;
    let mut left_hz = axis.excluded_hz();
    left_hz.extend(switching_band(axis));
    let found = noise::unsteady(axis, 0.0..half_hz, &left_hz, look.level());
    let Some(found) = found else {
        return Ok(Vec::new());
    };
    // A loud stretch shows in every band, and in some by more than in others; a short one may be a
    // shock that rings.
    let is_of_burst =
        || burst::even(look).is_some_and(|burst| burst.range.len() >= burst::LONG_STRETCH);
    if found.to_hz - found.from_hz > NARROW * half_hz
        || is_of_outliers(axis, &found)
        || is_of_burst()
    {
        return Ok(Vec::new());
    }
    if let Some(switching) = spectral::switching_anywhere(look)? {
        return Ok(switching);
    }
    let within_hz = found.from_hz..found.to_hz;
    if let Some(tone) = wandering_line::named(look, &within_hz, found.p_value) {
        return Ok(vec![tone]);
    }
    let excluded = Excluded {
        band_hz: found.from_hz..found.to_hz,
        remark: remark(&found),
    };
    // What was named while the band was still in may have been named for it.
    let mut kinds = vec![outliers::KIND];
    let jumps = axis.residual.jumps();
    let moments: Vec<Range<usize>> = jumps.map(|jump| jump.index..jump.index + 1).collect();
    if is_of_band(axis, &axis.excluded_with(&excluded.band_hz), &moments) {
        kinds.push(steps::KIND);
    }
    Ok(vec![Proposal::Exclude(excluded, kinds)])
}

/// Whether a band is as unsteady as outliers make it that are too small to be taken out one by one,
/// which shows where the noise is least. `n` samples of size `s` a second have the density
/// `n s^2 / rate^2`; where that is the share `m` of all, and sizes are normal, the strength of tiles
/// of duration `t` has the relative variance `3 m^2 / (n t)` (Campbell's theorem).
fn is_of_outliers(axis: &AxisState, found: &Unsteady) -> bool {
    /// Share of what is seen that they must explain: their law is known to some factor.
    const MOST_OF_IT: f64 = 0.3;
    let Some(one) = axis.explanation(outliers::KIND) else {
        return false;
    };
    let outliers = Outliers::of(&one.effect.plain());
    let density = outliers.density(axis.rate_hz);
    let share = (density / axis.density(found.peak_hz)).min(1.0);
    let variance = 3.0 * share * share / (outliers.rate_hz * found.tile_s);
    variance > MOST_OF_IT * found.variance && found.variance > 0.0
}

/// Where two levels decide what the noise looks like: Gaussian it is not.
fn switching_band(axis: &AxisState) -> Option<Range<f64>> {
    let one = axis.explanation(crate::model::telegraph::KIND)?;
    let end_hz = match axis.law_number(one) {
        Some(law) => spectral::band_of(axis, law, DECIDES).end,
        // Taken out jump by jump: what is left of them fades within some tens of 1 / dwell.
        None => LEFT_OF_JUMPS / telegraph::levels(axis)?.dwell_s,
    };
    Some(0.0..end_hz)
}

/// What there is to say of an unsteady band.
pub fn remark(found: &Unsteady) -> Remark {
    let Unsteady {
        from_hz,
        to_hz,
        peak_hz,
        tile_s,
        variance,
        p_value,
        ..
    } = *found;
    let description = if variance < 0.0 {
        "power that is steadier than noise: a tone that wanders within the band".into()
    } else {
        format!(
            "power whose strength changes in time, by {:.0} % over {tile_s:.2} s: a tone that \
             wanders or is switched, shocks that ring, or noise that comes and goes",
            100.0 * variance.sqrt()
        )
    };
    Remark {
        test: "steadiness".into(),
        place: Place::Band {
            ends_hz: [from_hz, to_hz],
            peak_hz: Some(peak_hz),
        },
        p_value,
        description,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::look::Lesson;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::explanation::Change;
    use crate::model::kind::Kind;
    use crate::model::telegraph;

    /// Samples from one moment at which the band comes to the next; it stays for a fifth of them.
    const PERIOD: usize = 1500;

    /// Adds a band about 20 Hz that comes and goes.
    fn add_band(values: &mut [f64], seed: u64) {
        trial::add_band(values, seed, 1.2, |n| {
            if n % PERIOD < PERIOD / 5 { 1.0 } else { 0.0 }
        });
    }

    /// Noise with such a band.
    fn values(seed: u64) -> Vec<f64> {
        let mut values = noise(seed);
        add_band(&mut values, seed);
        values
    }

    /// The band that is excluded, and what may have been found for it.
    fn excluded(trial: &Trial) -> Option<(Range<f64>, Vec<Kind>)> {
        let mut proposals = trial.ask(&DETECTOR);
        match proposals.pop()? {
            Proposal::Exclude(excluded, kinds) => Some((excluded.band_hz, kinds)),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_band_that_comes_and_goes_is_excluded() {
        let (band_hz, kinds) = excluded(&Trial::new(values(0))).expect("a plain band");
        assert!(
            band_hz.start < 20.0 && 20.0 < band_hz.end,
            "seed 0: {band_hz:?}"
        );
        assert!(band_hz.end - band_hz.start < 12.5, "seed 0: {band_hz:?}");
        assert_eq!(kinds, [outliers::KIND], "seed 0");
        assert!(excluded(&Trial::new(noise(0))).is_none(), "seed 0: steady");
    }

    #[test]
    fn all_of_the_noise_is_no_band() {
        let values = noise(1).into_iter().enumerate();
        let all = values.map(|(n, value)| {
            if (n / PERIOD).is_multiple_of(2) {
                2.0 * value
            } else {
                value
            }
        });
        let mut trial = Trial::new(all.collect());
        trial.character.strength_moves = true;
        let found = noise::unsteady(&trial.axis, 0.0..50.0, &[], trial::LEVEL);
        assert!(found.is_some(), "seed 1: steady");
        assert!(excluded(&trial).is_none(), "seed 1");
    }

    #[test]
    fn a_band_that_small_outliers_make_is_theirs() {
        // Of a tenth of the density there, or of all of it and as few: chance may make it as unsteady.
        for (size, is_excluded) in [(1.0, true), (300.0, false)] {
            let mut trial = Trial::new(values(7));
            trial.know(outliers::KIND, [0.1, size], Change::Waves(Vec::new()));
            assert_eq!(
                excluded(&trial).is_some(),
                is_excluded,
                "seed 7, size {size}"
            );
        }
    }

    #[test]
    fn a_band_that_a_long_burst_makes_is_its_own() {
        // The stretch has as much of the band as the rest of the record.
        for (length, is_excluded) in [(0, true), (PERIOD, false)] {
            let mut values = values(3);
            values[6 * PERIOD..6 * PERIOD + length]
                .iter_mut()
                .for_each(|one| *one *= 1.6);
            assert_eq!(
                excluded(&Trial::new(values)).is_some(),
                is_excluded,
                "seed 3, {length}"
            );
        }
    }

    #[test]
    fn jumps_at_its_moments_may_have_been_found_for_it() {
        for (offset, is_named) in [(PERIOD / 10, true), (PERIOD * 3 / 5, false)] {
            let mut trial = Trial::new(values(9));
            let at = |period: usize| trial::jump(period * PERIOD + offset, 0.0);
            trial.know(
                steps::KIND,
                [0.0; 2],
                trial::steps(&[3, 5, 7, 9, 11].map(at)),
            );
            let (_, kinds) = excluded(&trial).expect("a plain band");
            assert_eq!(kinds.contains(&steps::KIND), is_named, "seed 9, {offset}");
        }
    }

    #[test]
    fn a_level_that_switches_is_named_before_a_band_is_excluded() {
        let (mut values, _) = trial::switching(8, 4.0);
        add_band(&mut values, 8);
        let proposals = Trial::new(values).ask(&DETECTOR);
        assert!(
            trial::teaches(&proposals, &Lesson::LevelSwitches),
            "seed 8: {proposals:?}"
        );
        let is_excluded = |one: &Proposal| matches!(one, Proposal::Exclude(..));
        assert!(!proposals.iter().any(is_excluded), "seed 8");
    }

    #[test]
    fn where_two_levels_decide_no_band_is_looked_at() {
        for (dwell_s, is_excluded) in [(20.0, true), (1.0, false)] {
            let mut trial = Trial::new(values(5));
            trial.know(telegraph::KIND, [1.0, dwell_s], trial::steps(&[]));
            assert_eq!(
                excluded(&trial).is_some(),
                is_excluded,
                "seed 5, {dwell_s} s"
            );
        }
    }

    #[test]
    fn a_record_of_many_bands_is_of_another_kind() {
        let mut trial = Trial::new(values(6));
        for number in 0..MOST_BANDS {
            if number + 1 == MOST_BANDS {
                assert!(excluded(&trial).is_some(), "seed 6, {number} bands");
            }
            let from_hz = 40.0 + number as f64;
            trial.exclude(from_hz, from_hz + 0.1);
        }
        assert_eq!(trial.axis.excluded().len(), MOST_BANDS);
        assert!(excluded(&trial).is_none(), "seed 6");
    }
}
