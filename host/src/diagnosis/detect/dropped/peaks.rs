//! Which peaks of a spectrum are one line whose phase jumps, and where else to look for lines.
//!
//! A line of amplitude `A` that jumps at one moment has side lobes that fall as `1/d` with the
//! distance `d` from it in cycles a record: of `|1 - e^(j phi)| A / (2 pi d)` either way, at most
//! `A / (pi d)`. A strong one is surrounded by dozens of peaks that are nothing of their own.

use crate::diagnosis::detect::dropped::line::LINE_REACH;
use crate::diagnosis::detect::lines::mains_base;
use crate::spectrum::Line as Peak;

/// Peaks closer than this, in cycles a record, are one line that a jump has split: a choice. A jump
/// by half a cycle in the middle leaves its two peaks 1.5 from each other.
pub(crate) const SPLIT: f64 = 12.0;

/// Side lobes over those of a jump, at most: a jump by half a cycle in the middle leaves 0.72 of
/// the amplitude in each of two peaks.
const LOBES: f64 = 1.5;

/// Standard deviations by which noise helps a lobe, at most: 6e-5 beyond, both sides.
const HELP: f64 = 4.0;

/// Harmonics of a mains frequency that are looked at: a choice.
pub(crate) const HARMONICS: u32 = 10;

/// Where to look for a line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Place {
    /// Middle of the place, cycles a sample.
    pub(crate) cycles: f64,
    /// Distance of the outermost main peaks, cycles a record.
    pub(crate) width: f64,
}

/// Peaks gathered into lines, the strongest first.
pub(crate) fn merged(peaks: &[Peak], rate_hz: f64, len: usize) -> Vec<Place> {
    let mut peaks = peaks.to_vec();
    peaks.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    let duration_s = len as f64 / rate_hz;
    let mut groups: Vec<Vec<Peak>> = Vec::new();
    for peak in peaks {
        let home = groups.iter_mut().find(|group| {
            let strongest = group[0];
            let away = (peak.frequency_hz - strongest.frequency_hz).abs() * duration_s;
            let lobe = LOBES * strongest.amplitude / (std::f64::consts::PI * away);
            let noise = peak.amplitude / (2.0 * peak.ratio).sqrt();
            away < SPLIT || peak.amplitude < lobe + HELP * noise
        });
        match home {
            Some(group) => group.push(peak),
            None => groups.push(vec![peak]),
        }
    }
    groups
        .iter()
        .map(|group| {
            let (mut low, mut high) = (group[0].frequency_hz, group[0].frequency_hz);
            // The main peaks of a split line are alike within a factor of a few, and no lobe further off is.
            let is_main = |peak: &&Peak| 4.0 * peak.amplitude > group[0].amplitude;
            for peak in group.iter().filter(is_main) {
                low = low.min(peak.frequency_hz);
                high = high.max(peak.frequency_hz);
            }
            Place {
                cycles: 0.5 * (low + high) / rate_hz,
                width: (high - low) * duration_s,
            }
        })
        .collect()
}

/// The places, and multiples of the first mains frequency among them: a harmonic that a search of
/// all frequencies misses still speaks for a loss.
pub(crate) fn with_harmonics(mut places: Vec<Place>, rate_hz: f64, len: usize) -> Vec<Place> {
    let base = places
        .iter()
        .find_map(|place| mains_base(place.cycles * rate_hz));
    let Some((base_hz, number)) = base else {
        return places;
    };
    for harmonic in 1..=HARMONICS {
        let cycles = f64::from(harmonic) * base_hz / rate_hz;
        // The peak that the base is known by may be off by a cycle a record.
        let width = 2.0 * (f64::from(harmonic) / f64::from(number)).max(1.0);
        let known = places.iter().any(|place| {
            (place.cycles - cycles).abs() * (len as f64)
                < SPLIT.max(width) + place.width + LINE_REACH
        });
        if !known && cycles < 0.5 {
            places.push(Place { cycles, width });
        }
    }
    places
}
