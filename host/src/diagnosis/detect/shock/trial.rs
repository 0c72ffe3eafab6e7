//! Shocks in small records, for the tests of this room.

use std::ops::Range;

use super::about::{About, Beside};
use crate::model::shock::Shock;

/// Samples in which something happens.
pub const EVENT: Range<usize> = 9000..9200;

/// Ringing of a frequency and a decay, in the units of its time.
pub const fn ringing(time_s: f64, peak: f64, f_hz: f64, decay_s: f64) -> Shock {
    Shock {
        time_s,
        peak,
        duration_s: f64::INFINITY,
        f_hz,
        decay_s,
    }
}

/// Half a sine.
pub const fn bump(time_s: f64, peak: f64, duration_s: f64) -> Shock {
    Shock {
        time_s,
        peak,
        duration_s,
        f_hz: 0.0,
        decay_s: 0.0,
    }
}

/// What is about the [`EVENT`] of some values, whitened by what is beside it.
pub fn about(values: &[f64]) -> About {
    let quiet = [0..EVENT.start, EVENT.end + 400..values.len()];
    let beside = Beside {
        values,
        quiet: &quiet,
        faint: 0.0,
    };
    let near = EVENT.start - 100..EVENT.end + 100;
    About::new(&beside, &EVENT, &near, 1).expect("noise beside it")
}
