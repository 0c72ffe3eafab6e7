//! Dropped: samples lost without a trace, recognised by the lines that jump with them.

mod demodulate;
mod evidence;
mod in_motion;
mod lengths;
mod line;
mod loss;
mod moment;
mod part;
mod peaks;
mod sample;
mod search;
mod tables;

use super::Detector;
use super::lines::{self, Group, Measured};
use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::detect::look::{Lesson, Look, Proposal};
use crate::diagnosis::explanation::{Candidate, Change};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;
use crate::model::dropped::KIND;
use crate::model::motion;
use crate::model::shock::{self, Shock};
use crate::spectrum::Line;
use loss::Loss;

/// Samples on either side of a loss that no law of a whole record speaks for: the noise itself is
/// cut there, and a steep filter remembers that many.
const CUT: f64 = 64.0;

/// Lines that are followed: the strongest show a loss best, and a record of many lines has no time for all of them.
const MOST_LINES: usize = 16;

/// Standard deviations of the moment that are excluded as well: 99.7 %.
const UNSURE: f64 = 3.0;

/// Looks for lines that all jump in phase at one moment. The moment is excluded: where noise is cut there
/// are bad samples and bursts that are nothing of their own.
pub static DETECTOR: Detector = Detector { tests: 1, look };

fn look(look: &Look<'_>) -> Result<Vec<Proposal>, NoFit> {
    let axis = look.axis;
    // Once lines are out, what a loss leaves of them is no measure of it.
    let is_line = |wave: &Wave| matches!(wave, Wave::Line { .. });
    if !look.is_open(KIND) || axis.residual.waves().iter().any(is_line) {
        return Ok(Vec::new());
    }
    let found = strongest(lines::lines(axis, look.level()));
    if are_the_same(
        &found,
        &look.character.lines_without_loss,
        look.duration_s(),
    ) {
        return Ok(Vec::new());
    }
    let Some(loss) = search::lost_samples(axis, &found, look.level()) else {
        return Ok(vec![Proposal::Learn(Lesson::LinesWithoutLoss(found))]);
    };
    let (loss, moved) = match in_motion::loss(look) {
        Some(loss) => (loss, Some(motion::KIND)),
        None => (loss, None),
    };
    let mut proposals = lines::proposals(look, lines::with_hum(measured(look, &loss)), |_| false);
    let mut candidate = candidate(look, &loss);
    candidate.supersedes.extend(moved);
    proposals.push(Proposal::Explain(Box::new(candidate)));
    Ok(proposals)
}

/// Whether lines are those that were seen `before`, in a record of `duration_s` seconds: as many, none of them half an
/// ordinate away, and none far stronger or weaker beside its noise. What jumps is the same then.
fn are_the_same(lines: &[Line], before: &[Line], duration_s: f64) -> bool {
    /// Factor on the power over the noise from which a line shows more or less than it did: a choice, half of a decibel.
    const AS_STRONG: f64 = 1.12;
    let is_same = |(now, then): (&Line, &Line)| {
        let moved = (now.frequency_hz - then.frequency_hz).abs() * duration_s;
        let factor = (now.ratio / then.ratio).max(then.ratio / now.ratio);
        moved < 0.5 && factor < AS_STRONG
    };
    lines.len() == before.len() && lines.iter().zip(before).all(is_same)
}

/// The strongest of the lines in some groups, by their frequencies.
fn strongest(groups: Vec<Group>) -> Vec<Line> {
    let mut found: Vec<Line> = groups
        .into_iter()
        .flat_map(|group| match group {
            Group::Single(one) => vec![one.line],
            Group::Hum { lines, .. } => lines.into_iter().map(|(_, one)| one.line).collect(),
            Group::Cluster { lines, .. } => lines,
        })
        .collect();
    found.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
    found.truncate(MOST_LINES);
    found.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    found
}

/// The lines of a loss as any others are measured.
fn measured(look: &Look<'_>, loss: &Loss) -> Vec<Measured> {
    let (rate_hz, duration_s) = (look.axis.rate_hz, look.duration_s());
    let samples = look.axis.filled.len() as f64;
    let both = loss.waves().zip(&loss.lines);
    both.map(|(wave, steady)| {
        let sd = lines::amplitude_sd(look.axis, steady.cycles * rate_hz, samples);
        Measured {
            line: steady.peak(rate_hz, duration_s),
            wave,
            amplitude_sd: (lines::UNDECLARED.sqrt() * sd).hypot(steady.amplitude_sd),
        }
    })
    .collect()
}

