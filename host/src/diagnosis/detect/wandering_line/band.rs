//! A narrow band of a record, moved to zero frequency: its ordinates over the floor of the noise beside it,
//! transformed back by themselves.

use std::f64::consts::LN_2;
use std::ops::Range;

use realfft::num_complex::Complex64;

use super::window;
use crate::diagnosis::axis::{AxisState, Whitened};
use crate::diagnosis::statistic::matched_filter::smooth_len;
use crate::diagnosis::steady::tiles::as_whole_as_most;
use crate::fft;
use crate::numeric::order::median;
use crate::numeric::top::golden_section;

/// Ordinates on either side from which the floor is taken, at least: it is then known to 7 %.
const SIDE: usize = 256;

/// Ordinates on one side with which that side counts: its median is known to a quarter.
const LEAST_SIDE: usize = 24;

/// Ordinates of a band, at least: with windows of eight of its samples there are then 64 of them.
const LEAST_WIDTH: usize = 512;

/// Ordinates at most: a choice between time and place; a wider band has windows too short to be worth much.
const MOST_WIDTH: usize = 1 << 18;

/// Steps by which a line is placed between two ordinates: to a hundredth of one, where a thousandth of its power is missed.
const FINEST: u32 = 12;

/// The first ordinate that a band may have: what lies below is drift and the record's ends.
const FIRST: usize = 4;

/// A band of the record, sample by sample: complex, of the variance 1 where there is noise alone.
pub struct Band {
    /// Its samples.
    pub values: Vec<Complex64>,
    /// The same, ordinate by ordinate; nothing where other tones are excluded.
    pub ordinates: Vec<Complex64>,
    /// Number of its first ordinate in the record's transform.
    pub first: usize,
    /// Two-sided density of the floor at its two ends.
    floor: [f64; 2],
    /// Frequency of one ordinate, hertz.
    pub step_hz: f64,
    /// Length of the record, seconds.
    pub duration_s: f64,
    /// Share of the record that was measured or drawn: the mean power of the ordinates of noise.
    pub share: f64,
    /// Share of the record that a line goes through.
    unbridged: f64,
}

impl Band {
    /// The band about the frequencies `within_hz`, `times` as wide, wider where it would have too few ordinates;
    /// `None` where the record has none there. What is in `other_hz` is not in it, besides what the axis excludes.
    pub fn about(
        axis: &AxisState,
        seen: &Whitened,
        within_hz: &Range<f64>,
        times: f64,
        other_hz: Option<&Range<f64>>,
    ) -> Option<Self> {
        let step_hz = seen.transform.frequency(1);
        let middle = 0.5 * (within_hz.start + within_hz.end) / step_hz;
        let width = times * (within_hz.end - within_hz.start) / step_hz;
        let width = (width as usize).clamp(LEAST_WIDTH, MOST_WIDTH);
        let first = (middle - 0.5 * width as f64).max(FIRST as f64) as usize;
        let last = (middle + 0.5 * width as f64).max(0.0) as usize;
        let mut excluded_hz = axis.excluded_hz();
        excluded_hz.extend(other_hz.cloned());
        Self::of(axis, seen, first..last, &excluded_hz)
    }

    /// The band of these ordinates, as far as the record has them, without those in `excluded_hz`.
    fn of(
        axis: &AxisState,
        seen: &Whitened,
        ordinates: Range<usize>,
        excluded_hz: &[Range<f64>],
    ) -> Option<Self> {
        let first = ordinates.start.max(FIRST);
        let end = ordinates
            .end
            .min(seen.top.min(seen.transform.ordinates().len()));
        let len = smooth_len(end.checked_sub(first)?);
        if len < LEAST_SIDE {
            return None;
        }
        let share = axis.present_share();
        let floor = floor(seen, &(first..first + len), excluded_hz)?.map(|one| one / share);
        let step_hz = seen.transform.frequency(1);
        let all = &seen.transform.ordinates()[first..first + len];
        let ordinate = |k: usize| {
            let f_hz = seen.transform.frequency(first + k);
            if excluded_hz.iter().any(|one| one.contains(&f_hz)) {
                return Complex64::ZERO;
            }
            all[k] / (at(floor, k, len) * seen.transform.power()).sqrt()
        };
        let ordinates: Vec<Complex64> = (0..len).map(ordinate).collect();
        let mut values = ordinates.clone();
        fft::inverse(len).process(&mut values);
        let unit = (len as f64).sqrt().recip();
        values.iter_mut().for_each(|value| *value *= unit);
        Some(Self {
            values,
            ordinates,
            first,
            floor,
            step_hz,
            duration_s: step_hz.recip(),
            share,
            unbridged: axis.unbridged_share(),
        })
    }

    /// Its samples a second.
    pub fn rate_hz(&self) -> f64 {
        self.values.len() as f64 * self.step_hz
    }

    /// Frequency of its ordinate number `k`, which may lie between two, hertz.
    pub fn frequency_hz(&self, k: f64) -> f64 {
        (self.first as f64 + k) * self.step_hz
    }

    /// Two-sided density of the floor at its ordinate number `k`.
    pub fn floor(&self, k: usize) -> f64 {
        at(self.floor, k, self.values.len())
    }

    /// Which of its windows of `length` samples count.
    pub fn counting(&self, axis: &AxisState, length: usize) -> Vec<bool> {
        let of_window = axis.ring_len() as f64 * length as f64 / self.values.len() as f64;
        let sample = |window: usize| (window as f64 * of_window) as usize;
        let windows = 0..self.values.len() / length;
        as_whole_as_most(axis, windows.map(|one| sample(one)..sample(one + 1)))
    }

