//! A bit slips, and before that is noticed something else happens that hides it: every word between
//! is named to the host all the same.

mod rig;

use inm_emulator::{Fault, Slip};
use inm_protocol::{Answer, Rate, Request, Trouble};
use rig::{OFFSETS, Rig, bench, settings};

/// Around zero, where no word tells that its bits have slipped.
const AROUND_ZERO: [i32; 3] = [0; 3];

/// What hides the slip of Y.
type Hiding = fn(&mut Rig<'_, rig::Noisy>);

/// Streams, lets a bit of Y slip, and something hide it `later_ms` after.
fn hidden_by(slip: Slip, later_ms: u64, hiding: Hiding) {
    let bench = bench(AROUND_ZERO);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(300);
    rig.inject(1, Fault::Slip(slip));
    rig.run_ms(later_ms);
    hiding(&mut rig);
    rig.run_ms(1500);
    if rig.instrument.is_streaming() {
        rig.ask(Request::Stop).expect("it stops");
    }
    let wrong = rig.wrong_and_not_told();
    assert_eq!(wrong, [], "{slip:?}, {later_ms} ms later: {:?}", rig.events);
    // And the words were wrong: the test is about something.
    let told = rig.troubles(1);
    assert!(
        told.iter().any(|trouble| trouble.is_reset_for()),
        "{told:?}"
    );
}

fn at_any_time(hiding: Hiding) {
    for slip in [Slip::Early, Slip::Late] {
        for later_ms in [0, 1, 5, 12, 20, 30, 45] {
            hidden_by(slip, later_ms, hiding);
        }
    }
}

#[test]
fn words_behind_a_slip_are_told_when_another_reset_of_the_axis_comes_first() {
    at_any_time(|rig| rig.inject(1, Fault::DrdyStops));
    at_any_time(|rig| rig.inject(1, Fault::BusError));
    at_any_time(|rig| rig.inject(1, Fault::BrownOut));
}

#[test]
fn words_behind_a_slip_are_told_when_the_common_sync_comes_first() {
    // Z recovers a fixed time after its fault; the slip of Y falls anywhere ahead of it.
    for slip in [Slip::Early, Slip::Late] {
        for before_ms in [1, 3, 10, 30, 60, 70, 72, 74, 76, 80] {
            let bench = bench(AROUND_ZERO);
            let mut rig = Rig::new(&bench);
            rig.start();
            rig.run_ms(300);
            rig.inject(2, Fault::DrdyStops);
            rig.run_ms(before_ms);
            rig.inject(1, Fault::Slip(slip));
            rig.run_ms(1500);
            assert_eq!(rig.wrong_and_not_told(), [], "{slip:?}, {before_ms} ms");
            assert!(rig.recoveries() >= 2, "{:?}", rig.events);
        }
    }
}

#[test]
fn words_behind_a_slip_are_told_when_the_stream_ends_first() {
    at_any_time(|rig| {
        assert_eq!(rig.ask(Request::Stop), Ok(Answer::Done));
        // Whoever has the reply has all that there is to know.
        let told = rig.troubles(1);
        assert!(
            matches!(told[..], [Trouble::Misaligned | Trouble::Slipped { .. }]),
            "{told:?}"
        );
    });
}

#[test]
fn words_behind_a_slip_are_told_when_the_board_is_held_up() {
    at_any_time(|rig| rig.bench.advance_ps(100 * 500_000_000));
    at_any_time(|rig| rig.bench.advance_ps(20 * 500_000_000));
}

#[test]
fn a_slip_is_noticed_within_the_time_that_is_said() {
    for rate in Rate::ALL {
        for axis in 0..3 {
            let bench = bench(AROUND_ZERO);
            let mut rig = Rig::new(&bench);
            rig.configure(settings(rate, inm_protocol::Phase::Linear, None));
            rig.start();
            rig.run_ms(500);
            rig.inject(axis, Fault::Slip(Slip::Early));
            rig.run_until(3000, "recovery", |rig| rig.recoveries() > 0);
            rig.run_ms(100);
            assert_eq!(rig.wrong_and_not_told(), [], "{rate:?} axis {axis}");
        }
    }
}

/// The silence of the settling ends a slip in it with the first clock, which spoils one word.
#[test]
fn a_slip_while_the_filters_fill_spoils_no_word() {
    for slip in [Slip::Early, Slip::Late] {
        for after_ms in (40..110).step_by(2) {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            rig.start();
            rig.run_ms(300);
            rig.inject(0, Fault::DrdyStops);
            rig.run_ms(after_ms);
            rig.inject(0, Fault::Slip(slip));
            rig.inject(1, Fault::Slip(slip));
            rig.run_ms(1500);
            assert_eq!(rig.wrong_and_not_told(), [], "{slip:?} {after_ms} ms");
        }
    }
}

/// A brown-out at the settings of the reset shows in no register. While the filters fill it shows in
/// nothing but the moment of the first word.
#[test]
fn a_brown_out_while_the_filters_fill_leaves_no_axis_out_of_step() {
    for axis in 0..2 {
        for after_ms in 140..230 {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            rig.configure(settings(Rate::Sps1000, inm_protocol::Phase::Linear, None));
            rig.start();
            rig.run_ms(100);
            rig.inject(2, Fault::BusError);
            rig.run_ms(after_ms);
            rig.inject(axis, Fault::BrownOut);
            rig.run_ms(1500);
            assert_eq!(rig.wrong_and_not_told(), [], "axis {axis}, {after_ms} ms");
            assert!(rig.recoveries() >= 2, "{:?}", rig.events);
        }
    }
}

/// The rest is what ends a slip: RESET alone is not understood. How long it has to be is the
/// converter's, and not the driver's constant.
#[test]
fn a_slipped_converter_is_left_without_a_clock_for_64_periods_before_its_reset() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(300);
    rig.inject(1, Fault::Slip(Slip::Early));
    rig.run_until(3000, "recovery", |rig| rig.recoveries() > 0);
    let [noticed, .., recovered] = &rig.events[..] else {
        panic!("{:?}", rig.events);
    };
    assert_eq!(rig.events.len(), 2, "one attempt: {:?}", rig.events);
    assert!(recovered.index - noticed.index >= 64 + 63 + 63);
}

