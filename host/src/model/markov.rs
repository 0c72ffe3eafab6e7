//! Exponentially correlated (first-order Markov) noise: the seventh noise that the source names.

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use super::effect::{Band, Effect, Parameter, Part, Quantity};
use super::kind::Kind;
use super::marks::Mark;
use super::random::{Gaussian, Generator};
use super::{Seed, Term};

/// A process with the covariance `D exp(-mu |t|)`. Pavlov and Petrov eq. 3, where
/// `D = deviation^2` and `mu = 1 / time_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Markov {
    /// Standard deviation of the signal, unit of the signal.
    pub deviation: f64,
    /// Correlation time, seconds.
    pub time_s: f64,
}

/// Correlation times at which the Allan variance of Markov noise is largest.
const ALLAN_PEAK: f64 = 1.89;

impl Markov {
    /// Where it shows: the corner of its spectrum, and the averaging time at which it adds most.
    pub(super) fn marks(&self) -> Vec<Mark> {
        vec![
            Mark::Corner(1.0 / (2.0 * PI * self.time_s)),
            Mark::AveragingTime(ALLAN_PEAK * self.time_s),
        ]
    }

    /// Data period over correlation time.
    fn decay(&self, rate_hz: f64) -> f64 {
        1.0 / (self.time_s * rate_hz)
    }
}

/// Below this length of the averaging time in correlation times, the closed forms lose digits and
/// their series take over.
const SHORT: f64 = 1e-3;

/// Series of the Allan variance for unit deviation at `x` correlation times, `discrete` being
/// `1 / m^2` of sampled data and 0 of continuous time. Relative error below 1e-9 for `x` < [`SHORT`].
fn short(x: Complex64, discrete: f64) -> Complex64 {
    x * (2.0 / 3.0 * (1.0 + 0.5 * discrete) - x * (0.5 - x * cubic(discrete)))
}

/// Factor of the third power in it, from the sums over the cubes of lags: 1/6 for one sample, 7/30 without an end.
fn cubic(discrete: f64) -> f64 {
    7.0 / 30.0 - discrete / 18.0 - discrete * discrete / 90.0
}

/// Allan variance at `m` samples of a process whose covariance is `exp(-decay |k|)` at a lag of `k` samples, from
/// the sums over `a^|k|` with `a = exp(-decay)`:
/// `1 / m^2 * [m (1 + a) / (1 - a) - a (1 - a^m) (3 - a^m) / (1 - a)^2]`. Of a complex decay the real part is that of a
/// process which rings.
pub(super) fn unit_allan_variance(decay: Complex64, m: u64) -> Complex64 {
    let m = m as f64;
    let x = m * decay;
    if x.norm() < SHORT {
        return short(x, 1.0 / (m * m));
    }
    let (fall, whole) = (one_less_exp(decay), one_less_exp(x));
    let a = 1.0 - fall;
    let sum = m * (1.0 + a) / fall - a * whole * (2.0 + whole) / (fall * fall);
    sum / (m * m)
}

/// The same of `decay` and its derivative with respect to it.
pub(super) fn unit_allan_variance_and_slope(decay: Complex64, m: u64) -> [Complex64; 2] {
    /// As [`SHORT`], for a difference in which the first terms cancel.
    const SHORT_SLOPE: f64 = 2e-3;
    let count = m as f64;
    let x = count * decay;
    if x.norm() < SHORT_SLOPE {
        let discrete = 1.0 / (count * count);
        let slope = 2.0 / 3.0 * (1.0 + 0.5 * discrete) - x * (1.0 - 3.0 * x * cubic(discrete));
        return [short(x, discrete), count * slope];
    }
    let (fall, whole) = (one_less_exp(decay), one_less_exp(x));
    let a = 1.0 - fall;
    let product = whole * (2.0 + whole);
    let grown = count * (1.0 - whole) * (2.0 + 2.0 * whole);
    let falls = a / (fall * fall);
    let slope = -2.0 * count * falls - falls * (grown - product - 2.0 * a * product / fall);
    [unit_allan_variance(decay, m), slope / (count * count)]
}

/// `1 - exp(-x)`, with all its digits where that is small.
fn one_less_exp(x: Complex64) -> Complex64 {
    let half = (0.5 * x.im).sin();
    let cosine_less_one = -2.0 * half * half;
    let fall = (-x.re).exp();
    Complex64::new(
        -(-x.re).exp_m1() - fall * cosine_less_one,
        fall * x.im.sin(),
    )
}

impl Markov {
    /// With these parameters, in the catalogue's order.
    pub fn of(values: &[f64]) -> Self {
        Self {
            deviation: values[0],
            time_s: values[1],
        }
    }
}

impl Term for Markov {
    fn allan_variance(&self, m: u64, rate_hz: f64) -> f64 {
        self.deviation.powi(2) * unit_allan_variance(self.decay(rate_hz).into(), m).re
    }

    fn allan_asymptote(&self, tau_s: f64) -> f64 {
        let x = tau_s / self.time_s;
        let shape = if x < SHORT {
            short(x.into(), 0.0).re
        } else {
            (2.0 * x - 3.0 + 4.0 * (-x).exp() - (-2.0 * x).exp()) / (x * x)
        };
        self.deviation.powi(2) * shape
    }

