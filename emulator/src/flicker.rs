//! Flicker (1/f) noise as a bank of relaxations, in integers.
//!
//! Fourteen one-pole low-passes two octaves apart, all of the same variance, each driven by its
//! own noise and stepped as often as its corner needs: number i every 4^i conversions, so that
//! all share the coefficient 3/4 and a conversion costs 4/3 steps in the mean. Two octaves apart
//! the sum follows 1/f within 5 % from 2e-8 to 3e-3 of the data rate (tested; 8 % low at 0.012,
//! half at 0.09, where the white terms are stronger by 40 dB and more); what it averages to over
//! an octave pair is exact, because the integral of a relaxation's spectrum is its variance. With
//! B^2 / (2 pi f) two-sided, that variance is B^2 ln 4 / pi.
//!
//! The corners run from 0.046 of the data rate (fDATA/22) down to 6.8e-10 of it, far below 1/(10
//! h) at every rate. The bank starts in its stationary state.

use crate::random::Random;

/// Relaxations in the bank.
const POLES: usize = 14;

/// Variance of each relaxation for B = 1: ln 4 / pi.
pub(crate) const POLE_VARIANCE: f64 = 0.441_271_200_305_303_2;

/// Share of a relaxation's variance that is new in a step: 1 - (3/4)^2.
pub(crate) const NEW_VARIANCE: f64 = 7.0 / 16.0;

/// The bank; levels in units of the caller's.
#[derive(Debug, Clone)]
pub(crate) struct Flicker {
    poles: [i64; POLES],
    sum: i64,
    conversion: u64,
}

impl Flicker {
    /// A bank in its stationary state; `sigma` is a relaxation's standard deviation over that of
    /// [`Random::gauss`].
    pub(crate) fn new(sigma: i64, random: &mut Random) -> Self {
        let poles = [(); POLES].map(|()| sigma * i64::from(random.gauss()));
        Self {
            sum: poles.iter().sum(),
            poles,
            conversion: 0,
        }
    }

    /// The next level, once a conversion; `step` is the standard deviation of what is new in it,
    /// over that of [`Random::gauss`].
    pub(crate) fn next(&mut self, step: i64, random: &mut Random) -> i64 {
        self.conversion += 1;
        let due = self.conversion.trailing_zeros() as usize / 2;
        for pole in self.poles.iter_mut().take(due + 1) {
            let change = step * i64::from(random.gauss()) - (*pole >> 2);
            *pole += change;
            self.sum += change;
        }
        self.sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    /// Two-sided spectrum of the bank for B = 1, data rate 1: sampled relaxations, held.
    fn spectrum(f: f64) -> f64 {
        (0..POLES as i32)
            .map(|i| {
                let period = f64::from(1_u32 << (2 * i));
                let (x, rho) = (f * period, 0.75);
                let held = libm::sin(PI * x) / (PI * x);
                let white = period * POLE_VARIANCE * NEW_VARIANCE;
                held * held * white / (1.0 + rho * rho - 2.0 * rho * libm::cos(2.0 * PI * x))
            })
            .sum()
    }

    #[test]
    fn the_bank_follows_one_over_f_within_five_percent() {
        let mut f = 2e-8;
        while f < 3e-3 {
            let ratio = spectrum(f) * 2.0 * PI * f;
            assert!(
                (ratio - 1.0).abs() < 0.05,
                "{ratio} at {f} of the data rate"
            );
            f *= 1.07;
        }
    }

    #[test]
    fn a_relaxation_keeps_its_variance() {
        let seed = 3;
        let mut random = Random::new(seed, 0);
        let sigma = 1 << 20;
        let step = (libm::sqrt(NEW_VARIANCE) * f64::from(sigma)) as i64;
        let mut flicker = Flicker::new(i64::from(sigma), &mut random);
        let n = 400_000;
        let mut square = 0.0;
        for _ in 0..n {
            flicker.next(step, &mut random);
            let x = flicker.poles[0] as f64 / f64::from(sigma);
            square += x * x / crate::random::GAUSS_VARIANCE;
        }
        let variance = square / f64::from(n);
        // Correlation time 7 steps: n/3.6 independent squares; five sigma of sqrt(2 * 3.6 / n).
        assert!((variance - 1.0).abs() < 0.021, "seed {seed}: {variance}");
    }
}
