//! The board's own bins: what the health records say of them is what the converters made.

mod rig;

use inm_emulator::{Fault, Slip};
use inm_protocol::{Answer, Phase, Rate, Request};
use rig::{OFFSETS, Rig, bench, settings};

#[test]
fn every_health_record_marks_the_bins_behind_the_last_batch() {
    for rate in [Rate::Sps250, Rate::Sps2000, Rate::Sps4000] {
        let bench = bench(OFFSETS);
        let mut rig = Rig::with_baud(&bench, Some(921_600));
        rig.configure(settings(rate, Phase::Linear, None));
        rig.start();
        let mut marks = 0;
        while marks < 4 {
            let before = rig.health.len();
            rig.run_until(2000, "health", |rig| rig.health.len() > before);
            let mark = rig.health[before].bins.expect("streaming");
            let end = rig.batches.last().map(inm_protocol::Batch::end);
            assert_eq!(Some(mark.index), end, "{rate:?}");
            assert_eq!(mark.epoch, 0);
            marks += 1;
        }
        rig.proven();
        rig.marks_proven();
    }
}

#[test]
fn the_last_conversion_of_a_stream_is_marked_and_silence_is_not() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    for _ in 0..2 {
        assert_eq!(rig.fresh_health().bins, None);
        rig.start();
        rig.run_ms(1234);
        rig.ask(Request::Stop).expect("stop");
        rig.proven();
        let last = *rig.marks_proven().last().expect("marks");
        let end = rig.batches.last().map(inm_protocol::Batch::end);
        assert_eq!((last.epoch, Some(last.index)), (0, end));
        rig.batches.clear();
        rig.health.clear();
    }
}

/// Clipped words, torn words, words that did not come, and a common SYNC in between.
#[test]
fn flags_and_recoveries_are_gaps_on_their_axes() {
    let stuck = Fault::BusStuck {
        high: true,
        conversions: Some(4),
    };
    for fault in [stuck, Fault::DrdyStops, Fault::Slip(Slip::Early)] {
        for axis in 0..3 {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            rig.start();
            rig.run_ms(700);
            rig.inject(axis, fault);
            rig.run_ms(3000);
            let flags: usize = rig.batches.iter().map(|batch| batch.flags.len()).sum();
            let conversions = rig.received().len() as u64;
            let gap = rig.batches.last().map(inm_protocol::Batch::end) > Some(conversions);
            assert!(flags > 0 || gap, "{fault:?} on axis {axis}");
            let after = rig.marks_proven().last().map(|mark| mark.index);
            assert!(after > Some(5000), "{after:?}");
        }
    }
}

#[test]
fn the_bins_begin_anew_a_second_ahead() {
    for rate in [Rate::Sps250, Rate::Sps4000] {
        let bench = bench(OFFSETS);
        let mut rig = Rig::with_baud(&bench, Some(921_600));
        assert_eq!(
            rig.ask(Request::RestartBins),
            Ok(Answer::BinsEpoch { index: 0 }),
            "not streaming"
        );
        rig.configure(settings(rate, Phase::Linear, None));
        rig.start();
        rig.run_ms(1500);
        let Ok(Answer::BinsEpoch { index }) = rig.ask(Request::RestartBins) else {
            panic!("no epoch");
        };
        let received = rig.batches.last().map_or(0, inm_protocol::Batch::end);
        let ahead = index - received;
        assert!(
            (0..64).contains(&(ahead - u64::from(rate.hz()))),
            "{ahead} conversions ahead at {rate:?}"
        );
        rig.run_ms(3500);
        rig.proven();
        let epochs: Vec<u64> = rig.marks_proven().iter().map(|mark| mark.epoch).collect();
        assert_eq!(epochs.first(), Some(&0));
        assert_eq!(epochs.last(), Some(&index));
        let waiting = rig
            .health
            .iter()
            .filter(|h| h.streaming && h.bins.is_none());
        assert!(
            (1..=2).contains(&waiting.count()),
            "no mark until they begin"
        );
    }
}

/// The beginning falls into a common SYNC.
#[test]
fn the_bins_begin_with_a_gap_if_they_have_to() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(500);
    let Ok(Answer::BinsEpoch { index }) = rig.ask(Request::RestartBins) else {
        panic!("no epoch");
    };
    // X stops a rest, a proof and half the settling ahead of it.
    let left = index - rig.batches.last().map_or(0, inm_protocol::Batch::end);
    rig.run_ms((left - (66 + 79 + 31)) / 2);
    rig.inject(0, Fault::DrdyStops);
    rig.run_ms(3000);
    let first = rig.received().into_iter().find(|c| c.index >= index);
    assert!(first.is_some_and(|c| c.index > index), "{first:?}, {index}");
    let last = *rig.marks_proven().last().expect("marks");
    assert_eq!(last.epoch, index);
}
