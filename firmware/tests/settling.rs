//! The time in which the filters fill, during which no DRDY wakes a sleeping board.

mod rig;

use inm_emulator::{Fault, Slip};
use inm_protocol::{Phase, Rate, Request};
use rig::{Noisy, OFFSETS, Rig, bench, settings};

const PS_PER_US: u64 = 1_000_000;

/// The heartbeat of the images: without an edge the loop sleeps up to the next.
const HEARTBEAT_PS: u64 = 1000 * PS_PER_US;

/// Steps as the images do, asleep whenever there is nothing to do: an edge of X or the heartbeat
/// wakes. Returns the edges that were the first after a restart of the converter, picoseconds.
fn run_asleep(rig: &mut Rig<'_, Noisy>, ms: u64, phase_ps: u64) -> Vec<u64> {
    let mut first_edges = Vec::new();
    let mut before = rig.bench.last_edge_ps(0);
    let end_ps = rig.bench.now_ps() + ms * 1000 * PS_PER_US;
    while rig.bench.now_ps() < end_ps {
        rig.step();
        let beats = (rig.bench.now_ps() + HEARTBEAT_PS - phase_ps) / HEARTBEAT_PS;
        let edge = rig.bench.last_edge_ps(0);
        if edge == before {
            rig.bench.run_until_edge(0, beats * HEARTBEAT_PS + phase_ps);
        }
        let edge = rig.bench.last_edge_ps(0);
        first_edges.extend(edge.filter(|_| before.is_none()));
        before = edge;
    }
    first_edges
}

#[test]
fn a_board_that_sleeps_between_heartbeats_starts_with_the_first_word() {
    for rate in Rate::ALL {
        for phase_us in (0..1000).step_by(125) {
            let bench = bench(OFFSETS);
            let mut rig = Rig::new(&bench);
            rig.configure(settings(rate, Phase::Linear, None));
            rig.send(Request::Start);
            // As far as SYNC on one phase of the heartbeat, which alone would always meet the same.
            run_asleep(&mut rig, 6, 0);
            let first_edges = run_asleep(&mut rig, 500, phase_us * PS_PER_US);
            let (_, answer) = rig.replies.last().expect("it has answered");
            assert!(answer.is_ok(), "{rate:?}, {phase_us} us: {answer:?}");
            assert_eq!(rig.events, [], "{rate:?}, {phase_us} us");
            let first = rig.proven()[0];
            let edge = first_edges.last().map(|edge_ps| edge_ps / PS_PER_US);
            assert_eq!(
                (first.index, Some(first.stamp)),
                (0, edge),
                "{rate:?}, {phase_us} us"
            );
        }
    }
}

/// A board that stands still so long that the first word comes before the converters were looked at
/// begins anew: it neither refuses the start nor takes words that nothing proves.
#[test]
fn a_board_held_up_while_the_filters_fill_starts_all_the_same() {
    for slip in [None, Some(Slip::Early), Some(Slip::Late)] {
        // The filters are full after 63.5 periods; the reset and the configuration come before.
        for held_up in [5, 15, 30, 55, 60, 62, 63, 64, 65, 80, 200] {
            for at in [4, 10, 20, 40, 50, 60] {
                let bench = bench([0; 3]);
                let mut rig = Rig::new(&bench);
                let period_ps = 250 * PS_PER_US;
                rig.configure(settings(Rate::Sps4000, Phase::Linear, None));
                rig.send(Request::Start);
                rig.run_ms(4);
                let until_ps = bench.now_ps() + at * period_ps;
                while bench.now_ps() < until_ps {
                    rig.step();
                }
                if let Some(slip) = slip {
                    rig.inject(1, Fault::Slip(slip));
                }
                bench.advance_ps(held_up * period_ps);
                rig.run_ms(2000);
                let what = format!("{slip:?}, at {at} for {held_up} periods");
                let (_, answer) = rig.replies.last().expect("it has answered");
                assert!(answer.is_ok(), "{what}: {answer:?}");
                assert_eq!(rig.wrong_and_not_told(), [], "{what}");
                let good = rig.proven_but(|index, _| index < 400);
                assert!(good.len() > 2000, "{what}: {}", good.len());
            }
        }
    }
}
