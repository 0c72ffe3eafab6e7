//! Statistics: arrays in, numbers out.

pub mod allan_curve;
pub mod kriging;
pub mod matched_filter;
pub mod p_value;
pub mod spread;
pub mod sums;
pub mod tails;
