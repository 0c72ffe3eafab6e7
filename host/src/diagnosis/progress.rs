//! What a diagnosis says on its way.

use crate::model::kind::Kind;

/// What has come of an axis meanwhile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// The axis is begun with.
    Begun,
    /// An effect was found in it, which may be given back later.
    Found(Kind),
    /// The axis is done.
    Done,
}

/// Called with the name of an axis and what has come of it, by several threads.
pub type Progress<'a> = dyn Fn(&str, Step) + Sync + 'a;
