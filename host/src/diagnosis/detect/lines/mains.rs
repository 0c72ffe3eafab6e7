//! Lines at multiples of one frequency, the mains' or a machine's: one cause.

use super::measure::Measured;
use crate::spectrum::Line;

/// Lines with one cause.
#[derive(Debug, Clone, PartialEq)]
pub enum Group {
    /// A line by itself.
    Single(Measured),
    /// Mains and harmonics: base frequency with its standard deviation, and each line's number.
    Hum {
        /// Base frequency, hertz.
        base_hz: f64,
        /// Standard deviation of the base frequency, hertz.
        base_sd_hz: f64,
        /// The lines with their harmonic numbers.
        lines: Vec<(u32, Measured)>,
    },
    /// Lines that stand closer than the record can have separate ones: a narrow peak.
    Cluster {
        /// Middle of the lines, hertz.
        f_hz: f64,
        /// Distance of the outermost, hertz.
        width_hz: f64,
        /// The lines at multiples of the base.
        lines: Vec<Line>,
    },
}

/// Largest distance of a mains frequency from its nominal value, as a share: a choice, 0.25 Hz of
/// 50 Hz for the grid and the recorder's clock together.
const MAINS_SHARE: f64 = 0.005;

/// Nominal mains frequencies, hertz.
const MAINS_HZ: [f64; 2] = [50.0, 60.0];

/// Mains frequency that a line at `f_hz` is a multiple of, hertz, and which: a low one, for any
/// frequency above a kilohertz is near one.
pub fn mains_base(f_hz: f64) -> Option<(f64, u32)> {
    MAINS_HZ
        .iter()
        .filter_map(|&nominal_hz| base_near(f_hz, nominal_hz))
        .min_by_key(|(_, number)| *number)
}

fn base_near(f_hz: f64, nominal_hz: f64) -> Option<(f64, u32)> {
    let number = (f_hz / nominal_hz).round();
    let base_hz = f_hz / number;
    let is_near = (base_hz / nominal_hz - 1.0).abs() <= MAINS_SHARE;
    ((1.0..=20.0).contains(&number) && is_near).then_some((base_hz, number as u32))
}

/// What a tone at `f_hz` that does not keep its frequency may be.
pub fn wandering(f_hz: f64) -> String {
    let mains = MAINS_HZ.into_iter().find(|nominal_hz| {
        let number = (f_hz / nominal_hz).round();
        number >= 1.0 && (f_hz / (number * nominal_hz) - 1.0).abs() < MAINS_SHARE
    });
    match mains {
        Some(nominal_hz) => format!(
            "pick-up from {nominal_hz} Hz mains, whose frequency wanders with the grid, or another \
             tone that wanders or is switched"
        ),
        None => "a tone that wanders or is switched".into(),
    }
}

/// Gathers what fits one mains frequency, where a line may be alone, and one machine after another.
pub fn with_hum(singles: Vec<Measured>) -> Vec<Group> {
    // Mains does not keep to half the rate for as long as a record lasts.
    let (own, singles): (Vec<_>, Vec<_>) = singles.into_iter().partition(Measured::is_at_half);
    let own = own.into_iter().map(Group::Single);
    own.chain(of_one_cause(singles)).collect()
}

/// Lines below half the rate by their causes.
fn of_one_cause(singles: Vec<Measured>) -> Vec<Group> {
    // The base frequency that most lines are multiples of, by the strongest line that is one.
    let mut best: Option<(f64, f64, Vec<usize>)> = None;
    for nominal_hz in MAINS_HZ {
        for (index, seed) in singles.iter().enumerate() {
            let Some((base_hz, number)) = base_near(seed.line.frequency_hz, nominal_hz) else {
                continue;
            };
            let number = f64::from(number);
            let fits: Vec<usize> = (0..singles.len())
                .filter(|&other| {
                    let one = &singles[other].line;
                    let k = (one.frequency_hz / base_hz).round();
                    let sd = (seed.line.frequency_sd_hz * k / number).hypot(one.frequency_sd_hz);
                    k >= 1.0 && (one.frequency_hz - k * base_hz).abs() < 4.0 * sd
                })
                .collect();
            // A line by itself is mains only where its base is: not any line between 50 and 1000.
            let alone = fits.len() == 1 && number > 2.0;
            let more = best.as_ref().is_none_or(|(_, _, before)| {
                fits.len() > before.len()
                    || (fits.len() == before.len()
                        && singles[index].line.ratio > singles[before[0]].line.ratio)
            });
            if !alone && more && !fits.is_empty() {
                best = Some((base_hz, seed.line.frequency_sd_hz / number, fits));
            }
        }
    }
    let Some((rough_hz, _, members)) = best else {
        return with_machines(singles);
    };
    let (mut lines, mut others) = (Vec::new(), Vec::new());
    for (index, one) in singles.into_iter().enumerate() {
        if members.contains(&index) {
            let number = (one.line.frequency_hz / rough_hz).round() as u32;
            lines.push((number, one));
        } else {
            others.push(one);
        }
    }
    let mut groups = with_machines(others);
    groups.push(of_base(lines));
    groups
}

