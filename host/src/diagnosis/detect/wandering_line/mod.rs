//! Tones of steady size whose frequency moves: `wandering_line`, and mains as they are, `hum`.
//!
//! A band is suspected where lines do not keep their phase or stand too close to be separate, or where noise is not as
//! steady as noise is. There the strongest tone is [followed](track) through windows of many lengths. It is named if
//! its power, where other windows foretold it, is steadier than noise, grows with the length of the windows as that of
//! a tone does, and if its frequency [moves](course). A resonance has a power that fluctuates as noise does, however
//! narrow it is; a tone that comes and goes fluctuates by more.
//!
//! No fit and no test looks at the bands that it fills: a density would say that all of its spectrum is random. It is
//! in the model as it was measured.

mod band;
mod course;
mod harmonics;
mod made_for_it;
mod straight;
#[cfg(test)]
mod tests;
mod track;
mod window;

use std::ops::Range;

use self::band::Band;
use self::course::{Course, course};
use self::harmonics::{Line, family};
use self::made_for_it::{HAPPENED, made_for_it, may_be_made_for_it};
use self::track::{Steadiness, Track};
use super::Detector;
use super::lines::{self, Group, Measured};
use crate::diagnosis::axis::{AxisState, NoFit, Whitened};
use crate::diagnosis::detect::look::{Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Rival;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::steady::line::IMPERFECT;
use crate::model::kind::Kind;
use crate::model::{hum, resonance, wandering_line};

/// Shortest windows, samples of the band; those of half the length show how its energy grows.
const SHORTEST: usize = 8;

/// Windows at least.
const LEAST_WINDOWS: usize = 32;

/// How steady a tone must be: 0 as noise is, 1 as a tone without any change of its size. A choice; resonances of any
/// width and strength stay below a half.
const STEADY: f64 = 0.7;

/// Share of the bands of noise that may be named as tones: a choice. That there is something is known, and by what
/// probability; which of two names it has is asked here.
const MISTAKEN: f64 = 0.01;

/// By how much its energy must grow with windows of twice the length; that of a tone doubles, of noise stays.
const GROWTH: f64 = 1.5;

/// Width of the band that is looked at over that which is suspected.
const ROOM: f64 = 4.0;

/// Share of the band up to half the rate that it may fill: wider, it is no line.
const NARROW: f64 = 0.25;

/// Suspects that are looked at, the strongest ones: a choice.
const MOST: usize = 6;

/// Looks for tones that wander among lines that are no single ones. The tests are those of the lines: what is asked
/// here decides about a name.
pub static DETECTOR: Detector = Detector { tests: 0, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let mut suspects = suspects(look);
    suspects.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
    let found = suspects
        .iter()
        .take(MOST)
        .find_map(|one| named(look, &one.band_hz, one.p_value));
    Ok(found.into_iter().collect())
}

/// Where a tone may wander.
struct Suspect {
    band_hz: Range<f64>,
    /// Power of its strongest line over the floor.
    ratio: f64,
    p_value: f64,
}

/// Lines that are not steady, or stand too close to be separate.
fn suspects(look: &Look<'_>) -> Vec<Suspect> {
    /// Reach of a single line, 1/T.
    const REACH: f64 = 10.0;
    let mut known = look.axis.excluded_hz();
    known.extend(lines::resonances_hz(look.axis));
    let reach_hz = REACH / look.duration_s();
    let of_line = |one: &Measured| Suspect {
        band_hz: one.line.frequency_hz - reach_hz..one.line.frequency_hz + reach_hz,
        ratio: one.line.ratio,
        p_value: one.line.false_alarm,
    };
    let of_group = |group: Group| match group {
        Group::Single(one) => lines::wanders(look, &one).then(|| of_line(&one)),
        Group::Hum { lines, .. } => {
            let mut unsteady = lines.iter().filter(|(_, one)| lines::wanders(look, one));
            unsteady.next()?;
            let strongest = lines
                .iter()
                .max_by(|(_, a), (_, b)| a.line.ratio.total_cmp(&b.line.ratio));
            strongest.map(|(_, one)| of_line(one))
        }
        Group::Cluster { lines, .. } => {
            let strongest = lines.iter().max_by(|a, b| a.ratio.total_cmp(&b.ratio))?;
            Some(Suspect {
                band_hz: lines[0].frequency_hz - reach_hz
                    ..lines[lines.len() - 1].frequency_hz + reach_hz,
                ratio: strongest.ratio,
                p_value: strongest.false_alarm,
            })
        }
    };
    let all = lines::lines(look.axis, look.level()).into_iter();
    let is_known = |one: &Suspect| {
        let middle = 0.5 * (one.band_hz.start + one.band_hz.end);
        known.iter().any(|band| band.contains(&middle))
    };
    all.filter_map(of_group)
        .filter(|one| !is_known(one))
        .collect()
}

/// A tone that wanders within or about a band, found there otherwise with the probability `p_value` by chance.
pub fn named(look: &Look<'_>, within_hz: &Range<f64>, p_value: f64) -> Option<Proposal> {
    let mut found = followed(look, within_hz, p_value)?;
    let is_cut_out = |kind: &Kind| HAPPENED.contains(kind) || *kind == hum::KIND;
    if found.supersedes.iter().any(is_cut_out) {
        // What happened is cut out of the record: where it was the tone, that is followed through all of it. So is what is
        // known of the mains already: all of their multiples are followed together.
        let mut without = look.axis.clone();
        without.withdraw_where(|one| found.supersedes.contains(&one.kind()));
        without.refresh().ok()?;
        without.prepare(look.level());
        let whole = Look {
            axis: &without,
            ..*look
        };
        let gone = std::mem::take(&mut found.supersedes);
        found = followed(&whole, within_hz, p_value).unwrap_or(found);
        found.supersedes.extend(gone);
        // Or one by one they would go for each other for ever.
        if !holds_more(&found, look.axis) {
            return None;
        }
    }
    Some(Proposal::Explain(Box::new(found)))
}

/// Whether mains hold more multiples than those that wander and go for them.
fn holds_more(found: &Candidate, axis: &AxisState) -> bool {
    let gone = axis.explanation(hum::KIND);
    let gone = gone.filter(|_| found.supersedes.contains(&hum::KIND));
    let held = match &found.change {
        Change::Tone(bands_hz) => bands_hz.len(),
        _ => 0,
    };
    gone.is_none_or(|known| held > known.bands_hz().len())
}

/// The same as a candidate, through what is left of the record.
fn followed(look: &Look<'_>, within_hz: &Range<f64>, p_value: f64) -> Option<Candidate> {
    let axis = look.axis;
    let seen = axis.whitened();
    let band = Band::about(axis, &seen, within_hz, ROOM, None)?;
    let (track, steadiness) = steadiest(axis, &band)?;
    let course = course(&band, &track)?;
    // A tone that stands still is no business of this one.
    let own = filled(&band, &track);
    if course.nats < -look.level().ln() || band.is_line(&own, IMPERFECT) {
        return None;
    }
    let width_hz = (own.end - own.start) as f64 * band.step_hz;
    if width_hz > NARROW * 0.5 * axis.rate_hz {
        return None;
    }
    let tone = Tone {
        seen: &seen,
        band: &band,
        track: &track,
        f_hz: course.f_hz.value,
        own,
    };
    let family = family(axis, &tone, look.level())?;
    family
        .lines
        .iter()
        .find(|line| line.number == family.number)?;
    let kind = if family.is_mains {
        hum::KIND
    } else {
        wandering_line::KIND
    };
    if !look.is_open(kind) || kind == wandering_line::KIND && course.goes_one_way() {
        return None;
    }
    let effect = Estimate {
        kind,
        values: values(&course, &family.lines, family.number),
    };
    let bands = family.lines.iter().map(|line| line.band_hz.clone());
    let bands = bands.collect();
    let freedom = 4.0 + family.lines.len() as f64;
    let mut supersedes = made_for_it(axis, &family.lines);
    supersedes.extend(
        axis.has(kind)
            .then_some(kind)
            .filter(|kind| *kind == hum::KIND),
    );
    Some(Candidate {
        held_out_nats: Some(track.nats(steadiness.energy)),
        supersedes,
        reopens: may_be_made_for_it(axis, &family.lines),
        rivals: vec![Rival {
            effect: resonance::KIND,
            log_odds: -steadiness.p_value.max(f64::MIN_POSITIVE).ln(),
        }],
        ..Candidate::new(effect, p_value, freedom, Change::Tone(bands))
    })
}

/// A tone that was followed.
pub struct Tone<'a> {
    seen: &'a Whitened,
    band: &'a Band,
    track: &'a Track,
    /// Its mean frequency, hertz.
    f_hz: f64,
    /// Ordinates of the band that it fills.
    own: Range<usize>,
}

