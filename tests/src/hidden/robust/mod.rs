//! Records of any kind at all: whether the program keeps its head.
//!
//! Nothing is asked of what it finds but that it could be true: it ends in time, with a status of
//! its own, its answer can be read, and no parameter leaves what the record can hold.
//!
//! ```text
//! record    any length, rate, type, axes -+        run     the program with a limit of time
//! content   noise and what is none        +-> file ---> check   its answer against bounds
//! damage    what happens to samples      -+        tally   failures by class
//! ```

pub mod bounds;
pub mod check;
pub mod content;
pub mod damage;
pub mod record;
pub mod run;
pub mod tally;
