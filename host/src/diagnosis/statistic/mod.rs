//! Statistics: arrays in, numbers out.

pub mod matched_filter;
pub mod p_value;
pub mod profile;
pub mod ramp;
pub mod slow_change;
pub mod spread;
pub mod sums;
