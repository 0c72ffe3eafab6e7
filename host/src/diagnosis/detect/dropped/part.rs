//! A block of a record at one line, given back what the block's straight line took of it.

use rustfft::num_complex::Complex64;

/// What a block whose straight line is out says of a line, and what that takes of the line: with `q` its phasor turned
/// back, and `q~` the same without its own straight line, a line `a` gives
///
/// ```text
/// S = sum of 2 x q = a g + a* h,    g = sum of q~* q,    h = sum of q~ q
/// ```
pub(super) struct Part {
    sum: Complex64,
    g: Complex64,
    h: Complex64,
}

impl Part {
    /// Of the samples of a block, for a line that has the phase `turn` in its first and goes on by `step` a sample, radians.
    pub(super) fn new(values: &[f64], turn: f64, step: f64) -> Self {
        let step = Complex64::cis(-step);
        let middle = 0.5 * (values.len() as f64 - 1.0);
        let (mut sum, mut squares, mut count) = (Complex64::ZERO, 0.0, 0.0);
        // Mean and slope of the phasor in all samples and in those that are usable; its square.
        let (mut all, mut usable) = ([Complex64::ZERO; 2], [Complex64::ZERO; 2]);
        let mut twice = Complex64::ZERO;
        let mut q = Complex64::cis(-turn);
        for (index, &value) in values.iter().enumerate() {
            let away = index as f64 - middle;
            squares += away * away;
            let moments = [q, away * q];
            all[0] += moments[0];
            all[1] += moments[1];
            // What is not usable is exactly zero.
            if value != 0.0 {
                usable[0] += moments[0];
                usable[1] += moments[1];
                twice += q * q;
                count += 1.0;
                sum += 2.0 * value * q;
            }
            q *= step;
        }
        let [mean, slope] = [all[0] / values.len() as f64, all[1] / squares];
        Self {
            sum,
            g: count - mean.conj() * usable[0] - slope.conj() * usable[1],
            h: twice - mean * usable[0] - slope * usable[1],
        }
    }

    /// The line's complex amplitude times the `weight` of the samples that are usable; what the sum says where these are
    /// too few for both of its numbers.
    pub(super) fn line(&self, weight: f64) -> Complex64 {
        /// Share of the information that must be left, at least: a choice.
        const LEFT: f64 = 0.25;
        let left = self.g.norm_sqr() - self.h.norm_sqr();
        if left <= LEFT * weight * weight {
            return self.sum;
        }
        (self.g.conj() * self.sum - self.h * self.sum.conj()) / left * weight
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn a_line_of_few_cycles_is_itself_whatever_its_phase() {
        let (len, cycles) = (58, 0.073);
        let line = Complex64::from_polar(1.3, 0.7);
        let middle = 0.5 * (f64::from(len) - 1.0);
        for block in 0..7 {
            let turn = TAU * cycles * f64::from(block * len);
            let at =
                |index: i32| (line * Complex64::cis(turn + TAU * cycles * f64::from(index))).re;
            let away = |index: i32| f64::from(index) - middle;
            let mean = (0..len).map(at).sum::<f64>() / f64::from(len);
            let squares: f64 = (0..len).map(|index| away(index).powi(2)).sum();
            let slope = (0..len).map(|index| at(index) * away(index)).sum::<f64>() / squares;
            // A few samples that are not usable, the same in each block.
            let is_usable = |index: i32| block < 4 || index % 9 != 2;
            let left = |index: i32| {
                let value = at(index) - mean - slope * away(index);
                if is_usable(index) { value } else { 0.0 }
            };
            let values: Vec<f64> = (0..len).map(left).collect();
            let weight = (0..len).filter(|index| is_usable(*index)).count() as f64;
            let part = Part::new(&values, turn, TAU * cycles);
            let off = part.line(weight) / weight - line;
            assert!(off.norm() < 1e-12, "block {block}: {off}");
            // By the sum alone, a few hundredths are missing.
            assert!((part.sum / weight - line).norm() > 1e-2, "block {block}");
        }
    }
}
