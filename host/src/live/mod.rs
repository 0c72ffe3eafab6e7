//! The bench view: what is being recorded, what was lost, the Allan table and the
//! coefficients as they grow.
//!
//! [`Snapshot`] is the plain state; [`render`](Snapshot::render) makes it text, and
//! [`Screen`] keeps that text in one place of the terminal. Fits and drawing are on a thread of their
//! own: the recording never waits for them.

mod noise;
mod observe;
mod screen;
mod snapshot;
mod table;
mod view;
mod watch;

pub use observe::Observed;
pub use screen::Screen;
pub use snapshot::{Cell, Noise, NoiseRow, Row, Snapshot};
pub use watch::watch;