/// The windows through which a tone of a band is plainest, if there is one.
fn steadiest(axis: &AxisState, band: &Band) -> Option<(Track, Steadiness)> {
    let lengths = std::iter::successors(Some(SHORTEST / 2), |length| Some(2 * length));
    let lengths = lengths.take_while(|length| band.values.len() / length >= LEAST_WINDOWS);
    let tracks = lengths.map(|length| Track::new(band, length, band.counting(axis, length)));
    let mut tracks: Vec<Track> = tracks.collect();
    let said: Vec<Option<Steadiness>> = tracks.iter().map(Track::steadiness).collect();
    let best = plainest(&said, MISTAKEN / said.len() as f64)?;
    Some((tracks.swap_remove(best), said[best]?))
}

/// The number of those that show a tone plainest, among windows each twice as long as those before, by what is `said` of
/// each; the first only show how its energy grows.
fn plainest(said: &[Option<Steadiness>], level: f64) -> Option<usize> {
    /// Energy in a window from which the frequency is known well enough to turn phases into frequencies.
    const ENOUGH: f64 = 6.0;
    let tones = said.windows(2).enumerate().filter_map(|(before, two)| {
        let (shorter, one) = (two[0]?, two[1]?);
        let grows = one.energy > GROWTH * shorter.energy;
        (grows && one.share >= STEADY && one.p_value <= level).then_some((before + 1, one))
    });
    // The first that is strong enough has the most windows; below, the surest.
    let better = |best: (usize, Steadiness), next: (usize, Steadiness)| {
        let surer = next.1.energy >= ENOUGH || next.1.p_value < best.1.p_value;
        if best.1.energy < ENOUGH && surer {
            next
        } else {
            best
        }
    };
    tones.reduce(better).map(|(number, _)| number)
}

