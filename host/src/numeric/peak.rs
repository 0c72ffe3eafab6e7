//! A peak of a function of frequency.

/// Where a density is high, and how wide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Its frequency, hertz.
    pub f_hz: f64,
    /// About half of its width at half the height, hertz.
    pub half_width_hz: f64,
}
