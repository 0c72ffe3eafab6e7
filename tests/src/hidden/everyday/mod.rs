//! What happens to a sensor on an ordinary desk: disturbances as they are, and what may be said of them.
//!
//! ```text
//! motion    knock, door, footsteps, lorry, handling    ---+
//! machine   a fan, mains that wander                      +--> record --> score
//! warmth    a switched heater, warm-up of two times       |                 ^
//! logger    samples that are held, filters                |                 |
//!           ----------------------------------------------+        table: accepted kinds, times
//! ```
//!
//! No detector was looked at. Sizes are drawn in units of the short-term noise, so that each is plain to whoever
//! looks at the record.

pub mod logger;
pub mod machine;
pub mod motion;
pub mod record;
pub mod score;
pub mod table;
pub mod tally;
pub mod warmth;
