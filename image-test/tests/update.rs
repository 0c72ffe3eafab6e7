//! The image's own loader and its flash: a program comes in over the line, and runs from the other slot.

use inm_image_test::board::Board;
use inm_image_test::image::Image;
use inm_image_test::machine::{Machine, PS_PER_MS, Talk};
use inm_protocol::image::BOARD;
use inm_protocol::slot::{BLANK, HEADER, HEADER_WORDS, Header, PROVED, SLOT_STARTS};
use inm_protocol::update::{
    CHUNK, FromLoader, LOADER, LoaderRefusal, LoaderStatus, NewProgram, ToLoader,
};
use inm_protocol::{Decoder, Hello, MAX_FRAME, Restart, crc32, encode};

/// Board time within which a loader answers: two sectors to erase.
const PATIENCE_MS: u64 = 6000;

/// From a reset until a program answers.
const BACK_MS: u64 = 300;

fn send(machine: &mut Machine, message: &ToLoader) {
    let mut frame = [0; MAX_FRAME];
    let len = encode(message, &mut frame).expect("it has room");
    let chip = machine.chip_mut();
    chip.usart.line.send(chip.now_ps, &frame[..len]);
}

/// Says something to the loader; its answer, and the hello ahead of that.
fn say(machine: &mut Machine, message: &ToLoader) -> (FromLoader, Option<Hello>) {
    machine.chip_mut().usart.line.to_host.clear();
    send(machine, message);
    let mut decoder = Decoder::new();
    for _ in 0..PATIENCE_MS {
        machine.run(PS_PER_MS);
        let bytes = std::mem::take(&mut machine.chip_mut().usart.line.to_host);
        let mut bytes = &bytes[..];
        while let Some(met) = decoder.next::<FromLoader>(&mut bytes) {
            if let Ok(answer) = met {
                return (answer, decoder.hello().cloned());
            }
        }
    }
    panic!("no answer to {message:?}")
}

fn status(machine: &mut Machine, message: &ToLoader) -> LoaderStatus {
    match say(machine, message).0 {
        FromLoader::Status(status) => status,
        FromLoader::Refused(refusal) => panic!("{message:?}: {refusal:?}"),
    }
}

/// The program of a slot, as the image has it.
fn program(image: &Image, slot: usize) -> Vec<u8> {
    let at = |word: u32| image.word(SLOT_STARTS[slot] + 4 * word);
    let words: [u32; HEADER_WORDS] = std::array::from_fn(|word| at(word as u32));
    let header = Header::read(words).expect("a header");
    let start = HEADER..HEADER + header.length;
    let words = start
        .step_by(4)
        .map(|at| image.word(SLOT_STARTS[slot] + at));
    let bytes: Vec<u8> = words.flat_map(u32::to_le_bytes).collect();
    assert_eq!(crc32(&bytes), header.crc);
    bytes
}

fn begin(slot: usize, bytes: &[u8]) -> ToLoader {
    ToLoader::Begin(NewProgram {
        address: SLOT_STARTS[slot] + HEADER,
        length: bytes.len() as u32,
        crc: crc32(bytes),
        platform: BOARD.try_into().expect("short"),
    })
}

/// Has the board go into its loader, which says so.
fn enter(machine: &mut Machine) -> LoaderStatus {
    send(machine, &ToLoader::Enter);
    machine.run(BACK_MS * PS_PER_MS);
    let (answer, hello) = say(machine, &ToLoader::Status);
    let hello = hello.expect("a hello");
    assert_eq!((hello.version, &hello.platform[..]), (LOADER, BOARD));
    match answer {
        FromLoader::Status(status) => status,
        FromLoader::Refused(refusal) => panic!("{refusal:?}"),
    }
}

/// Sends the first bytes of a program, as many as there is to send.
fn bring(machine: &mut Machine, bytes: &[u8]) {
    for (k, part) in (0..).zip(bytes.chunks(CHUNK)) {
        let data = ToLoader::Data {
            offset: k * CHUNK as u32,
            bytes: part.iter().copied().collect(),
        };
        let written = status(machine, &data).written as usize;
        assert_eq!(written, k as usize * CHUNK + part.len());
    }
}

