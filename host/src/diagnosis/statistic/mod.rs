//! Statistics: arrays in, numbers out.

pub mod matched_filter;
pub mod p_value;
pub mod profile;
pub mod ramp;
pub mod sums;