    /// Whether one steady line holds all of the power above noise in these of its `ordinates`, but for the share
    /// `imperfect` and what the samples that are missing or excluded would hold.
    pub fn is_line(&self, ordinates: &Range<usize>, imperfect: f64) -> bool {
        let power = |k: usize| self.ordinates[k].norm_sqr();
        let noise = self.share * ordinates.len() as f64;
        let above = ordinates.clone().map(power).sum::<f64>() - noise;
        let top = ordinates
            .clone()
            .max_by(|&a, &b| power(a).total_cmp(&power(b)));
        let Some(top) = top else {
            return false;
        };
        // Between two ordinates it is lower in both.
        let at = |k: f64| window::power(&self.values, k / self.values.len() as f64);
        let best = golden_section(top as f64 - 1.0, top as f64 + 1.0, FINEST, at);
        at(best) >= (1.0 - imperfect) * self.unbridged * above
    }

    /// Ordinates outwards from `inside` that have more power than noise, in groups.
    pub fn grown(&self, inside: Range<usize>) -> Range<usize> {
        /// Ordinates of a group, and the power from which it is no noise: four deviations of its mean.
        const GROUP: usize = 32;
        const MORE: f64 = 1.7;
        let is_more = |group: &[Complex64]| {
            let power: f64 = group.iter().map(Complex64::norm_sqr).sum();
            power > MORE * self.share * group.len() as f64
        };
        let len = self.ordinates.len();
        let (mut start, mut end) = (inside.start.min(len), inside.end.min(len));
        while start > 0 {
            let from = start.saturating_sub(GROUP);
            if !is_more(&self.ordinates[from..start]) {
                break;
            }
            start = from;
        }
        while end < len {
            let to = (end + GROUP).min(len);
            if !is_more(&self.ordinates[end..to]) {
                break;
            }
            end = to;
        }
        start..end
    }
}

/// A straight line in the logarithms.
fn at(ends: [f64; 2], k: usize, len: usize) -> f64 {
    let share = k as f64 / len as f64;
    ends[0].powf(1.0 - share) * ends[1].powf(share)
}

/// Two-sided density of the noise at both ends of a band, by the medians on either side, which a line or two there
/// do not move.
fn floor(seen: &Whitened, band: &Range<usize>, excluded_hz: &[Range<f64>]) -> Option<[f64; 2]> {
    let all = seen.transform.ordinates();
    let side = SIDE.max(band.len() / 2);
    let density = |range: Range<usize>| {
        let is_free = |k: &usize| {
            let f_hz = seen.transform.frequency(*k);
            !excluded_hz.iter().any(|one| one.contains(&f_hz))
        };
        let mut powers: Vec<f64> = range
            .filter(is_free)
            .map(|k| all[k].norm_sqr() / seen.transform.power())
            .collect();
        let known = powers.len() >= LEAST_SIDE;
        // The median of an exponential law is ln 2 of its mean.
        known
            .then(|| median(&mut powers).map(|one| one / LN_2))
            .flatten()
    };
    let below = density(band.start.saturating_sub(side).max(1)..band.start);
    let above = density(band.end..(band.end + side).min(seen.top.min(all.len())));
    match (below, above) {
        (Some(below), Some(above)) => Some([below, above]),
        (Some(one), None) | (None, Some(one)) => Some([one, one]),
        (None, None) => None,
    }
    .filter(|ends| ends.iter().all(|one| *one > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{Trial, add_band, noise};

    #[test]
    fn it_grows_as_far_as_there_is_more_than_noise() {
        let mut ordinates = vec![Complex64::ONE; LEAST_WIDTH];
        ordinates[96..160].fill(Complex64::new(2.0, 0.0));
        let band = Band {
            values: ordinates.clone(),
            ordinates,
            first: FIRST,
            floor: [1.0; 2],
            step_hz: 1.0,
            duration_s: 1.0,
            share: 1.0,
            unbridged: 1.0,
        };
        // By groups of 32, of which the outermost hold more than is left out.
        assert_eq!(band.grown(120..130), 88..162);
        assert_eq!(band.grown(300..310), 300..310);
    }

    #[test]
    fn what_is_excluded_is_nothing_to_it_and_none_of_its_floor() {
        let seed = 3;
        let mut values = noise(seed);
        add_band(&mut values, seed, 10.0, |_| 1.0);
        let mut trial = Trial::new(values);
        trial.exclude(13.0, 27.0);
        let axis = &trial.axis;
        let seen = axis.whitened();
        let place = |f_hz: f64| (f_hz / seen.transform.frequency(1)) as usize;
        let of = |ordinates| Band::of(axis, &seen, ordinates, &axis.excluded_hz());
        let across = of(place(26.5)..place(29.0)).expect("a band");
        let inside = across.ordinates.iter().zip(across.first..);
        let mut inside = inside.filter(|(_, k)| seen.transform.frequency(*k) < 27.0);
        assert!(
            inside.all(|(one, _)| *one == Complex64::ZERO),
            "seed {seed}"
        );
        // Below it all is excluded: its floor is that of above at both ends.
        let above = of(place(27.02)..place(29.0)).expect("a band");
        assert_eq!(above.floor[0], above.floor[1], "seed {seed}");
    }
}
