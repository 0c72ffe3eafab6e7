//! Captures of a board that has trouble, and copies of them without some of their frames.

use std::path::Path;
use std::time::Duration;

use inm_emulator::{Fault, Slip};
use inm_host::internals::source::Source;
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::virtual_board::{Misfortune, VirtualConnect};
use inm_protocol::{Decoder, MAX_FRAME, Restart, ToHost, encode};

use crate::SEED;

/// A board whose Y slips a bit and is restarted, as the host records it.
pub fn troubled(capture: &Path) {
    let mut board = VirtualConnect::published(SEED, 0.0);
    board.faults = vec![
        (1, 900, Fault::Slip(Slip::Early)),
        (2, 5000, Fault::DrdyStops),
    ];
    let (cause, dark) = (Restart::Watchdog, Duration::ZERO);
    board.restarts = vec![Misfortune {
        words: 3000,
        cause,
        dark,
    }];
    let plan = Plan {
        samples: Some(12_000),
        reconnect: Some(Duration::from_secs(60)),
        ..Plan::default()
    };
    let recorded = BoardSource::start(Box::new(board), plan, Some(capture), Stop::default());
    let mut recorded = recorded.expect("a virtual board starts");
    while recorded
        .next_chunk()
        .expect("the board comes back")
        .is_some()
    {}
}

/// What a capture is made into: some of its frames are left out.
pub type Change = fn(&ToHost) -> bool;

/// A copy of a capture with those frames that are kept, and their messages as `edit` leaves them.
pub fn changed(capture: &[u8], keeps: Change, edit: fn(&mut ToHost)) -> Vec<u8> {
    let lines = capture
        .iter()
        .enumerate()
        .filter(|(_, byte)| **byte == b'\n');
    let (end, _) = lines.take(2).last().expect("two lines");
    let (header, frames) = capture.split_at(end + 1);
    let mut copy = header.to_vec();
    for frame in frames.split_inclusive(|&byte| byte == 0) {
        let Some(Ok(mut message)) = Decoder::new().next::<ToHost>(&mut &frame[..]) else {
            continue;
        };
        if keeps(&message) {
            edit(&mut message);
            let mut out = [0; MAX_FRAME];
            let len = encode(&message, &mut out).expect("every message has room");
            copy.extend(&out[..len]);
        }
    }
    copy
}
