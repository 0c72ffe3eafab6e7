//! Bands of noise that no steady law speaks for: they are excluded from what fits and tests look at.

mod reach;
#[cfg(test)]
mod tests;

use std::ops::Range;

use super::{Detector, burst, spectral, telegraph, wandering_line};
use crate::diagnosis::axis::{AxisState, Excluded, NoFit};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::steady::band_events::is_of_band;
use crate::diagnosis::steady::noise::{self, Unsteady};
use crate::model::outliers::{self, Outliers};
use crate::model::{shock, steps};

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
    let unsteady = |left_hz: &[Range<f64>]| {
        let within_hz = 0.0..half_hz;
        noise::unsteady(axis, within_hz, left_hz, look.level())
    };
    let mut found = unsteady(&left_hz);
    if found.is_some_and(|one| is_skirt(axis, &one)) {
        left_hz.extend(axis.tones_with_skirts_hz());
        found = unsteady(&left_hz);
    }
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
    if reach::holds_shocks(axis, &found) {
        kinds.push(shock::KIND);
    }
    Ok(vec![Proposal::Exclude(excluded, kinds)])
}

/// Whether a band is no more than the skirts of a tone, on one side or both: it is seldom where it seldom goes.
fn is_skirt(axis: &AxisState, found: &Unsteady) -> bool {
    let mut skirts_hz = axis.tones_with_skirts_hz();
    skirts_hz.any(|one| one.start <= found.from_hz && found.to_hz <= one.end)
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
