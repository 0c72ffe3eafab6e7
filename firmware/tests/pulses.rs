//! A pulse a second at the board's input: told with its time, whatever else the board does, at no cost to the samples.

mod rig;

use inm_protocol::{PulseCounters, Rate, Settings};
use rig::{OFFSETS, Rig, bench};

const PS_PER_MS: u64 = 1_000_000_000;

/// Runs until `until_ms` of virtual time, with edges at these times, microseconds.
fn run(rig: &mut Rig<'_, rig::Noisy>, until_ms: u64, edges_us: &[u64]) {
    let mut edges = edges_us.iter().copied().peekable();
    while rig.bench.now_ps() < until_ms * PS_PER_MS {
        let now_us = rig.bench.now_ps() / 1_000_000;
        while let Some(at_us) = edges.next_if(|&at_us| at_us <= now_us) {
            rig.link().pulse(at_us * 1_000_000);
        }
        rig.step();
    }
}

#[test]
fn a_board_at_rest_tells_each_pulse_with_its_time() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    let edges = [400_123, 1_400_124, 2_400_126];
    run(&mut rig, 3000, &edges);
    let stamps: Vec<u64> = rig.pulses.iter().map(|pulse| pulse.stamp).collect();
    assert_eq!(stamps, edges);
    let last = rig.pulses[2];
    assert_eq!((last.number, last.doubled), (3, false));
    assert_eq!(last.counters, PulseCounters::default());
}

#[test]
fn an_echo_a_double_edge_and_a_pulse_that_is_missing_are_counted() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    // An echo, seen by itself; two at once; two seconds without; one that is no whole second behind.
    let edges = [
        400_000, 410_000, 1_400_000, 1_400_001, 4_400_000, 5_000_000, 6_000_000,
    ];
    run(&mut rig, 6500, &edges);
    let stamps: Vec<u64> = rig.pulses.iter().map(|pulse| pulse.stamp).collect();
    assert_eq!(
        stamps,
        [400_000, 1_400_001, 4_400_000, 5_000_000, 6_000_000]
    );
    let doubled: Vec<bool> = rig.pulses.iter().map(|pulse| pulse.doubled).collect();
    assert_eq!(doubled, [false, true, false, false, false]);
    let expected = PulseCounters {
        early: 1,
        doubled: 1,
        missing: 2,
        odd: 1,
    };
    assert_eq!(rig.pulses[4].counters, expected);
}

/// At the fastest rate as well, with an input that moves all the time.
#[test]
fn pulses_and_noise_at_the_input_cost_no_conversion() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::with_baud(&bench, Some(921_600));
    let settings = Settings {
        rate: Rate::Sps4000,
        ..Settings::default()
    };
    run(&mut rig, 100, &[]);
    rig.configure(settings);
    rig.start();
    let from_ms = rig.bench.now_ps() / PS_PER_MS + 1;
    // An edge each 0.3 ms for three seconds.
    let edges: Vec<u64> = (0..10_000).map(|k| from_ms * 1000 + 300 * k).collect();
    run(&mut rig, from_ms + 3000, &edges);
    // Half a second lies between two that are told.
    assert!((5..=7).contains(&rig.pulses.len()), "{:?}", rig.pulses);
    let counters = rig.pulses.last().expect("some").counters;
    assert!(counters.early > 4000, "{counters:?}");
    let gaps = rig.batches.windows(2);
    assert!(rig.batches.len() > 300, "{}", rig.batches.len());
    assert!(gaps.into_iter().all(|two| two[0].end() == two[1].first));
    let health = rig.health.last().expect("once a second");
    assert_eq!(health.lost_conversions, 0);
    assert_eq!(health.link.frames_dropped, 0);
}
