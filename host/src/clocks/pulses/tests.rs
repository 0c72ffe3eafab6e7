//! The estimator against pulses whose truth is drawn: a crystal that is off, a receiver that jitters and misses some.

use rand_distr::{Distribution, Normal, Uniform};
use rand_pcg::Pcg64;

use super::*;
use crate::model::Seed;
use crate::model::random::random;

/// Ticks a second of the board's timer.
const TIMER_HZ: u32 = 84_000_000;

const RUNS: u64 = 1000;

/// 4 standard errors of a share of 95 % in so many runs: one share of 16 000 lies further off.
fn tolerance() -> f64 {
    4.0 * (0.95 * 0.05 / RUNS as f64).sqrt()
}

/// What is drawn of a record.
struct Drawn {
    ppm: f64,
    /// Seconds, standard deviation.
    jitter_s: f64,
    /// Share of the pulses that is missing.
    missing: f64,
    random: Pcg64,
}

fn within(random: &mut Pcg64, from: f64, to: f64) -> f64 {
    Uniform::new(from, to).expect("a range").sample(random)
}

fn drawn(seed: u64) -> Drawn {
    let mut random = random(Seed { seed, stream: 12 });
    Drawn {
        ppm: within(&mut random, -200.0, 200.0),
        // Ten ticks to a thousand: rounding is little beside it.
        jitter_s: 1.2e-7 * 10_f64.powf(within(&mut random, 0.0, 2.0)),
        missing: within(&mut random, 0.0, 0.3),
        random,
    }
}

fn pulse(stamp: u64) -> Pulse {
    Pulse {
        stamp,
        ..Pulse::default()
    }
}

/// The stamp of second `k` and so much, by a clock that is `ppm` fast and began before.
fn stamp(second: f64, ppm: f64) -> u64 {
    let ticks = (second + 3.7) * (1.0 + 1e-6 * ppm) * f64::from(TIMER_HZ);
    ticks as u64
}

/// A record of `seconds`; `common` of the variance of the jitter is shared by pulses for a while.
fn record(drawn: &mut Drawn, seconds: u32, common: f64) -> Pulses {
    let mut pulses = Pulses::default();
    let law = Normal::new(0.0, drawn.jitter_s).expect("a spread");
    // Half of it is left a second later: a receiver's tick drifts past the second within some.
    let (mut shared, left) = (law.sample(&mut drawn.random), 0.5_f64);
    for second in 0..seconds {
        shared = left * shared + (1.0 - left * left).sqrt() * law.sample(&mut drawn.random);
        let alone = law.sample(&mut drawn.random);
        let late_s = common.sqrt() * shared + (1.0 - common).sqrt() * alone;
        if within(&mut drawn.random, 0.0, 1.0) >= drawn.missing {
            let at = stamp(f64::from(second) + late_s, drawn.ppm);
            pulses.push(&pulse(at), TIMER_HZ);
        }
    }
    pulses
}

fn holds(pulses: &Pulses, ppm: f64) -> bool {
    let ratio = pulses.ratio().expect("enough");
    let half = ratio.half_95().expect("an interval");
    (ratio.value - 1.0 - 1e-6 * ppm).abs() < half
}

/// Share of the runs whose interval holds the truth, of records of some `seconds`.
fn share_held(seconds: u32, record: impl Fn(&mut Drawn) -> Pulses) -> f64 {
    let held = (0..RUNS).filter(|&seed| {
        let mut drawn = drawn(seed);
        let pulses = record(&mut drawn);
        holds(&pulses, drawn.ppm)
    });
    let share = held.count() as f64 / RUNS as f64;
    println!("{seconds} s: {share}, seeds 0..{RUNS}");
    share
}

/// The interval of records of some `seconds` holds the truth no less often than it says.
#[track_caller]
fn assert_held(seconds: u32, record: impl Fn(&mut Drawn) -> Pulses) {
    let share = share_held(seconds, record);
    assert!(share > 0.95 - tolerance(), "{seconds} s: {share}");
}

/// As often as it says, and no oftener: by single pulses, and by stretches.
#[test]
fn the_interval_holds_the_crystal_as_often_as_it_says() {
    for seconds in [20, 60, 600, 6000] {
        let share = share_held(seconds, |drawn| record(drawn, seconds, 0.0));
        let off = (share - 0.95).abs();
        assert!(off < tolerance(), "{seconds} s: {share}, seeds 0..{RUNS}");
    }
}

/// What neighbours have in common would make single pulses too sure: a stretch of some tens of them is as sure as its
/// mean shows.
#[test]
fn jitter_that_neighbours_share_is_in_the_interval() {
    for seconds in [600, 6000] {
        assert_held(seconds, |drawn| record(drawn, seconds, 1.0));
    }
}

/// A receiver without jitter: what is left is rounding, which a clock drifts past in step.
#[test]
fn rounding_to_a_tick_is_in_the_interval() {
    for seconds in [60, 600] {
        assert_held(seconds, |drawn| {
            (drawn.jitter_s, drawn.missing) = (0.0, 0.0);
            // Less than a tick over all of it, to some ticks a second.
            drawn.ppm *= 10_f64.powf(within(&mut drawn.random, -6.0, 0.0));
            record(drawn, seconds, 0.0)
        });
    }
}

