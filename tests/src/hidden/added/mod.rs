//! Known effects added to stretches of real records: whether they are named there, and nothing that the stretch does
//! not hold.
//!
//! ```text
//! list ----> stretch ----> case ----------> score ----> tally
//! which      a part of     the stretch with  what is     tables by kind,
//! records    one axis,     one effect in it  said more   record, strength
//!            its law                         than of the
//!                                            bare stretch
//! ```
//! The records stay where they are: the study is told of them by a list.

pub mod case;
pub mod list;
pub mod score;
pub mod stretch;
pub mod tally;
