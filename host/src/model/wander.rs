//! How a frequency wanders: the shape of a line whose frequency follows a slow random process.
//!
//! The frequency is `f0 + u(t)` with `u` Gaussian of covariance `rms^2 e^(-|t| / T)`. The phase is its integral, so
//! that a tone of power 1 has the covariance `cos(2 pi f0 t) e^(-b^2 (s - 1 + e^-s))` with `s = |t| / T` and
//! `b = 2 pi rms T` (R. Kubo in *Fluctuation, Relaxation and Resonance in Magnetic Systems*, 1962, eq. 5.8). Slow
//! wandering (`b` far above 1) makes a Gaussian line of the deviation `rms`, fast wandering a Lorentzian one of the
//! width `4 pi rms^2 T`.

use std::f64::consts::TAU;

use realfft::num_complex::Complex64;

use super::random::Gaussian;

/// Levels of the continued fraction, at most: with the last one closed as below its error is below 1e-4 at any `b`, against
/// a numerical transform of the covariance.
const LEVELS: u32 = 48;

/// Levels that do as well for small `b`: so many, and so many more for each unit of `b`. The error is below 1e-7 at any
/// `b` up to 10, where there are fewer than [`LEVELS`].
const LEAST_LEVELS: f64 = 6.0;
const LEVELS_PER_UNIT: f64 = 3.0;

/// From where on, half widths, how many levels do far from the line: the error is below 1e-5 there at any `b` from 0.03
/// to 1000.
const FAR: [(f64, u32); 2] = [(30.0, 2), (8.0, 6)];

/// Deviations beyond which a simulated frequency does not go: 6e-5 of the time.
const FURTHEST: f64 = 4.0;

/// How far and how fast a frequency wanders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wander {
    /// Root mean square about its mean, hertz.
    pub rms_hz: f64,
    /// Correlation time, seconds.
    pub time_s: f64,
}

impl Wander {
    /// The same of a multiple of the tone.
    pub fn times(self, number: u32) -> Self {
        Self {
            rms_hz: f64::from(number) * self.rms_hz,
            ..self
        }
    }

    /// Density per hertz of a tone of power 1 at `offset_hz` from its mean frequency, its integral over all offsets
    /// being 1: the transform of the covariance as a continued fraction (H. Mori, Prog. Theor. Phys. 34 (1965) 399),
    /// `J = 1 / (z + D^2 / (z + g + 2 D^2 / (z + 2 g + ...)))` with `D = 2 pi rms`, `g = 1 / T`. The last level is the
    /// root of its own equation with the level below it a little larger.
    pub fn shape(self, offset_hz: f64) -> f64 {
        let widths = offset_hz.abs() / self.half_width_hz();
        let far = FAR.into_iter().find(|(from, _)| widths > *from);
        self.shape_by(
            offset_hz,
            far.map_or_else(|| self.levels(), |(_, levels)| levels),
        )
    }

    /// Levels of the fraction that do near the line.
    fn levels(self) -> u32 {
        let turns = TAU * self.rms_hz * self.time_s;
        LEVELS.min((LEAST_LEVELS + LEVELS_PER_UNIT * turns) as u32)
    }

    /// The same by so many levels of the fraction.
    fn shape_by(self, offset_hz: f64, levels: u32) -> f64 {
        let square = (TAU * self.rms_hz).powi(2);
        let rate = self.time_s.recip();
        let z = Complex64::new(0.0, -TAU * offset_hz);
        let root = |level: f64, beyond: Complex64| {
            let own = z + level * rate + beyond;
            0.5 * (square_root(own * own + 4.0 * level * square) - own)
        };
        let last = f64::from(levels);
        let beyond = root(last + 1.0, Complex64::ZERO) - root(last, Complex64::ZERO);
        let inner = (1..levels).rev().map(f64::from);
        let fraction = inner.fold(root(last, beyond), |below, level| {
            level * square / (z + level * rate + below)
        });
        2.0 * (z + fraction).inv().re
    }

    /// Half of the width at half the height, about: of the narrower of the two limits.
    pub fn half_width_hz(self) -> f64 {
        self.rms_hz.min(TAU * self.rms_hz.powi(2) * self.time_s)
    }

    /// How many independent values of the frequency a record of `record_s` seconds has: where it wanders slowly they
    /// give the line its shape. Wandering fast, the phase does, as that of noise.
    pub fn shaped_by(self, record_s: f64) -> f64 {
        let is_slow = TAU * self.rms_hz * self.time_s > 1.0;
        if is_slow {
            (0.5 * record_s / self.time_s).max(1.0)
        } else {
            f64::INFINITY
        }
    }

    /// Distance from the mean frequency beyond which no more than some percent of the power lie.
    pub fn reach_hz(self) -> f64 {
        /// Half widths at which a Gaussian has 0.3 % of its power, a Lorentzian a fifth.
        const WIDTHS: f64 = 3.0;
        WIDTHS * self.half_width_hz()
    }
}

/// The root in the right half plane, without the angle, which would take ten times as long.
fn square_root(z: Complex64) -> Complex64 {
    let length = (z.re * z.re + z.im * z.im).sqrt();
    // The larger part first, so that nothing cancels.
    let larger = (0.5 * (length + z.re.abs())).sqrt();
    if larger == 0.0 {
        return Complex64::ZERO;
    }
    let smaller = 0.5 * z.im / larger;
    if z.re >= 0.0 {
        Complex64::new(larger, smaller)
    } else {
        Complex64::new(smaller.abs(), larger.copysign(z.im))
    }
}

