//! The bytes of WIRE.md. A change here is a new protocol version.

use inm_protocol::update::{FromLoader, LoaderRefusal, LoaderStatus, NewProgram, ToLoader};
use inm_protocol::{
    Answer, Batch, BinsMark, Code, Command, Decoder, Event, Fault, Filter, Flag, Flags, HELLO,
    Health, Hello, Identity, MAX_FRAME, Message, Phase, Pulse, PulseCounters, Rate, Refusal, Reply,
    Request, Restart, SensorCalibration, SensorRange, Settings, ToBoard, ToHost, Trouble, VERSION,
    encode,
};

const WIRE: &str = include_str!("../WIRE.md");

fn hex(message: &impl Message) -> String {
    let mut out = [0; MAX_FRAME];
    let len = encode(message, &mut out).expect("fits");
    out[..len]
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect::<Vec<_>>()
        .join(" ")
}

/// The frame must stand in WIRE.md under `### <name>`, which is what people implement from.
fn assert_documented(name: &str, message: &impl Message) {
    let section = WIRE
        .split("\n### ")
        .find(|section| section.starts_with(name))
        .unwrap_or_else(|| panic!("WIRE.md has no section `{name}`"));
    let documented: Vec<&str> = section
        .split("```text\n")
        .nth(1)
        .and_then(|block| block.split("```").next())
        .unwrap_or_else(|| panic!("section `{name}` has no text block"))
        .split_whitespace()
        .collect();
    assert_eq!(
        documented.join(" "),
        hex(message),
        "section `{name}` of WIRE.md"
    );
}

/// Frozen: these bytes never change.
#[test]
fn the_loader() {
    let text = |text: &str| text.try_into().expect("short");
    assert_documented("Ask for the loader", &ToLoader::Enter);
    let begin = ToLoader::Begin(NewProgram {
        address: 0x0806_0200,
        length: 84_000,
        crc: 0x1234_5678,
        platform: text("stm32f405"),
    });
    assert_documented("Begin a program", &begin);
    let data = ToLoader::Data {
        offset: 512,
        bytes: [0, 0x80, 0, 0x20, 9, 2, 6, 8].into_iter().collect(),
    };
    assert_documented("Bytes of a program", &data);
    assert_documented("Take a program", &ToLoader::Commit);
    let status = FromLoader::Status(LoaderStatus {
        starts: Some(0),
        free: 1,
        address: 0x0806_0200,
        room: 261_632,
        written: 520,
    });
    assert_documented("How far a loader is", &status);
    let refused = FromLoader::Refused(LoaderRefusal::WrongCrc { found: 0x8765_4321 });
    assert_documented("Refused by a loader", &refused);
}

#[test]
fn identify() {
    let command = Command {
        id: 1,
        request: Request::Identify,
    };
    assert_documented("Identify", &ToBoard::Command(command));
}

#[test]
fn configure() {
    let settings = Settings {
        rate: Rate::Sps4000,
        filter: Filter::Fir {
            phase: Phase::Minimum,
            high_pass: Some(0x0332),
        },
    };
    let command = Command {
        id: 300,
        request: Request::Configure(settings),
    };
    assert_documented("Configure", &ToBoard::Command(command));
}

/// The calibration that the examples hold.
fn calibration() -> SensorCalibration {
    SensorCalibration {
        range: SensorRange::G12,
        unix_s: 1_795_435_200,
        centi_celsius: Some(2875),
        gravity_um_s2: 9_815_000,
        positions: 12,
        rows: [
            1_366_000_000,
            -2_700_000,
            1_380_000_000,
            410_000,
            0,
            1_350_000_000,
        ],
        row_deviations: [2000, 3000, 2100, 3100, 2900, 2200],
        zero: [-1_234_567, 890_123, 45],
        zero_deviations: [110, 120, 130],
    }
}

#[test]
fn a_calibration_to_be_kept() {
    let command = Command {
        id: 301,
        request: Request::WriteSensorCalibration(calibration()),
    };
    assert_documented("Keep a calibration", &ToBoard::Command(command));
}

#[test]
fn the_calibration_that_is_kept() {
    let answer = Answer::SensorCalibration(Some(calibration()));
    assert_documented(
        "Kept calibration",
        &ToHost::Reply(Reply {
            id: 302,
            result: Ok(answer),
        }),
    );
}

#[test]
fn refused() {
    let refusal = Refusal::LinkTooSlow {
        needed: 99_500,
        available: 92_160,
    };
    assert_documented(
        "Refused",
        &ToHost::Reply(Reply {
            id: 300,
            result: Err(refusal),
        }),
    );
}