/// Gathers what stands at whole multiples of the lowest line that has any, whatever its frequency.
fn with_machines(mut singles: Vec<Measured>) -> Vec<Group> {
    singles.sort_by(|a, b| a.line.frequency_hz.total_cmp(&b.line.frequency_hz));
    let mut groups = Vec::new();
    while !singles.is_empty() {
        let base = singles.remove(0);
        let (group, others) = machine(base, singles, OF_MACHINES, |one| one.line, |one| one);
        singles = others;
        groups.push(group);
    }
    groups
}

/// How near a line has to be to a multiple.
#[derive(Debug, Clone, Copy)]
pub struct Near {
    /// The frequency of a line by itself is known no better, hertz.
    pub least_sd_hz: f64,
    /// Probability that a line stands so near to a multiple by chance, for each pair of lines.
    pub by_chance: f64,
}

/// Of lines that are as sure as they say. The chance is a choice.
const OF_MACHINES: Near = Near {
    least_sd_hz: 0.0,
    by_chance: 1e-4,
};

/// A line with those of `others` that are its multiples, which are to be `measured`; and the rest of them.
pub fn machine<T>(
    base: Measured,
    others: Vec<T>,
    near: Near,
    line: impl Fn(&T) -> Line,
    measured: impl Fn(T) -> Measured,
) -> (Group, Vec<T>) {
    let (mut own, rest) = multiples(&base.line, others, near, line, measured);
    if own.is_empty() {
        return (Group::Single(base), rest);
    }
    own.insert(0, (1, base));
    (of_base(own), rest)
}

/// Those of `others` that are multiples of a `base`, with their numbers, as they are `measured`; and the rest of them.
pub fn multiples<T>(
    base: &Line,
    others: Vec<T>,
    near: Near,
    line: impl Fn(&T) -> Line,
    measured: impl Fn(T) -> Measured,
) -> (Vec<(u32, Measured)>, Vec<T>) {
    let (mut own, mut rest) = (Vec::new(), Vec::new());
    for one in others {
        match multiple_of(base, &line(&one), near) {
            Some(number) => own.push((number, measured(one))),
            None => rest.push(one),
        }
    }
    (own, rest)
}

fn multiple_of(base: &Line, line: &Line, near: Near) -> Option<u32> {
    /// Highest multiple.
    const HIGHEST: f64 = 20.0;
    let number = (line.frequency_hz / base.frequency_hz).round();
    let off_hz = (line.frequency_hz - number * base.frequency_hz).abs();
    let own_sd_hz = line.frequency_sd_hz.max(near.least_sd_hz);
    let sd_hz = (number * base.frequency_sd_hz).hypot(own_sd_hz);
    let is_multiple = (2.0..=HIGHEST).contains(&number)
        && off_hz < 4.0 * sd_hz
        && 8.0 * sd_hz < near.by_chance * base.frequency_hz;
    is_multiple.then_some(number as u32)
}

/// Lines of one base, each by its own certainty.
pub fn of_base(lines: Vec<(u32, Measured)>) -> Group {
    // One base through all of them, each by its own certainty.
    let (mut sum, mut weight) = (0.0, 0.0);
    for (number, one) in &lines {
        let sd = one.line.frequency_sd_hz / f64::from(*number);
        sum += one.line.frequency_hz / f64::from(*number) / (sd * sd);
        weight += 1.0 / (sd * sd);
    }
    Group::Hum {
        base_hz: sum / weight,
        base_sd_hz: weight.sqrt().recip(),
        lines,
    }
}