/// Reading goes on by the next axis that runs.
#[test]
fn x_without_drdy_costs_y_and_z_nothing_but_the_notice() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(300);
    let before = rig.received().len();
    // Dead for ten seconds of 2000/s, whatever is done about it.
    let end_ps = rig.bench.now_ps() + 10_000_000_000_000;
    while rig.bench.now_ps() < end_ps {
        rig.inject(0, Fault::DrdyStops);
        rig.step();
    }
    let received = rig.proven();
    let arrived = received.len() - before;
    // A batch more or less is on its way.
    assert!((19_950..=20_033).contains(&arrived), "{arrived} of 20000");
    let good = received[before + 1..]
        .iter()
        .filter(|conversion| conversion.flags[1].is_none() && conversion.flags[2].is_none());
    assert!(good.count() + 5 >= arrived);
    // X comes back as any other axis does.
    rig.run_until(12_000, "recovery", |rig| rig.recoveries() > 0);
    rig.run_ms(500);
    let received = rig.proven();
    let last = &received[received.len() - 500..];
    assert!(last.iter().all(|c| c.flags.iter().all(|f| f.is_none())));
    assert_eq!(rig.bench.violation(), None);
}

/// X restarts within a period after SYNC, and its first edge is late by less than that: its words and
/// those of the others are not of the same moment, and no register tells.
#[test]
fn a_brown_out_right_behind_the_sync_leaves_no_axis_out_of_step() {
    for later_us in (100..1000).step_by(100) {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        rig.configure(settings(Rate::Sps1000, inm_protocol::Phase::Linear, None));
        rig.start();
        rig.run_ms(500);
        rig.inject(2, Fault::BusError);
        // X has no edge behind it only after SYNC.
        rig.run_until(3000, "SYNC", |rig| rig.bench.last_edge_ps(0).is_none());
        rig.bench.advance_ps(later_us * 1_000_000);
        rig.inject(0, Fault::BrownOut);
        rig.run_ms(1500);
        assert_eq!(rig.wrong_and_not_told(), [], "{later_us} us");
        assert!(rig.recoveries() >= 2, "{later_us} us: {:?}", rig.events);
    }
}
