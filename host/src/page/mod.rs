//! The page of `inm live`: a bench in the browser, on this machine alone unless asked otherwise.
//!
//! ```text
//!   live::Stage -> PageArtist: an analysis, the reports' own pictures -> Hub -> Server -> tabs
//!                     ^                                                            |
//!   the capture -> Looker: a diagnosis now and then     live::Desk: marks, <-------+
//!                                                       start, stop, self-test
//! ```
//!
//! The page is what [`Hub`](hub::Hub) holds, part by part; a tab gets what has changed since it last asked. Who may
//! ask is in [`guard`].

mod artist;
mod bench;
mod command;
mod files;
mod guard;
mod hub;
mod look;
mod parts;
mod server;
mod wanted;

pub use artist::PageArtist;
