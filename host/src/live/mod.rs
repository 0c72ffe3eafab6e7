//! The bench view: what is being recorded, what was lost, the Allan deviation and the coefficients as
//! they grow.
//!
//! ```text
//!   source -> watch -> record
//!     ^         |
//!     |         v
//!     |       Stage -> View: a thread of its own -> Artist: fits, and a Screen (lines, or the whole
//!     |                                               |     terminal) or, in `page`, a page for browsers
//!     +-- the next recording <- Desk <----------------+
//! ```
//!
//! [`Snapshot`] is the plain state of a moment, and an [`Artist`] shows it. The recording
//! waits for neither.

mod desk;
mod lines;
mod noise;
mod observe;
mod screen;
mod snapshot;
mod stage;
mod strip;
mod table;
mod terminal;
mod view;
mod watch;
pub mod words;

use std::sync::Arc;

pub use desk::{Declined, Desk, Phase, Wish};
pub use observe::Observed;
pub use screen::{Screen, ScreenArtist};
pub use snapshot::{Cell, Noise, NoiseRow, Row, Snapshot};
pub use stage::Stage;
pub use strip::Strip;
pub use terminal::give_back as give_terminal_back;
pub use view::{Artist, Scene};
pub use watch::{watch, watch_on};

/// What a viewer may do.
#[derive(Clone)]
pub struct Controls {
    /// Where it asks for something.
    pub desk: Desk,
    /// What Ctrl-C does: the first ends the recording in good order, the second the program.
    pub interrupt: Arc<dyn Fn() + Send + Sync>,
}
