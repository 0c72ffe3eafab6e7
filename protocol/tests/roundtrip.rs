//! Any message, any split, any damage: what the decoder owes its callers.

use inm_protocol::{
    AXES, Answer, BATCH_LEN, Batch, BinsMark, Code, Command, Counts, Decoder, Event, Fault, Flag,
    Flags, Health, MAX_FRAME, Pulse, PulseCounters, Rate, Refusal, Reply, Request, Settings,
    ToBoard, ToHost, Trouble, encode, samples_load,
};
use proptest::prelude::*;

fn framed(message: &ToHost) -> Vec<u8> {
    let mut out = [0; MAX_FRAME];
    let len = encode(message, &mut out).expect("MAX_FRAME holds every message");
    out[..len].to_vec()
}

fn decode_all(decoder: &mut Decoder, mut bytes: &[u8]) -> Vec<Result<ToHost, Fault>> {
    std::iter::from_fn(|| decoder.next(&mut bytes)).collect()
}

/// The largest message of all: every number at its longest, every word flagged.
fn longest_batch() -> Batch {
    let mut batch = Batch {
        seq: u32::MAX,
        first: u64::MAX,
        stamp: u64::MAX,
        stream: u16::MAX,
        ..Batch::default()
    };
    for conversion in 0..BATCH_LEN {
        batch
            .codes
            .push([Code(i32::MIN); AXES])
            .expect("room for BATCH_LEN");
        for axis in 0..AXES {
            let flag = Flag {
                conversion: conversion as u8,
                axis: axis as u8,
                flags: Flags(0xff),
            };
            batch.flags.push(flag).expect("room for every word");
        }
    }
    batch
}

#[test]
fn the_longest_message_fits_the_longest_frame_exactly() {
    let frame = framed(&ToHost::Samples(longest_batch()));
    // COBS adds at most one byte in 254; with few zeros inside, the worst case is reached or
    // nearly so.
    assert!(frame.len() <= MAX_FRAME);
    assert!(
        frame.len() >= MAX_FRAME - 3,
        "MAX_FRAME is slack: {} of {MAX_FRAME}",
        frame.len()
    );
}

#[test]
fn a_full_batch_loads_the_link_as_the_budget_says() {
    let mut batch = longest_batch();
    batch.flags.clear();
    let frame = framed(&ToHost::Samples(batch)).len() as u32;
    let settings = Settings {
        rate: Rate::Sps4000,
        ..Settings::default()
    };
    let load = samples_load(settings, 921_600);
    let batches = 4000 / BATCH_LEN as u32;
    assert!(
        load.needed >= batches * frame,
        "{load:?} against {frame} bytes a batch"
    );
    assert!(
        load.needed < batches * frame + 3000,
        "{load:?} against {frame} bytes a batch"
    );
    assert!(load.fits());
}

#[test]
fn lost_zero_merges_two_frames_and_the_third_arrives() {
    let messages: Vec<ToHost> = (0..3)
        .map(|index| {
            ToHost::Event(Event {
                index,
                axis: Some(1),
                trouble: Trouble::Stalled,
                stream: 3,
            })
        })
        .collect();
    let mut stream: Vec<u8> = messages.iter().flat_map(framed).collect();
    let first_zero = stream
        .iter()
        .position(|&b| b == 0)
        .expect("frames end in zero");
    stream.remove(first_zero);
    let mut decoder = Decoder::new();
    let got = decode_all(&mut decoder, &stream);
    assert_eq!(got.len(), 2);
    assert!(got[0].is_err());
    assert_eq!(got[1], Ok(messages[2].clone()));
    assert_eq!(decoder.counts().frames, 1);
    assert_eq!(decoder.counts().faults, 1);
}

#[test]
fn endless_line_noise_without_zero_is_bounded_and_counted() {
    let mut decoder = Decoder::new();
    for _ in 0..1000 {
        assert_eq!(decode_all(&mut decoder, &[0x55; 977]), vec![]);
    }
    assert_eq!(decode_all(&mut decoder, &[0]), vec![Err(Fault::TooLong)]);
    let lost = Counts {
        frames: 0,
        faults: 1,
        bytes_lost: 977_001,
    };
    assert_eq!(decoder.counts(), lost);
}

fn any_code() -> impl Strategy<Value = [Code; AXES]> {
    any::<[i32; AXES]>().prop_map(|codes| codes.map(Code))
}

fn any_batch() -> impl Strategy<Value = Batch> {
    let codes = prop::collection::vec(any_code(), 0..=BATCH_LEN);
    let flags = prop::collection::vec((any::<u8>(), any::<u8>(), any::<u8>()), 0..8);
    let numbers = (any::<u32>(), any::<u64>(), any::<u64>(), any::<u16>());
    (numbers, codes, flags).prop_map(|((seq, first, stamp, stream), codes, flags)| Batch {
        stream,
        seq,
        first,
        stamp,
        codes: codes.into_iter().collect(),
        flags: flags
            .into_iter()
            .map(|(conversion, axis, bits)| Flag {
                conversion,
                axis,
                flags: Flags(bits),
            })
            .collect(),
    })
}

