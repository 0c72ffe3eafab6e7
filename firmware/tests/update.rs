//! A new program over the serial line: wherever power goes, the board starts the old one or the new one,
//! whole, and can be updated again.

use inm_firmware::emulated::VirtualSlots;
use inm_firmware::update::{PROGRAM_AT, SLOT_WORDS, Slots, Updater, first_to_start, start, whole};
use inm_protocol::image::{BOARD, QEMU};
use inm_protocol::slot::{BLANK, HEADER, Header, PROVED, ROOM, SLOT_STARTS, TRIES};
use inm_protocol::update::{FromLoader, LoaderRefusal, LoaderStatus, NewProgram, ToLoader};
use inm_protocol::{crc32, slot::crc32_of_words};

type Flash = VirtualSlots<Vec<u32>>;

/// Bytes of a program that is tried at every word: three chunks, and one that is not full.
const SHORT: usize = 3 * 64 + 20;

/// Bytes in one message of these tests.
const PART: usize = 64;

fn blank() -> Flash {
    VirtualSlots::new(vec![BLANK; Flash::WORDS])
}

/// A program that would run in a slot, unlike those of other numbers in every word.
fn program(slot: usize, number: u32, len: usize) -> Vec<u8> {
    let start = SLOT_STARTS[slot] + HEADER;
    let vectors = [0x2000_8000, start + 8 + 1];
    let code = (0..).map(|word: u32| (word + 1).wrapping_mul(0x9E37_79B9) ^ number << 7);
    let words = vectors.into_iter().chain(code);
    words.take(len / 4).flat_map(u32::to_le_bytes).collect()
}

fn announced(slot: usize, program: &[u8]) -> NewProgram {
    NewProgram {
        address: SLOT_STARTS[slot] + HEADER,
        length: program.len() as u32,
        crc: crc32(program),
        platform: BOARD.try_into().expect("short"),
    }
}

fn part(program: &[u8], offset: usize) -> ToLoader {
    let end = program.len().min(offset + PART);
    ToLoader::Data {
        offset: offset as u32,
        bytes: program[offset..end].iter().copied().collect(),
    }
}

/// All that a host sends for a program.
fn messages(slot: usize, program: &[u8]) -> Vec<ToLoader> {
    let parts = (0..program.len()).step_by(PART);
    let parts = parts.map(|offset| part(program, offset));
    let begin = ToLoader::Begin(announced(slot, program));
    [begin]
        .into_iter()
        .chain(parts)
        .chain([ToLoader::Commit])
        .collect()
}

fn status(updater: &mut Updater<Flash>) -> LoaderStatus {
    match updater.answer(&ToLoader::Status) {
        FromLoader::Status(status) => status,
        FromLoader::Refused(refusal) => panic!("{refusal:?}"),
    }
}

/// Brings a program in, as far as the flash lets it; where it went, and whether all of it did.
fn update(flash: Flash, number: u32) -> (Flash, usize, bool) {
    let mut updater = Updater::new(flash);
    let slot = usize::from(status(&mut updater).free);
    let program = program(slot, number, SHORT);
    let refused = |answer: FromLoader| matches!(answer, FromLoader::Refused(_));
    let stopped = messages(slot, &program)
        .iter()
        .any(|one| refused(updater.answer(one)));
    (updater.release(), slot, !stopped)
}

/// The bytes of the program that a start runs, of those that [`program`] makes.
fn started(flash: &Flash) -> Option<(usize, Vec<u8>)> {
    let slot = first_to_start(flash)?;
    let header = whole(flash, slot)?;
    let words = PROGRAM_AT..PROGRAM_AT + header.length as usize / 4;
    let words = flash.slot(slot)[words].iter();
    Some((slot, words.flat_map(|word| word.to_le_bytes()).collect()))
}

fn prove(flash: &mut Flash, slot: usize) {
    flash.write(slot, PROVED, 0).expect("sound");
}

/// Boards before an update: with nothing, with one program, with two, one of which is to be replaced.
fn boards() -> Vec<Flash> {
    let mut boards = vec![blank()];
    for number in 1..=3 {
        let last = boards.last().expect("one").clone();
        let (mut next, slot, done) = update(last, number);
        assert!(done);
        prove(&mut next, slot);
        boards.push(next);
    }
    boards
}

#[test]
fn each_program_goes_to_the_other_slot_and_the_last_one_stays() {
    let mut flash = blank();
    assert_eq!(first_to_start(&flash), None);
    let mut before = None;
    for number in 1..=5 {
        let (next, slot, done) = update(flash, number);
        assert!(done);
        flash = next;
        assert_eq!(started(&flash), Some((slot, program(slot, number, SHORT))));
        if let Some((other, header)) = before {
            assert_ne!(other, slot);
            assert_eq!(whole(&flash, other), Some(header));
        }
        before = whole(&flash, slot).map(|header| (slot, header));
    }
}

