//! `inm board update`: a new program over the line, and all that may go wrong on the way.

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

use inm_firmware::update::{PROGRAM_AT, first_to_start};
use inm_host::internals::virtual_board::{ProgramFlash, VirtualConnect};
use inm_protocol::image::{BOARD, QEMU};
use inm_protocol::slot::BLANK;

use super::image::{Parts, elf, image};
use super::pty::PtyBoard;
use super::{fail, inm, json, steady, text};

/// Bytes of the programs of these tests beyond vectors and mark: some ten messages.
const MORE: usize = 5000;

/// Release of the board's firmware, which is that of the program under test.
const RELEASE: &str = env!("CARGO_PKG_VERSION");

/// An image as a file.
struct File {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl File {
    fn of(parts: &Parts) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("image.elf");
        std::fs::write(&path, elf(parts)).expect("written");
        Self {
            _folder: folder,
            path,
        }
    }

    fn path(&self) -> &str {
        self.path.to_str().expect("a name")
    }
}

fn board() -> VirtualConnect {
    VirtualConnect {
        serial: [1, 2, 0xABC],
        ..VirtualConnect::published(1, 1.0)
    }
}

/// The flash of a board as it is now.
fn flash(board: &VirtualConnect) -> ProgramFlash {
    board.programs.lock().expect("no test holds it").clone()
}

/// Whether a slot of the board holds the image's program.
fn holds(board: &VirtualConnect, slot: usize, image: &Parts) -> bool {
    let program = image[2 + 2 * slot].1.chunks(4).map(|bytes| {
        let mut word = [0xff; 4];
        word[..bytes.len()].copy_from_slice(bytes);
        u32::from_le_bytes(word)
    });
    let flash = flash(board);
    program.eq(
        flash.slot(slot)[PROGRAM_AT..][..image[2].1.len().div_ceil(4)]
            .iter()
            .copied(),
    )
}

#[test]
fn a_board_gets_a_new_program_and_answers() {
    let (plan, parts) = (board(), image(BOARD, RELEASE, MORE));
    let (file, board) = (File::of(&parts), PtyBoard::start(plan.clone()));
    let arguments = ["board", "update", file.path(), "--port", &board.port];
    let output = inm(&arguments);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    steady().bind(|| insta::assert_snapshot!("update_as_text", told));
    assert!(holds(&plan, 1, &parts));
    assert_eq!(first_to_start(&flash(&plan)), Some(1));
    // And the next goes where the first was.
    let json = json(&arguments, 0);
    assert_eq!(json["slot"], 0);
    steady().bind(|| {
        insta::assert_snapshot!(
            "update_as_json",
            serde_json::to_string_pretty(&json).expect("JSON")
        );
    });
    assert!(holds(&plan, 0, &parts) && holds(&plan, 1, &parts));
    let info = super::json(&["board", "info", "--port", &board.port], 0);
    assert_eq!(info["serial"], "000000010000000200000abc");
}

/// The virtual board keeps its own time.
#[test]
fn a_board_without_hardware_is_updated() {
    let file = File::of(&image(BOARD, RELEASE, MORE));
    let json = json(&["board", "update", file.path(), "--port", "virtual"], 0);
    assert_eq!(
        (&json["slot"], &json["before"]),
        (&1.into(), &RELEASE.into())
    );
}

/// Refused before anything is said to the board, as `inm flash` does.
#[test]
fn what_is_not_for_this_board_is_refused() {
    let mut damaged = image(BOARD, RELEASE, MORE);
    damaged[4].1[3000] ^= 1;
    for (parts, expected) in [
        (image(QEMU, RELEASE, MORE), "the image is for `qemu`"),
        (damaged, "the file is damaged"),
    ] {
        let file = File::of(&parts);
        let said = fail(&["board", "update", file.path(), "--port", "/dev/ttyNOPE"]);
        assert!(
            said.contains(expected) && said.contains("image.elf"),
            "{said}"
        );
    }
    let file = File::of(&image(BOARD, RELEASE, MORE));
    let said = fail(&["board", "update", file.path(), "--port", "/dev/ttyNOPE"]);
    assert!(
        said.contains("/dev/ttyNOPE: the port cannot be opened"),
        "{said}"
    );
}

