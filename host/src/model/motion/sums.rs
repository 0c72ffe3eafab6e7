//! What the noise of a stretch adds to the Allan variance of a record.

use rustfft::num_complex::Complex64;

use super::envelope::Envelope;
use crate::fft;
use crate::model::unnamed::Band;

/// Squares of its sums.
///
/// The noise `z = e (x - u) / q` is that of some bands with the covariance `C(k)`, under its envelope `e` of the mean square
/// `q^2`, without the mean `u = sum e x / sum e`. With `g = C * e / sum e` and `v = sum e g / sum e` its covariance, summed
/// over all places, is
///
/// ```text
/// R(k) = ((C(k) + v) sum_i e_i e_(i+k) - sum_i e_i e_(i+k) (g_i + g_(i+k))) / q^2
/// ```
///
/// and the squares of sums over `k` samples, summed over all places, are `S(k) = sum_j max(k - |j|, 0) R(j)`.
#[derive(Debug)]
pub(super) struct Sums(Vec<f64>);

impl Sums {
    /// Of some bands for as long as their common envelope.
    pub fn new(bands: &[Band], envelope: &Envelope, rate_hz: f64) -> Self {
        let covariances = covariances(bands, envelope.length() as usize, rate_hz);
        let mut squares = Vec::with_capacity(covariances.len() + 1);
        let (mut square, mut growth) = (0.0, 0.0);
        squares.push(square);
        for (lag, covariance) in of_places(&covariances, envelope).into_iter().enumerate() {
            growth += if lag == 0 {
                covariance
            } else {
                2.0 * covariance
            };
            square += growth;
            squares.push(square);
        }
        Self(squares)
    }

    /// Sum of the squares of the sums over `count` samples at all places: beyond all of them nothing is added, as they have
    /// no mean.
    fn over(&self, count: u64) -> f64 {
        let last = self.0.len() - 1;
        self.0[usize::try_from(count).map_or(last, |count| count.min(last))]
    }

    /// What it adds to the Allan variance over `m` samples of a record of `samples`, in the mean, where it is further from
    /// both ends than that: averaged over all places in the record, `(4 S(m) - S(2 m)) / (2 m^2)`.
    pub fn allan_variance(&self, m: u64, samples: u64) -> f64 {
        let places = samples.saturating_sub(2 * m) + 1;
        let square = (4.0 * self.over(m) - self.over(2 * m)) / places as f64;
        (square / (2.0 * (m as f64).powi(2))).max(0.0)
    }
}

/// Covariance of the bands together at each lag of so many samples.
fn covariances(bands: &[Band], length: usize, rate_hz: f64) -> Vec<f64> {
    /// Of a covariance that is a part of the first one this small, nothing is left to add: a choice.
    const NOTHING: f64 = 1e-12;
    let mut sum = vec![0.0; length];
    for band in bands {
        let first = band.covariance(0.0);
        let own = band.covariances(rate_hz.recip());
        for (lag, (sum, covariance)) in sum.iter_mut().zip(own).enumerate() {
            if band.bound(lag as f64 / rate_hz) < NOTHING * first {
                break;
            }
            *sum += covariance;
        }
    }
    sum
}

/// The covariances `R`, summed over all places, of noise with these `covariances` under an envelope.
fn of_places(covariances: &[f64], envelope: &Envelope) -> Vec<f64> {
    let length = covariances.len();
    // Twice as many, so that nothing comes round.
    let len = (2 * length).next_power_of_two();
    let (forward, back) = (fft::forward(len), fft::inverse(len));
    let transformed = |values: &mut dyn Iterator<Item = f64>| {
        let mut all: Vec<Complex64> = values.map(Complex64::from).collect();
        all.resize(len, Complex64::ZERO);
        forward.process(&mut all);
        all
    };
    let e = transformed(&mut envelope.values());
    let both_ways = (0..len).map(|lag| {
        let lag = lag.min(len - lag);
        covariances.get(lag).copied().unwrap_or_default()
    });
    let spectrum = transformed(&mut { both_ways });
    // What each sample has in common with the mean.
    let mut shared: Vec<Complex64> = e.iter().zip(&spectrum).map(|(e, c)| e * c.re).collect();
    back.process(&mut shared);
    let sum = envelope.mean() * length as f64;
    let of_mean: Vec<f64> = shared[..length]
        .iter()
        .zip(envelope.values())
        .map(|(shared, e)| e * shared.re / (sum * len as f64))
        .collect();
    let variance = of_mean.iter().sum::<f64>() / sum;
    let own = transformed(&mut of_mean.iter().copied());
    // Two real and even ones at once.
    let mut pairs: Vec<Complex64> = e
        .iter()
        .zip(&own)
        .map(|(e, own)| Complex64::new(e.norm_sqr(), 2.0 * (e.conj() * own).re))
        .collect();
    back.process(&mut pairs);
    let scale = (len as f64 * envelope.mean_square()).recip();
    let pairs = pairs.iter().zip(covariances);
    pairs
        .map(|(pair, covariance)| scale * ((covariance + variance) * pair.re - pair.im))
        .collect()
}
