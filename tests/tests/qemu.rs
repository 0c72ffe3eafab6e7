//! The image itself: the board's program in QEMU, streaming over a real serial port.
//!
//! QEMU executes the image instruction by instruction; the three converters on its buses are
//! emulated inside it. The host makes the words again from the same seed and compares all of
//! them. Integers on both sides, so one bit of difference is an error.
//!
//! Ignored where there is no image; `cargo xtask test` builds it and runs these.

use std::time::Instant;

use inm_emulator::channel::{Channel, published};
use inm_emulator::{Conversion, Registers};
use inm_host::internals::link::{Client, Connect, LinkError, Patience};
use inm_host::internals::source::assemble::Losses;
use inm_host::internals::source::audit::State;
use inm_host::internals::source::board::{BoardSource, Plan, Stop};
use inm_host::internals::source::{Block, Chunk, Source, Values};
use inm_protocol::{
    AXES, Answer, AxisCounters, Decoder, Filter, Health, Identity, Rate, Refusal, Reply, Request,
    Restart, Settings, ToHost,
};
use inm_tests::qemu::{OVERFLOW_VARIABLE, PATIENCE, Qemu, program};

/// The image's seed, `SEED` in board_qemu.rs.
const SEED: u64 = 0x494e_4d31;

/// Board time of a stream, seconds.
const DURATION_S: u64 = 60;

/// The words that the converters make after a start at a new rate.
struct Expected {
    registers: Registers,
    axes: [Conversion<Channel>; AXES],
}

impl Expected {
    /// `config0` is register 01h as the driver must have written it (SBAS378D, table 14).
    fn new(config0: u8) -> Self {
        let mut registers = Registers::default();
        registers.set(0x01, config0);
        Self {
            registers,
            axes: [0, 1, 2].map(|axis| Conversion::new(published(axis, SEED))),
        }
    }

    fn compare(&mut self, block: &Block) {
        for (axis, column) in block.columns.iter().enumerate() {
            assert_eq!(column.invalid, [], "axis {axis}: no word is flagged");
            let Values::Codes(codes) = &column.values else {
                panic!("codes stay codes")
            };
            for (i, &code) in codes.iter().enumerate() {
                let word = self.axes[axis].next_word(&self.registers);
                let index = block.first + i as u64;
                assert_eq!(
                    code as u32, word,
                    "axis {axis}, word {index}, seed {SEED:#x}"
                );
            }
        }
    }
}

/// Streams at `rate` and compares every word.
fn stream(rate: Rate, config0: u8) {
    let qemu = Qemu::start().expect("QEMU runs the image");
    let plan = Plan {
        settings: Some(Settings {
            rate,
            filter: Filter::default(),
        }),
        samples: Some(DURATION_S * u64::from(rate.hz())),
        patience: PATIENCE,
        ..Plan::default()
    };
    let wanted = plan.samples;
    let mut source = BoardSource::start(Box::new(qemu.connect()), plan, None, Stop::default())
        .expect("the board starts");
    let begin = Instant::now();
    let mut expected = Expected::new(config0);
    let mut received = 0;
    let mut first_health = None;
    while let Some(chunk) = source.next_chunk().expect("the port stays") {
        match chunk {
            Chunk::Samples(block) => {
                assert_eq!(block.first, received, "no gap in the index");
                expected.compare(&block);
                received = block.end();
            }
            Chunk::Gap(gap) => panic!("a gap: {gap:?}"),
            Chunk::News(news) => panic!("news on a sound board: {news}"),
        }
        first_health = first_health.or(source.status().health);
    }
    let took = begin.elapsed().as_secs_f64();
    assert!(Some(received) >= wanted, "{received} of {wanted:?} samples");
    assert_eq!(source.losses(), Losses::default());
    let proven = State::Proven {
        epoch: 0,
        index: received,
    };
    assert_eq!(source.proof().map(|proof| proof.state), Some(proven));
    assert_eq!(source.damaged(), (0, 0), "frames damaged, and their bytes");
    let health = source
        .status()
        .health
        .as_ref()
        .expect("a health record each second");
    assert_sound(health);
    println!(
        "{received} conversions of three axes at {}/s equal bit for bit: {:.0} s of board time in \
         {took:.1} s; stack {} of {} bytes",
        rate.hz(),
        received as f64 / f64::from(rate.hz()),
        health.stack_used,
        health.stack_size,
    );
}

/// Nothing went wrong on the board.
fn assert_sound(health: &Health) {
    for axis in health.axes {
        // Each start resets the converters on purpose.
        assert_eq!(
            axis,
            AxisCounters {
                resets: axis.resets,
                ..AxisCounters::default()
            }
        );
    }
    assert_eq!(health.lost_conversions, 0);
    assert_eq!(health.link.frames_dropped, 0);
    assert!(health.stack_used > 0, "the stack is measured");
    assert!(
        health.stack_used < health.stack_size / 2,
        "half the stack is in reserve: {health:?}"
    );
}

#[test]
#[ignore = "needs the image for QEMU: cargo xtask test"]
fn a_minute_at_2000_a_second_arrives_bit_for_bit() {
    stream(Rate::Sps2000, 0x5a);
}

#[test]
#[ignore = "needs the image for QEMU: cargo xtask test"]
fn a_minute_at_4000_a_second_arrives_bit_for_bit() {
    stream(Rate::Sps4000, 0x62);
}

/// A board and what it said.
struct Talk {
    client: Client,
    decoder: Decoder,
    samples: u64,
}

impl Talk {
    fn new(qemu: &Qemu, patience: Patience) -> Self {
        let port = qemu.connect().open().expect("its port opens");
        Self {
            client: Client::new(port, "QEMU".to_owned(), patience),
            decoder: Decoder::new(),
            samples: 0,
        }
    }

