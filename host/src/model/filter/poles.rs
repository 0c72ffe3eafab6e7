//! The poles of a low-pass as a recursion over samples.

use std::f64::consts::PI;

/// One pole on the real axis or two that are conjugate, at DC of gain one: `y = first y' + second y'' + own x`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    first: f64,
    second: f64,
    own: f64,
    last: [f64; 2],
}

/// The poles of a Butterworth low-pass, each as `exp(s / rate)` of the analog one at `s`.
pub struct Poles {
    sections: Vec<Section>,
    /// Size less one and angle, radians, of each.
    places: Vec<[f64; 2]>,
}

impl Poles {
    /// So many of a corner that is `decay` radians a sample.
    pub fn new(count: usize, decay: f64) -> Self {
        // At equal angles on the left half of a circle about zero (S. Butterworth, Wireless Engineer 7, 1930, 536).
        let angle = |number: usize| PI * (2 * number + 1) as f64 / (2 * count) as f64;
        let analog = (0..count).map(|number| {
            let angle = angle(number);
            [-decay * angle.sin(), decay * angle.cos()]
        });
        let analog: Vec<[f64; 2]> = analog.collect();
        let sections = analog[..count / 2].iter().map(|&[real, imaginary]| {
            let kept = real.exp();
            Section {
                first: 2.0 * kept * imaginary.cos(),
                second: -kept * kept,
                // |1 - z|^2 without the difference of what is nearly equal.
                own: square_from_one(real, imaginary),
                last: [0.0; 2],
            }
        });
        let single = (count % 2 == 1).then(|| {
            let kept = (-decay).exp();
            Section {
                first: kept,
                second: 0.0,
                own: 1.0 - kept,
                last: [0.0; 2],
            }
        });
        Self {
            sections: sections.chain(single).collect(),
            places: analog
                .iter()
                .map(|[real, imaginary]| [real.exp_m1(), *imaginary])
                .collect(),
        }
    }

    /// The same so many times, one after the other.
    pub fn repeated(self, times: u8) -> Self {
        let times = usize::from(times);
        Self {
            sections: self.sections.repeat(times),
            places: self.places.repeat(times),
        }
    }

    /// Takes it that all that came before was `value`.
    pub fn rest_at(&mut self, value: f64) {
        for section in &mut self.sections {
            section.last = [value; 2];
        }
    }

    /// The next value.
    pub fn follow(&mut self, value: f64) -> f64 {
        self.sections.iter_mut().fold(value, |value, section| {
            let Section {
                first, second, own, ..
            } = *section;
            let [before, earlier] = section.last;
            let next = first * before + second * earlier + own * value;
            section.last = [next, before];
            next
        })
    }

    /// Power response at an angular frequency, radians a sample.
    pub fn power(&self, radians: f64) -> f64 {
        let of_pole = |&[less_one, angle]: &[f64; 2]| {
            let from = |radians: f64| {
                let straight = less_one * less_one;
                straight + 4.0 * (1.0 + less_one) * (0.5 * (radians - angle)).sin().powi(2)
            };
            from(0.0) / from(radians)
        };
        self.places.iter().map(of_pole).product()
    }

    /// The slowest decay of them, nepers a sample.
    pub fn slowest(&self) -> f64 {
        let decays = self.places.iter().map(|[less_one, _]| -less_one.ln_1p());
        decays.fold(f64::INFINITY, f64::min)
    }
}

/// `|1 - exp(s)|^2`, from real and imaginary part of `s`.
fn square_from_one(real: f64, imaginary: f64) -> f64 {
    let less_one = real.exp_m1();
    less_one * less_one + 4.0 * (1.0 + less_one) * (0.5 * imaginary).sin().powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_below_the_rate_the_response_is_butterworths() {
        for count in 1..=6 {
            let poles = Poles::new(count, 1e-3);
            for share in [0.1_f64, 0.5, 1.0, 2.0, 4.0] {
                let expected = 1.0 / (1.0 + share.powi(2 * count as i32));
                let ratio = poles.power(1e-3 * share) / expected;
                // What folds down about half the rate is a part in a million there.
                assert!((ratio - 1.0).abs() < 1e-4, "{count}, {share}: {ratio}");
            }
        }
    }

    #[test]
    fn the_recursion_has_the_response() {
        for count in 1..=5 {
            let (mut poles, radians) = (Poles::new(count, 0.3), 0.4_f64);
            let [mut sine, mut cosine] = [0.0; 2];
            // The power at one frequency of the answer to a single sample.
            for n in 0..2000 {
                let answer = poles.follow(if n == 0 { 1.0 } else { 0.0 });
                sine += answer * (radians * f64::from(n)).sin();
                cosine += answer * (radians * f64::from(n)).cos();
            }
            let power = sine * sine + cosine * cosine;
            let expected = poles.power(radians);
            assert!((power / expected - 1.0).abs() < 1e-9, "{count} poles");
        }
    }

    #[test]
    fn what_was_the_same_all_the_time_goes_through() {
        for decay in [1e-6, 0.3, 4.0] {
            let mut poles = Poles::new(3, decay);
            poles.rest_at(5.0);
            assert!((poles.follow(5.0) - 5.0).abs() < 1e-9, "{decay}");
        }
    }
}
