//! Jumps as they are behind what filters.

use crate::diagnosis::axis::{AxisState, SPREAD};

/// Makes the jumps of `axis` in `wave`, its deterministic part, pass what filters the record: there a jump takes as long
/// as the filter.
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

/// Course of a jump from 0 to 1 behind what filters, from [`SPREAD`] samples before it to as many after; `None` where
/// nothing filters.
fn passage(axis: &AxisState) -> Option<Vec<f64>> {
    let seen = axis.whitened();
    let passed = axis.passed(&seen.transform)?;
    let answer = seen.transform.answer(|k| passed[k]);
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
    use std::sync::Arc;

    use super::*;
    use crate::chain::Chain;
    use crate::diagnosis::detect::trial::{self, Trial, noise};
    use crate::diagnosis::record::wave::Wave;
    use crate::model::steps::KIND;

    const SEED: u64 = 40;

    /// A jump by 4 as `chain` lets it pass.
    fn passed(chain: Option<&str>) -> Vec<f64> {
        let chain: Option<Chain> = chain.map(|one| one.parse().expect("a chain"));
        let jumps = [trial::jump(9000, 4.0)];
        let mut values = noise(SEED);
        trial::add(&mut values, &Wave::Steps(jumps.to_vec()));
        let mut trial = Trial::new(values.clone());
        let axis = AxisState::new(Arc::new(values), trial::RATE_HZ, chain.as_ref());
        trial.axis = axis.expect("a spectrum");
        trial.know(KIND, [90.0, 4.0], trial::steps(&jumps));
        let mut wave = trial.axis.residual.waveform();
        soften(&trial.axis, &mut wave);
        wave
    }

    #[test]
    fn a_jump_behind_a_filter_takes_its_time_and_arrives() {
        let sharp = passed(None);
        assert_eq!((sharp[8999], sharp[9000]), (0.0, 4.0));
        let soft = passed(Some("ads1281:linear"));
        let off = |n: usize, level: f64| (soft[n] - level).abs();
        // At the moment itself a filter without delay is half way up; its band ends at two fifths of the rate.
        assert!(
            off(8999, 0.0) > 0.1 && off(9000, 4.0) > 0.1,
            "{:?}",
            &soft[8995..9005]
        );
        assert!(off(8936, 0.0) < 0.01 && off(9064, 4.0) < 0.01);
        assert_eq!((soft[8900], soft[9100]), (0.0, 4.0));
    }
}
