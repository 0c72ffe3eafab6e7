//! What a detector could do that knows the kind and the noise's law, but not the parameters.

pub mod detector;
pub mod envelope;
pub mod grid;
pub mod levels;
pub mod matched;
pub mod spectral;
