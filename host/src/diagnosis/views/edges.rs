//! Jumps as they are simulated: behind the roll-offs that have a name. A chain leaves them sharp
//! ([`crate::model::steps::Steps`]), and so they stay here.

use crate::diagnosis::axis::{AxisState, SPREAD};

/// Makes the jumps of `axis` in `wave`, its deterministic part, pass the laws of the model that filter: there a jump takes
/// as long as they.
pub fn soften(axis: &AxisState, wave: &mut [f64]) {
    let mut jumps = axis.residual.jumps().peekable();
    if jumps.peek().is_none() {
        return;
    }
    let Some(passage) = passage(axis) else {
        return;
    };
    for jump in jumps {
        for (n, part) in passage.iter().enumerate() {
            let sharp = if n < SPREAD { 0.0 } else { 1.0 };
            let at = (jump.index + n).checked_sub(SPREAD);
            if let Some(value) = at.and_then(|at| wave.get_mut(at)) {
                *value += jump.height * (part - sharp);
            }
        }
    }
}

/// Course of a jump from 0 to 1 behind them, from [`SPREAD`] samples before it to as many after; `None` where nothing
/// filters.
fn passage(axis: &AxisState) -> Option<Vec<f64>> {
    if !axis.filters_level() {
        return None;
    }
    let ring = &axis.whitened().transform;
    let answer = ring.answer(|k| axis.level_filters(ring.frequency(k)).sqrt());
    let about = (0..2 * SPREAD).map(|n| answer[(n + answer.len() - SPREAD) % answer.len()]);
    let sums = about.scan(0.0, |sum, one| {
        *sum += one;
        Some(*sum)
    });
    let mut course: Vec<f64> = sums.collect();
    let whole = course.last().copied()?;
    course.iter_mut().for_each(|part| *part /= whole);
    Some(course)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::explanation::Change;
    use crate::diagnosis::laws::Law;
    use crate::diagnosis::record::wave::Wave;
    use crate::model::{highpass, rolloff, steps};

    const SEED: u64 = 40;

    /// A jump by 4 as the model has it, behind a pole at 10 Hz or none, or a coupling of 1 Hz.
    fn modelled(pole: bool, coupling: bool) -> Vec<f64> {
        let jumps = [trial::jump(9000, 4.0)];
        let mut values = noise(SEED);
        trial::add(&mut values, &Wave::Steps(jumps.to_vec()));
        let kept = (-std::f64::consts::TAU * 10.0 / trial::RATE_HZ).exp();
        let mut level = 0.0;
        for value in values.iter_mut().filter(|_| pole) {
            level = kept * level + (1.0 - kept) * *value;
            *value = level;
        }
        let mut trial = Trial::new(values);
        trial.know(steps::KIND, [90.0, 4.0], trial::steps(&jumps));
        if pole {
            let (effect, values) = (rolloff::KIND, vec![10.0]);
            trial.know(rolloff::KIND, [10.0], Change::Law(Law { effect, values }));
        }
        if coupling {
            let (effect, values) = (highpass::KIND, vec![1.0]);
            trial.know(highpass::KIND, [1.0], Change::Law(Law { effect, values }));
        }
        let mut wave = trial.axis.residual.waveform();
        soften(&trial.axis, &mut wave);
        wave
    }

    #[test]
    fn a_jump_behind_a_rolloff_takes_its_time_and_arrives() {
        let sharp = modelled(false, false);
        assert_eq!((sharp[8999], sharp[9000]), (0.0, 4.0));
        assert_eq!(modelled(false, true), sharp, "the level joins behind it");
        let soft = modelled(true, false);
        // A pole at a tenth of the rate keeps half within a sample and nothing after thirty.
        assert!(
            soft[8999] > 0.4 && soft[9000] < 3.6,
            "{:?}",
            &soft[8995..9005]
        );
        assert!(soft[8960].abs() < 0.01 && (soft[9040] - 4.0).abs() < 0.01);
        assert_eq!((soft[8900], soft[9100]), (0.0, 4.0));
    }
}
