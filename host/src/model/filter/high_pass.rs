//! A Butterworth high-pass as a recursion over samples.

use std::f64::consts::PI;

use super::mirror::Mirror;
use super::settling;
use crate::model::effect::Distorter;

/// One pole on the real axis or two that are conjugate, behind as many zeros at DC:
/// `y = own (difference of x) + first y' + second y''`.
#[derive(Debug, Clone, Copy)]
struct Section {
    own: f64,
    first: f64,
    second: f64,
    /// Whether there are two of each.
    is_double: bool,
    /// The last two values that came.
    came: [f64; 2],
    /// The last two that went.
    went: [f64; 2],
}

impl Section {
    /// One pole of an analog corner that is `bent` (below) by the bilinear transform.
    fn single(bent: f64) -> Self {
        Self {
            own: 1.0 / (1.0 + bent),
            first: (1.0 - bent) / (1.0 + bent),
            second: 0.0,
            is_double: false,
            came: [0.0; 2],
            went: [0.0; 2],
        }
    }

    /// Two at this angle from the imaginary axis, radians.
    fn double(bent: f64, angle: f64) -> Self {
        let damping = 2.0 * bent * angle.sin();
        let square = bent * bent;
        let all = 1.0 + damping + square;
        Self {
            own: 1.0 / all,
            first: 2.0 * (1.0 - square) / all,
            second: -(1.0 - damping + square) / all,
            is_double: true,
            came: [0.0; 2],
            went: [0.0; 2],
        }
    }

    fn follow(&mut self, value: f64) -> f64 {
        let [last, before] = self.came;
        let change = if self.is_double {
            (value - last) - (last - before)
        } else {
            value - last
        };
        let next = self.own * change + self.first * self.went[0] + self.second * self.went[1];
        self.came = [value, last];
        self.went = [next, self.went[0]];
        next
    }
}

/// Poles of a Butterworth high-pass by the bilinear transform, and as many zeros at DC.
pub struct HighPass {
    sections: Vec<Section>,
    mirror: Mirror,
    settling: usize,
    /// Values that are not the record's yet, once it has begun.
    unsettled: Option<usize>,
}

impl HighPass {
    /// So many poles, a corner of `bent`, the tangent of half the radians a sample that it is.
    pub fn new(poles: u8, bent: f64) -> Self {
        // At equal angles on the left half of a circle about zero.
        let angle = |number: u8| PI * f64::from(2 * number + 1) / f64::from(2 * poles);
        let pairs = (0..poles / 2).map(|number| Section::double(bent, angle(number)));
        let single = (poles % 2 == 1).then(|| Section::single(bent));
        // The pair next to the imaginary axis decays slowest; a corner is two of its tangent, radians a sample.
        let slowest = 2.0 * bent.min(1.0) * angle(0).sin();
        let settling = settling(slowest);
        Self {
            sections: pairs.chain(single).collect(),
            mirror: Mirror::new(settling),
            settling,
            unsettled: None,
        }
    }
}

impl Distorter for HighPass {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        let Some(came) = self.mirror.before(std::mem::take(samples)) else {
            return;
        };
        let mut unsettled = self.unsettled.unwrap_or_else(|| {
            // All that came before was the same: what goes out is zero behind each section.
            if let Some(first) = self.sections.first_mut() {
                first.came = [came[0]; 2];
            }
            self.settling
        });
        for value in came {
            let value = self
                .sections
                .iter_mut()
                .fold(value, |value, section| section.follow(value));
            if unsettled > 0 {
                unsettled -= 1;
            } else {
                samples.push(value);
            }
        }
        self.unsettled = Some(unsettled);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recursion_has_the_response() {
        for poles in 1..=5 {
            let bent = 0.11_f64;
            for radians in [0.05_f64, 0.2, 0.5, 2.0] {
                let mut sections = HighPass::new(poles, bent).sections;
                let [mut sine, mut cosine] = [0.0; 2];
                // The power at one frequency of the answer to a single sample.
                for n in 0..2000 {
                    let one = if n == 0 { 1.0 } else { 0.0 };
                    let answer = sections
                        .iter_mut()
                        .fold(one, |value, one| one.follow(value));
                    sine += answer * (radians * f64::from(n)).sin();
                    cosine += answer * (radians * f64::from(n)).cos();
                }
                let corners = ((0.5 * radians).tan() / bent).powi(2 * i32::from(poles));
                let expected = corners / (1.0 + corners);
                let power = sine * sine + cosine * cosine;
                assert!((power / expected - 1.0).abs() < 1e-9, "{poles} poles");
            }
        }
    }

    #[test]
    fn a_level_is_gone_from_the_first_sample_on() {
        let mut filter = HighPass::new(2, 0.01);
        let mut samples = vec![1e6; 20_000];
        filter.apply(&mut samples);
        assert!(!samples.is_empty());
        assert!(samples.iter().all(|value| value.abs() < 1e-3));
    }
}
