//! Allan and modified Allan variance of any spectrum: the integral over the kernel of sampled data.
//!
//! For a sampled process with two-sided spectral density `S(f)` and averaging over `m` samples,
//! with `x = pi f tau0`,
//!
//! ```text
//! sigma^2(m) = 2 int_0^{fs/2} S(f) k(f) df
//! Allan:          k(f) = 2 sin^4(m x) / (m sin x)^2
//! modified Allan: k(f) = 2 sin^6(m x) / (m sin x)^4
//! ```
//!
//! which for the Allan variance is Pavlov and Petrov eq. 7 with the sum over samples in place of
//! the integral over time. The kernel oscillates `m / 2` times; beyond 32 of them the
//! power of the sine is replaced by its mean, which leaves a relative error below 2e-6 for
//! every spectrum that does not change within one oscillation there.

use std::f64::consts::PI;

/// Oscillations of the kernel that are resolved.
const CYCLES: f64 = 32.0;

/// Panels an oscillation.
const PANELS_PER_CYCLE: f64 = 4.0;

/// Panels over the band from zero to the rate: what a converter's filter edge needs.
const PANELS_PER_RATE: f64 = 200.0;

/// Relative width of a panel where the integrand is smooth.
const RELATIVE_PANEL: f64 = 0.2;

/// First panel, as a part of those in the resolved band: from there on they double, so that a
/// bend of the spectrum far below the first oscillation is resolved too.
const FIRST_PANEL: f64 = 1e-6;

/// Nodes and weights of Gauss-Legendre quadrature with eight points on (-1, 1), positive half.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Which variance a kernel belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kernel {
    /// Allan variance.
    Allan,
    /// Modified Allan variance.
    Modified,
}

impl Kernel {
    /// Power of the oscillating sine, and its mean over an oscillation.
    const fn sine(self) -> (i32, f64) {
        match self {
            Self::Allan => (4, 3.0 / 8.0),
            Self::Modified => (6, 5.0 / 16.0),
        }
    }

    /// The kernel for `m` samples, with `x = pi f / rate`.
    pub fn at(self, m: u64, x: f64) -> f64 {
        self.smooth(m, x) * (m as f64 * x).sin().powi(self.sine().0)
    }

    /// The kernel averaged over its oscillation.
    pub fn mean(self, m: u64, x: f64) -> f64 {
        self.smooth(m, x) * self.sine().1
    }

    /// The part that does not oscillate.
    pub fn smooth(self, m: u64, x: f64) -> f64 {
        2.0 / (m as f64 * x.sin()).powi(self.sine().0 - 2)
    }
}

/// The variance at `m` samples of a process with the two-sided spectral density `spectrum`, a
/// function of the frequency in hertz; it is asked above zero and below half the rate.
pub fn variance(kernel: Kernel, m: u64, rate_hz: f64, spectrum: impl Fn(f64) -> f64) -> f64 {
    let nyquist = 0.5 * rate_hz;
    let cycle = rate_hz / m as f64;
    let resolved = (CYCLES * cycle).min(nyquist);
    let widest = rate_hz / PANELS_PER_RATE;
    let fine = (cycle / PANELS_PER_CYCLE).min(widest);
    let near = panels(
        0.0,
        resolved,
        |f| f.max(FIRST_PANEL * fine).min(fine),
        |f| spectrum(f) * kernel.at(m, PI * f / rate_hz),
    );
    let far = panels(
        resolved,
        nyquist,
        |f| (RELATIVE_PANEL * f).min(widest),
        |f| spectrum(f) * kernel.mean(m, PI * f / rate_hz),
    );
    2.0 * (near + far)
}

/// Mean squares of what a process of the two-sided density `spectrum` moves by over 0 samples, 1, and so on, `count` numbers:
/// `D(j) = 4 int_0^{fs/2} S(f) (1 - cos(2 pi f j / fs)) df`. Walks and flicker have them too, though no variance.
pub(crate) fn moved(count: usize, rate_hz: f64, spectrum: impl Fn(f64) -> f64) -> Vec<f64> {
    let cycle = rate_hz / count.max(1) as f64;
    let fine = (cycle / PANELS_PER_CYCLE).min(rate_hz / PANELS_PER_RATE);
    let width = |f: f64| f.max(FIRST_PANEL * fine).min(fine);
    let mut moved = vec![0.0; count];
    for (f_hz, weight) in nodes(0.0, 0.5 * rate_hz, width) {
        let power = 4.0 * weight * spectrum(f_hz);
        for (sum, step) in moved
            .iter_mut()
            .zip(one_less_cosine(2.0 * PI * f_hz / rate_hz))
        {
            *sum += power * step;
        }
    }
    moved
}

