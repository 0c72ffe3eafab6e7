//! Trouble on the board: each kind is told to the host, counted and recovered from, and what
//! follows is right, bit for bit.

mod rig;

use std::cmp::Ordering;

use inm_emulator::channel::published;
use inm_emulator::{Bench, Converter, Fault, Signal, Slip};
use inm_protocol::{
    Answer, AxisCounters, Flags, Phase, Rate, Refusal, Request, Trouble, UNPROVEN_PERIODS,
};
use rig::{OFFSETS, Received, Rig, bench, settings};

/// Streams, lets `fault` happen on `axis`, waits for the recovery and some more, and proves
/// all that arrived.
#[track_caller]
fn suffer(rig: &mut Rig<'_, impl Signal>, axis: usize, fault: Fault) -> Vec<Received> {
    rig.start();
    rig.run_ms(300);
    assert_eq!(rig.events, []);
    rig.inject(axis, fault);
    rig.run_until(3000, "recovery", |rig| rig.recoveries() > 0);
    rig.run_ms(300);
    let received = rig.proven();
    let Some(last) = received.last() else {
        panic!("nothing arrived");
    };
    let good_after = received
        .iter()
        .rev()
        .take_while(|conversion| conversion.flags == [Flags::NONE; 3])
        .count();
    assert!(good_after >= 500, "{good_after} good conversions, {last:?}");
    assert_eq!(rig.recoveries(), 1, "{:?}", rig.events);
    assert_eq!(rig.bench.violation(), None);
    received
}

/// Conversions that did not arrive, all counted by the board.
#[track_caller]
fn lost(rig: &mut Rig<'_, impl Signal>, received: &[Received]) -> u64 {
    let (first, last) = (received[0], received[received.len() - 1]);
    let lost = last.index - first.index + 1 - received.len() as u64;
    let told: u64 = rig
        .events
        .iter()
        .map(|event| match event.trouble {
            Trouble::Recovered { lost } => u64::from(lost),
            _ => 0,
        })
        .sum();
    let health = rig.fresh_health();
    assert_eq!(health.lost_conversions, lost);
    assert!(told <= lost);
    lost
}

#[track_caller]
fn counters(rig: &mut Rig<'_, impl Signal>, axis: usize) -> AxisCounters {
    rig.fresh_health().axes[axis]
}

#[test]
fn drdy_that_stops_is_a_stall_on_any_axis() {
    for axis in 0..3 {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        let received = suffer(&mut rig, axis, Fault::DrdyStops);
        let told = rig.troubles(axis as u8);
        assert_eq!(told[0], Trouble::Stalled, "axis {axis}");
        assert!(matches!(told[1], Trouble::Recovered { .. }));
        assert_eq!(told.len(), 2);
        let lost = lost(&mut rig, &received);
        if axis == 0 {
            // Nothing is read until the silence is noticed. Y drives the reading until X is back.
            assert!((63 + 7..63 + 12).contains(&lost), "{lost} lost");
        } else {
            // The others go on until the axis has proved itself.
            assert!((63..70).contains(&lost), "{lost} lost");
        }
        {
            let repeated = received
                .iter()
                .filter(|conversion| conversion.flags[axis].has(Flags::MISSED))
                .count();
            assert!((130..160).contains(&repeated), "{repeated} repeated");
            let others = received.iter().flat_map(|conversion| {
                (0..3)
                    .filter(move |&other| other != axis)
                    .map(move |other| conversion.flags[other])
            });
            assert!(others.into_iter().all(Flags::is_none));
        }
        let counted = counters(&mut rig, axis);
        assert_eq!(counted.stalled, 1);
        assert_eq!(counted.resets, 3, "power-up, start, recovery");
    }
}

#[test]
fn a_stuck_bus_is_flagged_from_its_first_word() {
    for axis in 0..3 {
        for high in [false, true] {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            let conversions = None;
            let received = suffer(&mut rig, axis, Fault::BusStuck { high, conversions });
            let told = rig.troubles(axis as u8);
            assert_eq!(told[0], Trouble::Stuck { ones: high });
            assert_eq!(told.len(), 2);
            assert_eq!(counters(&mut rig, axis).stuck, 1);
            let first = received
                .iter()
                .position(|conversion| conversion.flags[axis].has(Flags::STUCK))
                .expect("flagged words");
            let uniform = if high { -1 } else { 0 };
            assert!(
                received[..first]
                    .iter()
                    .all(|conversion| conversion.codes[axis].0 != uniform)
            );
        }
    }
}

#[test]
fn a_bus_that_is_stuck_for_a_moment_needs_no_reset() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(100);
    rig.inject(
        1,
        Fault::BusStuck {
            high: true,
            conversions: Some(4),
        },
    );
    rig.run_ms(200);
    rig.proven();
    assert_eq!(rig.events, []);
    assert_eq!(counters(&mut rig, 1).stuck, 0);
}