/// The phase of a tone whose frequency wanders, sample by sample.
pub(super) struct Phase {
    noise: Gaussian,
    /// Deviation of the frequency over its root mean square.
    state: f64,
    keep: f64,
    innovation: f64,
    turns: f64,
    step: f64,
    swing: f64,
}

impl Phase {
    /// Of a tone of mean frequency `f_hz`.
    pub fn new(f_hz: f64, wander: Wander, rate_hz: f64, mut noise: Gaussian) -> Self {
        let decay = (wander.time_s * rate_hz).recip();
        Self {
            state: noise.draw(),
            noise,
            keep: (-decay).exp(),
            innovation: (-(-2.0 * decay).exp_m1()).sqrt(),
            turns: 0.0,
            step: f_hz / rate_hz,
            swing: wander.rms_hz / rate_hz,
        }
    }

    /// The phase at the next sample, turns.
    pub fn next(&mut self) -> f64 {
        let now = self.turns;
        let before = self.state;
        self.state = self.keep * before + self.innovation * self.noise.draw();
        let mean = 0.5 * (before + self.state);
        let frequency = self.step + self.swing * mean.clamp(-FURTHEST, FURTHEST);
        self.turns = (self.turns + frequency).fract();
        now
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn roots_are_those_of_the_angle() {
        for (re, im) in [
            (3.0, 4.0),
            (3.0, -4.0),
            (-3.0, 4.0),
            (-3.0, -4.0),
            (0.0, 2.0),
            (-1.0, 0.0),
            (0.0, 0.0),
        ] {
            let z = Complex64::new(re, im);
            let error = (square_root(z) - z.sqrt()).norm();
            assert!(
                error < 1e-15 * (1.0 + z.norm()),
                "{z}: {} {}",
                square_root(z),
                z.sqrt()
            );
        }
    }

    #[test]
    fn far_from_the_line_few_levels_do() {
        for tenth in -15..=30 {
            // From a tenth of a turn in a correlation time to a hundred times as many.
            let turns = 10_f64.powf(0.1 * f64::from(tenth));
            let line = wander(turns / TAU, 1.0);
            for widths in [8.001, 12.0, 29.999, 30.001, 60.0, 1e3] {
                let offset_hz = widths * line.half_width_hz();
                let (few, all) = (line.shape(offset_hz), line.shape_by(offset_hz, LEVELS));
                assert!(
                    (few / all - 1.0).abs() < 1e-5,
                    "{turns} {widths}: {few} {all}"
                );
            }
        }
    }

    #[test]
    fn near_the_line_fewer_levels_do_the_less_it_turns() {
        for tenth in -20..=20 {
            let turns = 10_f64.powf(0.1 * f64::from(tenth));
            let line = wander(turns / TAU, 1.0);
            for widths in [0.0, 0.3, 1.0, 2.0, 3.0, 5.0, 8.0] {
                let offset_hz = widths * line.half_width_hz();
                let (few, all) = (line.shape(offset_hz), line.shape_by(offset_hz, 400));
                let most = if line.levels() < LEVELS { 1e-7 } else { 1e-4 };
                assert!(
                    (few / all - 1.0).abs() < most,
                    "{turns} {widths}: {few} {all}"
                );
            }
        }
    }

    fn wander(rms_hz: f64, time_s: f64) -> Wander {
        Wander { rms_hz, time_s }
    }

    #[test]
    fn slow_wandering_is_gaussian_and_fast_wandering_lorentzian() {
        // b = 6283: the first correction is 1 / b.
        let slow = wander(1.0, 1e3);
        for offset in [0.0, 0.5, 1.0, 2.0, 3.0] {
            let gauss = (-0.5_f64 * offset * offset).exp() / TAU.sqrt();
            let ratio = slow.shape(offset) / gauss;
            assert!((ratio - 1.0).abs() < 2e-3, "{offset} Hz: {ratio}");
        }
        // b = 0.0063: the first correction is b^2.
        let fast = wander(1.0, 1e-3);
        let half = fast.half_width_hz();
        for offset in [0.0, 0.5, 1.0, 3.0] {
            let lorentz = 1.0 / (PI * half * (1.0 + offset * offset));
            let ratio = fast.shape(offset * half) / lorentz;
            assert!((ratio - 1.0).abs() < 2e-4, "{offset} widths: {ratio}");
        }
    }

    #[test]
    fn is_the_transform_of_the_covariance() {
        for time_s in [0.03, 0.3, 3.0, 30.0] {
            let one = wander(1.0, time_s);
            let b = TAU * time_s;
            let covariance = |t: f64| {
                let s = t / time_s;
                (-b * b * (s + (-s).exp_m1())).exp()
            };
            for offset in [0.0, 0.5, 1.0, 2.0, 3.0] {
                // The trapezium rule, to where nothing is left: errors of a step squared over 24 of the curvature.
                let step = 0.002_f64.min(0.01 * time_s);
                let end = (20.0 * time_s + 20.0 / one.half_width_hz()).min(40.0);
                let sum: f64 = (1..(end / step) as u32)
                    .map(|n| f64::from(n) * step)
                    .map(|t| covariance(t) * (TAU * offset * t).cos())
                    .sum();
                let exact = 2.0 * step * (0.5 + sum);
                let found = one.shape(offset);
                assert!(
                    (found - exact).abs() < 2e-4 * exact + 1e-6,
                    "{time_s} s, {offset} Hz: {found} for {exact}"
                );
            }
        }
    }
}
