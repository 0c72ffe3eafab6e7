use std::io::{self, ErrorKind, Read, Write};

use inm_protocol::{AxisCounters, Hello, LinkCounters, MAX_FRAME, REGISTERS, encode};

use super::*;
use crate::link::{Clock, Port};

/// A far end that answers whatever is written with the same bytes, once.
struct Answers(Vec<u8>);

/// The port to it.
struct Line {
    answer: Vec<u8>,
    asked: bool,
}

impl Read for Line {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        if !std::mem::take(&mut self.asked) || self.answer.is_empty() {
            return Err(ErrorKind::TimedOut.into());
        }
        let answer = std::mem::take(&mut self.answer);
        buf[..answer.len()].copy_from_slice(&answer);
        Ok(answer.len())
    }
}

impl Write for Line {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        self.asked = true;
        Ok(buf.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Connect for Answers {
    fn name(&self) -> String {
        "port".to_owned()
    }

    fn clock(&self) -> Clock {
        Clock::of_the_wall()
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        Ok(Box::new(Line {
            answer: self.0.clone(),
            asked: false,
        }))
    }
}

/// One short wait.
const SHORT: Patience = Patience {
    wait: Duration::from_millis(20),
    tries: 1,
    silence: Duration::from_secs(3),
};

fn refused(answer: Vec<u8>) -> LinkError {
    let opened = Session::open(&mut Answers(answer), SHORT);
    opened.map(|_| ()).expect_err("no board of ours")
}

#[test]
fn a_board_of_another_version_is_named_with_its_firmware() {
    let hello = Hello {
        version: 9,
        serial: [1, 2, 3],
        firmware: "9.1.0".try_into().expect("short"),
        platform: "stm32f405".try_into().expect("short"),
    };
    let mut frame = [0; MAX_FRAME];
    let len = hello.encode(&mut frame).expect("it has room");
    let said = refused(frame[..len].to_vec()).to_string();
    for part in ["000000010000000200000003", "9.1.0", "protocol version 9"] {
        assert!(said.contains(part), "`{part}` is not in: {said}");
    }
}

#[test]
fn a_port_without_a_board_gives_no_answer() {
    for answer in [Vec::new(), b"login: \0".to_vec()] {
        let error = refused(answer);
        assert!(matches!(error, LinkError::NoReply { .. }), "{error}");
    }
}

/// What a board says unasked arrives among its answers, and waits.
#[test]
fn a_health_record_ahead_of_an_answer_is_kept() {
    let health = Health {
        stamp: 5,
        index: 0,
        streaming: false,
        mcu_centi_celsius: None,
        supply_mv: Some(2800),
        registers: [[0; REGISTERS]; AXES],
        axes: [AxisCounters::default(); AXES],
        link: LinkCounters::default(),
        lost_conversions: 0,
        stack_used: 0,
        stack_size: 0,
        bins: None,
        stream: 0,
    };
    let mut frame = [0; MAX_FRAME];
    let len = encode(&ToHost::Health(health), &mut frame).expect("it has room");
    let mut connect = Answers(frame[..len].to_vec());
    let port = connect.open().expect("it opens");
    let mut session = Session {
        client: Client::new(port, connect.name(), SHORT),
        clock: connect.clock(),
        listener: Listener::default(),
    };
    let answer = session.ask::<()>(Request::Stop);
    assert!(matches!(answer, Err(LinkError::NoReply { .. })));
    let heard = session.health(Duration::ZERO).expect("the port is there");
    assert_eq!(heard.map(|(_, health)| health), Some(health));
    assert!(session.heard().is_none());
}