/// The slot whose program runs and answers.
fn running(machine: &mut Machine) -> (usize, Restart) {
    machine.run(BACK_MS * PS_PER_MS);
    let restart = Talk::default().identify(machine).restart;
    let vectors = machine.chip().core.vectors();
    let slot = SLOT_STARTS
        .iter()
        .position(|start| start + HEADER == vectors);
    (slot.expect("it runs in a slot"), restart)
}

/// Power goes when half of a program is there; then all of it comes, runs, and says that it is sound.
#[test]
fn a_program_comes_over_the_line_and_runs_from_the_other_slot() {
    let image = Image::built();
    let mut machine = Machine::new(&image, Board::new(true));
    assert_eq!(running(&mut machine), (0, Restart::Power));
    let bytes = program(&image, 1);

    let at = enter(&mut machine);
    assert_eq!((at.starts, at.free), (Some(0), 1));
    assert_eq!(at.address, SLOT_STARTS[1] + HEADER);
    status(&mut machine, &begin(1, &bytes));
    bring(&mut machine, &bytes[..bytes.len() / 2 / CHUNK * CHUNK]);
    machine.power_off_and_on();
    assert_eq!(running(&mut machine), (0, Restart::Power));

    enter(&mut machine);
    status(&mut machine, &begin(1, &bytes));
    bring(&mut machine, &bytes);
    assert_eq!(status(&mut machine, &ToLoader::Commit).starts, Some(1));
    let proved = SLOT_STARTS[1] + 4 * PROVED as u32;
    assert_eq!(machine.word(proved), BLANK);
    status(&mut machine, &ToLoader::Start);
    assert_eq!(running(&mut machine), (1, Restart::Command));
    assert_eq!(machine.word(proved), 0);
    machine.power_off_and_on();
    assert_eq!(running(&mut machine), (1, Restart::Power));
    assert_eq!(machine.chip().misuse, Default::default());
    assert_eq!(machine.chip().board.bench.violation(), None);
}

/// What is refused is refused by the image's own code, too, and it goes back to its program.
#[test]
fn a_loader_that_refuses_starts_the_program_that_was_there() {
    let image = Image::built();
    let mut machine = Machine::new(&image, Board::new(true));
    assert_eq!(running(&mut machine).0, 0);
    enter(&mut machine);
    let bytes = program(&image, 0);
    let (refused, _) = say(&mut machine, &begin(0, &bytes));
    let expected = SLOT_STARTS[1] + HEADER;
    let wrong = LoaderRefusal::WrongAddress { expected };
    assert_eq!(refused, FromLoader::Refused(wrong));
    status(&mut machine, &ToLoader::Start);
    assert_eq!(running(&mut machine), (0, Restart::Command));
    assert_eq!(machine.chip().misuse, Default::default());
}

/// A program that hangs before it understands anybody is started four times, and then no more.
#[test]
fn a_program_that_does_not_prove_itself_is_left_for_the_one_before() {
    let image = Image::built();
    let mut machine = Machine::new(&image, Board::new(true));
    assert_eq!(running(&mut machine).0, 0);
    let bytes = program(&image, 1);
    enter(&mut machine);
    status(&mut machine, &begin(1, &bytes));
    bring(&mut machine, &bytes);
    status(&mut machine, &ToLoader::Commit);
    status(&mut machine, &ToLoader::Start);
    for start in 1..=4 {
        machine.run(BACK_MS * PS_PER_MS);
        let vectors = machine.chip().core.vectors();
        assert_eq!(vectors, SLOT_STARTS[1] + HEADER, "start {start}");
        machine.power_off_and_on();
    }
    assert_eq!(running(&mut machine), (0, Restart::Power));
}

/// From power-on to the first instruction of the program: the sum of its words, on the slow clock of a reset.
#[test]
fn a_start_costs_little_time() {
    /// Half of what a start without a crystal takes for its oscillator.
    const LONGEST_MS: u64 = 100;
    let image = Image::built();
    let mut machine = Machine::new(&image, Board::new(true));
    let program = SLOT_STARTS[0] + HEADER;
    let took = (1..).find(|_| {
        machine.run(PS_PER_MS);
        machine.chip().core.vectors() == program
    });
    let took_ms = took.expect("it starts");
    println!("{took_ms} ms");
    assert!(took_ms < LONGEST_MS, "{took_ms} ms");
}
