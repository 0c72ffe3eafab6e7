//! Powers of short windows of a record.
//!
//! A window of `L` samples, less the line through them, under Hann's taper: its ordinates are those of noise
//! about the frequencies `k / L`.

use std::ops::Range;
use std::sync::Arc;

use realfft::RealToComplex;
use realfft::num_complex::Complex64;

use crate::fft;
use crate::numeric::taper::hann;

/// Windows that every sample of a run is in.
pub const OVERLAP: usize = 2;

/// A window's length, its taper and its transform.
pub struct Windows {
    len: usize,
    pub(super) taper: Vec<f64>,
    fft: Arc<dyn RealToComplex<f64>>,
}

/// What one thread needs to transform.
pub struct Scratch {
    values: Vec<f64>,
    ordinates: Vec<Complex64>,
    spare: Vec<Complex64>,
}

impl Windows {
    /// Of `len` samples, an even number.
    pub fn new(len: usize) -> Self {
        Self {
            len,
            taper: (0..len).map(|n| hann(n as f64 + 0.5, len as f64)).collect(),
            fft: fft::real_forward(len),
        }
    }

    /// Samples of a window.
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Powers of a window: one a frequency between zero and half the rate, neither included.
    pub const fn bins(&self) -> usize {
        self.len / 2 - 1
    }

    /// Memory for a thread.
    pub fn scratch(&self) -> Scratch {
        Scratch {
            values: self.fft.make_input_vec(),
            ordinates: self.fft.make_output_vec(),
            spare: self.fft.make_scratch_vec(),
        }
    }

    /// Powers of the window that begins at `start`, in units of `unit` squared.
    pub fn powers<'a>(
        &self,
        values: &[f64],
        unit: f64,
        start: usize,
        scratch: &'a mut Scratch,
    ) -> impl Iterator<Item = f64> + 'a {
        let part = &values[start..start + self.len];
        let length = self.len as f64;
        let middle = 0.5 * (length - 1.0);
        let (mut sum, mut moment) = (0.0, 0.0);
        for (n, value) in part.iter().enumerate() {
            sum += value;
            moment += value * (n as f64 - middle);
        }
        let mean = sum / length;
        let slope = moment * 12.0 / (length * (length * length - 1.0));
        let both = part.iter().zip(&self.taper).enumerate();
        for ((n, (value, taper)), tapered) in both.zip(&mut scratch.values) {
            *tapered = (value - mean - slope * (n as f64 - middle)) / unit * taper;
        }
        // The lengths are those that it was planned for.
        let done = self.fft.process_with_scratch(
            &mut scratch.values,
            &mut scratch.ordinates,
            &mut scratch.spare,
        );
        debug_assert!(done.is_ok());
        let bins = scratch.ordinates[1..=self.bins()].iter();
        bins.map(|ordinate| ordinate.norm_sqr())
    }

    /// Where windows begin in a run of samples: half a window apart ([`OVERLAP`]), and one that ends with it.
    pub fn starts(&self, run: &Range<usize>) -> impl Iterator<Item = usize> + use<> {
        let last = run.end.checked_sub(self.len);
        let last = last.filter(|last| *last >= run.start);
        let (from, step) = (run.start, self.len / OVERLAP);
        let regular = last
            .into_iter()
            .flat_map(move |last| (from..=last).step_by(step));
        let at_end = last.filter(move |last| (last - from) % step != 0);
        regular.chain(at_end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_fill_a_run_to_its_end() {
        let windows = Windows::new(16);
        let starts: Vec<usize> = windows.starts(&(100..130)).collect();
        assert_eq!(starts, [100, 108, 114]);
        assert_eq!(windows.starts(&(5..20)).count(), 0);
        assert_eq!(windows.starts(&(5..21)).collect::<Vec<_>>(), [5]);
    }
}