    /// The Lorentzian with all that folds back onto it: an autoregression of first order.
    fn spectrum(&self, f_hz: f64, rate_hz: f64) -> f64 {
        let decay = self.decay(rate_hz);
        let (fall, a) = (-(-decay).exp_m1(), (-decay).exp());
        let sine = (PI * f_hz / rate_hz).sin();
        let innovation = -(-2.0 * decay).exp_m1();
        self.deviation.powi(2) * innovation / rate_hz / (fall * fall + 4.0 * a * sine * sine)
    }

    fn spectrum_ahead(&self, f_hz: f64, _rate_hz: f64) -> f64 {
        let x = 2.0 * PI * f_hz * self.time_s;
        2.0 * self.deviation.powi(2) * self.time_s / (1.0 + x * x)
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        let decay = self.decay(rate_hz);
        let mut noise = Gaussian::new(seed, self.deviation);
        Box::new(Autoregression {
            // Stationary from the first sample on.
            value: noise.draw(),
            noise,
            fall: -(-decay).exp_m1(),
            innovation: (-(-2.0 * decay).exp_m1()).sqrt(),
        })
    }
}

struct Autoregression {
    noise: Gaussian,
    fall: f64,
    innovation: f64,
    value: f64,
}

impl Generator for Autoregression {
    fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            *sample += self.value;
            // Written with 1 - a, which keeps its digits for long correlation times.
            self.value += self.innovation * self.noise.draw() - self.fall * self.value;
        }
    }
}

/// Markov noise in the catalogue.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "markov"
    }

    fn meaning(&self) -> &'static str {
        "exponentially correlated noise: a disturbance behind a slow first-order lag, such as a \
         regulator, a temperature control or air moving about the sensor"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("amplitude", Quantity::Signal, "standard deviation"),
            Parameter::new("time_s", Quantity::Second, "correlation time"),
        ]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "look for something with a time constant of {:.3} s: shield the board from moving \
             air, watch the supply's regulator and the reference",
            values[1]
        )
    }

    fn size(&self) -> Option<usize> {
        Some(0)
    }

    fn surprise_nats(&self, values: &[f64], rate_hz: f64) -> f64 {
        /// Samples to the correlation time below which it is more likely a filter ahead of the converter, with white
        /// noise in it: whoever builds one for this rate puts its corner there, above a twelfth of it.
        const OF_A_FILTER: f64 = 2.0;
        /// What that costs: one in twenty, a choice. It decides where a pole on all noise and noise with a
        /// correlation time differ by less than the record can distinguish.
        const NATS: f64 = 3.0;
        if Markov::of(values).time_s * rate_hz < OF_A_FILTER {
            NATS
        } else {
            0.0
        }
    }

    fn starts(&self, band: &Band) -> Vec<Vec<f64>> {
        band.steps(1.0)
            .map(|corner_hz| vec![1.0, 1.0 / (2.0 * PI * corner_hz)])
            .collect()
    }

    fn marks(&self, values: &[f64]) -> Vec<Mark> {
        Markov::of(values).marks()
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Term(Box::new(Markov::of(values)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::kernel::{self, Kernel};
    use super::*;

    #[test]
    fn closed_form_equals_the_integral_of_the_spectrum() {
        let rate_hz = 200.0;
        for time_s in [1e-3, 0.02, 1.0, 50.0, 1e4] {
            let markov = Markov {
                deviation: 2.0,
                time_s,
            };
            for m in [1, 2, 5, 64, 1000, 30_000] {
                let integral =
                    kernel::variance(Kernel::Allan, m, rate_hz, |f| markov.spectrum(f, rate_hz));
                let relative = markov.allan_variance(m, rate_hz) / integral - 1.0;
                // The quadrature is within 2e-6 where the spectrum is smooth over a cycle.
                assert!(relative.abs() < 4e-6, "{time_s} s, m = {m}: {relative:e}");
            }
        }
    }

    #[test]
    fn series_and_closed_form_meet() {
        let markov = |time_s| Markov {
            deviation: 1.0,
            time_s,
        };
        for m in [1, 3, 1000] {
            let at = |x: f64| markov(m as f64 / x).allan_variance(m, 1.0) / x;
            let jump = at(SHORT * (1.0 - 1e-9)) / at(SHORT * (1.0 + 1e-9)) - 1.0;
            assert!(jump.abs() < 2e-7, "m = {m}: {jump:e}");
        }
        // A long average of sampled data knows continuous time only.
        let slow = markov(3.0);
        let ratio = slow.allan_variance(100_000, 1e5) / slow.allan_asymptote(1.0);
        assert!((ratio - 1.0).abs() < 1e-8, "{ratio}");
    }

    #[test]
    fn far_from_half_the_rate_sampling_does_not_show() {
        let markov = Markov {
            deviation: 1.0,
            time_s: 10.0,
        };
        let ratio = markov.spectrum(0.1, 1000.0) / markov.spectrum_ahead(0.1, 1000.0);
        assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
    }
}
