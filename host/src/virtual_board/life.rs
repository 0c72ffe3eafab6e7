//! The lives of a board, from power on to the restart that ends each, with what happens to it on the way.

use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use inm_emulator::{Bench, Converter};
use inm_firmware::emulated::{VirtualBoard, VirtualLink, describe};
use inm_firmware::update::{Slots, start};
use inm_firmware::{Board, Instrument};
use inm_protocol::slot::{BLANK, PROVED};
use inm_protocol::{AXES, Hello, Restart, SensorRange};

use super::line::{Line, PARCEL, Parcel};
use super::loading::{flash, listen};
use super::pulses::Pulses;
use super::shaken::{Pins, Shaken};
use super::witness::{note_by_axis, note_words};
use super::{Misfortune, VirtualConnect};
use crate::link::Clock;

/// What the board calls itself.
const PLATFORM: &str = "virtual";

/// Transmit queue of the board, bytes; that of the image.
const QUEUE: usize = 4096;

/// Steps of the instrument after which a parcel leaves, empty or not: 50 ms of a board at rest, of
/// one that streams some 100 conversions. Much work compared with handing it over, and no long wait.
const STEPS: u32 = 200;

/// How long a program that hangs is left alone, in real time: the watchdog of the image has a second.
const HUNG: Duration = Duration::from_millis(200);

/// Runs the board until the host is gone.
pub(super) fn power_on(plan: &VirtualConnect, line: &mut Line) {
    let mut restart = Restart::Power;
    let mut misfortunes = plan.restarts.iter();
    let mut loader_asked = false;
    loop {
        let starts = match std::mem::take(&mut loader_asked) {
            true => None,
            false => start(&mut *flash(plan)),
        };
        let Some(slot) = starts else {
            let hello = Hello {
                serial: plan.serial,
                // Cannot fail: both are short.
                firmware: env!("CARGO_PKG_VERSION").try_into().unwrap_or_default(),
                platform: PLATFORM.try_into().unwrap_or_default(),
                ..Hello::default()
            };
            match listen(plan, hello, line) {
                Some(()) => continue,
                None => return,
            }
        };
        if plan.hangs == Some(slot) {
            // Until its watchdog bites.
            stay_dark(HUNG, &plan.clock);
            restart = Restart::Watchdog;
            continue;
        }
        let pins = Arc::default();
        let bench = Bench::new(plan.sensors(&pins).map(Converter::new));
        let described = describe(PLATFORM);
        let board = Board {
            restart,
            serial: plan.serial,
            timer_hz: plan.off.said_hz(described.timer_hz),
            ..described
        };
        let mut instrument =
            VirtualBoard::instrument(&bench, VirtualLink::new(Some(plan.baud)), board);
        let flash = instrument.platform_mut().flash_mut();
        flash.clone_from(&plan.kept.lock().unwrap_or_else(PoisonError::into_inner));
        let misfortune = misfortunes.as_slice().first();
        restart = match run(instrument, plan, slot, &pins, misfortune, line) {
            Some(End::Command) => Restart::Command,
            Some(End::Loader) => {
                loader_asked = true;
                Restart::Command
            }
            Some(End::Misfortune(Misfortune { cause, dark, .. })) => {
                misfortunes.next();
                stay_dark(*dark, &plan.clock);
                cause.clone()
            }
            None => return,
        };
    }
}

/// Nothing comes through the port for so long.
fn stay_dark(dark: Duration, clock: &Clock) {
    let until = Instant::now() + dark;
    while Instant::now() < until {
        thread::sleep(PARCEL);
        clock.pass(PARCEL);
    }
}

type Running<'b> = Instrument<VirtualBoard<'b, Shaken, VirtualLink<QUEUE>>>;

/// How a life of the board ended.
enum End<'p> {
    /// The host asked for it.
    Command,
    /// The host asked for the loader.
    Loader,
    /// Nobody did.
    Misfortune(&'p Misfortune),
}

/// Runs one life of the board: until it restarts, or the host is gone (`None`).
fn run<'p>(
    mut instrument: Running<'_>,
    plan: &VirtualConnect,
    slot: usize,
    pins: &Pins,
    misfortune: Option<&'p Misfortune>,
    line: &mut Line,
) -> Option<End<'p>> {
    let started = Instant::now();
    let mut parcel = Parcel::default();
    let mut steps = 0;
    let mut words = 0;
    let mut noted = [0; AXES];
    let mut faults = &plan.faults[..];
    let mut streams_from = None;
    let mut pulses = plan.receiver.map(|one| Pulses::new(one, plan.off.pace()));
    loop {
        let now_ps = instrument.platform().bench().now_ps();
        while let Some(at_ps) = pulses.as_mut().and_then(|pulses| pulses.due(now_ps)) {
            instrument.platform_mut().environment_mut().pulse(at_ps);
        }
        instrument.step();
        steps += 1;
        let bench = instrument.platform().bench();
        if !faults.is_empty() && instrument.is_streaming() {
            for &(axis, word, fault) in std::mem::take(&mut faults) {
                bench.inject_at(axis, bench.sent(axis).words() + word, fault);
            }
        }
        if let Some(misfortune) = misfortune.filter(|_| instrument.is_streaming()) {
            let words = bench.sent(0).words();
            if words - *streams_from.get_or_insert(words) >= misfortune.words {
                return Some(End::Misfortune(misfortune));
            }
        }
        if let Some(witness) = &plan.witness {
            note_words(bench, &mut words, witness);
        }
        if let Some(witness) = &plan.axis_witness {
            note_by_axis(bench, &mut noted, witness);
        }
        let now_ps = bench.now_ps();
        let link = instrument.platform_mut().environment_mut();
        pins.self_test
            .store(link.self_test_is_on(), Ordering::Relaxed);
        let coarse = link.range() == SensorRange::G12;
        pins.coarse.store(coarse, Ordering::Relaxed);
        link.take(now_ps, |byte| parcel.push(byte, now_ps));
        parcel.at_ps = now_ps;
        let (restarts, loader) = (link.restarts() > 0, link.loader_is_asked_for());
        if restarts || loader {
            keep(&mut instrument, slot, plan);
            // Its reply is on the line by then. What the host writes meanwhile finds nobody.
            line.exchange(parcel)?;
            return Some(if loader { End::Loader } else { End::Command });
        }
        if steps < STEPS {
            continue;
        }
        steps = 0;
        keep(&mut instrument, slot, plan);
        let link = instrument.platform_mut().environment_mut();
        link.send(&line.exchange(std::mem::take(&mut parcel))?);
        keep_pace(started, now_ps, plan.speed);
    }
}

/// What the board keeps stays when it is off.
fn keep(instrument: &mut Running<'_>, slot: usize, plan: &VirtualConnect) {
    let board = instrument.platform_mut();
    if board.environment().program_has_proved() && flash(plan).read(slot, PROVED) == BLANK {
        // Power stays on, and a word that is not written is tried again.
        let _ = flash(plan).write(slot, PROVED, 0);
    }
    let flash = board.flash_mut();
    let mut kept = plan.kept.lock().unwrap_or_else(PoisonError::into_inner);
    if *kept != *flash {
        kept.clone_from(flash);
    }
}

/// Sleeps until real time has come to where virtual time is.
fn keep_pace(started: Instant, now_ps: u64, speed: f64) {
    if speed > 0.0 {
        let due = Duration::from_secs_f64(now_ps as f64 * 1e-12 / speed);
        thread::sleep(due.saturating_sub(started.elapsed()));
    }
}
