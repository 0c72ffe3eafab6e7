//! What passes in a record and has no law: stretches that are louder, and those in which something moves the sensor.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::result::finding::Finding;
use crate::model::Term;
use crate::model::burst;
use crate::model::effect::Part;
use crate::model::kernel::{self, Kernel};

/// All of it.
pub(crate) struct Passing {
    bursts: Vec<Burst>,
    terms: Vec<Box<dyn Term>>,
    samples: u64,
    rate_hz: f64,
}

/// A stretch of another variance.
struct Burst {
    /// Length of the stretch, seconds.
    duration_s: f64,
    /// What it adds to the power of faster noise in the mean over the record, as a share.
    share: f64,
}

impl Burst {
    /// What it adds to a density that is `density` elsewhere, as a mean over the record.
    fn adds(&self, f_hz: f64, density: f64) -> f64 {
        if f_hz * self.duration_s < 1.0 {
            return 0.0;
        }
        self.share * density
    }
}

impl Passing {
    /// Of what was found in an axis.
    pub fn new(axis: &AxisState, findings: &[Finding]) -> Self {
        let samples = axis.residual.len();
        let record_s = samples as f64 / axis.rate_hz;
        let is_burst = |one: &&Finding| one.effect == burst::KIND;
        let burst = |finding: &Finding| {
            let burst = burst::Burst::of(&finding.estimate.plain());
            Burst {
                duration_s: burst.to_s - burst.from_s,
                share: burst.adds(record_s),
            }
        };
        let term = |finding: &Finding| match finding.effect.part(&finding.estimate.plain()) {
            Part::Term(term) => Some(term),
            Part::Distortion(_) | Part::Clock(_) | Part::Follows(_) => None,
        };
        Self {
            bursts: findings.iter().filter(is_burst).map(burst).collect(),
            terms: findings.iter().filter_map(term).collect(),
            samples: samples as u64,
            rate_hz: axis.rate_hz,
        }
    }

    /// What it adds to a density at `f_hz` that is `density` without it.
    pub fn adds(&self, f_hz: f64, density: f64) -> f64 {
        let record_s = self.samples as f64 / self.rate_hz;
        let bursts = self.bursts.iter().map(|one| one.adds(f_hz, density));
        let terms = self.terms.iter();
        let terms = terms.map(|one| one.passing_density(f_hz, record_s, self.rate_hz));
        bursts.sum::<f64>() + terms.sum::<f64>()
    }

    /// What it adds to the Allan variance over `m` samples of noise of this `density`.
    pub fn allan_variance(&self, m: u64, density: impl Fn(f64) -> f64) -> f64 {
        let louder = |f_hz: f64| -> f64 {
            let density = density(f_hz);
            self.bursts.iter().map(|one| one.adds(f_hz, density)).sum()
        };
        let bursts = if self.bursts.is_empty() {
            0.0
        } else {
            kernel::variance(Kernel::Allan, m, self.rate_hz, louder)
        };
        let terms = self.terms.iter();
        bursts
            + terms
                .map(|one| one.passing(m, self.samples, self.rate_hz))
                .sum::<f64>()
    }
}