/// Ordinates of the band that the tone fills: where it was followed to, but for a few windows, and from there on as
/// long as there is more power than noise has.
fn filled(band: &Band, track: &Track) -> Range<usize> {
    /// Share of the windows on either side that may have gone astray.
    const ASTRAY: f64 = 0.01;
    let pairs = track.places.iter().zip(&track.counts);
    let counted = pairs.filter(|(_, counts)| **counts);
    let mut places: Vec<f64> = counted.map(|(place, _)| *place).collect();
    places.sort_by(f64::total_cmp);
    let few = (ASTRAY * places.len() as f64) as usize;
    let width = band.values.len() as f64 / track.length as f64;
    let start = (places[few] - width).max(0.0) as usize;
    let end = (places[places.len() - 1 - few] + width) as usize + 1;
    band.grown(start..end)
}

/// Parameters in the catalogue's order, of a tone that is number `number` of its family.
fn values(course: &Course, lines: &[Line], number: u32) -> Vec<Option<Value>> {
    let base = |value: Value| value.map(|one| one / f64::from(number));
    let mut values = vec![
        Some(base(course.f_hz)),
        Some(base(course.wander_hz)),
        Some(course.wander_s),
    ];
    for line in lines {
        let place = wandering_line::FIRST_AMPLITUDE + line.number as usize - 1;
        values.resize(values.len().max(place + 1), None);
        values[place] = Some(line.amplitude);
    }
    values
}
