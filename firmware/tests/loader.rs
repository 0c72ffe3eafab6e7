//! The loader at the line, and the way into it from a program.

mod rig;

use inm_firmware::emulated::VirtualSlots;
use inm_firmware::update::{Loader, SILENCE_MS};
use inm_protocol::slot::{BLANK, HEADER, SLOT_STARTS};
use inm_protocol::update::{
    CHUNK, FromLoader, LOADER, LoaderRefusal, LoaderStatus, NewProgram, ToLoader,
};
use inm_protocol::{
    Command, Decoder, Hello, MAX_FRAME, Request, ToBoard, crc32, encode, image::BOARD,
};
use rig::{OFFSETS, Rig, bench};

type Flash = VirtualSlots<Vec<u32>>;

fn loader() -> Loader<Flash> {
    let hello = Hello {
        serial: [1, 2, 3],
        platform: BOARD.try_into().expect("short"),
        ..Hello::default()
    };
    let blank = VirtualSlots::new(vec![BLANK; Flash::WORDS]);
    Loader::new(blank, hello, 0)
}

fn frame<M: inm_protocol::Message>(message: &M) -> Vec<u8> {
    let mut frame = [0; MAX_FRAME];
    let len = encode(message, &mut frame).expect("it has room");
    frame[..len].to_vec()
}

/// What comes back for these bytes: a hello, and a message.
fn say(
    loader: &mut Loader<Flash>,
    bytes: &[u8],
    now_ms: u64,
) -> (Option<Hello>, Option<FromLoader>) {
    let mut said = Vec::new();
    for &byte in bytes {
        loader.take(byte, now_ms, |frame| said.extend_from_slice(frame));
    }
    let mut decoder = Decoder::new();
    let mut rest = &said[..];
    let message = decoder
        .next(&mut rest)
        .map(|met| met.expect("an intact frame"));
    assert!(decoder.next::<FromLoader>(&mut rest).is_none());
    (decoder.hello().cloned(), message)
}

fn program() -> Vec<u8> {
    let start = SLOT_STARTS[0] + HEADER;
    let words = [0x2000_8000, start + 9].into_iter().chain(2..2 + 300);
    words.flat_map(u32::to_le_bytes).collect()
}

/// Brings the program in by whole chunks, and has it started.
fn update(loader: &mut Loader<Flash>) {
    let bytes = program();
    let begin = ToLoader::Begin(NewProgram {
        address: SLOT_STARTS[0] + HEADER,
        length: bytes.len() as u32,
        crc: crc32(&bytes),
        platform: BOARD.try_into().expect("short"),
    });
    let data = (0..)
        .zip(bytes.chunks(CHUNK))
        .map(|(k, part)| ToLoader::Data {
            offset: k * CHUNK as u32,
            bytes: part.iter().copied().collect(),
        });
    for message in [begin].into_iter().chain(data).chain([ToLoader::Commit]) {
        let (_, answer) = say(loader, &frame(&message), 0);
        assert!(
            matches!(answer, Some(FromLoader::Status(_))),
            "{message:?}: {answer:?}"
        );
    }
}

#[test]
fn a_loader_says_who_it_is_to_hosts_of_any_version() {
    let mut loader = loader();
    let identify = ToBoard::Command(Command {
        id: 1,
        request: Request::Identify,
    });
    let (hello, message) = say(&mut loader, &frame(&identify), 0);
    assert_eq!(message, None);
    let hello = hello.expect("a hello");
    assert_eq!((hello.version, hello.serial), (LOADER, [1, 2, 3]));
    for asked in [ToLoader::Enter, ToLoader::Status] {
        let (again, message) = say(&mut loader, &frame(&asked), 0);
        assert_eq!(again.as_ref(), Some(&hello));
        let Some(FromLoader::Status(LoaderStatus {
            starts: None,
            free: 0,
            written: 0,
            ..
        })) = message
        else {
            panic!("{message:?}");
        };
    }
}

#[test]
fn bytes_that_are_no_frame_get_no_answer() {
    let mut loader = loader();
    let mut damaged = frame(&ToLoader::Status);
    damaged[2] ^= 1;
    let noise: Vec<u8> = (0..2000_u32)
        .map(|k| (k.wrapping_mul(0x9E37_79B9) >> 24) as u8)
        .collect();
    for bytes in [&damaged[..], &noise, &[0; 20]] {
        assert_eq!(say(&mut loader, bytes, 0), (None, None));
    }
    // Behind a zero it is itself again.
    say(&mut loader, &[0], 0);
    assert!(say(&mut loader, &frame(&ToLoader::Status), 0).1.is_some());
}

#[test]
fn a_loader_leaves_when_it_is_told_or_nobody_speaks_and_only_for_a_program() {
    let mut blank = loader();
    let (_, refused) = say(&mut blank, &frame(&ToLoader::Start), 0);
    assert_eq!(
        refused,
        Some(FromLoader::Refused(LoaderRefusal::NothingToStart))
    );
    assert!(!blank.is_over(u64::MAX), "it has nothing to start");
    let mut loader = loader();
    update(&mut loader);
    assert!(!loader.is_over(SILENCE_MS - 1) && loader.is_over(SILENCE_MS));
    say(&mut loader, &frame(&ToLoader::Status), SILENCE_MS / 2);
    assert!(!loader.is_over(SILENCE_MS) && loader.is_over(SILENCE_MS / 2 + SILENCE_MS));
    say(&mut loader, &frame(&ToLoader::Start), SILENCE_MS);
    assert!(loader.is_over(SILENCE_MS));
}

/// A program goes into its loader from rest and from a stream, without an answer, and is not proved by
/// bytes that nobody sent.
#[test]
fn a_program_that_is_asked_for_its_loader_goes_there() {
    for streams in [false, true] {
        let bench = bench(OFFSETS);
        let mut rig = Rig::new(&bench);
        rig.run_ms(50);
        rig.link().send(&[1, 2, 3, 0, 5, 0]);
        rig.run_ms(5);
        assert!(!rig.link().program_has_proved());
        if streams {
            rig.start();
            rig.run_ms(300);
        }
        rig.link().send(&frame(&ToLoader::Status));
        rig.run_ms(5);
        assert!(rig.link().program_has_proved() && !rig.link().loader_is_asked_for());
        rig.link().send(&frame(&ToLoader::Enter));
        // A halted board lets no time pass.
        for _ in 0..10_000 {
            rig.step();
        }
        assert!(rig.link().loader_is_asked_for());
        assert_eq!(rig.link().restarts(), 0);
    }
}