    fn ask(&mut self, request: Request) -> Result<Answer, Refusal> {
        match self.try_ask(request) {
            Ok(answer) => Ok(answer),
            Err(LinkError::Refused { refusal, .. }) => Err(refusal),
            Err(error) => panic!("{error}"),
        }
    }

    fn try_ask(&mut self, request: Request) -> Result<Answer, LinkError> {
        let Self {
            client,
            decoder,
            samples,
        } = self;
        client.request(request, |mut bytes, id| {
            let mut found: Option<Reply> = None;
            while let Some(message) = decoder.next::<ToHost>(&mut bytes) {
                match message.expect("a pty damages nothing") {
                    ToHost::Samples(batch) => *samples += batch.codes.len() as u64,
                    ToHost::Reply(reply) if reply.id == id => found = Some(reply),
                    _ => {}
                }
            }
            Ok(found)
        })
    }

    fn identify(&mut self) -> Identity {
        match self.ask(Request::Identify) {
            Ok(Answer::Identity(identity)) => identity,
            other => panic!("not an identity: {other:?}"),
        }
    }
}

#[test]
#[ignore = "needs the image for QEMU: cargo xtask test"]
fn commands_are_answered_and_refused() {
    let qemu = Qemu::start().expect("QEMU runs the image");
    let mut board = Talk::new(&qemu, PATIENCE);

    let identity = board.identify();
    assert_eq!(identity.platform, "qemu");
    assert_eq!(identity.restart, Restart::Power);
    assert!(
        identity.converters.iter().all(Option::is_some),
        "{identity:?}"
    );

    let sinc = Settings {
        rate: Rate::Sps4000,
        filter: Filter::Sinc,
    };
    let refused = board.ask(Request::Configure(sinc));
    assert!(
        matches!(refused, Err(Refusal::LinkTooSlow { .. })),
        "{refused:?}"
    );
    assert_eq!(
        board.identify().settings,
        Settings::default(),
        "a refused mode changes nothing"
    );

    // Stop and start, three times: it streams after each start and is silent after each stop.
    for round in 1..=3 {
        assert_eq!(
            board.ask(Request::Start),
            Ok(Answer::Settings(Settings::default()))
        );
        assert_eq!(
            board.ask(Request::Start),
            Err(Refusal::Streaming),
            "round {round}"
        );
        let before = board.samples;
        for _ in 0..100 {
            board.identify();
        }
        assert!(
            board.samples > before,
            "round {round}: samples come while it streams"
        );
        assert_eq!(board.ask(Request::Stop), Ok(Answer::Done));
        let after = board.samples;
        for _ in 0..20 {
            board.identify();
        }
        assert_eq!(board.samples, after, "round {round}: none after the stop");
    }
}

/// Machines that are restarted, at most. QEMU 7.2 loses all interrupts at about one reset by software
/// in twenty: the NVIC shows them enabled and pending, and none is taken while the program runs on
/// without them. So one machine may fall silent, but not three.
const MACHINES: usize = 3;

#[test]
#[ignore = "needs the image for QEMU: cargo xtask test"]
fn a_restart_by_command_is_told() {
    let silent = (0..MACHINES).take_while(|_| !restarts()).count();
    println!("{silent} machines fell silent at their reset");
    assert!(silent < MACHINES, "no machine answered after its reset");
}

/// Whether a machine answers after a restart by command, which it then must say.
fn restarts() -> bool {
    let patience = Patience {
        tries: 8,
        ..PATIENCE
    };
    let qemu = Qemu::start().expect("QEMU runs the image");
    let mut board = Talk::new(&qemu, patience);
    let started = Ok(Answer::Settings(Settings::default()));
    assert_eq!(board.identify().restart, Restart::Power);
    assert_eq!(board.ask(Request::Start), started);
    assert_eq!(board.ask(Request::Stop), Ok(Answer::Done));
    assert_eq!(board.ask(Request::Reset), Ok(Answer::Done));
    match board.try_ask(Request::Identify) {
        Err(LinkError::NoReply { .. }) => return false,
        Ok(Answer::Identity(identity)) => assert_eq!(
            identity.restart,
            Restart::Command,
            "the reason survives the restart"
        ),
        other => panic!("not an identity: {other:?}"),
    }
    assert_eq!(board.ask(Request::Start), started);
    assert_eq!(board.ask(Request::Stop), Ok(Answer::Done));
    true
}

/// How long a machine may take to start, fill 28 KB and start again: a second on an idle one.
const OVERFLOW_PATIENCE: std::time::Duration = std::time::Duration::from_secs(60);

/// The handler of the fault has a stack of its own, and what it notes down survives the restart.
#[test]
#[ignore = "needs the image for QEMU: cargo xtask test"]
fn a_full_stack_is_told_as_the_reason_of_the_restart() {
    let image = std::env::var_os(OVERFLOW_VARIABLE).expect("cargo xtask test names the image");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let said = folder.path().join("said");
    let mut machine = std::process::Command::new(program())
        .args(["-M", "netduinoplus2", "-nographic", "-monitor", "none"])
        .arg("-serial")
        .arg(format!("file:{}", said.display()))
        .arg("-kernel")
        .arg(image)
        .stdin(std::process::Stdio::null())
        .spawn()
        .expect("QEMU starts");
    let begin = Instant::now();
    let mut text = String::new();
    while begin.elapsed() < OVERFLOW_PATIENCE && text.matches(';').count() < 2 {
        std::thread::sleep(std::time::Duration::from_millis(50));
        text = std::fs::read_to_string(&said).unwrap_or_default();
    }
    machine.kill().expect("it still runs");
    machine.wait().expect("it has ended");
    assert_eq!(text, "power;stack overflow;");
}
