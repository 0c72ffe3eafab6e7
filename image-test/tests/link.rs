//! The link: what comes through, and what an open input picks up.

use inm_image_test::machine::{Machine, PS_PER_S, Talk};
use inm_protocol::Restart;

#[test]
fn bytes_pass_at_the_speed_of_the_host() {
    let mut machine = Machine::started(true);
    let mut talk = Talk::default();
    for _ in 0..20 {
        assert_eq!(talk.identify(&mut machine).restart, Restart::Power);
    }
    let health = talk.health(&mut machine);
    assert_eq!((health.link.frames_bad, health.link.bytes_lost), (0, 0));
    assert_eq!(talk.damaged, 0);
    assert_eq!(machine.chip().usart.line.garbled, 0);
}

/// Without a cable the input would be open, and every edge that it picks up would begin a byte.
#[test]
fn nothing_is_received_while_nobody_is_connected() {
    let mut machine = Machine::started(true);
    machine.chip_mut().usart.line.open = true;
    machine.run(2 * PS_PER_S);
    machine.chip_mut().usart.line.open = false;
    let health = Talk::default().health(&mut machine);
    assert_eq!((health.link.frames_bad, health.link.bytes_lost), (0, 0));
}
