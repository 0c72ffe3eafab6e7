//! The freeze: small records of every sort, and what `inm diagnose` said of each of them.
//!
//! What it says of a record must not change when its code is rebuilt. The records are made anew
//! at every use, from the judge's own numbers; what was said stands in `tests/frozen`.
//!
//! ```text
//! records ----> record ----> program ----> compare
//! the list      a record     inm in the    with what was
//!               on disk      folder of     said before
//!                            the record
//! ```

pub mod answer;
pub mod change;
pub mod compare;
pub mod program;
pub mod record;
pub mod records;