/// A power cut at every word that is erased or written, and in the middle of it: some bits of it, or others.
#[test]
fn power_that_goes_at_any_word_leaves_the_old_program_or_the_new_one() {
    let mut cuts = 0;
    for (old_number, board) in boards().into_iter().enumerate() {
        let old = started(&board);
        let (after, slot, done) = update(board.clone(), 9);
        assert!(done);
        let new = started(&after);
        assert_eq!(new, Some((slot, program(slot, 9, SHORT))));
        for torn in [BLANK, 0xFFFF_0000, 0x5555_5555, 0] {
            for words in 0.. {
                let cut = board.clone().cut_after(Some(words), torn);
                let (cut, _, done) = update(cut, 9);
                let on = cut.cut_after(None, BLANK);
                let found = started(&on);
                let what = format!("board {old_number}, {words} words, torn {torn:08x}");
                if done {
                    assert_eq!(found, new, "{what}");
                    break;
                }
                // The last word of the header may have been written whole as power went.
                assert!(found == old || found == new, "{what}");
                // And it is updated as if nothing had been.
                let (again, slot, done) = update(on, 10);
                assert!(done, "{what}");
                assert_eq!(
                    started(&again),
                    Some((slot, program(slot, 10, SHORT))),
                    "{what}"
                );
                cuts += 1;
            }
        }
    }
    // Words that are written alone, for four boards and four ways to be torn.
    assert!(cuts > 16 * SHORT / 4, "{cuts} cuts");
}

#[test]
fn a_program_that_does_not_prove_itself_is_left_for_the_one_before() {
    let (mut flash, old, _) = update(blank(), 1);
    prove(&mut flash, old);
    let (mut flash, new, _) = update(flash, 2);
    for _ in TRIES {
        assert_eq!(start(&mut flash), Some(new));
    }
    for _ in 0..10 {
        assert_eq!(start(&mut flash), Some(old));
    }
    // The next one goes where the bad one is.
    let (mut flash, third, done) = update(flash, 3);
    assert!(done);
    assert_eq!(third, new);
    assert_eq!(start(&mut flash), Some(third));
    prove(&mut flash, third);
    for _ in 0..10 {
        assert_eq!(start(&mut flash), Some(third));
    }
}

#[test]
fn where_no_program_has_proved_itself_the_loader_stays_and_takes_another() {
    let (mut flash, slot, _) = update(blank(), 1);
    for _ in TRIES {
        assert_eq!(start(&mut flash), Some(slot));
    }
    assert_eq!(start(&mut flash), None);
    let mut updater = Updater::new(flash);
    let said = updater.answer(&ToLoader::Start);
    assert_eq!(said, FromLoader::Refused(LoaderRefusal::NothingToStart));
    let (mut flash, _, done) = update(updater.release(), 2);
    assert!(done);
    assert!(start(&mut flash).is_some());
}

/// A bit of a cell that is lost is a program that is not started any more.
#[test]
fn a_program_that_lost_a_bit_is_left_for_the_other() {
    let boards = boards();
    let (new, program) = started(&boards[2]).expect("a program");
    let (old, _) = started(&boards[1]).expect("a program");
    for word in (0..5).chain(PROGRAM_AT..PROGRAM_AT + program.len() / 4) {
        let mut decayed = boards[2].clone();
        let value = decayed.read(new, word);
        if value == 0 {
            continue;
        }
        decayed
            .write(new, word, value & (value - 1))
            .expect("sound");
        assert_eq!(first_to_start(&decayed), Some(old), "word {word}");
    }
}

/// Every answer is lost once, and everything is said twice.
#[test]
fn a_message_that_is_repeated_does_no_harm() {
    let mut updater = Updater::new(blank());
    let bytes = program(0, 1, SHORT);
    for message in messages(0, &bytes) {
        let first = updater.answer(&message);
        assert!(
            matches!(first, FromLoader::Status(_)),
            "{message:?}: {first:?}"
        );
        assert_eq!(updater.answer(&message), first, "{message:?}");
    }
    assert_eq!(started(updater.slots()), Some((0, bytes)));
}

/// The host went away in the middle, and comes back to a loader that still has what there was.
#[test]
fn an_update_goes_on_where_it_was_broken_off() {
    let mut updater = Updater::new(blank());
    let bytes = program(0, 1, SHORT);
    let all = messages(0, &bytes);
    for message in &all[..3] {
        updater.answer(message);
    }
    assert_eq!(status(&mut updater).written as usize, 2 * PART);
    let FromLoader::Status(again) = updater.answer(&all[0]) else {
        panic!("it goes on");
    };
    assert_eq!(again.written as usize, 2 * PART);
    for message in &all[3..] {
        assert!(matches!(updater.answer(message), FromLoader::Status(_)));
    }
    assert_eq!(started(updater.slots()), Some((0, bytes)));
}