/// `1 - cos(j angle)` for j = 0, 1, and so on, exact for small angles too.
pub(crate) fn one_less_cosine(angle: f64) -> impl Iterator<Item = f64> {
    let first = 2.0 * (0.5 * angle).sin().powi(2);
    let (mut value, mut step) = (0.0, first);
    std::iter::repeat_with(move || {
        let this = value;
        value += step;
        step += 2.0 * first * (1.0 - value);
        this
    })
}

/// Integral of `f` from `from` to `to`, over panels of at most the width `width(start)`.
pub(crate) fn panels(
    from: f64,
    to: f64,
    width: impl Fn(f64) -> f64,
    f: impl Fn(f64) -> f64,
) -> f64 {
    nodes(from, to, width)
        .map(|(x, weight)| weight * f(x))
        .sum()
}

/// Places, ascending, and weights of an integral from `from` to `to`, over panels of at most the width
/// `width(start)`.
pub(crate) fn nodes(
    from: f64,
    to: f64,
    width: impl Fn(f64) -> f64,
) -> impl Iterator<Item = (f64, f64)> {
    let mut start = from;
    let panels = std::iter::from_fn(move || {
        if start >= to {
            return None;
        }
        // A sliver at the end joins the panel before it.
        let step = width(start);
        let end = if start + 1.01 * step >= to {
            to
        } else {
            start + step
        };
        let (centre, half) = (0.5 * (start + end), 0.5 * (end - start));
        start = end;
        Some((centre, half))
    });
    panels.flat_map(|(centre, half)| {
        let below = GAUSS
            .into_iter()
            .rev()
            .map(|(node, weight)| (-node, weight));
        let place = move |(node, weight)| (centre + half * node, half * weight);
        below.chain(GAUSS).map(place)
    })
}

#[cfg(test)]
mod tests {
    use super::super::Coefficient;
    use super::*;

    #[test]
    fn moves_as_sampled_noise_does() {
        for rate_hz in [1.0, 2000.0] {
            let of = |coefficient: Coefficient| {
                let term = coefficient.term(3.0);
                moved(150, rate_hz, |f| term.spectrum(f, rate_hz))
            };
            let (white, walk) = (of(Coefficient::N), of(Coefficient::K));
            assert_eq!((white[0], walk[0]), (0.0, 0.0));
            for (j, (white, walk)) in (0_i32..).zip(white.iter().zip(&walk)).skip(1) {
                // Twice the variance, and that of so many steps.
                let (exact_white, exact_walk) = (18.0 * rate_hz, 9.0 * f64::from(j) / rate_hz);
                let off = (white / exact_white - 1.0)
                    .abs()
                    .max((walk / exact_walk - 1.0).abs());
                assert!(off < 2e-6, "{j} samples at {rate_hz} Hz: {off:e}");
            }
        }
    }

    #[test]
    fn one_less_a_cosine_is_exact_for_small_angles() {
        for angle in [1e-9, 1e-3, 0.7, 3.0, std::f64::consts::PI] {
            for (j, value) in (0_u32..2000).zip(one_less_cosine(angle)) {
                let exact = 2.0 * (0.5 * f64::from(j) * angle).sin().powi(2);
                // The recurrence's error grows with the square of its length, from one of the first step's.
                assert!(
                    (value - exact).abs() < 1e-9 * exact.max(1e-3),
                    "{j} times {angle}: {value}"
                );
            }
        }
    }

    #[test]
    fn equals_the_closed_forms_of_sampled_noise() {
        for rate_hz in [1.0, 2000.0] {
            for m in [1, 2, 3, 7, 63, 64, 65, 1000, 123_456] {
                let check = |kernel, coefficient: Coefficient, exact: f64| {
                    let term = coefficient.term(3.0);
                    let numeric = variance(kernel, m, rate_hz, |f| term.spectrum(f, rate_hz));
                    let relative = numeric / exact - 1.0;
                    assert!(
                        relative.abs() < 2e-6,
                        "{kernel:?} {coefficient:?} m={m}: {relative:e}"
                    );
                };
                let (m, tau_s) = (m as f64, m as f64 / rate_hz);
                for coefficient in [Coefficient::Q, Coefficient::N, Coefficient::K] {
                    let allan = coefficient.term(3.0).allan_variance(m as u64, rate_hz);
                    check(Kernel::Allan, coefficient, allan);
                }
                // P. Lesage and T. Ayi, IEEE Trans. Instrum. Meas. 33 (1984) 332.
                check(Kernel::Modified, Coefficient::Q, 27.0 / (m * tau_s * tau_s));
                check(
                    Kernel::Modified,
                    Coefficient::N,
                    9.0 * (1.0 + m.powi(-2)) / (2.0 * tau_s),
                );
            }
        }
    }
}
