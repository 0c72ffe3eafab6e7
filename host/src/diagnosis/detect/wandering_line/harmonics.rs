//! Multiples of a tone that wanders, which wander with it: one cause.

use std::ops::Range;

use super::Tone;
use super::band::Band;
use super::window::power;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::lines::mains_base;
use crate::diagnosis::result::value::Value;
use crate::diagnosis::statistic::p_value;

/// Multiples of the base that are asked for: a choice.
const MOST: u32 = 12;

/// Numbers that the tone itself may have among the multiples of its base: a choice. The lowest of a family is seldom
/// much weaker than the rest.
const OWN: u32 = 4;

/// Highest number that a tone at a mains frequency's multiple may have where it is alone: a bridge rectifier doubles.
const ALONE: u32 = 2;

/// Share of the rate up to which multiples are asked for: above, what folds back lies next to them.
const HIGHEST: f64 = 0.48;

/// Power over the floor by which a multiple must stand out, besides its probability: several times the error of the
/// floor.
const STANDS_OUT: f64 = 1.25;

/// Share of the power of a tone that a multiple of it has, at least: an amplitude of a hundredth, which is a choice. Of a strong
/// tone the skirts, what the record's ends make of them and the least distortion on its way show as well.
const LEAST: f64 = 1e-4;

/// Factor by which a band has to grow for another look with more room: a choice. Less comes to an end.
const GROWS: f64 = 1.1;

/// One line of a family.
pub struct Line {
    /// Multiple of the base.
    pub number: u32,
    /// Half of peak to peak, ahead of the chain.
    pub amplitude: Value,
    /// The frequencies that it fills, hertz.
    pub band_hz: Range<f64>,
}

/// A tone with all that keeps step with it.
pub struct Family {
    /// Number of the tone itself.
    pub number: u32,
    /// Lines by ascending number.
    pub lines: Vec<Line>,
    /// Whether the base is a mains frequency.
    pub is_mains: bool,
}

/// The family of a tone; `None` where it is as loud as far as the next multiple, which is noise.
pub fn family(axis: &AxisState, tone: &Tone<'_>, level: f64) -> Option<Family> {
    let own = line(axis, tone, [1, 1], None)?;
    // The middle of what it fills may be another: skirts of a strong one may end where the band does.
    let f_hz = tone.f_hz;
    let level = level / f64::from(MOST + OWN);
    let share_at = |ratio: f64| share(axis, tone, &own.band_hz, ratio, level);
    // What a converter's filter shuts out is no multiple, but what folds or leaks.
    let passes_hz = tone.seen.transform.frequency(tone.seen.top);
    let highest_hz = passes_hz.min(HIGHEST * axis.rate_hz);
    let members = |number: u32| -> Vec<u32> {
        let base_hz = f_hz / f64::from(number);
        let is_member = |k: u32| {
            let f_hz = f64::from(k) * base_hz;
            f_hz < highest_hz && share_at(f64::from(k) / f64::from(number)).is_some()
        };
        (1..=MOST)
            .filter(|&k| k == number || is_member(k))
            .collect()
    };
    let of = |number: u32, numbers: &[u32], is_mains| Family {
        number,
        lines: numbers
            .iter()
            .filter_map(|&k| {
                let other_hz = (k != number).then_some(&own.band_hz);
                line(axis, tone, [k, number], other_hz)
            })
            .collect(),
        is_mains,
    };
    if let Some((_, number)) = mains_base(f_hz) {
        let numbers = members(number);
        if number <= ALONE || numbers.len() > 1 {
            return Some(of(number, &numbers, true));
        }
    }
    let lower = (2..=OWN).filter_map(|k| Some((k, share_at(f64::from(k).recip())?)));
    let number = number(&lower.collect::<Vec<(u32, f64)>>());
    let family = of(number, &members(number), false);
    // Multiples that are all multiples of one have that as their base: what stood out at a lower one is no line.
    let numbers = family.lines.iter().map(|line| line.number);
    let common = numbers.fold(0, gcd);
    if common <= 1 {
        return Some(family);
    }
    let number = number / common;
    Some(of(number, &members(number), false))
}

