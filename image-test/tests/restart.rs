//! Ways to die, and what the board says of them when it is back.

use inm_image_test::board::Board;
use inm_image_test::chip::rcc::Cause;
use inm_image_test::image::Image;
use inm_image_test::machine::{Machine, PS_PER_MS, PS_PER_S, Talk};
use inm_protocol::{Answer, Request, Restart};

/// Longest from a hang to the bite: what the image asks for, and the rounding of its divider.
const PATIENCE_PS: u64 = PS_PER_S + PS_PER_S / 20;

/// What a restarted board says.
fn reason(machine: &mut Machine) -> Restart {
    machine.run(300 * PS_PER_MS);
    Talk::default().identify(machine).restart
}

/// How long until the chip is reset.
fn time_to_reset_ps(machine: &mut Machine) -> u64 {
    let (before, begin_ps) = (machine.resets.len(), machine.chip().now_ps);
    while machine.resets.len() == before {
        machine.run(10 * PS_PER_MS);
        assert!(machine.chip().now_ps < begin_ps + 2 * PATIENCE_PS, "never");
    }
    machine.chip().now_ps - begin_ps
}

/// A bus that does not answer holds the loop for ever; nobody feeds the watchdog.
#[test]
fn a_loop_that_hangs_is_bitten_and_told() {
    let mut machine = Machine::started(true);
    let mut talk = Talk::default();
    talk.ask(&mut machine, Request::Start).expect("it starts");
    machine.chip_mut().spi[1].stalled = true;
    let took_ps = time_to_reset_ps(&mut machine);
    assert!((PS_PER_S / 2..PATIENCE_PS).contains(&took_ps), "{took_ps}");
    assert_eq!(machine.resets, [Cause::Watchdog]);
    assert_eq!(reason(&mut machine), Restart::Watchdog);
    // And it stays up.
    machine.run(2 * PS_PER_S);
    assert_eq!(machine.resets, [Cause::Watchdog]);
}

/// The core stands still with its crystal; the watchdog runs on an oscillator of its own. Neither reason
/// hides the other.
#[test]
fn a_crystal_that_stops_is_told_with_the_bite_that_it_causes() {
    let mut machine = Machine::started(true);
    machine.chip_mut().set_crystal(false);
    let took_ps = time_to_reset_ps(&mut machine);
    assert!(took_ps < PATIENCE_PS, "{took_ps}");
    assert_eq!(reason(&mut machine), Restart::WatchdogClockFallback);
    assert_eq!(machine.resets, [Cause::Watchdog]);
}

#[test]
fn a_restart_by_command_is_told() {
    let mut machine = Machine::started(true);
    let done = Talk::default().ask(&mut machine, Request::Reset);
    assert_eq!(done, Ok(Answer::Done));
    assert_eq!(reason(&mut machine), Restart::Command);
    assert_eq!(machine.resets, [Cause::Software]);
}

/// A flipped bit in RAM has the start-up code find its peripherals taken, and it panics.
fn panicked(crystal: bool) -> (Machine, u32, String) {
    let image = Image::built();
    let mut machine = Machine::new(&image, Board::new(crystal));
    machine.run_to(image.address("main"));
    machine.poke(image.address("DEVICE_PERIPHERALS"), &[1]);
    let said = reason(&mut machine);
    let (Restart::Panic { line, file } | Restart::PanicClockFallback { line, file }) = &said else {
        panic!("{said:?}");
    };
    assert_eq!(crystal, matches!(said, Restart::Panic { .. }), "{said:?}");
    let file = String::from_utf8_lossy(file).into_owned();
    (machine, *line, file)
}

/// Name and line are those of the source.
#[test]
fn a_panic_is_told_by_its_place() {
    let (mut machine, line, file) = panicked(true);
    assert_eq!(machine.resets, [Cause::Software]);
    assert!(file.ends_with("src/image/mod.rs"), "{file}");
    let source = include_str!("../../firmware/src/image/mod.rs");
    let named = source.lines().nth(line as usize - 1);
    assert!(named.is_some_and(|line| line.contains("started twice")));
    // The next restart has forgotten it.
    let done = Talk::default().ask(&mut machine, Request::Reset);
    assert_eq!(done, Ok(Answer::Done));
    assert_eq!(reason(&mut machine), Restart::Command);
}

#[test]
fn a_panic_on_the_internal_oscillator_is_told_with_it() {
    let (machine, ..) = panicked(false);
    assert_eq!(machine.resets, [Cause::Software]);
}

/// A jump to where there is no memory.
#[test]
fn a_fault_is_told_by_its_address() {
    let mut machine = Machine::started(true);
    machine.jump(0x0900_0000);
    let said = reason(&mut machine);
    let Restart::Panic { line: 0, file } = &said else {
        panic!("{said:?}");
    };
    assert_eq!(String::from_utf8_lossy(file), "hard fault at 09000000");
    assert_eq!(machine.resets, [Cause::Software]);
}
