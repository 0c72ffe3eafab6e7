//! Who the converters are: learnt when they are up, and every time that a configuration is verified.

mod rig;

use inm_emulator::{Bench, Fault};
use inm_protocol::{
    Answer, Command, Flags, Hello, MAX_FRAME, Request, ToBoard, Trouble, VERSION, encode,
};
use rig::{Noisy, OFFSETS, Rig, bench};

/// 16 ms after power-on the parts are up; RESET is sent at 20 ms and the registers are read at
/// 21 ms.
const BETWEEN_RESET_AND_REGISTERS_PS: u64 = 20_300_000_000;

/// A board with Y's DOUT at one level when the registers are read first.
fn late(bench: &Bench<Noisy>, high: bool) -> Rig<'_, Noisy> {
    let mut rig = Rig::new(bench);
    while rig.bench.now_ps() < BETWEEN_RESET_AND_REGISTERS_PS {
        rig.step();
    }
    let conversions = None;
    rig.inject(1, Fault::BusStuck { high, conversions });
    rig.run_ms(10);
    rig
}

fn converters(rig: &mut Rig<'_, Noisy>) -> [Option<u8>; 3] {
    match rig.ask(Request::Identify) {
        Ok(Answer::Identity(identity)) => identity.converters,
        other => panic!("no identity: {other:?}"),
    }
}

#[test]
fn a_converter_whose_registers_all_read_alike_is_not_there() {
    for high in [false, true] {
        let bench = bench(OFFSETS);
        let mut rig = late(&bench, high);
        assert_eq!(
            converters(&mut rig),
            [Some(0x10), None, Some(0x10)],
            "{high}"
        );
    }
}

#[test]
fn a_converter_that_is_late_at_power_on_is_learnt_with_its_configuration() {
    for high in [false, true] {
        let bench = bench(OFFSETS);
        let mut rig = late(&bench, high);
        // RESET, the first thing of a start, finds it up.
        rig.start();
        assert_eq!(converters(&mut rig), [Some(0x10); 3]);
        rig.run_ms(10_000);
        assert_eq!(rig.events, [], "{high}");
        let received = rig.proven();
        assert!(received.len() > 19_000, "{}", received.len());
        assert!(received.iter().all(|c| c.flags == [Flags::NONE; 3]));
        assert_eq!(rig.fresh_health().axes[1].resets, 2, "power-on and start");
    }
}

/// A wrong identity that a first look took for good, since its low nibble is 0.
#[test]
fn an_identity_that_was_misread_at_power_on_is_learnt_anew() {
    let bench = bench(OFFSETS);
    bench.inject(1, Fault::WrongId(0x00));
    let mut rig = Rig::new(&bench);
    rig.run_ms(30);
    assert_eq!(converters(&mut rig)[1], Some(0x00));
    rig.inject(1, Fault::WrongId(0x10));
    rig.start();
    rig.run_ms(3000);
    assert_eq!(rig.events, []);
    assert_eq!(converters(&mut rig)[1], Some(0x10));
}

/// A part that was exchanged, or read wrongly for a while, is told once and then goes on as it is.
#[test]
fn an_identity_that_changes_is_learnt_when_the_axis_is_configured_again() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    rig.run_ms(300);
    rig.inject(1, Fault::WrongId(0x20));
    rig.run_until(3000, "recovery", |rig| rig.recoveries() > 0);
    rig.run_ms(3000);
    let told = rig.troubles(1);
    assert_eq!(told[0], Trouble::WrongId { found: 0x20 });
    assert_eq!(told.len(), 2, "{told:?}");
    assert_eq!(converters(&mut rig)[1], Some(0x20));
}

#[test]
fn a_start_without_a_converter_says_that_nothing_answers() {
    for (high, found) in [(false, 0x00), (true, 0xFF)] {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        rig.run_ms(30);
        rig.send(Request::Start);
        rig.step();
        // Whatever RESET does about it.
        let conversions = None;
        while rig.replies.is_empty() {
            rig.inject(2, Fault::BusStuck { high, conversions });
            rig.step();
        }
        let trouble = Trouble::WrongId { found };
        let refusal = inm_protocol::Refusal::Converter { axis: 2, trouble };
        assert_eq!(rig.replies[0].1, Err(refusal));
    }
}

/// A question as a host of another version asks it: its frame is intact, what it holds is unknown here.
fn foreign(version: u8) -> Vec<u8> {
    let mut frame = [0; MAX_FRAME];
    let request = Request::Identify;
    let command = ToBoard::Command(Command { id: 1, request });
    let len = encode(&command, &mut frame).expect("a command fits");
    let mut payload = [0; MAX_FRAME];
    let len = cobs::decode(&frame[..len - 1], &mut payload).expect("our own frame");
    payload[0] = version;
    let (body, crc) = payload[..len].split_at_mut(len - 4);
    let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(body);
    crc.copy_from_slice(&sum.to_le_bytes());
    let len = cobs::encode(&payload[..len], &mut frame);
    frame[..=len].to_vec()
}

#[test]
fn a_host_of_any_version_learns_who_the_board_is() {
    // The commands of version 1 are those of version 2 and answered, too.
    for (version, answers) in [(0, 0), (1, 1), (VERSION + 1, 0), (255, 0)] {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        rig.run_ms(30);
        assert_eq!(rig.hello(), None);
        rig.link().send(&foreign(version));
        rig.run_ms(5);
        let said = rig.hello().expect("a hello").clone();
        let expected = Hello {
            version: VERSION,
            serial: said.serial,
            firmware: env!("CARGO_PKG_VERSION").try_into().expect("short"),
            platform: "virtual".try_into().expect("short"),
        };
        assert_eq!(said, expected, "to a host of version {version}");
        assert_eq!(rig.replies.len(), answers, "version {version}");
    }
}

#[test]
fn a_hello_stands_ahead_of_every_identity() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.run_ms(30);
    rig.listening = false;
    rig.send(Request::Identify);
    rig.run_ms(20);
    let now_ps = rig.bench.now_ps();
    let mut bytes = Vec::new();
    rig.link().take(now_ps, |byte| bytes.push(byte));
    let frames: Vec<_> = bytes.split(|&byte| byte == 0).collect();
    let is_hello = |frame: &&[u8]| frame.windows(8).any(|part| part == b"inmhello");
    let at = frames.iter().position(is_hello).expect("a hello");
    assert!(frames[at + 1].len() > 40, "the identity: {frames:?}");
}

#[test]
fn foreign_questions_cost_a_stream_no_word() {
    let bench = bench(OFFSETS);
    let mut rig = Rig::new(&bench);
    rig.start();
    for _ in 0..20 {
        rig.link().send(&foreign(VERSION + 1));
        rig.run_ms(50);
    }
    assert!(rig.hello().is_some());
    assert_eq!(rig.events, []);
    let received = rig.proven();
    assert!(received.len() > 1900, "{}", received.len());
    assert!(received.iter().all(|c| c.flags == [Flags::NONE; 3]));
}