/// The largest number that divides both.
pub const fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// The number of a tone, of which there is that share of its power at one over each of these numbers times its frequency.
pub fn number(lower: &[(u32, f64)]) -> u32 {
    /// Power over that of the strongest of them at least: a choice. What is weaker is what that one leaks.
    const NO_WEAKER: f64 = 0.1;
    let most = lower
        .iter()
        .fold(0.0, |most, (_, share)| f64::max(most, *share));
    let bases = lower.iter().filter(|(_, share)| *share >= NO_WEAKER * most);
    bases.map(|(number, _)| *number).max().unwrap_or(1)
}

/// The power at `ratio` times the frequency of a tone, which itself fills `tone_hz`, over that of the tone, window by window;
/// `None` where nothing stands out.
fn share(
    axis: &AxisState,
    tone: &Tone<'_>,
    tone_hz: &Range<f64>,
    ratio: f64,
    level: f64,
) -> Option<f64> {
    let own_hz = filled_hz(tone, ratio);
    let mut excluded_hz = axis.excluded_hz().into_iter();
    if excluded_hz.any(|one| one.start < own_hz.end && own_hz.start < one.end)
        || tone_hz.contains(&(ratio * tone.f_hz))
    {
        return None;
    }
    let other = Band::about(axis, tone.seen, &own_hz, super::ROOM, Some(tone_hz))?;
    let band = tone.band;
    let len = other.values.len() as f64;
    // A multiple turns as many times as far within a window.
    let parts = (ratio.ceil() as usize).next_power_of_two();
    let windows = tone.track.places.len();
    let length = tone.track.length as f64 / band.values.len() as f64 * len / parts as f64;
    if length < 4.0 {
        return None;
    }
    let powers = (0..windows * parts).filter_map(|part| {
        let window = part / parts;
        let own = (part as f64 * length) as usize..((part + 1) as f64 * length) as usize;
        let samples = other.values.get(own)?;
        let f_hz = ratio * band.frequency_hz(tone.track.places[window]);
        let cycles = (f_hz / other.step_hz - other.first as f64) / len;
        tone.track.counts[window].then(|| power(samples, cycles))
    });
    let powers: Vec<f64> = powers.collect();
    let middle = |band: &Band| band.floor(band.ordinates.len() / 2);
    let own = energy(tone.track.counted()) * middle(band);
    let its = energy(powers.iter().copied()) * parts as f64 * middle(&other);
    (its > LEAST * own && stand_out(&powers, level)).then(|| its / own)
}

/// Mean energy of a tone over that of noise in windows of these powers.
fn energy(powers: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = powers.fold((0.0, 0.0), |(sum, count), power| (sum + power, count + 1.0));
    sum / f64::max(count, 1.0) - 1.0
}

/// Whether these powers of windows are those of more than noise.
fn stand_out(powers: &[f64], level: f64) -> bool {
    // Bounded: what is loud for a while is no tone. Under the exponential law the mean is a half, the variance 1/12.
    let count = f64::max(powers.len() as f64, 1.0);
    let mean = powers.iter().map(|power| (-power).exp()).sum::<f64>() / count;
    let z = (0.5 - mean) * f64::sqrt(12.0 * count);
    mean < (1.0 + STANDS_OUT).recip() && z > 0.0 && p_value::two_sided(z) < 2.0 * level
}

/// The frequencies that `ratio` times the tone fills, no narrower than one window tells.
fn filled_hz(tone: &Tone<'_>, ratio: f64) -> Range<f64> {
    let of = |place: usize| ratio * tone.band.frequency_hz(place as f64);
    of(tone.own.start)..of(tone.own.end)
}

