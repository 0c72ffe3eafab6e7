//! Questions to the board while its samples go on arriving.

use inm_protocol::{Reply, Request};

use crate::capture::{CaptureError, Writer};
use crate::link::{Client, Expect, LinkError};
use crate::source::SourceError;
use crate::source::frames::Frames;

/// Why an exchange with the board failed: only the link's faults may pass.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failed {
    /// The board, or the way to it.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The capture cannot be written.
    #[error(transparent)]
    Capture(#[from] CaptureError),
}

impl From<Failed> for SourceError {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Link(error) => error.into(),
            Failed::Capture(error) => error.into(),
        }
    }
}

/// One exchange with the board, everything that arrives meanwhile kept.
pub(super) struct Talk<'a> {
    pub(super) client: &'a mut Client,
    pub(super) frames: &'a mut Frames,
    pub(super) capture: Option<&'a mut dyn Keep>,
}

/// Where the bytes of a record go.
pub(super) trait Keep {
    fn keep(&mut self, bytes: &[u8]) -> Result<(), CaptureError>;
}

impl Keep for Writer {
    fn keep(&mut self, bytes: &[u8]) -> Result<(), CaptureError> {
        self.append(bytes)
    }
}

/// What comes before the header of the capture is known.
impl Keep for Vec<u8> {
    fn keep(&mut self, bytes: &[u8]) -> Result<(), CaptureError> {
        self.extend_from_slice(bytes);
        Ok(())
    }
}

impl Talk<'_> {
    pub(super) fn ask<T: Expect>(&mut self, request: Request) -> Result<T, Failed> {
        let Self {
            client,
            frames,
            capture,
        } = self;
        let answer = client.request(request, |bytes, id| -> Result<Option<Reply>, Failed> {
            keep(bytes, frames, capture)?;
            Ok(frames.take_reply(id))
        });
        let status = frames.status();
        let answer = match (answer, status.foreign_version) {
            (Err(_), Some(theirs)) => Err(client
                .foreign_version(theirs, status.foreign.clone())
                .into()),
            (answer, _) => answer,
        }?;
        T::from_answer(answer).ok_or_else(|| client.wrong_answer(request).into())
    }

    /// What the reply to a request that was told says.
    pub(super) fn said<T: Expect>(&self, request: Request, reply: Reply) -> Result<T, Failed> {
        let answer = self.client.answer(request, reply)?;
        T::from_answer(answer).ok_or_else(|| self.client.wrong_answer(request).into())
    }

    pub(super) fn arrived(&mut self, bytes: &[u8]) -> Result<(), Failed> {
        keep(bytes, self.frames, &mut self.capture)
    }
}

/// Into the capture first: what cannot be decoded is worth keeping too.
fn keep(
    bytes: &[u8],
    frames: &mut Frames,
    capture: &mut Option<&mut dyn Keep>,
) -> Result<(), Failed> {
    if bytes.is_empty() {
        return Ok(());
    }
    let written = capture
        .as_mut()
        .map_or(Ok(()), |capture| capture.keep(bytes));
    frames.push(bytes);
    Ok(written?)
}
