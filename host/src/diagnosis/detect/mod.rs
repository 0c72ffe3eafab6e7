//! What each effect looks like in a record: one file an effect.

pub mod burst;
pub mod common_mode;
pub mod dropped;
pub mod lines;
pub mod outliers;
pub mod slow;
pub mod stale;
pub mod steps;
pub mod telegraph;
pub mod timebase;
pub mod values;
