//! Waves sample by sample, for the price of a product each.

use realfft::num_complex::Complex64;

/// Values between two that are exact: rounding of 255 products is below 1e-13 of a value, and a sine costs next to nothing.
const ANCHOR: u64 = 256;

/// A complex exponential from its value number `from` on: each is the one before times `step`, and every 256th is
/// `exact`. The same number has the same value wherever one begins.
pub fn turning(
    from: u64,
    step: Complex64,
    exact: impl Fn(u64) -> Complex64,
) -> impl Iterator<Item = Complex64> {
    let aside = from % ANCHOR;
    let mut value = Complex64::ZERO;
    let values = (from - aside..).map(move |number| {
        value = if number % ANCHOR == 0 {
            exact(number)
        } else {
            value * step
        };
        value
    });
    values.skip(aside as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_exponential_wherever_one_begins() {
        let rate = Complex64::new(-1e-3, 0.7);
        let exact = |number: u64| (rate * number as f64).exp();
        let from = |from: u64| turning(from, rate.exp(), exact).take(1000);
        for (number, value) in from(0).enumerate() {
            let exact = exact(number as u64);
            // The last angle is 700 rad, known to 1.5e-13; 255 products add half as much.
            assert!((value - exact).norm() < 3e-13 * exact.norm(), "{number}");
        }
        assert!(from(0).skip(777).eq(from(777).take(223)));
    }
}
