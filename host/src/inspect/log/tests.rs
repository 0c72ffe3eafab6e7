use std::time::Instant;

use inm_protocol::{REGISTERS, Trouble};

use super::*;

const TIMER_HZ: u32 = 1_000_000;

fn heard(message: ToHost) -> Heard {
    Heard {
        at: Instant::now(),
        message,
    }
}

fn health(second: u64) -> Health {
    Health {
        stamp: second * u64::from(TIMER_HZ),
        index: 0,
        streaming: false,
        mcu_centi_celsius: None,
        supply_mv: None,
        registers: [[0; REGISTERS]; AXES],
        axes: [AxisCounters::default(); AXES],
        link: LinkCounters::default(),
        lost_conversions: 0,
        stack_used: 0,
        stack_size: 0,
        bins: None,
        stream: 0,
    }
}

fn said(log: &mut Log, message: ToHost) -> Vec<String> {
    let entries = log.take(&heard(message));
    let line = |entry: Entry| format!("{} {}", entry.axis.as_deref().unwrap_or("-"), entry.what);
    entries.into_iter().map(line).collect()
}

#[test]
fn counters_are_told_once_and_then_only_what_they_grow_by() {
    let mut log = Log::new(TIMER_HZ);
    let mut record = health(5);
    record.axes[1].over_range = 3;
    record.link.frames_bad = 1;
    let first = said(&mut log, ToHost::Health(record));
    assert_eq!(
        first,
        [
            "Y 3 words clipped by the converter since it started",
            "- 1 frames from the host that the board could not decode since it started"
        ]
    );
    record.stamp += u64::from(TIMER_HZ);
    assert!(said(&mut log, ToHost::Health(record)).is_empty());
    record.axes[1].over_range = 10;
    let grown = said(&mut log, ToHost::Health(record));
    assert_eq!(grown, ["Y 7 words clipped by the converter"]);
}

#[test]
fn a_reset_is_told_by_its_event_or_by_its_counter_and_never_by_both() {
    let mut log = Log::new(TIMER_HZ);
    assert!(said(&mut log, ToHost::Health(health(1))).is_empty());
    let event = Event {
        index: 77,
        axis: Some(2),
        trouble: Trouble::Stalled,
        stream: 1,
    };
    let entries = log.take(&heard(ToHost::Event(event)));
    assert_eq!(entries[0].conversion, Some(77));
    assert_eq!(entries[0].axis.as_deref(), Some("Z"));
    assert_eq!(entries[0].up_s, Some(1.0));
    let mut record = health(2);
    record.axes[2].stalled = 1;
    assert!(said(&mut log, ToHost::Health(record)).is_empty());
    record.stamp += 1;
    record.axes[2].stuck = 1;
    let lost = said(&mut log, ToHost::Health(record));
    assert_eq!(lost.len(), 1, "{lost:?}");
    assert!(lost[0].contains("without a notice"), "{lost:?}");
}

#[test]
fn a_stamp_that_goes_back_is_a_restart_and_begins_all_counts_anew() {
    let mut log = Log::new(TIMER_HZ);
    let mut record = health(100);
    record.axes[0].torn = 9;
    assert_eq!(said(&mut log, ToHost::Health(record)).len(), 1);
    let mut young = health(1);
    young.axes[0].torn = 2;
    let message = heard(ToHost::Health(young));
    assert!(log.has_restarted(&message));
    let told = log.take(&message);
    assert_eq!(told.len(), 1);
    assert!(told[0].what.starts_with("2 words"), "{told:?}");
    assert!(!log.has_restarted(&heard(ToHost::Health(health(2)))));
}

#[test]
fn what_is_odd_about_a_pulse_a_second_is_told_as_it_grows() {
    let mut log = Log::new(TIMER_HZ);
    let mut pulse = Pulse {
        stamp: 5,
        ..Pulse::default()
    };
    pulse.counters.missing = 2;
    assert_eq!(
        said(&mut log, ToHost::Pulse(pulse)),
        [
            "- a pulse a second comes",
            "- 2 seconds without a pulse since it started"
        ]
    );
    pulse.stamp += u64::from(TIMER_HZ);
    assert!(said(&mut log, ToHost::Pulse(pulse)).is_empty());
    (pulse.counters.early, pulse.counters.doubled) = (3, 1);
    assert_eq!(
        said(&mut log, ToHost::Pulse(pulse)),
        [
            "- 1 pulses of more than one edge",
            "- 3 edges within half a second of a pulse"
        ]
    );
    // A board that has restarted counts from nothing.
    let young = Pulse {
        stamp: 1,
        ..Pulse::default()
    };
    assert_eq!(
        said(&mut log, ToHost::Pulse(young)),
        ["- a pulse a second comes"]
    );
}
