//! How strong each kind can be at most, and which records have room for it: the one table.

use crate::hidden::effect::Effect;
use crate::hidden::scene::Scene;

/// Where a kind ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// At this multiple of strength 1.
    Times(f64),
    /// Where its parameter reaches this, to which the strength is proportional.
    Reaches(&'static str, f64),
    /// Where the corner falls to this share of the rate; the strength goes with its square.
    Corner(f64),
    /// Where the corner rises to this share of the rate, the strength with it.
    CornerUp(f64),
    /// At this share of the samples; strength 1 is `CLIPPED` of them.
    Clipped(f64),
}

/// A kind's row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The kind.
    pub kind: &'static str,
    /// Where it ends.
    pub end: End,
    /// Samples that a record needs for it at least.
    pub samples: usize,
    /// Samples a second that it needs at least.
    pub rate_hz: f64,
}

/// Clipped samples at strength 1: with ten drawn, four are there in 99 %.
const CLIPPED: f64 = 10.0;

const fn limit(kind: &'static str, end: End, samples: usize, rate_hz: f64) -> Limit {
    Limit {
        kind,
        end,
        samples,
        rate_hz,
    }
}

/// Every kind of the catalogue that is hidden. Mains have their fifth harmonic below half of 800/s; a cycle
/// of a thousand samples is there twenty times in 2^15; two rates that differ by 0.2 % show in 2^16
/// samples.
pub const LIMITS: [Limit; 24] = [
    limit("sinusoid", End::Times(1000.0), 0, 0.0),
    limit("hum", End::Times(1000.0), 0, 800.0),
    limit("markov", End::Times(1000.0), 0, 0.0),
    limit("resonance", End::Times(1000.0), 0, 0.0),
    limit("rolloff", End::Corner(0.02), 0, 0.0),
    // At most some 32 samples: lobes as narrow as spectra are looked at by.
    limit("averaging", End::Times(1000.0), 0, 0.0),
    limit("telegraph", End::Times(1000.0), 0, 0.0),
    limit("steps", End::Times(1000.0), 0, 0.0),
    limit("outliers", End::Times(1000.0), 0, 0.0),
    limit("stale", End::Reaches("share", 0.5), 0, 0.0),
    limit("dropped", End::Times(1000.0), 0, 800.0),
    limit("clipping", End::Clipped(0.3), 0, 0.0),
    // Strength 10 is four deviations of the short-term noise: few codes are left.
    limit("quantisation", End::Times(10.0), 0, 0.0),
    limit("burst", End::Times(1000.0), 0, 0.0),
    limit("cyclic", End::Reaches("depth", 1.0), 1 << 15, 0.0),
    limit("warmup", End::Times(1000.0), 0, 0.0),
    limit("drift", End::Times(1000.0), 0, 0.0),
    limit("thermal", End::Times(1000.0), 0, 0.0),
    limit("common_mode", End::Times(1000.0), 0, 0.0),
    limit("powerlaw", End::Times(1000.0), 0, 0.0),
    limit("timebase", End::Times(1000.0), 1 << 16, 0.0),
    limit("shock", End::Times(1000.0), 1 << 16, 0.0),
    limit("wandering_line", End::Times(1000.0), 1 << 16, 0.0),
    // What is faster is a difference of samples.
    limit("highpass", End::CornerUp(0.03), 0, 0.0),
];

/// The row of a kind; none for what the catalogue does not have.
pub fn of(kind: &str) -> Option<&'static Limit> {
    LIMITS.iter().find(|limit| limit.kind == kind)
}

/// The largest strength of a kind whose effect at strength 1 is `unit`; 10 for what has no row.
pub fn cap(kind: &str, unit: &dyn Effect, scene: &Scene) -> f64 {
    let parameter = |name: &str| {
        let truths = unit.truths();
        truths.iter().find_map(|truth| truth.parameter(name))
    };
    let cap = match of(kind).map_or(End::Times(10.0), |limit| limit.end) {
        End::Times(times) => times,
        End::Reaches(name, most) => parameter(name).map_or(1.0, |one| most / one),
        End::Corner(share) => {
            let lowest_hz = share * scene.rate_hz;
            parameter("corner_hz").map_or(1.0, |one| (one / lowest_hz).powi(2))
        }
        End::CornerUp(share) => {
            let highest_hz = share * scene.rate_hz;
            parameter("corner_hz").map_or(1.0, |one| highest_hz / one)
        }
        End::Clipped(share) => share * scene.samples as f64 / CLIPPED,
    };
    cap.clamp(1.0, 1000.0)
}
