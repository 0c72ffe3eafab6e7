//! The terminal as the documentation shows it, for `cargo xtask pictures`: no test, so only run when asked
//! for. The page: `browser/pictures.rs`.

use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use crate::terminal::{Bench, PATIENCE};

/// Folder that the pictures go to.
pub const FOLDER: &str = "INM_PICTURES";

/// Columns and rows: as it begins, and made larger while it runs.
const SIZES: [[u16; 2]; 2] = [[80, 24], [120, 40]];

/// What the view shows when it is drawn: coefficients that are not those of its first seconds, when Q was known to some
/// percent, and all down to its last row.
const SHOWN: [&str; 2] = ["±0.", "m mark"];

/// Seconds of the board in a second.
const SPEED: &str = "20";

/// The folder for the pictures.
pub fn folder() -> PathBuf {
    PathBuf::from(std::env::var_os(FOLDER).expect(FOLDER))
}

/// A terminal that shows what was drawn on it, as far as the view uses it: cells that are written, a
/// cursor that is moved, and a screen that is cleared (ECMA-48, 8.3.21 and 8.3.39). It has no colours.
struct Screen {
    cells: Vec<Vec<char>>,
    row: usize,
    column: usize,
}

impl Screen {
    fn new([columns, rows]: [u16; 2]) -> Self {
        Self {
            cells: vec![vec![' '; columns.into()]; rows.into()],
            row: 0,
            column: 0,
        }
    }

    fn draw(&mut self, text: &str) {
        let mut text = text.chars();
        while let Some(c) = text.next() {
            match c {
                '\u{1b}' if text.clone().next() == Some('[') => {
                    text.next();
                    let mut sequence = String::new();
                    let end = text.find(|c| {
                        sequence.push(*c);
                        c.is_ascii_alphabetic()
                    });
                    self.control(&sequence, end);
                }
                '\r' => self.column = 0,
                '\n' => self.row += 1,
                c if c.is_control() => {}
                c => {
                    let row = self.cells.get_mut(self.row);
                    if let Some(cell) = row.and_then(|row| row.get_mut(self.column)) {
                        *cell = c;
                    }
                    self.column += 1;
                }
            }
        }
    }

    fn control(&mut self, sequence: &str, end: Option<char>) {
        match end {
            Some('H') => {
                let place = sequence.trim_end_matches('H').split(';');
                let mut place = place.map(|number| number.parse().unwrap_or(1));
                let mut next = || place.next().unwrap_or(1usize).saturating_sub(1);
                (self.row, self.column) = (next(), next());
            }
            Some('J') => self.cells.iter_mut().for_each(|row| row.fill(' ')),
            _ => {}
        }
    }

    fn text(&self) -> String {
        let lines = self.cells.iter().map(|row| {
            let line: String = row.iter().collect();
            line.trim_end().to_owned() + "\n"
        });
        lines.collect()
    }
}

#[test]
fn a_screen_shows_what_was_drawn_last() {
    let mut screen = Screen::new([4, 2]);
    screen.draw("\u{1b}[2J\u{1b}[1;31mabcd\u{1b}[2;3Hx\u{1b}[1;1Hz\u{1b}[?25l");
    assert_eq!(screen.text(), "zbcd\n  x\n");
}

#[test]
#[ignore = "writes pictures: `cargo xtask pictures`"]
fn the_terminal_as_the_documentation_shows_it() {
    let place = tempfile::tempdir().expect("a folder");
    let mut live = Command::new(env!("CARGO_BIN_EXE_inm"));
    live.current_dir(place.path())
        .args(["live", "--source", "virtual", "--speed", SPEED])
        .args(["--duration", "5400", "-o", "run1.inmcap"]);
    let mut bench = Bench::on_terminal(&mut live, SIZES[0]);
    let mut screen = Screen::new(SIZES[0]);
    wait_for(&mut bench, &mut screen, "m mark");
    wait_for(&mut bench, &mut screen, "00:09:");
    bench.press("mfan on\r");
    wait_for(&mut bench, &mut screen, "! mark");
    // Any key: the answer to the last one gives way to what keys do.
    bench.press("x");
    wait_for(&mut bench, &mut screen, "00:11:");
    for size @ [columns, rows] in SIZES {
        if size != SIZES[0] {
            bench.resize(size);
            screen = Screen::new(size);
        }
        let [_, shown] = SHOWN.map(|text| wait_for(&mut bench, &mut screen, text));
        let file = folder().join(format!("live-{columns}x{rows}.txt"));
        std::fs::write(file, shown).expect("written");
    }
    bench.press("qy");
    bench.end();
}

/// What is on the screen once `text` is.
#[track_caller]
fn wait_for(bench: &mut Bench, screen: &mut Screen, text: &str) -> String {
    let deadline = Instant::now() + PATIENCE;
    while !screen.text().contains(text) {
        assert!(Instant::now() < deadline, "no `{text}`: {}", screen.text());
        bench.read();
        screen.draw(&std::mem::take(&mut bench.drawn));
    }
    screen.text()
}
