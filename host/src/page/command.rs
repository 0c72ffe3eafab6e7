//! What a tab may ask for, and the words that it gets.

use std::time::Duration;

use axum::body::{Body, to_bytes};
use axum::http::StatusCode;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use tokio::time::timeout;

use super::wanted;
use crate::live::{Declined, Desk};

/// Longest body of a command, bytes: a note of a mark is 120.
const MOST_BODY: usize = 1024;

/// How long a command may take to arrive.
const PATIENCE: Duration = Duration::from_secs(5);

/// What a tab may ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    Mark,
    Stop,
    Record,
    Test,
    End,
}

impl Command {
    /// The command at `path`.
    pub fn at(path: &str) -> Option<Self> {
        Some(match path {
            "/mark" => Self::Mark,
            "/stop" => Self::Stop,
            "/record" => Self::Record,
            "/selftest" => Self::Test,
            "/end" => Self::End,
            _ => return None,
        })
    }

    /// Carries it out as far as a tab can: the bench does the rest.
    pub async fn carry_out(self, desk: &Desk, body: Body) -> Response {
        let body = match timeout(PATIENCE, to_bytes(body, MOST_BODY)).await {
            Ok(Ok(body)) => body,
            Ok(Err(_)) => {
                let words = format!("a command has at most {MOST_BODY} bytes");
                return said(StatusCode::PAYLOAD_TOO_LARGE, words);
            }
            Err(_) => return StatusCode::REQUEST_TIMEOUT.into_response(),
        };
        let unfit = |words| said(StatusCode::UNPROCESSABLE_ENTITY, words);
        let done = match self {
            Self::Mark => match std::str::from_utf8(&body) {
                Ok(text) => desk.mark(text),
                Err(_) => return unfit("the note of a mark is UTF-8".to_owned()),
            },
            Self::Record => match wanted::settings(&body) {
                Ok(settings) => desk.record(settings),
                Err(bad) => return unfit(bad.to_string()),
            },
            Self::Stop => desk.stop(),
            Self::Test => desk.test(),
            Self::End => {
                desk.end();
                Ok(())
            }
        };
        match done {
            Ok(()) => StatusCode::NO_CONTENT.into_response(),
            Err(Declined::Mark(error)) => unfit(error.to_string()),
            Err(declined) => said(StatusCode::CONFLICT, declined.to_string()),
        }
    }
}

/// An answer in words.
pub fn said(status: StatusCode, words: String) -> Response {
    let headers = [
        (CONTENT_TYPE, "text/plain; charset=utf-8"),
        (CACHE_CONTROL, "no-store"),
    ];
    (status, headers, words + "\n").into_response()
}