fn candidate(look: &Look<'_>, loss: &Loss) -> Candidate {
    let rate_hz = look.axis.rate_hz;
    let time_s = Value {
        value: loss.index as f64 / rate_hz,
        lo: Some(loss.index_lo / rate_hz),
        hi: Some(loss.index_hi / rate_hz),
    };
    let samples = Value {
        value: f64::from(loss.samples),
        lo: Some(loss.samples_lo),
        hi: Some(loss.samples_hi),
    };
    let wide = CUT + UNSURE * loss.index_sd;
    let from = (loss.index as f64 - wide).max(0.0) as usize;
    let to = ((loss.index as f64 + wide) as usize).min(look.axis.residual.len());
    let supersedes = are_of_loss(look.axis, loss).then_some(shock::KIND);
    Candidate {
        held_out_nats: Some(loss.held_nats),
        supersedes: supersedes.into_iter().collect(),
        ..Candidate::new(
            Estimate::new(KIND, [time_s, samples]),
            loss.p_value,
            2.0,
            Change::Cut(from..to),
        )
    }
}

/// Whether shocks are known that all are what a loss makes of its lines: a line that jumps in phase is that line less one that
/// rings at its frequency about the moment.
fn are_of_loss(axis: &AxisState, loss: &Loss) -> bool {
    let [from_s, to_s] = [loss.index_lo, loss.index_hi].map(|index| index / axis.rate_hz);
    let is_line = |one: &Shock| {
        let mut lines = loss.lines.iter();
        // Within the width of what rings so shortly.
        lines.any(|line| (line.cycles * axis.rate_hz - one.f_hz).abs() * one.decay_s < 1.0)
    };
    let is_then = |one: &Shock| one.time_s <= to_s && from_s <= one.time_s + one.duration_s;
    let mut shocks = axis.residual.shocks().peekable();
    shocks.peek().is_some() && shocks.all(|one| is_line(one) && is_then(one))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::model::sinusoid;

    /// Three lines of which `lost` samples are lost in the middle.
    pub fn trial(seed: u64, lost: usize) -> Trial {
        let mut longer = noise(seed);
        for f_hz in [7.3, 11.9, 17.1] {
            trial::add(&mut longer, &trial::line(f_hz, 0.5));
        }
        let middle = longer.len() / 2;
        longer.drain(middle..middle + lost);
        Trial::new(longer)
    }

    #[test]
    fn a_loss_is_found_with_its_lines_while_they_are_in() {
        let mut trial = trial(0, 9);
        let mut kinds = trial::kinds(&trial.ask(&DETECTOR));
        assert_eq!(kinds.pop(), Some(KIND), "seed 0");
        assert_eq!(kinds, [sinusoid::KIND; 3], "seed 0");
        trial.refuse(KIND);
        assert!(trial.ask(&DETECTOR).is_empty(), "seed 0: refused");
        trial.refused.clear();
        let out = Change::Waves(vec![trial::line(30.0, 0.0)]);
        trial.know(sinusoid::KIND, [30.0, 0.0], out);
        assert!(trial.ask(&DETECTOR).is_empty(), "seed 0: lines are out");
    }

    /// Lines on a walk, `lost` samples lost ahead of the sample `index`.
    fn on_a_walk(seed: u64, index: usize, lost: usize) -> Trial {
        let mut longer = noise(seed);
        let mut level = 0.0;
        for value in &mut longer {
            level += 0.3 * *value;
            *value = level;
        }
        for f_hz in [17.3, 21.9, 27.1] {
            trial::add(&mut longer, &trial::line(f_hz, 2.0));
        }
        longer.drain(index..index + lost);
        Trial::new(longer)
    }

    /// The moment that is found, in samples, and its interval.
    fn moment(trial: &Trial) -> Option<[f64; 3]> {
        trial.ask(&DETECTOR).into_iter().find_map(|one| match one {
            Proposal::Explain(one) if one.effect.kind == KIND => {
                let said = one.effect.values[0]?;
                Some([said.lo?, said.value, said.hi?].map(|one| one * trial.axis.rate_hz))
            }
            _ => None,
        })
    }

    #[test]
    fn noise_that_is_cut_with_the_lines_does_not_move_the_moment() {
        let held = (0..20).filter(|&seed| {
            let index = 9000 + 137 * seed as usize;
            let found = moment(&on_a_walk(seed, index, 9));
            let [lo, said, hi] = found.expect("a loss");
            assert!(
                (said - index as f64).abs() < 30.0,
                "seed {seed}: {said} for {index}"
            );
            (lo..=hi).contains(&(index as f64))
        });
        // Of 20 intervals of 95 %, four or more miss once in 60.
        let held = held.count();
        assert!(held >= 17, "{held} of 20");
    }

    #[test]
    fn two_hundred_cycles_of_the_slowest_line_are_enough() {
        for (seed, length) in [(0, 10_001), (1, 9567), (2, 11_002)] {
            let mut longer = noise(seed);
            longer.truncate(length);
            for f_hz in [2.1, 11.9, 17.1] {
                trial::add(&mut longer, &trial::line(f_hz, 0.7));
            }
            let index = length / 2;
            longer.drain(index..index + 7);
            let [lo, _, hi] = moment(&Trial::new(longer)).expect("a loss");
            let is_held = (lo - 1.0..hi + 1.0).contains(&(index as f64));
            assert!(is_held, "seed {seed}: {lo} to {hi} for {index}");
        }
    }

    #[test]
    fn a_shock_that_rings_as_a_line_about_the_moment_is_the_loss_itself() {
        let replaces_shock = |f_hz: f64, from_end: f64| {
            let mut trial = trial(0, 9);
            let end_s = trial.axis.residual.len() as f64 / trial.axis.rate_hz;
            let shock = Shock {
                time_s: (0.5 - from_end) * end_s,
                peak: 1e-6,
                duration_s: 0.1 * end_s,
                f_hz,
                decay_s: 2.0,
            };
            let wave = Wave::Shocks {
                shocks: vec![shock],
                rate_hz: trial.axis.rate_hz,
            };
            let Shock {
                time_s,
                peak,
                duration_s,
                f_hz,
                decay_s,
            } = shock;
            let values = [time_s, peak, duration_s, f_hz, decay_s];
            trial.know(shock::KIND, values, Change::Waves(vec![wave]));
            let found = trial.ask(&DETECTOR).into_iter().find_map(|one| match one {
                Proposal::Explain(one) if one.effect.kind == KIND => Some(one.supersedes),
                _ => None,
            });
            found.expect("a loss, seed 0") == [shock::KIND]
        };
        assert!(replaces_shock(11.9, 0.05));
        assert!(!replaces_shock(14.0, 0.05), "no line");
        assert!(!replaces_shock(11.9, 0.3), "before the moment");
    }

    #[test]
    fn lines_without_a_loss_are_remembered() {
        let proposals = trial(1, 0).ask(&DETECTOR);
        let [Proposal::Learn(lesson @ Lesson::LinesWithoutLoss(without))] = proposals.as_slice()
        else {
            panic!("seed 1: {proposals:?}");
        };
        assert_eq!(without.len(), 3, "seed 1");
        // Whatever is remembered is not looked at again, not even a loss.
        let mut trial = trial(0, 9);
        let lines = trial.look(|look| strongest(lines::lines(look.axis, look.level())));
        trial.character.learn(lesson.clone());
        assert!(!trial.ask(&DETECTOR).is_empty(), "seed 0: other lines");
        trial.character.learn(Lesson::LinesWithoutLoss(lines));
        assert!(trial.ask(&DETECTOR).is_empty(), "seed 0: the same lines");
    }

    #[test]
    fn lines_are_the_same_until_one_moves_comes_goes_or_stands_out_more() {
        let line = |frequency_hz: f64, ratio: f64| Line {
            frequency_hz,
            frequency_sd_hz: 0.0,
            amplitude: 1.0,
            ratio,
            false_alarm: 0.0,
        };
        let before = [line(7.0, 30.0), line(11.0, 50.0)];
        let are_same = |now: &[Line]| are_the_same(now, &before, 100.0);
        assert!(are_same(&[line(7.004, 31.0), line(10.997, 46.0)]));
        assert!(!are_same(&[line(7.006, 30.0), line(11.0, 50.0)]), "moved");
        assert!(!are_same(&[line(7.0, 34.0), line(11.0, 50.0)]), "stronger");
        assert!(!are_same(&[line(7.0, 30.0), line(11.0, 44.0)]), "weaker");
        assert!(!are_same(&before[..1]), "gone");
    }
}