/// The power goes at some words of the update; the board is back with what it had, and is updated then.
#[test]
fn power_that_goes_in_the_middle_leaves_the_program_that_was_there() {
    let (plan, parts) = (board(), image(BOARD, RELEASE, MORE));
    let (file, board) = (File::of(&parts), PtyBoard::start(plan.clone()));
    let arguments = ["board", "update", file.path(), "--port", &board.port];
    for words in [0, 700, 1280] {
        {
            let mut programs = plan.programs.lock().expect("no test holds it");
            *programs = programs.clone().cut_after(Some(words), 0x5555_5555);
        }
        let said = fail(&arguments);
        assert!(
            said.contains("restarted in the middle, into the program that it had"),
            "{said}"
        );
        assert_eq!(first_to_start(&flash(&plan)), Some(0), "{words} words");
        let info = json(&["board", "info", "--port", &board.port], 0);
        assert_eq!(info["firmware"], RELEASE);
    }
    assert!(inm(&arguments).status.success());
    assert!(holds(&plan, 1, &parts));
}

/// The cable is out for longer than the host waits, then back.
#[test]
fn a_cable_that_is_pulled_costs_another_try() {
    let (plan, parts) = (board(), image(BOARD, RELEASE, 30_000));
    let (file, board) = (File::of(&parts), PtyBoard::start(plan.clone()));
    let (path, port) = (file.path().to_owned(), board.port.clone());
    let first = thread::spawn(move || fail(&["board", "update", &path, "--port", &port]));
    // The first words of the program are there.
    while flash(&plan).slot(1)[PROGRAM_AT] == BLANK {
        thread::sleep(Duration::from_millis(1));
    }
    board.parted.store(true, Ordering::Relaxed);
    let said = first.join().expect("it ends");
    assert!(
        said.contains("no answer") && said.contains("try again"),
        "{said}"
    );
    board.parted.store(false, Ordering::Relaxed);
    let said = fail(&["board", "info", "--port", &board.port]);
    assert!(
        said.contains("runs no program: its loader listens"),
        "{said}"
    );
    assert!(said.contains("`inm board update`"), "{said}");
    let json = json(&["board", "update", file.path(), "--port", &board.port], 0);
    // It was in its loader.
    assert_eq!(
        (&json["before"], &json["slot"]),
        (&serde_json::Value::Null, &1.into())
    );
    assert!(holds(&plan, 1, &parts));
}

/// A board that never had a program, or whose flash has lost it.
#[test]
fn a_board_with_nothing_to_start_takes_a_program() {
    let (plan, parts) = (board(), image(BOARD, RELEASE, MORE));
    *plan.programs.lock().expect("no test holds it") =
        ProgramFlash::new(vec![BLANK; ProgramFlash::WORDS]);
    let (file, board) = (File::of(&parts), PtyBoard::start(plan.clone()));
    let json = json(&["board", "update", file.path(), "--port", &board.port], 0);
    assert_eq!(json["slot"], 0);
    assert!(holds(&plan, 0, &parts));
}

/// A program of another release than the image's answers: that of the virtual board is always this one.
#[test]
fn a_program_that_is_not_the_one_that_was_written_is_told() {
    let file = File::of(&image(BOARD, "9.9.9", MORE));
    let said = fail(&["board", "update", file.path(), "--port", "virtual"]);
    assert!(
        said.contains("firmware 9.9.9 was written and verified, and"),
        "{said}"
    );
}

/// The new program has the release of the one before and hangs: the board starts it four times, then the other, which
/// answers with the release that is wanted.
#[test]
fn a_board_that_goes_back_to_a_program_of_the_same_release_is_told() {
    let parts = image(BOARD, RELEASE, MORE);
    let plan = VirtualConnect {
        hangs: Some(1),
        ..board()
    };
    let (file, board) = (File::of(&parts), PtyBoard::start(plan.clone()));
    let said = fail(&["board", "update", file.path(), "--port", &board.port]);
    assert!(
        said.contains("the program before it, of the same release, answers"),
        "{said}"
    );
    assert!(holds(&plan, 1, &parts));
    assert_eq!(first_to_start(&flash(&plan)), Some(0));
    // It runs again.
    let info = json(&["board", "info", "--port", &board.port], 0);
    assert_eq!(info["firmware"], RELEASE);
}