#[test]
fn identity() {
    let identity = Identity {
        serial: [0x0020_0041, 0x5246_5002, 0x2031_3432],
        firmware: "0.1.0".try_into().expect("short"),
        platform: "stm32f405".try_into().expect("short"),
        timer_hz: 84_000_000,
        converter_clock_hz: 4_096_000,
        baud: 921_600,
        range: SensorRange::G4,
        reference_uv: 5_000_000,
        sensor_supply_uv: 2_800_000,
        converters: [Some(0x50), Some(0x50), None],
        settings: Settings::default(),
        restart: Restart::Power,
    };
    let answer = Answer::Identity(identity);
    assert_documented(
        "Identity",
        &ToHost::Reply(Reply {
            id: 1,
            result: Ok(answer),
        }),
    );
}

#[test]
fn samples() {
    let batch = Batch {
        seq: 5,
        first: 160,
        stamp: 6_720_000,
        codes: [
            [Code(1), Code(-2), Code(0x7fff_ffff)],
            [Code(3), Code(-4), Code(0x1000_0000)],
        ]
        .into_iter()
        .collect(),
        flags: [Flag {
            conversion: 0,
            axis: 2,
            flags: Flags::OVER_RANGE,
        }]
        .into_iter()
        .collect(),
        stream: 4711,
    };
    assert_documented("Samples", &ToHost::Samples(batch));
}

#[test]
fn health() {
    let health = Health {
        stamp: 84_000_000,
        index: 2000,
        streaming: true,
        mcu_centi_celsius: Some(3125),
        supply_mv: Some(2800),
        registers: [[0x10, 0x5a, 0x08, 0x32, 0x03, 0, 0, 0, 0, 0, 0x40]; 3],
        stack_used: 1500,
        stack_size: 65_536,
        bins: Some(BinsMark {
            epoch: 0,
            index: 2000,
            digests: [1, 300, u64::MAX],
        }),
        stream: 4711,
        ..Health::default()
    };
    assert_documented("Health", &ToHost::Health(health));
}

#[test]
fn bins_begin_anew() {
    let command = Command {
        id: 2,
        request: Request::RestartBins,
    };
    assert_documented("Begin the bins anew", &ToBoard::Command(command));
    let answer = inm_protocol::Answer::BinsEpoch { index: 62_500 };
    assert_documented(
        "Where the bins begin",
        &ToHost::Reply(Reply {
            id: 2,
            result: Ok(answer),
        }),
    );
}

#[test]
fn event() {
    let trouble = Trouble::RegisterLost {
        address: 1,
        wrote: 0x5a,
        found: 0x52,
    };
    assert_documented(
        "Event",
        &ToHost::Event(Event {
            index: 1000,
            axis: Some(1),
            trouble,
            stream: 4711,
        }),
    );
}

#[test]
fn pulse() {
    let pulse = Pulse {
        stamp: 84_000_123,
        number: 300,
        doubled: false,
        counters: PulseCounters {
            early: 1,
            doubled: 2,
            missing: 130,
            odd: 4,
        },
    };
    assert_documented("Pulse", &ToHost::Pulse(pulse));
}

/// The same frames as version 1 wrote them, which captures hold: the streams have no number.
#[test]
fn frames_of_version_1_are_read() {
    const SAMPLES: &str = "02 01 0a 05 a0 01 80 94 9a 03 02 01 01 01 0a fe ff ff ff ff ff ff 7f 03 01 01 05 fc \
        ff ff ff 01 01 03 10 01 07 02 01 c6 19 9a 26 00";
    const EVENT: &str = "0f 01 03 e8 07 01 01 05 01 5a 52 c1 da 46 a5 00";
    const HEALTH: &str = "15 01 01 80 fa 86 28 d0 0f 01 01 ea 30 01 f0 15 10 5a 08 32 03 01 01 01 01 07 40 10 \
        5a 08 32 03 01 01 01 01 07 40 10 5a 08 32 03 01 01 01 01 02 40 01 01 01 01 01 01 01 \
        01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 07 dc 0b 80 80 04 01 \
        14 d0 0f 01 ac 02 ff ff ff ff ff ff ff ff ff 01 80 1f 3d 25 00";
    const REFUSED: &str = "11 01 02 ac 02 01 01 ac 89 06 80 d0 05 88 8c 77 a8 00";
    let read = |frame: &str| -> ToHost {
        let bytes = frame.split_whitespace();
        let bytes: Vec<u8> = bytes
            .map(|byte| u8::from_str_radix(byte, 16).expect("a byte"))
            .collect();
        let mut decoder: Decoder = Decoder::new();
        let message = decoder.next(&mut &bytes[..]).expect("a frame");
        assert_eq!(decoder.version(), Some(1));
        message.expect("a message of then")
    };
    let ToHost::Samples(batch) = read(SAMPLES) else {
        panic!("samples");
    };
    assert_eq!((batch.seq, batch.end(), batch.flags.len()), (5, 162, 1));
    let ToHost::Health(health) = read(HEALTH) else {
        panic!("a health record");
    };
    assert_eq!(health.bins.map(|mark| mark.index), Some(2000));
    let ToHost::Event(event) = read(EVENT) else {
        panic!("an event");
    };
    assert_eq!((event.index, event.axis), (1000, Some(1)));
    assert_eq!([batch.stream, health.stream, event.stream], [0; 3]);
    assert!(matches!(
        read(REFUSED),
        ToHost::Reply(Reply { id: 300, .. })
    ));
}

