//! Why a source ended early.

use crate::capture::CaptureError;
use crate::link::LinkError;

/// Why a source ended early. Each source has its own error; this carries it with its text.
#[derive(Debug, thiserror::Error)]
#[error("{}{message}{}", prefix(place), suffix(remedy))]
pub struct SourceError {
    /// File or port, and the place in it; empty where the message begins with it.
    pub place: String,
    /// What was found and what was expected.
    pub message: String,
    /// What to do about it; may be empty.
    pub remedy: String,
}

impl SourceError {
    /// From an error whose text begins with the place, its causes included.
    pub fn new(error: &dyn std::error::Error, remedy: impl Into<String>) -> Self {
        let mut message = error.to_string();
        let mut cause = error.source();
        while let Some(error) = cause {
            let text = error.to_string();
            if !message.contains(&text) {
                message = format!("{message}: {text}");
            }
            cause = error.source();
        }
        Self {
            place: String::new(),
            message,
            remedy: remedy.into(),
        }
    }
}

impl From<CaptureError> for SourceError {
    fn from(error: CaptureError) -> Self {
        let remedy = error.remedy();
        Self::new(&error, remedy)
    }
}

impl From<LinkError> for SourceError {
    fn from(error: LinkError) -> Self {
        let remedy = error.remedy();
        Self::new(&error, remedy)
    }
}

fn prefix(place: &str) -> String {
    if place.is_empty() {
        String::new()
    } else {
        format!("{place}: ")
    }
}

fn suffix(remedy: &str) -> String {
    if remedy.is_empty() {
        String::new()
    } else {
        format!("; {remedy}")
    }
}
