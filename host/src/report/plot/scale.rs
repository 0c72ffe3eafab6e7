//! Maps values onto a stretch of pixels, and says where its ticks are.

/// Pixels between two ticks of a linear scale, at least: labels side by side, and above one
/// another.
const BESIDE: f64 = 56.0;
const ABOVE: f64 = 20.0;

/// Decades of a linear scale's labels that are written out; beyond, a power of ten is taken out.
const PLAIN: std::ops::Range<i32> = -2..4;

/// A scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    logarithmic: bool,
    /// Values at the two ends, their common logarithms on a logarithmic scale.
    ends: (f64, f64),
    pixels: (f64, f64),
}

/// A tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Its pixel.
    pub at: f64,
    /// Its label.
    pub label: String,
}

impl Scale {
    /// A logarithmic scale from `10^decades.0` at `pixels.0` to `10^decades.1` at `pixels.1`.
    pub const fn log(decades: (f64, f64), pixels: (f64, f64)) -> Self {
        Self {
            logarithmic: true,
            ends: decades,
            pixels,
        }
    }

    /// A linear scale from `ends.0` at `pixels.0` to `ends.1` at `pixels.1`.
    pub const fn linear(ends: (f64, f64), pixels: (f64, f64)) -> Self {
        Self {
            logarithmic: false,
            ends,
            pixels,
        }
    }

    /// Pixel of a value, which is above zero on a logarithmic scale.
    pub fn at(&self, value: f64) -> f64 {
        let value = if self.logarithmic {
            value.log10()
        } else {
            value
        };
        let part = (value - self.ends.0) / (self.ends.1 - self.ends.0);
        self.pixels.0 + part * (self.pixels.1 - self.pixels.0)
    }

    /// Values at the two ends.
    pub fn ends(&self) -> (f64, f64) {
        if self.logarithmic {
            (10_f64.powf(self.ends.0), 10_f64.powf(self.ends.1))
        } else {
            self.ends
        }
    }

    /// The whole powers of ten of a logarithmic scale; round numbers of a linear one, over
    /// `10^`[`Scale::exponent`].
    pub fn ticks(&self) -> Vec<Tick> {
        if self.logarithmic {
            let powers = self.ends.0.ceil() as i32..=self.ends.1.floor() as i32;
            let tick = |exponent: i32| Tick {
                at: self.at(10_f64.powi(exponent)),
                label: power_of_ten(exponent),
            };
            return powers.map(tick).collect();
        }
        let step = self.step();
        let exponent = self.exponent();
        let (low, high) = (self.ends.0.min(self.ends.1), self.ends.0.max(self.ends.1));
        let decimals = (exponent - step.log10().floor() as i32).max(0) as usize;
        let tick = |number: i64| {
            let value = number as f64 * step;
            let shown = value / 10_f64.powi(exponent);
            let sign = if number < 0 { "\u{2212}" } else { "" };
            Tick {
                at: self.at(value),
                label: format!("{sign}{:.decimals$}", shown.abs()),
            }
        };
        let numbers = (low / step - 1e-9).ceil() as i64..=(high / step + 1e-9).floor() as i64;
        numbers.map(tick).collect()
    }

    /// Power of ten that the labels of a linear scale leave out; 0 of a logarithmic one.
    pub fn exponent(&self) -> i32 {
        if self.logarithmic {
            return 0;
        }
        let largest = self.ends.0.abs().max(self.ends.1.abs());
        let exponent = largest.log10().floor() as i32;
        if largest == 0.0 || PLAIN.contains(&exponent) {
            0
        } else {
            exponent
        }
    }

    /// Distance of ticks: 1, 2 or 5 times a power of ten.
    fn step(&self) -> f64 {
        let length = self.pixels.1 - self.pixels.0;
        // Upright scales run from the bottom up, against the pixels.
        let apart = if length > 0.0 { BESIDE } else { ABOVE };
        let wanted = apart / length.abs();
        let least = wanted * (self.ends.1 - self.ends.0).abs();
        let power = 10_f64.powf(least.log10().floor());
        let round = [1.0, 2.0, 5.0].into_iter().map(|one| one * power);
        round
            .into_iter()
            .find(|step| *step >= least * (1.0 - 1e-9))
            .unwrap_or(10.0 * power)
    }
}

/// A power of ten as text with a raised exponent.
pub fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = [
        '\u{2070}', '\u{b9}', '\u{b2}', '\u{b3}', '\u{2074}', '\u{2075}', '\u{2076}', '\u{2077}',
        '\u{2078}', '\u{2079}',
    ];
    let raised = |letter: char| match letter.to_digit(10) {
        Some(digit) => RAISED[digit as usize],
        None => '\u{207b}',
    };
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        _ => format!(
            "10{}",
            exponent.to_string().chars().map(raised).collect::<String>()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale) -> Vec<String> {
        scale.ticks().into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn logarithmic_scales_tick_at_powers_of_ten() {
        let scale = Scale::log((-2.0, 2.0), (0.0, 400.0));
        assert_eq!(scale.at(1.0), 200.0);
        let places: Vec<f64> = scale.ticks().iter().map(|tick| tick.at).collect();
        assert_eq!(places, [0.0, 100.0, 200.0, 300.0, 400.0]);
        let powers = [
            "10\u{207b}\u{b2}",
            "10\u{207b}\u{b9}",
            "1",
            "10",
            "10\u{b2}",
        ];
        assert_eq!(labels(scale), powers);
    }

    #[test]
    fn linear_scales_tick_at_round_numbers() {
        let scale = Scale::linear((-0.5, 0.5), (90.0, 0.0));
        assert_eq!(labels(scale), ["\u{2212}0.5", "0.0", "0.5"]);
        let scale = Scale::linear((0.0, 5400.0), (0.0, 560.0));
        assert_eq!(scale.exponent(), 0);
        assert_eq!(scale.ticks()[1].label, "1000");
        let scale = Scale::linear((-3.2e-5, 2.9e-5), (100.0, 0.0));
        assert_eq!(scale.exponent(), -5);
        assert_eq!(labels(scale), ["\u{2212}2", "0", "2"]);
    }
}
