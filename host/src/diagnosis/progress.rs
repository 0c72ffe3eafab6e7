//! What a diagnosis says on its way.

use crate::diagnosis::decision::Decision;

/// What has come of an axis meanwhile.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// The axis is begun with.
    Begun,
    /// Something was decided of it; what was taken in may be taken back later.
    Decided(Decision),
    /// The axis is done.
    Done,
}

/// Called with the name of an axis and what has come of it, by several threads.
pub type Progress<'a> = dyn Fn(&str, Step) + Sync + 'a;
