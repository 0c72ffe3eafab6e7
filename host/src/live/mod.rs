//! The bench view: what is being recorded, what was lost, the Allan deviation and the coefficients as
//! they grow.
//!
//! ```text
//!   source -> watch -> record
//!               |
//!               v
//!             View: fits, on a thread of its own -> Screen: lines, or the whole terminal
//! ```
//!
//! [`Snapshot`] is the plain state of a moment, and [`Screen`] shows it. The recording waits for
//! neither.

mod lines;
mod noise;
mod observe;
mod screen;
mod snapshot;
mod table;
mod terminal;
mod view;
mod watch;

use std::sync::Arc;

use crate::source::board::Marks;

pub use observe::Observed;
pub use screen::Screen;
pub use snapshot::{Cell, Noise, NoiseRow, Row, Snapshot};
pub use terminal::give_back as give_terminal_back;
pub use watch::watch;

/// What a viewer may do to a recording.
#[derive(Clone)]
pub struct Controls {
    /// What Ctrl-C does: the first ends the recording in good order, the second the program.
    pub interrupt: Arc<dyn Fn() + Send + Sync>,
    /// Where marks go; `None` where they have no place.
    pub marks: Option<Marks>,
}