/// Ten hours: pulses become means, and nothing is lost by it.
#[test]
fn ten_hours_take_no_more_memory_than_two() {
    let mut drawn = drawn(3);
    let pulses = record(&mut drawn, 36_000, 0.0);
    assert!(pulses.now.readings.len() <= MOST);
    let ratio = pulses.ratio().expect("enough");
    // That of a slope through so many, to the spread of ten degrees of freedom.
    let number = 36_000.0 * (1.0 - drawn.missing);
    let expected = drawn.jitter_s * (12.0 / number).sqrt() / 36_000.0;
    assert!((0.3..2.0).contains(&(ratio.sd / expected)), "{ratio:?}");
    assert!(holds(&pulses, drawn.ppm), "{ratio:?}");
}

/// The chip's own oscillator, 1 % off, and a receiver that finds nothing for minutes: seconds are counted on.
#[test]
fn seconds_are_counted_over_gaps_on_a_clock_that_is_far_off() {
    for ppm in [-10_000.0, 10_000.0] {
        let mut pulses = Pulses::default();
        for second in (0..30).chain(200..230).chain(380..400) {
            pulses.push(&pulse(stamp(f64::from(second), ppm)), TIMER_HZ);
        }
        assert_eq!(pulses.now.seconds(), 399, "{ppm}");
        let ratio = pulses.ratio().expect("enough");
        assert!((1e6 * (ratio.value - 1.0) - ppm).abs() < 1e-3, "{ratio:?}");
    }
}

/// At first, in the middle, and one that begins a run of its own.
#[test]
fn a_disturbance_is_no_pulse_and_a_receiver_that_steps_begins_anew() {
    let at = |second: f64| pulse(stamp(second, 80.0));
    let mut pulses = Pulses::default();
    let first = [0.3, 1.0, 2.0, 3.0, 3.6, 4.0, 5.0, 5.4, 6.0, 7.0, 8.0];
    for second in first {
        pulses.push(&at(second), TIMER_HZ);
    }
    assert_eq!((pulses.now.seconds(), pulses.now.pulses), (7, 8));
    // A second source between them, once a second: neither takes the other's place.
    for second in 9..15 {
        pulses.push(&at(f64::from(second)), TIMER_HZ);
        pulses.push(&at(f64::from(second) + 0.6), TIMER_HZ);
    }
    assert_eq!((pulses.now.seconds(), pulses.now.pulses), (13, 14));
    // The receiver steps, and the longer run counts.
    for second in 0..40 {
        pulses.push(&at(16.25 + f64::from(second)), TIMER_HZ);
    }
    assert_eq!((pulses.longest.seconds(), pulses.now.seconds()), (13, 39));
    let ratio = pulses.ratio().expect("enough");
    assert!((1e6 * (ratio.value - 1.0) - 80.0).abs() < 1e-3, "{ratio:?}");
}

#[test]
fn of_a_board_that_restarted_the_longest_life_counts() {
    let mut pulses = Pulses::default();
    for (seconds, ppm) in [(300, -70.0), (20, 40.0)] {
        for second in 0..seconds {
            pulses.push(&pulse(stamp(f64::from(second), ppm)), TIMER_HZ);
        }
    }
    let ratio = pulses.ratio().expect("enough");
    assert!((1e6 * (ratio.value - 1.0) + 70.0).abs() < 1e-3, "{ratio:?}");
}

#[test]
fn too_few_and_doubled_ones_say_nothing() {
    let mut pulses = Pulses::default();
    for second in 0..FEWEST {
        assert_eq!(pulses.ratio(), None);
        let at = stamp(second as f64, 0.0);
        let doubled = Pulse {
            doubled: true,
            ..pulse(at + 1000)
        };
        pulses.push(&pulse(at), TIMER_HZ);
        pulses.push(&doubled, TIMER_HZ);
    }
    assert!(pulses.ratio().is_some());
    assert_eq!(pulses.now.pulses, FEWEST as u64);
}

/// Any stamps, as a damaged capture may hold them.
#[test]
fn no_stamp_is_too_odd() {
    for timer_hz in [0, 1, TIMER_HZ, u32::MAX] {
        let mut pulses = Pulses::default();
        for k in 0..3_u64 {
            for stamp in [0, 1, u64::MAX, 5, u64::MAX / 2, u64::MAX - 1] {
                pulses.push(&pulse(stamp.wrapping_add(k)), timer_hz);
            }
        }
        let _ = pulses.ratio();
    }
}

#[test]
fn what_was_told_is_counted_since_the_record_began() {
    let mut pulses = Pulses::default();
    let told = |number: u32, missing: u32| Pulse {
        stamp: u64::from(number) * 84_000_000,
        number,
        counters: PulseCounters {
            missing,
            ..PulseCounters::default()
        },
        ..Pulse::default()
    };
    assert_eq!(pulses.tally(), None);
    for (number, missing) in [(10, 4), (11, 4), (13, 6), (1, 1), (2, 2)] {
        pulses.push(&told(number, missing), TIMER_HZ);
    }
    let tally = pulses.tally().expect("some came");
    assert_eq!(
        (tally.arrived, tally.lost, tally.counters.missing),
        (5, 1, 3)
    );
}
