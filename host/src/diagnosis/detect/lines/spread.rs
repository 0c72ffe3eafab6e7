//! How well the sizes of lines are known, in the noise that is left beside all that was found: where a line was, noise was taken for more
//! than it is.

use super::{amplitudes, measure};
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::Explanation;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::value::Value;

/// An explanation of lines that are taken out, with the intervals that their sizes have in the axis as it is now, a tone that
/// is excluded as it was; `None` for any other.
pub fn in_noise_left(axis: &AxisState, one: &Explanation) -> Option<Estimate> {
    let first = amplitudes::first(one.kind())?;
    let mut effect = one.effect.clone();
    let base = effect.values[0]?.value;
    let samples = measure::weights(axis);
    for wave in one.waves() {
        // What is lost between has an uncertainty of its own.
        let Wave::Line {
            cycles, lost: None, ..
        } = *wave
        else {
            return None;
        };
        let f_hz = cycles * axis.rate_hz;
        let number = (f_hz / base).round() as usize;
        let size = effect.values.get_mut((first + number).checked_sub(1)?)?;
        let sd = measure::amplitude_sd(axis, f_hz, samples) / axis.bins.chain_power(f_hz).sqrt();
        *size = size.map(|size| Value::normal(size.value, sd));
    }
    Some(effect)
}

#[cfg(test)]
mod tests {
    use super::super::DETECTOR;
    use super::*;
    use crate::diagnosis::detect::trial::{self, Trial, noise};

    #[test]
    fn a_line_is_known_as_well_as_the_noise_beside_it_leaves_it() {
        for seed in 60..66 {
            let mut values = noise(seed);
            trial::add(&mut values, &trial::line(3.7, -2.0));
            let samples = values.len() as f64;
            let mut trial = Trial::new(values);
            let line = trial::candidate(trial.ask(&DETECTOR)).expect("a plain line");
            trial.accept(line);
            let one = &trial.axis.explanations()[0];
            let sd = in_noise_left(&trial.axis, one).expect("a line").values[1].expect("a size");
            // The bound of H. Cramer and C. R. Rao beside noise of the deviation 1, which ends that are tapered miss by 3 %; the
            // density is known to some percent.
            let bound = (2.0 / samples).sqrt();
            assert!(
                (sd.sd() / bound - 1.0).abs() < 0.1,
                "seed {seed}: {}",
                sd.sd() / bound
            );
        }
    }
}
