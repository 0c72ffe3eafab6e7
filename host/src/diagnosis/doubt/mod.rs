//! What speaks against a name.

pub mod constancy;
pub mod lopsided;
pub mod steadiness;
pub mod tone;
pub mod wander;
