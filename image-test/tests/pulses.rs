//! A pulse a second at PA0: the timer holds its time, to the tick, however late the program looks.

use inm_image_test::machine::{Machine, PS_PER_MS, PS_PER_S, Talk};
use inm_protocol::{Pulse, PulseCounters, Request, ToHost};

/// Ticks of the timer in a second.
const TIMER_HZ: u64 = 84_000_000;

/// What the board tells of edges at these times from now, microseconds.
fn told(machine: &mut Machine, talk: &mut Talk, edges_us: &[u64]) -> Vec<Pulse> {
    let chip = machine.chip_mut();
    let from_ps = chip.now_ps;
    chip.board.pulses = edges_us.iter().map(|us| from_ps + us * 1_000_000).collect();
    let last_us = edges_us.last().copied().unwrap_or_default();
    machine.run(last_us * 1_000_000 + 20 * PS_PER_MS);
    talk.listen(machine);
    let pulses = talk.heard.iter().filter_map(|message| match message {
        ToHost::Pulse(pulse) => Some(*pulse),
        _ => None,
    });
    pulses.collect()
}

/// Whether stamps are as far apart as edges, to the tick at either end.
fn assert_apart(pulses: &[Pulse], edges_us: &[u64]) {
    assert_eq!(pulses.len(), edges_us.len(), "{pulses:?}");
    for (two, edges) in pulses.windows(2).zip(edges_us.windows(2)) {
        let ticks = two[1].stamp - two[0].stamp;
        let expected = (edges[1] - edges[0]) * TIMER_HZ / 1_000_000;
        assert!(ticks.abs_diff(expected) <= 1, "{ticks} for {expected}");
    }
}

#[test]
fn a_pulse_is_stamped_to_the_tick_at_rest_and_while_samples_stream() {
    let mut machine = Machine::started(true);
    let mut talk = Talk::default();
    // No pulse of a second yet: nothing is told.
    assert_eq!(told(&mut machine, &mut talk, &[]), []);
    let edges_us = [200_003, 1_200_004, 2_200_003];
    let pulses = told(&mut machine, &mut talk, &edges_us);
    assert_apart(&pulses, &edges_us);
    // By the same timer as everything else.
    let health = talk.health(&mut machine);
    let behind = health.stamp - pulses[2].stamp;
    assert!(behind < TIMER_HZ, "{behind} ticks");
    talk.heard.clear();
    talk.ask(&mut machine, Request::Start).expect("it starts");
    let edges_us = [500_000, 1_500_111];
    let pulses = told(&mut machine, &mut talk, &edges_us);
    assert_apart(&pulses, &edges_us);
    assert_eq!(talk.damaged, 0);
    assert_eq!(machine.resets, []);
    assert_eq!(machine.chip().misuse, Default::default());
}

/// Two within a microsecond, an echo, and an input that moves all the time.
#[test]
fn edges_that_are_no_pulse_a_second_are_counted_and_do_no_harm() {
    let mut machine = Machine::started(true);
    let mut talk = Talk::default();
    let pulses = told(
        &mut machine,
        &mut talk,
        &[100_000, 100_001, 130_000, 1_100_000],
    );
    let doubled: Vec<bool> = pulses.iter().map(|pulse| pulse.doubled).collect();
    assert_eq!(doubled, [true, false]);
    let expected = PulseCounters {
        early: 1,
        doubled: 1,
        ..PulseCounters::default()
    };
    assert_eq!(pulses[1].counters, expected);
    talk.heard.clear();
    let noise: Vec<u64> = (0..100_000).map(|k| 600_000 + 10 * k).collect();
    let pulses = told(&mut machine, &mut talk, &noise);
    assert!((2..=3).contains(&pulses.len()), "{pulses:?}");
    assert!(pulses.iter().all(|pulse| pulse.doubled), "{pulses:?}");
    // It listens, and nothing bit.
    talk.identify(&mut machine);
    machine.run(PS_PER_S / 10);
    assert_eq!(machine.resets, []);
    assert_eq!(machine.chip().misuse, Default::default());
}
