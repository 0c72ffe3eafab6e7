//! The digital filter's frequency response, in `f64`, for those who analyse the words.
//!
//! From the same tables as the integer filter. Frequencies are in units of the data rate. The
//! high-pass filter is not part of it.

use core::f64::consts::PI;

use crate::{
    Phase,
    filter::DECIMATION,
    tables::{
        FIR1, FIR1_SHIFT, FIR2, FIR2_SHIFT, FIR3_LINEAR, FIR3_MINIMUM, FIR3_SHIFT, FIR4_LINEAR,
        FIR4_MINIMUM, FIR4_SHIFT,
    },
};

/// Response of the sinc5 and FIR stages.
///
/// ```
/// use inm_emulator::{Phase, response::Response};
/// let response = Response::new(Phase::Linear, 2000);
/// let db = 20.0 * response.gain(0.4129).log10();
/// assert!((db + 3.01).abs() < 0.05, "-3 dB at 0.4129 of the data rate");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Response {
    phase: Phase,
    sinc_decimation: u32,
}

impl Response {
    /// The filter at `data_rate_hz` (250 to 4000); the rate matters only beyond half of it,
    /// through the sinc stage's decimation of 32000 / rate.
    pub const fn new(phase: Phase, data_rate_hz: u32) -> Self {
        let rate = if data_rate_hz == 0 { 1 } else { data_rate_hz };
        let decimation = 32_000 / rate;
        Self {
            phase,
            sinc_decimation: if decimation == 0 { 1 } else { decimation },
        }
    }

    /// |H(f)|, f in units of the data rate. Relative accuracy 1e-12 in the pass band, absolute
    /// 1e-13 (-260 dB) beyond.
    pub fn gain(&self, f: f64) -> f64 {
        let (re, im) = self.value(f);
        libm::sqrt(re * re + im * im)
    }

    /// H(f) as real and imaginary part. The time origin is the middle of the last input of the
    /// word.
    pub fn value(&self, f: f64) -> (f64, f64) {
        let (fir3, fir4) = match self.phase {
            Phase::Linear => (&FIR3_LINEAR, &FIR4_LINEAR),
            Phase::Minimum => (&FIR3_MINIMUM, &FIR4_MINIMUM),
        };
        // Angles per tap: each stage runs at 32, 16, 8 and 2 times the data rate.
        let input = 2.0 * PI * f / DECIMATION as f64;
        let stages = [
            stage(&FIR1, FIR1_SHIFT, input),
            stage(&FIR2, FIR2_SHIFT, 2.0 * input),
            stage(fir3, FIR3_SHIFT, 4.0 * input),
            stage(fir4, FIR4_SHIFT, 16.0 * input),
        ];
        stages.into_iter().fold(self.sinc5(input), product)
    }

    /// Group delay in conversions, with the sinc stage's own (2.5 of its words).
    pub fn group_delay(&self, f: f64) -> f64 {
        let step = 1e-6;
        let (before, after) = (self.value(f - step), self.value(f + step));
        // Phase of after times the conjugate of before: no unwrapping.
        let (re, im) = product(after, (before.0, -before.1));
        -libm::atan2(im, re) / (2.0 * step * 2.0 * PI)
    }

    /// The sinc stage and its delay of 5 (N - 1) / 2 modulator cycles.
    fn sinc5(&self, input: f64) -> (f64, f64) {
        let n = f64::from(self.sinc_decimation);
        let (half_word, half_cycle) = (input / 2.0, input / 2.0 / n);
        let ratio = if libm::sin(half_cycle) == 0.0 {
            1.0
        } else {
            libm::sin(half_word) / (n * libm::sin(half_cycle))
        };
        let amplitude = ratio * ratio * ratio * ratio * ratio;
        let angle = -5.0 * (n - 1.0) * half_cycle;
        (amplitude * libm::cos(angle), amplitude * libm::sin(angle))
    }
}

/// Sum of taps * exp(-j angle k) over the stage's unit gain, by Horner's rule from the last tap.
fn stage(taps: &[i32], shift: u32, angle: f64) -> (f64, f64) {
    let turn = (libm::cos(angle), -libm::sin(angle));
    let unit = (1_u64 << shift) as f64;
    taps.iter().rev().fold((0.0, 0.0), |sum, &tap| {
        let (re, im) = product(sum, turn);
        (re + f64::from(tap) / unit, im)
    })
}

