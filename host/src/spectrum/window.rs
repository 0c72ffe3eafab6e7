//! The taper of every segment: smooth, and complementary in power at half overlap.
//!
//! `w[n] = sin(pi/2 sin^2(pi n / N))`, `n = 0..N`, is symmetric about `N/2`. Because
//! `w[n]^2 + w[n + N/2]^2 = 1`, half-overlapped segments give every sample of a run but its two
//! ends the same total weight: an average over many segments and frequencies loses no
//! information, where the Hann taper loses 5 % (Percival and Walden 1993, section 6.17). At the
//! edges value and slope vanish, so that the side lobes fall by 18 dB an octave as Hann's do
//! (Harris 1978, section 4): enough for the 6 dB an octave of a random walk and for the
//! 12 dB of what a drift leaves. The same taper serves lapped transforms in audio coding
//! (Princen and Bradley 1986 give the condition; this form is that of Vorbis I, section 4.3.1).
//!
//! Equivalent noise bandwidth 1.379 bins; main lobe to its first minimum 1.5 bins; side lobes
//! -20.6 dB (2 bins), -57 dB (6), -81 dB (16), -110 dB (51).

use std::f64::consts::PI;

/// The taper for segments of one length, with its spectrum and overlap correlations.
#[derive(Debug, Clone)]
pub struct Window {
    values: Vec<f64>,
    line: Vec<f64>,
    sum: f64,
    sum_of_squares: f64,
    sum_of_line: f64,
}

impl Window {
    /// Taper of `len` samples; `len` is even and at least 4 (odd lengths lose their last sample).
    pub fn new(len: usize) -> Self {
        let len = (len & !1).max(4);
        let values: Vec<f64> = (0..len)
            .map(|n| {
                let sine = (PI * n as f64 / len as f64).sin();
                (0.5 * PI * sine * sine).sin()
            })
            .collect();
        let line: Vec<f64> = values
            .iter()
            .enumerate()
            .map(|(n, w)| w * (n as f64 - (len / 2) as f64))
            .collect();
        Self {
            sum_of_line: line
                .iter()
                .enumerate()
                .map(|(n, w)| w * (n as f64 - (len / 2) as f64))
                .sum(),
            line,
            sum: values.iter().sum(),
            sum_of_squares: values.iter().map(|w| w * w).sum(),
            values,
        }
    }

    /// The weights.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The weights times a line through zero at the centre: `w[n] (n - N/2)`.
    pub fn line(&self) -> &[f64] {
        &self.line
    }

    /// Sum of the weights times that line squared, `sum w[n] (n - N/2)^2`.
    pub fn sum_of_line(&self) -> f64 {
        self.sum_of_line
    }

    /// Sum of the weights.
    pub fn sum(&self) -> f64 {
        self.sum
    }

    /// Sum of the squared weights: half the length.
    pub fn sum_of_squares(&self) -> f64 {
        self.sum_of_squares
    }

    /// Equivalent noise bandwidth in bins of `1 / len` (Harris 1978, eq. 11).
    pub fn noise_bandwidth_bins(&self) -> f64 {
        self.values.len() as f64 * self.sum_of_squares / (self.sum * self.sum)
    }

    /// Fourier transform about the centre, `sum w[n] cos(2 pi u (n - N/2) / N)`, at `offset_bins`
    /// `u`: real and even, as the taper is symmetric.
    pub fn transform(&self, offset_bins: f64) -> f64 {
        let len = self.values.len();
        let step = 2.0 * PI * offset_bins / len as f64;
        let half = len / 2;
        let pairs: f64 = (1..half)
            .map(|distance| self.values[half + distance] * (step * distance as f64).cos())
            .sum();
        self.values[half] + 2.0 * pairs
    }

    /// Squared correlation of the spectra of two segments `lag` samples apart at frequencies
    /// `offset_bins` apart, for noise that is white over the main lobe:
    /// `|sum w[n] w[n + lag] exp(2 pi i u n / N)|^2 / (sum w^2)^2`
    /// (Welch 1967; Percival and Walden 1993, eq. 292b).
    pub fn correlation(&self, lag: usize, offset_bins: f64) -> f64 {
        let len = self.values.len();
        let step = 2.0 * PI * offset_bins / len as f64;
        let (mut re, mut im) = (0.0, 0.0);
        for n in 0..len.saturating_sub(lag) {
            let product = self.values[n] * self.values[n + lag];
            let (sin, cos) = (step * n as f64).sin_cos();
            re += product * cos;
            im += product * sin;
        }
        (re * re + im * im) / (self.sum_of_squares * self.sum_of_squares)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_overlapped_squares_add_to_one() {
        let window = Window::new(256);
        let w = window.values();
        for n in 0..128 {
            let total = w[n] * w[n] + w[n + 128] * w[n + 128];
            assert!((total - 1.0).abs() < 1e-14, "n = {n}: {total}");
        }
        assert!((window.sum_of_squares() - 128.0).abs() < 1e-11);
    }

    #[test]
    fn spectrum_is_as_stated_in_the_header() {
        let window = Window::new(1024);
        assert!((window.noise_bandwidth_bins() - 1.378_784).abs() < 1e-6);
        for (bins, limit_db) in [(1.9, -20.5), (6.0, -55.0), (16.0, -79.0), (51.0, -109.0)] {
            // The highest of the lobes from here on.
            let worst = (0..400)
                .map(|i| window.transform(bins + 0.05 * f64::from(i)).abs() / window.sum())
                .fold(0.0, f64::max);
            let worst_db = 20.0 * worst.log10();
            assert!(worst_db < limit_db, "from {bins} bins: {worst_db:.1} dB");
        }
    }

    #[test]
    fn correlation_is_one_at_no_distance() {
        let window = Window::new(128);
        assert!((window.correlation(0, 0.0) - 1.0).abs() < 1e-12);
        assert!((window.correlation(64, 0.0) - 0.0557).abs() < 1e-3);
        assert_eq!(window.correlation(128, 0.0), 0.0);
    }
}
