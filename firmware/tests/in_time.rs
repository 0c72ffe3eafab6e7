//! Nothing is done between two conversions at 4000/s that leaves no time to read the next: not at the
//! start, and not when a health record is made.

mod rig;
mod timed;

use inm_emulator::Bench;
use inm_firmware::Instrument;
use inm_firmware::emulated::converter;
use inm_protocol::{
    Batch, Command, Decoder, MAX_FRAME, Phase, Rate, Request, ToBoard, ToHost, encode,
};
use rig::{Noisy, OFFSETS, bench, settings};
use timed::{Conversion, TimedBoard, Work};

const PS_PER_US: u64 = 1_000_000;

/// Data period at 4000/s.
const PERIOD_PS: u64 = 250 * PS_PER_US;

/// What a conversion may have taken when something long is begun behind it: three quarters of the period.
const ROOM_PS: u64 = PERIOD_PS * 3 / 4;

/// Board time, ms: five health records, each in another place among the batches and the read-backs.
const RUN_MS: u64 = 5200;

/// What a board did that streamed at 4000/s.
struct Course {
    ahead: Vec<(u64, Work)>,
    conversions: Vec<Conversion>,
    batches: Vec<Batch>,
}

fn streamed(bench: &Bench<Noisy>) -> Course {
    let converters = [0, 1, 2].map(|axis| converter(bench, axis));
    let mut board = Instrument::new(TimedBoard::new(bench), converters, bench.sync());
    let rate = settings(Rate::Sps4000, Phase::Linear, None);
    let requests = [(1, Request::Configure(rate)), (2, Request::Start)];
    let mut requests = requests.into_iter();
    let mut decoder: Decoder = Decoder::new();
    let mut batches = Vec::new();
    let mut answered = true;
    while bench.now_ps() < RUN_MS * 1000 * PS_PER_US {
        // Commands wait until the converters are up.
        let is_up = bench.now_ps() > 100_000 * PS_PER_US;
        let next = if answered && is_up {
            requests.next()
        } else {
            None
        };
        if let Some((id, request)) = next {
            let mut frame = [0; MAX_FRAME];
            let command = ToBoard::Command(Command { id, request });
            let length = encode(&command, &mut frame).expect("a command fits");
            board.platform_mut().link().send(&frame[..length]);
            answered = false;
        }
        board.step();
        let mut arrived = Vec::new();
        let link = board.platform_mut().link();
        link.take(bench.now_ps(), |byte| arrived.push(byte));
        let mut bytes = &arrived[..];
        while let Some(message) = decoder.next(&mut bytes) {
            match message.expect("the link is clean") {
                ToHost::Samples(batch) => batches.push(batch),
                ToHost::Reply(reply) => {
                    reply.result.expect("done");
                    answered = true;
                }
                ToHost::Event(event) => panic!("trouble: {event:?}"),
                _ => {}
            }
        }
    }
    let board = board.platform_mut();
    Course {
        ahead: std::mem::take(&mut board.ahead),
        conversions: std::mem::take(&mut board.conversions),
        batches,
    }
}

/// Begun behind the first edge, they cost the word of Z of the first conversion of every start.
#[test]
fn bins_are_begun_ahead_of_the_first_word() {
    let bench = bench(OFFSETS);
    let course = streamed(&bench);
    let first = &course.conversions[0];
    let begun = course.ahead.iter().filter(|(_, work)| *work == Work::Begin);
    let begun: Vec<u64> = begun.map(|&(at_ps, _)| at_ps).collect();
    let [begun_ps] = begun[..] else {
        panic!("begun at {begun:?}");
    };
    // Ahead of SYNC, behind which the filters take 63 periods.
    let ahead = first.edge_ps.saturating_sub(begun_ps) / PERIOD_PS;
    assert!(ahead >= 60, "begun {ahead} periods ahead of the first edge");
    let late_us = (first.read_ps - first.edge_ps) / PS_PER_US;
    let between = course
        .ahead
        .iter()
        .filter(|(at_ps, _)| *at_ps >= first.edge_ps);
    let between: Vec<Work> = between.map(|&(_, work)| work).collect();
    assert_eq!(between, [Work::Record], "read {late_us} us late");
}

/// On the very next conversion, or behind one that was late already, each record cost two to four words.
#[test]
fn the_two_halves_of_a_health_record_wait_for_conversions_with_room() {
    let bench = bench(OFFSETS);
    let course = streamed(&bench);
    let mut halves = [0, 0];
    for conversion in &course.conversions {
        let works: Vec<Work> = conversion.work.iter().map(|&(_, work)| work).collect();
        for &(at_ps, work) in &conversion.work {
            let half = match work {
                Work::Rest => 0,
                Work::Record => 1,
                _ => continue,
            };
            halves[half] += 1;
            let took_us = (at_ps - conversion.edge_ps) / PS_PER_US;
            assert!(
                at_ps - conversion.edge_ps <= ROOM_PS,
                "{work:?}, {took_us} us behind the edge"
            );
            let alone: &[Work] = if half == 0 {
                &[Work::Rest, Work::Mark]
            } else {
                &[Work::Record]
            };
            assert_eq!(works, alone);
        }
    }
    assert_eq!(halves, [5, 5]);
}

#[test]
fn every_word_is_read_in_time_at_4000_a_second() {
    let bench = bench(OFFSETS);
    let course = streamed(&bench);
    let latest = course.conversions.iter();
    let latest = latest.map(|conversion| conversion.read_ps - conversion.edge_ps);
    let latest_us = latest.max().expect("conversions") / PS_PER_US;
    let mut next = 0;
    for batch in &course.batches {
        assert_eq!(batch.first, next, "read up to {latest_us} us late");
        assert!(
            batch.flags.is_empty(),
            "{:?} of {}",
            batch.flags,
            batch.first
        );
        next = batch.end();
    }
    assert!(next > 4 * 4000, "{next} conversions");
}