/// What is refused, and why; the program that starts is none the worse for it.
#[test]
fn what_does_not_belong_on_the_board_is_refused() {
    let (mut board, slot, _) = update(blank(), 1);
    prove(&mut board, slot);
    let old = started(&board);
    let bytes = program(1, 2, SHORT);
    let right = announced(1, &bytes);
    let begin = |change: fn(&mut NewProgram)| {
        let mut new = right.clone();
        change(&mut new);
        ToLoader::Begin(new)
    };
    let ours = SLOT_STARTS[1] + HEADER;
    let wrong_address = LoaderRefusal::WrongAddress { expected: ours };
    let wrong_length = LoaderRefusal::WrongLength { room: ROOM };
    let mut updater = Updater::new(board);
    for (message, expected) in [
        (
            begin(|new| new.platform = QEMU.try_into().expect("short")),
            LoaderRefusal::WrongBoard,
        ),
        (begin(|new| new.platform.clear()), LoaderRefusal::WrongBoard),
        (
            begin(|new| new.address = SLOT_STARTS[0] + HEADER),
            wrong_address,
        ),
        (begin(|new| new.address = SLOT_STARTS[1]), wrong_address),
        (begin(|new| new.length = 0), wrong_length),
        (begin(|new| new.length += 1), wrong_length),
        (begin(|new| new.length = ROOM + 4), wrong_length),
        (begin(|new| new.length = u32::MAX - 3), wrong_length),
        (part(&bytes, 0), LoaderRefusal::NotBegun),
        (ToLoader::Commit, LoaderRefusal::NotBegun),
    ] {
        let said = updater.answer(&message);
        assert_eq!(said, FromLoader::Refused(expected), "{message:?}");
        assert_eq!(started(updater.slots()), old);
    }
}

#[test]
fn data_out_of_their_place_are_refused_and_the_rest_goes_on() {
    let mut updater = Updater::new(blank());
    let bytes = program(0, 1, SHORT);
    updater.answer(&ToLoader::Begin(announced(0, &bytes)));
    updater.answer(&part(&bytes, 0));
    let expected = PART as u32;
    let longer = [&bytes[..], &[0; 4]].concat();
    for (message, offset) in [
        (part(&bytes, 2 * PART), expected),
        (part(&bytes, PART - 4), expected),
        (part(&bytes[..PART + 3], PART), expected),
        (ToLoader::Commit, expected),
    ] {
        let refused = LoaderRefusal::WrongPlace { expected: offset };
        assert_eq!(
            updater.answer(&message),
            FromLoader::Refused(refused),
            "{message:?}"
        );
    }
    for offset in (PART..3 * PART).step_by(PART) {
        updater.answer(&part(&bytes, offset));
    }
    let refused = LoaderRefusal::WrongPlace {
        expected: 3 * expected,
    };
    let said = updater.answer(&part(&longer, 3 * PART));
    assert_eq!(said, FromLoader::Refused(refused));
    updater.answer(&part(&bytes, 3 * PART));
    assert!(matches!(
        updater.answer(&ToLoader::Commit),
        FromLoader::Status(_)
    ));
    assert_eq!(started(updater.slots()), Some((0, bytes)));
}

/// A worn cell, a file that changed under way, a program that begins nowhere.
#[test]
fn what_is_not_as_announced_never_starts() {
    let (mut board, slot, _) = update(blank(), 1);
    prove(&mut board, slot);
    let old = started(&board);
    let sound = program(1, 2, SHORT);
    let mut other = sound.clone();
    other[100] ^= 1;
    let [mut nowhere, mut no_stack, mut even] = [(); 3].map(|()| sound.clone());
    nowhere[4..8].copy_from_slice(&(SLOT_STARTS[0] + HEADER + 9).to_le_bytes());
    no_stack[..4].copy_from_slice(&0x2002_0004_u32.to_le_bytes());
    even[4] &= !1;
    let wrong = LoaderRefusal::WrongCrc {
        found: crc32(&other),
    };
    for (announce, send, expected) in [
        (&sound, &other, wrong),
        (&nowhere, &nowhere, LoaderRefusal::NoProgram),
        (&no_stack, &no_stack, LoaderRefusal::NoProgram),
        (&even, &even, LoaderRefusal::NoProgram),
    ] {
        let mut updater = Updater::new(board.clone());
        updater.answer(&ToLoader::Begin(announced(1, announce)));
        for message in &messages(1, send)[1..] {
            let said = updater.answer(message);
            if *message == ToLoader::Commit {
                assert_eq!(said, FromLoader::Refused(expected));
            }
        }
        assert_eq!(started(updater.slots()), old);
        let said = updater.answer(&ToLoader::Commit);
        assert_eq!(said, FromLoader::Refused(LoaderRefusal::NotBegun));
        // The right one goes through then.
        let (flash, slot, done) = update(updater.release(), 3);
        assert!(done && started(&flash) == Some((slot, program(slot, 3, SHORT))));
    }
}

/// A whole slot, to the last byte.
#[test]
fn the_largest_program_has_room() {
    let mut updater = Updater::new(blank());
    let bytes = program(0, 1, ROOM as usize);
    for message in messages(0, &bytes) {
        assert!(matches!(updater.answer(&message), FromLoader::Status(_)));
    }
    assert_eq!(PROGRAM_AT + bytes.len() / 4, SLOT_WORDS);
    let words = updater.slots().slot(0)[PROGRAM_AT..].iter().copied();
    let header = Header {
        number: 1,
        length: ROOM,
        crc: crc32_of_words(words),
    };
    assert_eq!(whole(updater.slots(), 0), Some(header));
}