#[test]
fn a_slipped_bit_is_seen_on_axes_with_offset() {
    for axis in 0..3 {
        for (slip, doubled) in [(Slip::Early, true), (Slip::Late, false)] {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            suffer(&mut rig, axis, Fault::Slip(slip));
            let told = rig.troubles(axis as u8);
            assert_eq!(told[0], Trouble::Slipped { doubled }, "axis {axis}");
            assert_eq!(told.len(), 2);
            assert_eq!(counters(&mut rig, axis).slipped, 1);
        }
    }
}

#[test]
fn a_slipped_bit_is_seen_on_the_published_sensors_within_a_tenth_of_a_second() {
    for axis in 0..3 {
        for (slip, doubled) in [(Slip::Early, true), (Slip::Late, false)] {
            let bench = Bench::new([0, 1, 2].map(|axis| Converter::new(published(axis, 7))));
            let mut rig = Rig::new(&bench);
            rig.start();
            rig.run_ms(1000);
            assert_eq!(rig.events, []);
            rig.inject(axis, Fault::Slip(slip));
            rig.run_until(1000, "recovery", |rig| rig.recoveries() > 0);
            rig.run_ms(500);
            let told = rig.events[0];
            let by_level = Trouble::Slipped { doubled };
            assert!([by_level, Trouble::Misaligned].contains(&told.trouble));
            assert_eq!(told.axis, Some(axis as u8));
            // One word does not tell here: up to the event they are not flagged, and the host
            // leaves them out.
            let blind = told.index - UNPROVEN_PERIODS..told.index;
            assert!(
                told.index < 2000 + UNPROVEN_PERIODS,
                "axis {axis} {slip:?}: {}",
                told.index
            );
            let received = rig.proven_but(|index, of| of == axis && blind.contains(&index));
            let good = [Flags::NONE; 3];
            assert!(
                received[received.len() - 800..]
                    .iter()
                    .all(|c| c.flags == good)
            );
            assert_eq!(rig.events.len(), 2, "{:?}", rig.events);
        }
    }
}

#[test]
fn a_slip_where_nothing_else_tells_shows_in_the_registers() {
    let bench = bench([0; 3]);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(300);
    rig.inject(1, Fault::Slip(Slip::Early));
    rig.run_until(3000, "recovery", |rig| rig.recoveries() > 0);
    // The converter does not understand the question.
    assert_eq!(rig.troubles(1)[0], Trouble::Misaligned);
    assert_eq!(rig.troubles(1).len(), 2);
    assert!(rig.events[0].index < 600 + UNPROVEN_PERIODS);
}

#[test]
fn a_late_slip_around_zero_breaks_the_sign_rule() {
    let bench = bench([0, 0, OFFSETS[2]]);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(300);
    rig.inject(0, Fault::Slip(Slip::Late));
    rig.run_until(3000, "recovery", |rig| rig.recoveries() > 0);
    assert_eq!(rig.troubles(0)[0], Trouble::Slipped { doubled: false });
}

#[test]
fn an_overload_is_told_once_and_clears_by_itself() {
    for (axis, input) in [(0, 1_200_000_000), (2, -1_200_000_000)] {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        rig.start();
        rig.run_ms(300);
        let conversions = 50;
        rig.inject(axis, Fault::Overload { input, conversions });
        rig.run_ms(300);
        let received = rig.proven();
        assert_eq!(rig.troubles(axis as u8), [Trouble::OverRange]);
        assert_eq!(rig.events.len(), 1);
        let clipped: Vec<_> = received
            .iter()
            .filter(|conversion| conversion.flags[axis].has(Flags::OVER_RANGE))
            .collect();
        assert!((30..80).contains(&clipped.len()), "{}", clipped.len());
        let full_scale = if input > 0 { i32::MAX } else { i32::MIN };
        assert!(clipped.iter().all(|c| c.codes[axis].0 == full_scale));
        let counted = counters(&mut rig, axis);
        assert_eq!(counted.over_range as usize, clipped.len());
        assert_eq!((counted.slipped, counted.torn, counted.resets), (0, 0, 2));
    }
}

#[test]
fn a_brown_out_shows_in_the_registers() {
    for rate in [Rate::Sps250, Rate::Sps1000, Rate::Sps2000, Rate::Sps4000] {
        for axis in 0..3 {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            rig.configure(settings(rate, Phase::Minimum, None));
            rig.start();
            rig.run_ms(1000);
            rig.inject(axis, Fault::BrownOut);
            rig.run_until(3000, "recovery", |rig| rig.recoveries() > 0);
            rig.run_ms(1000);
            rig.proven();
            let told = rig.troubles(axis as u8);
            let lost = matches!(
                told[0],
                Trouble::RegisterLost {
                    address: 1,
                    found: 0x52,
                    ..
                }
            );
            // X is silent for 63 of its own periods after the brown-out: at higher rates the
            // silence is noticed before the registers can be.
            let stalled = axis == 0 && told[0] == Trouble::Stalled;
            assert!(lost || stalled, "{rate:?} axis {axis}: {told:?}");
            assert_eq!(told.len(), 2, "{rate:?} axis {axis}: {told:?}");
            let counted = counters(&mut rig, axis);
            assert_eq!(counted.registers_lost + counted.stalled, 1);
        }
    }
}

