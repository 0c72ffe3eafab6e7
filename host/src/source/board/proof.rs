//! Losses that make the board's bins incomparable: it is asked to begin them anew.

use std::time::{Duration, Instant};

use inm_protocol::Request;

use super::BoardSource;
use super::resume::Broken;
use crate::source::SourceError;

/// Between two requests to begin the bins anew: the answer to the first is that far ahead.
const ASK_AGAIN: Duration = Duration::from_secs(1);

impl BoardSource {
    /// Asks the board to begin its bins anew where a loss has made them incomparable. The
    /// samples do not wait for the answer, which is found among them.
    pub(super) fn restore_proof(&mut self) -> Result<(), SourceError> {
        let early = self.asked.is_some_and(|asked| asked.elapsed() < ASK_AGAIN);
        if early || !self.frames.wants_new_beginning() {
            return Ok(());
        }
        self.asked = Some(Instant::now());
        match self.client.tell(Request::RestartBins) {
            Ok(_) => Ok(()),
            Err(gone) => self.begin_search(Broken::Port(gone)),
        }
    }
}