fn any_message() -> impl Strategy<Value = ToHost> {
    let refusal = Refusal::LinkTooSlow {
        needed: 100_000,
        available: 92_160,
    };
    prop_oneof![
        4 => any_batch().prop_map(ToHost::Samples),
        1 => (any::<u64>(), any::<u32>()).prop_map(|(stamp, stack_used)| {
            let digests = [stamp, !stamp, stamp.rotate_left(7)];
            let bins = Some(BinsMark { epoch: stamp, index: !stamp, digests });
            let stream = stack_used as u16;
            ToHost::Health(Health { stamp, stack_used, bins, stream, ..Health::default() })
        }),
        1 => (any::<u16>(), any::<u64>()).prop_map(|(id, index)| {
            ToHost::Reply(Reply { id, result: Ok(Answer::BinsEpoch { index }) })
        }),
        1 => any::<u16>().prop_map(|id| ToHost::Reply(Reply { id, result: Ok(Answer::Done) })),
        1 => any::<u16>().prop_map(move |id| ToHost::Reply(Reply { id, result: Err(refusal) })),
        1 => (any::<u64>(), any::<u32>(), any::<bool>()).prop_map(|(stamp, number, doubled)| {
            let counters = PulseCounters { early: !number, missing: number, ..PulseCounters::default() };
            ToHost::Pulse(Pulse { stamp, number, doubled, counters })
        }),
        1 => (any::<u64>(), any::<u32>()).prop_map(|(index, lost)| {
            let trouble = Trouble::Recovered { lost };
            ToHost::Event(Event { index, axis: None, trouble, stream: lost as u16 })
        }),
    ]
}

proptest! {
    #[test]
    fn any_split_delivers_the_same_messages(
        messages in prop::collection::vec(any_message(), 1..12),
        cuts in prop::collection::vec(1usize..200, 1..40),
    ) {
        let stream: Vec<u8> = messages.iter().flat_map(framed).collect();
        let mut decoder = Decoder::new();
        let mut got = Vec::new();
        let mut rest = &stream[..];
        for cut in cuts.iter().cycle() {
            if rest.is_empty() {
                break;
            }
            let (now, later) = rest.split_at((*cut).min(rest.len()));
            got.extend(decode_all(&mut decoder, now));
            rest = later;
        }
        prop_assert_eq!(got, messages.into_iter().map(Ok).collect::<Vec<_>>());
        prop_assert_eq!(decoder.pending(), 0);
        prop_assert_eq!(decoder.counts().bytes_lost, 0);
    }

    #[test]
    fn one_damaged_byte_costs_at_most_two_frames_and_no_wrong_message(
        messages in prop::collection::vec(any_message(), 3..10),
        place in any::<prop::sample::Index>(),
        change in 1u8..=255,
    ) {
        let mut stream: Vec<u8> = messages.iter().flat_map(framed).collect();
        let at = place.index(stream.len());
        stream[at] ^= change;
        let mut decoder = Decoder::new();
        let good: Vec<ToHost> =
            decode_all(&mut decoder, &stream).into_iter().filter_map(Result::ok).collect();
        // What arrives is a subsequence of what was sent: nothing made up, nothing reordered.
        let mut sent = messages.iter();
        for message in &good {
            prop_assert!(sent.any(|s| s == message), "a message that was never sent");
        }
        prop_assert!(good.len() + 2 >= messages.len());
    }

    #[test]
    fn rubbish_never_panics_and_every_byte_is_accounted_for(
        rubbish in prop::collection::vec(any::<u8>(), 0..5000),
    ) {
        let mut decoder = Decoder::new();
        let results = decode_all(&mut decoder, &rubbish);
        let counts = decoder.counts();
        prop_assert_eq!(results.len() as u64, counts.frames + counts.faults);
        // Every byte was a separator, part of a fault, part of a message or is still pending.
        prop_assert!(counts.bytes_lost + decoder.pending() as u64 <= rubbish.len() as u64);

        let message = ToHost::Health(Health::default());
        let mut tail = vec![0];
        tail.extend(framed(&message));
        prop_assert_eq!(decode_all(&mut decoder, &tail).pop(), Some(Ok(message)));
    }

    #[test]
    fn every_command_comes_back(id in any::<u16>(), which in 0usize..10) {
        let request = [
            Request::Identify,
            Request::Start,
            Request::Stop,
            Request::Configure(Settings::default()),
            Request::CalibrateOffset,
            Request::CalibrateGain,
            Request::SelfTest,
            Request::ReadRegisters,
            Request::Reset,
            Request::RestartBins,
        ][which];
        let command = ToBoard::Command(Command { id, request });
        let mut out = [0; 64];
        let len = encode(&command, &mut out).expect("commands are short");
        let mut decoder: Decoder<64> = Decoder::with_capacity();
        prop_assert_eq!(decoder.next(&mut &out[..len]), Some(Ok(command)));
    }
}