#[test]
fn an_identity_that_changes_is_told_and_tried_again() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(300);
    rig.inject(1, Fault::WrongId(0x5A));
    rig.run_until(3000, "attempts", |rig| rig.troubles(1).len() >= 3);
    assert!(
        rig.troubles(1)
            .iter()
            .all(|&trouble| trouble == Trouble::WrongId { found: 0x5A })
    );
    // A part that is not what it should be costs the others nothing.
    let received = rig.proven();
    assert_eq!(lost(&mut rig, &received), 0);
    rig.inject(1, Fault::WrongId(0x10));
    rig.run_until(6000, "recovery", |rig| rig.recoveries() > 0);
    rig.run_ms(100);
    rig.proven();
}

#[test]
fn a_start_with_a_wrong_part_is_refused_with_the_reason() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.run_ms(30);
    rig.inject(2, Fault::WrongId(0x23));
    let trouble = Trouble::WrongId { found: 0x23 };
    assert_eq!(
        rig.ask(Request::Start),
        Err(Refusal::Converter { axis: 2, trouble })
    );
    rig.inject(2, Fault::WrongId(0x00));
    rig.start();
    rig.run_ms(100);
    assert!(rig.proven().len() > 150);
}

#[test]
fn a_start_without_drdy_is_refused_after_one_more_reset() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.run_ms(30);
    let id = rig.send(Request::Start);
    // After the RESET of the start command, which would cure it.
    rig.run_ms(10);
    rig.inject(0, Fault::DrdyStops);
    rig.run_until(1000, "reply", |rig| !rig.replies.is_empty());
    let trouble = Trouble::Stalled;
    let refusal = Err(Refusal::Converter { axis: 0, trouble });
    assert_eq!(rig.replies, [(id, refusal)]);
    rig.start();
}

#[test]
fn a_torn_word_is_flagged_and_only_that() {
    for axis in 0..3 {
        for bits in [1, 7, 16, 31] {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            rig.start();
            rig.run_ms(200);
            rig.inject(axis, Fault::LateRead { bits });
            rig.run_ms(200);
            let received = rig.proven();
            let bad: Vec<_> = received
                .iter()
                .filter(|conversion| conversion.flags != [Flags::NONE; 3])
                .collect();
            // Part of the next word of this axis went out with the torn one; what would have
            // been read after it had been replaced by then.
            let place = |other: usize| match other.cmp(&axis) {
                Ordering::Less => [Flags::NONE, Flags::NONE],
                Ordering::Equal => [Flags::TORN, Flags::MISSED],
                Ordering::Greater => [Flags::MISSED, Flags::NONE],
            };
            assert_eq!(bad.len(), 2, "axis {axis}, {bits} bits: {bad:?}");
            for (k, conversion) in bad.iter().enumerate() {
                let expected = [0, 1, 2].map(|other| place(other)[k]);
                assert_eq!(conversion.flags, expected, "axis {axis}, {bits} bits");
            }
            let indices = received.iter().map(|conversion| conversion.index);
            assert!(indices.eq(0..received.len() as u64), "nothing is lost");
            assert_eq!(counters(&mut rig, axis).torn, 1);
            assert_eq!(rig.events, []);
        }
    }
}

#[test]
fn a_bus_error_takes_its_axis_out_and_back() {
    for axis in 0..3 {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        suffer(&mut rig, axis, Fault::BusError);
        assert_eq!(rig.troubles(axis as u8)[0], Trouble::Bus);
    }
}

#[test]
fn trouble_on_two_axes_at_once_is_cured_on_both() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(300);
    rig.inject(0, Fault::Slip(Slip::Early));
    rig.inject(2, Fault::DrdyStops);
    rig.run_ms(1000);
    let received = rig.proven();
    for axis in [0, 2] {
        let told = rig.troubles(axis);
        assert!(
            matches!(told[..], [_, Trouble::Recovered { .. }]),
            "{told:?}"
        );
    }
    assert!(
        received[received.len() - 500..]
            .iter()
            .all(|conversion| conversion.flags == [Flags::NONE; 3])
    );
}

#[test]
fn a_stream_in_trouble_can_be_stopped_and_started() {
    for axis in 0..3 {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        rig.start();
        rig.run_ms(100);
        rig.inject(axis, Fault::DrdyStops);
        rig.run_ms(20);
        assert_eq!(rig.ask(Request::Stop), Ok(Answer::Done));
        rig.start();
        rig.batches.clear();
        rig.run_ms(200);
        let received = rig.proven();
        assert!(received.len() > 300);
        assert!(
            received
                .iter()
                .all(|conversion| conversion.flags == [Flags::NONE; 3])
        );
    }
}