/// The ordinates with more power than noise about the frequencies `within_hz`, and a band about them that is wide enough
/// for the tone's skirts not to be taken for the floor.
fn filled(
    axis: &AxisState,
    tone: &Tone<'_>,
    within_hz: Range<f64>,
    other_hz: Option<&Range<f64>>,
) -> Option<(Band, Range<usize>)> {
    let mut within_hz = within_hz;
    loop {
        let band = Band::about(axis, tone.seen, &within_hz, super::ROOM, other_hz)?;
        let len = band.ordinates.len();
        let place = |f_hz: f64| {
            let place = f_hz / band.step_hz - band.first as f64;
            (place.max(0.0) as usize).min(len)
        };
        let inside = band.grown(place(within_hz.start)..(place(within_hz.end) + 1).min(len));
        let wider_hz = band.frequency_hz(inside.start as f64)..band.frequency_hz(inside.end as f64);
        let grows = wider_hz.end - wider_hz.start > GROWS * (within_hz.end - within_hz.start);
        if 2 * inside.len() <= len || !grows {
            return Some((band, inside));
        }
        within_hz = wider_hz;
    }
}

/// Of `all` ordinates that have more power than noise about the multiple `number` of a tone that is number `own`, those up
/// to half way to the next one; `None` where it is as loud there as in the middle, which is noise.
pub fn up_to_next(
    band: &Band,
    all: &Range<usize>,
    tone: &Tone<'_>,
    [number, own]: [u32; 2],
) -> Option<Range<usize>> {
    /// Share of the power that lies within a quarter of the way, at least: of noise that is as loud everywhere there is a half,
    /// of a tone nearly all.
    const MOST_OF_IT: f64 = 0.75;
    let base_hz = tone.f_hz / f64::from(own);
    let place = |number: f64| {
        let ordinate = (number * base_hz / band.step_hz).max(0.0) as usize;
        ordinate
            .saturating_sub(band.first)
            .clamp(all.start, all.end)
    };
    let within = |way: f64| place(f64::from(number) - way)..place(f64::from(number) + way);
    let power = |range: Range<usize>| -> f64 {
        let above = band.ordinates[range]
            .iter()
            .map(|one| one.norm_sqr() - band.share);
        above.sum()
    };
    let inside = within(0.5);
    (power(within(0.25)) >= MOST_OF_IT * power(inside.clone())).then_some(inside)
}

/// A line of the family with its size: the power of its band over the floor, without what is in `other_hz`.
fn line(
    axis: &AxisState,
    tone: &Tone<'_>,
    [number, own]: [u32; 2],
    other_hz: Option<&Range<f64>>,
) -> Option<Line> {
    /// Relative error of the floor's ends together, times the root of their ordinates: that of two medians.
    const FLOOR_ERROR: f64 = 1.02;
    let ratio = f64::from(number) / f64::from(own);
    let (band, all) = filled(axis, tone, filled_hz(tone, ratio), other_hz)?;
    let inside = up_to_next(&band, &all, tone, [number, own])?;
    let (mut sum, mut variance, mut floor) = (0.0, 0.0, 0.0);
    for k in inside.clone() {
        // Over the share of the record in which there is any of it.
        let more = band.ordinates[k].norm_sqr() / band.share - 1.0;
        let unit = band.floor(k);
        sum += unit * more;
        variance += unit * unit * (1.0 + 2.0 * more.max(0.0));
        floor += unit;
    }
    variance += (FLOOR_ERROR * floor).powi(2) / band.ordinates.len() as f64;
    // The square of an amplitude is four times the power on one side of zero.
    let square = 4.0 * band.step_hz * sum;
    let f_hz = band.frequency_hz(0.5 * (inside.start + inside.end) as f64);
    let passed = axis.bins.chain_power(f_hz).sqrt();
    let amplitude = square.max(0.0).sqrt();
    if amplitude <= 0.0 {
        return None;
    }
    let sd = 2.0 * band.step_hz * variance.sqrt() / amplitude;
    Some(Line {
        number,
        amplitude: Value::normal(amplitude / passed, sd / passed),
        band_hz: band.frequency_hz(inside.start as f64)..band.frequency_hz(inside.end as f64),
    })
}
