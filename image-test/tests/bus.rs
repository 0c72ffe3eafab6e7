//! The converters' buses: the gap after the bytes of a command, and the order in which an edge is taken.

use inm_emulator::time::{COMMAND_GAP_PS, SHORTEST_SCLK_PS};
use inm_image_test::chip::EXTI4;
use inm_image_test::chip::core::FIRST_INTERRUPT;
use inm_image_test::machine::{Machine, PS_PER_MS, PS_PER_S, Talk};
use inm_protocol::Request;

/// A gap takes no longer than this: the driver's 6 us, its waiting for a tick, and the calls around it. A
/// longer one would do no harm, but then the test did not see what it should.
const LONGEST_SHORTEST_GAP_PS: u64 = 10_000_000;

/// 24/fCLK after every byte of a command, to the bit (SBAS378D, page 30). The emulated converters hold the
/// image to it in all commands; here it is measured for those that are no zeros.
#[test]
fn the_gap_after_a_byte_of_a_command_is_kept() {
    let mut machine = Machine::started(true);
    machine.chip_mut().board.bytes = Some(Vec::new());
    let mut talk = Talk::default();
    for request in [
        Request::ReadRegisters,
        Request::CalibrateOffset,
        Request::Start,
        Request::ReadRegisters,
        Request::Stop,
    ] {
        let answer = talk.ask(&mut machine, request);
        assert!(answer.is_ok(), "{request:?}: {answer:?}");
        machine.run(50 * PS_PER_MS);
    }
    let chip = machine.chip();
    assert_eq!(chip.board.bench.violation(), None);
    let bytes = chip.board.bytes.as_ref().expect("they were asked for");
    for axis in 0..3 {
        let of_axis: Vec<_> = bytes.iter().filter(|byte| byte.axis == axis).collect();
        assert!(of_axis.iter().all(|byte| byte.bit_ps > SHORTEST_SCLK_PS));
        let commands = of_axis.windows(2).filter(|pair| pair[0].din != 0);
        let gaps = commands.map(|pair| pair[0].gap_ps(pair[1]));
        let shortest_ps = gaps.min().expect("there were commands");
        println!("axis {axis}: {} ns", shortest_ps / 1000);
        let allowed = COMMAND_GAP_PS..LONGEST_SHORTEST_GAP_PS;
        assert!(allowed.contains(&shortest_ps), "{shortest_ps} ps");
    }
}

/// An edge that comes while the handler stamps the one before asks for the interrupt again: the handler
/// clears what is pending first. The other way round it would go unseen.
#[test]
fn an_edge_during_its_handler_is_not_lost() {
    let mut machine = Machine::started(true);
    // Of the edges that fell before it listened, those ahead of its set-up were nobody's.
    let seen = |machine: &Machine| {
        let chip = machine.chip();
        (chip.core.entered[FIRST_INTERRUPT + EXTI4], chip.edges[0])
    };
    let before = seen(&machine);
    let mut talk = Talk::default();
    let started = talk.ask(&mut machine, Request::Start);
    assert!(started.is_ok(), "{started:?}");
    machine.chip_mut().edge_at_next_stamp = true;
    machine.run(PS_PER_S / 10);
    assert!(!machine.chip().edge_at_next_stamp, "it came");
    let after = seen(&machine);
    let (entered, edges) = (after.0 - before.0, after.1 - before.1);
    assert!(entered > 100, "{entered} edges");
    assert_eq!(entered, edges);
}
