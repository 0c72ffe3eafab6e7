//! Whether what is in a record stays as it is from its beginning to its end: noise in its bands, the laws of
//! the noise, lines, and the strength of all of it.

pub mod band_events;
pub mod gaps;
pub mod lasting;
pub mod law;
pub mod line;
pub mod noise;
pub mod prediction;
pub mod strength;
pub mod swing;
pub mod tiles;
