//! An entry of the catalogue by its identity: what a diagnosis compares, and asks for all that is
//! known of an effect.

use std::fmt;
use std::ops::Deref;

use serde::{Serialize, Serializer};

use super::effect::Effect;

/// Which effect of the [catalogue](super::catalogue); two are the same if they have one name.
///
/// Every effect's file has its own as `KIND`, and whatever is asked of it is in that file.
#[derive(Clone, Copy)]
pub struct Kind(&'static dyn Effect);

impl Kind {
    /// The kind of an entry.
    pub(super) const fn of(entry: &'static dyn Effect) -> Self {
        Self(entry)
    }

    /// Its name behind the article that it takes.
    pub fn with_article(self) -> String {
        let name = self.name();
        let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) {
            "an"
        } else {
            "a"
        };
        format!("{article} {name}")
    }
}

impl Deref for Kind {
    type Target = dyn Effect;

    fn deref(&self) -> &Self::Target {
        self.0
    }
}

impl PartialEq for Kind {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Kind {}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Debug for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The name in model files.
impl Serialize for Kind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
