//! What a record holds once: no two records have it alike, so its law is zero.
//!
//! What it adds to an Allan variance depends on where in the record it is. Whoever knows the record takes out its course,
//! or, where it is random, adds what it makes of the record in the mean.

use super::random::Generator;
use super::{Seed, Term};

/// Something that happened in one record.
pub trait Once: Send + Sync {
    /// Whether it is a slow course without a spectrum, that any chain lets through as it is.
    fn drifts(&self) -> bool {
        false
    }

    /// What it adds to the Allan variance over `m` samples of a record of `samples`, in the mean, where it is random.
    fn in_record(&self, _m: u64, _samples: u64, _rate_hz: f64) -> f64 {
        0.0
    }

    /// The two-sided density that it adds at `f_hz` to a record of `record_s` seconds, in the mean, where it is random.
    fn density_in_record(&self, _f_hz: f64, _record_s: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    /// Makes it again; the same `seed` gives the same data.
    fn course(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator>;
}

impl<T: Once> Term for T {
    fn allan_variance(&self, _m: u64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn allan_asymptote(&self, _tau_s: f64) -> f64 {
        0.0
    }

    fn spectrum(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn spectrum_ahead(&self, _f_hz: f64, _rate_hz: f64) -> f64 {
        0.0
    }

    fn is_drift(&self) -> bool {
        self.drifts()
    }

    fn is_once(&self) -> bool {
        true
    }

    fn passing(&self, m: u64, samples: u64, rate_hz: f64) -> f64 {
        self.in_record(m, samples, rate_hz)
    }

    fn passing_density(&self, f_hz: f64, record_s: f64, rate_hz: f64) -> f64 {
        self.density_in_record(f_hz, record_s, rate_hz)
    }

    fn generator(&self, rate_hz: f64, seed: Seed) -> Box<dyn Generator> {
        self.course(rate_hz, seed)
    }
}