/// The bytes of a hello, from the version to ahead of the check sum. They are typed in: what is frozen
/// must not follow the code.
const HELLO_BYTES: &str = "02 69 6e 6d 68 65 6c 6c 6f 1c 41 00 20 00 02 50 46 52 32 34 31 20 05 30 2e \
    31 2e 30 09 73 74 6d 33 32 66 34 30 35";

fn hello() -> Hello {
    Hello {
        version: 2,
        serial: [0x0020_0041, 0x5246_5002, 0x2031_3432],
        firmware: "0.1.0".try_into().expect("short"),
        platform: "stm32f405".try_into().expect("short"),
    }
}

/// Frames a payload by hand.
fn frame(payload: &[u8]) -> Vec<u8> {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(payload);
    let payload = [payload, &crc.to_le_bytes()].concat();
    let mut out = [0; MAX_FRAME];
    let len = cobs::encode(&payload, &mut out);
    out[..=len].to_vec()
}

fn hello_bytes() -> Vec<u8> {
    let bytes = HELLO_BYTES.split_whitespace();
    let bytes = bytes.map(|byte| u8::from_str_radix(byte, 16).expect("a byte"));
    bytes.collect()
}

#[test]
fn the_hello_is_frozen() {
    let mut out = [0; MAX_FRAME];
    let len = hello().encode(&mut out).expect("fits");
    assert_eq!(out[..len], frame(&hello_bytes()));
    let section = WIRE
        .split("\n### Hello")
        .nth(1)
        .expect("a section of its own");
    let hex = out[..len].iter().map(|byte| format!("{byte:02x}"));
    let found = section.split_whitespace().collect::<Vec<_>>().join(" ");
    let hex = hex.collect::<Vec<_>>().join(" ");
    assert!(found.contains(&hex), "section `Hello` of WIRE.md: {hex}");
}

#[test]
fn a_hello_of_any_version_and_of_any_length_is_understood() {
    for version in [0, 1, VERSION, VERSION + 1, 255] {
        for added in [&[][..], &[7, 0, 9]] {
            let mut bytes = hello_bytes();
            bytes[0] = version;
            bytes[9] += added.len() as u8;
            bytes.extend(added);
            let mut decoder = Decoder::new();
            assert_eq!(decoder.next::<ToHost>(&mut &frame(&bytes)[..]), None);
            let read = decoder.hello().cloned();
            assert_eq!(read, Some(Hello { version, ..hello() }));
            assert_eq!(decoder.counts().faults, 0);
        }
    }
}

#[test]
fn what_only_begins_like_a_hello_is_a_fault() {
    let whole = hello_bytes();
    for len in 9..whole.len() {
        let mut decoder = Decoder::new();
        let read = decoder.next::<ToHost>(&mut &frame(&whole[..len])[..]);
        assert_eq!(read, Some(Err(Fault::Message)), "{len} bytes");
        assert_eq!(decoder.hello(), None);
    }
    // No message begins as it does.
    let numbers = postcard::take_from_bytes::<ToHost>(&HELLO);
    assert!(numbers.is_err());
}

#[test]
fn a_frame_of_another_version_says_so() {
    let mut out = [0; MAX_FRAME];
    let command = ToBoard::Command(Command {
        id: 1,
        request: Request::Identify,
    });
    let len = encode(&command, &mut out).expect("fits");
    // Rebuild the frame by hand with the next version and a fresh check sum.
    let mut payload = [0; MAX_FRAME];
    let body = cobs::decode(&out[..len - 1], &mut payload).expect("own frame");
    payload[0] = VERSION + 1;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&payload[..body - 4]);
    payload[body - 4..body].copy_from_slice(&crc.to_le_bytes());
    let len = cobs::encode(&payload[..body], &mut out);
    out[len] = 0;
    let mut decoder = Decoder::new();
    assert_eq!(
        decoder.next::<ToBoard>(&mut &out[..=len]),
        Some(Err(Fault::Version {
            theirs: VERSION + 1
        }))
    );
}
