//! The bench view: what is being recorded, what was lost, the Allan table as it grows.
//!
//! [`Snapshot`] is the plain state; [`render`](Snapshot::render) makes it text, and
//! [`Screen`] keeps that text in one place of the terminal.

mod observe;
mod screen;
mod snapshot;
mod watch;

pub use observe::Observed;
pub use screen::Screen;
pub use snapshot::{Cell, Row, Snapshot};
pub use watch::watch;
