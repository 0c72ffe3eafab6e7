//! The wide draw: strengths of three decades, in records of any length, rate, noise and form.
//!
//! ```text
//! scene    length, rate, mix of the five terms, chain declared or not
//! limits   how strong a kind can be at most, and which records have room for it
//! form     doubles, codes, gaps
//! counted  whether what is named is there once, with the right parameters
//! tally    tables by kind, strength, length, noise, chain and form
//! ```

pub mod counted;
pub mod form;
pub mod limits;
pub mod scene;
pub mod tally;