/// Complex product.
fn product(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn db(gain: f64) -> f64 {
        20.0 * libm::log10(gain)
    }

    fn frequencies(from: f64, to: f64, count: u32) -> impl Iterator<Item = f64> {
        (0..=count).map(move |i| from + (to - from) * f64::from(i) / f64::from(count))
    }

    /// First frequency from `from` on at which the gain is below `level_db`.
    fn crossing(response: Response, from: f64, level_db: f64) -> f64 {
        frequencies(from, from + 0.2, 20_000)
            .find(|&f| db(response.gain(f)) < level_db)
            .expect("within the transition band")
    }

    /// The figures of an independent computation from the same tables; data-sheet limits beside
    /// them.
    #[test]
    fn figures_of_both_phases() {
        struct Expected {
            phase: Phase,
            dc_db: f64,
            ripple_mdb: (f64, f64),
            corner: f64,
            nyquist_db: f64,
            stop_db: f64,
        }
        let linear = Expected {
            phase: Phase::Linear,
            dc_db: 0.00025,
            ripple_mdb: (-2.5, 2.4),
            corner: 0.4129,
            nyquist_db: -144.7,
            stop_db: -141.8,
        };
        let minimum = Expected {
            phase: Phase::Minimum,
            dc_db: 0.0015,
            ripple_mdb: (-1.7, 2.0),
            corner: 0.4136,
            nyquist_db: -121.0,
            stop_db: -141.5,
        };
        for expected in [linear, minimum] {
            let phase = expected.phase;
            let response = Response::new(phase, 1000);
            let dc = db(response.gain(0.0));
            assert!(
                (dc - expected.dc_db).abs() < 5e-5,
                "{phase:?}: {dc} dB at DC"
            );
            // Relative to unity, not to DC: the gain itself has a limit of 3 mdB (page 16).
            let (low, high) = frequencies(0.0, 0.375, 4000)
                .map(|f| 1000.0 * db(response.gain(f)))
                .fold((0.0, 0.0), |(low, high): (f64, f64), x| {
                    (low.min(x), high.max(x))
                });
            let (want_low, want_high) = expected.ripple_mdb;
            assert!(
                (low - want_low).abs() < 0.15,
                "{phase:?}: ripple from {low} mdB"
            );
            assert!(
                (high - want_high).abs() < 0.15,
                "{phase:?}: ripple to {high} mdB"
            );
            let corner = crossing(response, 0.375, -3.0103);
            assert!(
                (corner - expected.corner).abs() < 1e-4,
                "{phase:?}: -3 dB at {corner}"
            );
            let nyquist = db(response.gain(0.5));
            assert!(
                (nyquist - expected.nyquist_db).abs() < 0.5,
                "{phase:?}: {nyquist} dB at 0.5"
            );
            let stop = frequencies(0.51, 15.9, 60_000)
                .map(|f| db(response.gain(f)))
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(
                (stop - expected.stop_db).abs() < 0.3,
                "{phase:?}: stop band at {stop} dB"
            );
        }
    }

    #[test]
    fn group_delays() {
        let linear = Response::new(Phase::Linear, 1000);
        for f in [0.001, 0.1, 0.25, 0.375] {
            let delay = linear.group_delay(f);
            assert!((delay - 30.795).abs() < 0.01, "{delay} at {f}");
        }
        let minimum = Response::new(Phase::Minimum, 1000);
        for (f, expected) in [(0.001, 5.0), (0.2, 5.8), (0.3, 7.6), (0.375, 12.0)] {
            let delay = minimum.group_delay(f);
            assert!((delay - expected).abs() < 0.1, "{delay} at {f}");
        }
    }

    /// White noise through the filter: power in the band gives correlation and first Allan point.
    #[test]
    fn white_noise_comes_out_coloured() {
        let response = Response::new(Phase::Linear, 1000);
        let count = 20_000;
        let (mut power, mut lag) = (0.0, 0.0);
        for f in frequencies(0.0, 0.6, count) {
            let density = response.gain(f) * response.gain(f);
            power += density;
            lag += density * libm::cos(2.0 * PI * f);
        }
        let step = 2.0 * 0.6 / f64::from(count);
        let correlation = lag / power;
        assert!(
            (power * step / 2.0 - 0.413).abs() < 0.001,
            "noise bandwidth"
        );
        assert!((correlation - 0.199).abs() < 0.001, "{correlation}");
        // Of neighbours' difference, against the ideal line's 1.
        let first = libm::sqrt(power * step * (1.0 - correlation));
        assert!((first - 0.813).abs() < 0.001, "{first}");
    }
}
