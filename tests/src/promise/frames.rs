//! The decoder of the link: what it delivers is a message that encodes and comes back, every byte is
//! accounted for, and how the bytes were split makes no difference.

use std::fmt::Debug;

use inm_protocol::update::{FromLoader, ToLoader};
use inm_protocol::{Counts, Decoder, Fault, MAX_FRAME, Message, ToBoard, ToHost, encode};

use serde::de::DeserializeOwned;

use super::pieces::stream;

/// Holds for both directions of the link, to the program and to the loader.
pub fn keeps(bytes: &[u8]) {
    let stream = stream(bytes);
    both_ways::<ToHost>(&stream);
    both_ways::<ToBoard>(&stream);
    both_ways::<ToLoader>(&stream);
    both_ways::<FromLoader>(&stream);
}

fn both_ways<M: Message + DeserializeOwned + PartialEq + Debug>(stream: &[u8]) {
    let (whole, counts) = decoded::<M>(stream, stream.len());
    // Seven bytes: no divisor of a frame's length, and shorter than any message.
    let (split, same) = decoded::<M>(stream, 7);
    assert!(whole == split, "split, the bytes say something else");
    assert_eq!(counts, same);
    assert_eq!(whole.len() as u64, counts.frames + counts.faults);
    assert!(counts.bytes_lost <= stream.len() as u64);
    for message in whole.iter().flatten() {
        let mut frame = [0; MAX_FRAME];
        let length = encode(message, &mut frame).expect("a message that came fits in a frame");
        let (again, _) = decoded::<M>(&frame[..length], length);
        let [Ok(again)] = &again[..] else {
            panic!("{message:?} comes back as {again:?}");
        };
        assert!(again == message, "{message:?} comes back as {again:?}");
        // Numbers may have come longer than they need to be; ours are as short as they can be.
        let mut second = [0; MAX_FRAME];
        let same = encode(again, &mut second).expect("encoded a moment ago");
        assert_eq!(frame[..length], second[..same]);
    }
}

/// The messages and faults of a stream that comes in parts of `part` bytes.
fn decoded<M: Message + DeserializeOwned>(
    stream: &[u8],
    part: usize,
) -> (Vec<Result<M, Fault>>, Counts) {
    let mut decoder = Decoder::new();
    let mut all = Vec::new();
    for mut bytes in stream.chunks(part.max(1)) {
        while let Some(one) = decoder.next(&mut bytes) {
            all.push(one);
        }
    }
    (all, decoder.counts())
}
