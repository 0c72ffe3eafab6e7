//! What docs/how-to/bring-up.md says of pins, clocks, supplies and limits is made of the sources, and the
//! table of pins at the top of firmware/src/board.rs is what the code below it sets up.
//!
//! `INM_WRITE_TABLES=1 cargo test -p xtask bring_up` writes the page's parts anew; without it a part that
//! differs is a failure.
#![cfg(test)]

use std::fs;

use crate::layers::lexer::tokens;
use crate::run::root;

const PAGE: &str = "docs/how-to/bring-up.md";
const BOARD: &str = "firmware/src/board.rs";
const ANALOG: &str = "firmware/src/board/analog.rs";
const OSCILLATOR: &str = "firmware/src/board/oscillator.rs";
const IMAGE: &str = "firmware/src/image/mod.rs";
const PLATFORM: &str = "firmware/src/platform.rs";
const DRIVER: &str = "ads1281/src/lib.rs";
const SHEET: &str = "host/src/data_sheet.rs";

/// What `inm board selftest` prints of the virtual board, as its own test holds it.
const SELF_TEST: &str = "host/tests/board/snapshots/board__checked__selftest_as_text.snap";

/// Pins that the code leaves as a reset does: the crystal's, and the debug probe's.
const NOT_TAKEN: [&str; 4] = ["PH0", "PH1", "PA13", "PA14"];

/// If set, the parts are written instead of compared.
const WRITE: &str = "INM_WRITE_TABLES";

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Pins and their use, in the order of the table: its left half, then its right half.
fn table(source: &str) -> Vec<[String; 2]> {
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for line in source
        .lines()
        .filter_map(|line| line.strip_prefix("//! | P"))
    {
        let line = format!("P{line}");
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [a, what_a, b, what_b, ""] = cells[..] else {
            panic!("{BOARD}: four cells are expected in `{line}`");
        };
        left.push([a.to_owned(), what_a.to_owned()]);
        right.push([b.to_owned(), what_b.to_owned()]);
    }
    left.append(&mut right);
    left
}

/// What the table says of a pin.
fn use_of<'t>(table: &'t [[String; 2]], pin: &str) -> Option<&'t str> {
    let mut rows = table.iter();
    let row = rows.find(|[pins, _]| pins.split(", ").any(|one| one == pin));
    row.map(|[_, what]| what.as_str())
}

/// Pins among the tokens of a source, as `a.pa5`, each with the place of its port's letter.
fn pins(tokens: &[&str]) -> Vec<(usize, String)> {
    let pin = |(at, three): (usize, &[&str])| match *three {
        [port, ".", pin]
            if pin
                .strip_prefix('p')?
                .strip_prefix(port)?
                .parse::<u8>()
                .is_ok() =>
        {
            Some((at, pin.to_uppercase()))
        }
        _ => None,
    };
    tokens.windows(3).enumerate().filter_map(pin).collect()
}

/// The pins in the first statement, or list of arguments, that begins with `words`.
fn pins_behind(tokens: &[&str], words: &[&str]) -> Vec<String> {
    let mut starts = tokens.windows(words.len());
    let start = starts.position(|window| window == words);
    let start = start.unwrap_or_else(|| panic!("{BOARD}: no `{}`", words.join(" ")));
    let end = tokens[start..].iter().position(|&token| token == ";");
    let statement = &tokens[start..start + end.unwrap_or(0)];
    pins(statement).into_iter().map(|(_, pin)| pin).collect()
}

/// The right-hand side of `name = ... ;` or `name: ... ,`, without the separators of digits.
fn said(path: &str, name: &str) -> String {
    let text = read(path);
    let tokens = tokens(&text);
    let from = |words: &[&str]| {
        let mut windows = tokens.windows(words.len());
        windows
            .position(|window| window == words)
            .map(|at| at + words.len())
    };
    let (start, end) = match from(&["const", name, ":"]) {
        Some(at) => {
            let equals = tokens[at..].iter().position(|&token| token == "=");
            (at + equals.expect("a constant has a value") + 1, ";")
        }
        None => (
            from(&[name, ":"]).unwrap_or_else(|| panic!("{path}: no {name}")),
            ",",
        ),
    };
    let value = tokens[start..].iter().take_while(|&&token| token != end);
    value.copied().collect::<String>().replace('_', "")
}

/// The number that a source gives a name.
fn number(path: &str, name: &str) -> f64 {
    let said = said(path, name);
    said.parse()
        .unwrap_or_else(|_| panic!("{path}: {name} is `{said}`, a number is expected"))
}

fn wiring() -> String {
    let rows = table(&read(BOARD))
        .into_iter()
        .map(|[pins, what]| format!("| {pins} | {what} |\n"));
    "| pin of the STM32F405RG | wired to |\n|---|---|\n".to_owned() + &rows.collect::<String>()
}

fn figures() -> String {
    let mhz = |path, name| number(path, name) * 1e-6;
    let volts = |name| number(IMAGE, name) * 1e-6;
    let supply = said(SHEET, "SENSOR_SUPPLY_V");
    let supply = supply.trim_matches(['[', ']']).replace(',', " to ");
    let nominal = volts("sensor_supply_uv");
    let range = said(IMAGE, "range").replace("SensorRange::G", "");
    let rows = [
        (
            "crystal",
            format!("{} MHz", mhz(OSCILLATOR, "CRYSTAL_HZ")),
            OSCILLATOR,
        ),
        (
            "oscillator of the converters, one for all three",
            format!("{} MHz", mhz(DRIVER, "CLOCK_HZ")),
            DRIVER,
        ),
        (
            "SCLK of each bus, mode 0",
            format!("{} MHz", mhz(IMAGE, "SPI_HZ")),
            IMAGE,
        ),
        (
            "serial line",
            format!("{} bit/s", number(PLATFORM, "BAUD")),
            IMAGE,
        ),
        (
            "reference of the converters, VREFP to VREFN",
            format!("{} V", volts("reference_uv")),
            IMAGE,
        ),
        (
            "supply of the accelerometers",
            format!("{nominal} V; they are specified for {supply} V"),
            SHEET,
        ),
        (
            "AINN of each converter: half that supply, from the reference",
            format!("{} V", nominal / 2.0),
            "firmware/src/mma7331l.rs",
        ),
        ("range, by g-Select", format!("{range} g"), IMAGE),
        (
            "divider of the supply at PC0",
            format!("by {}", number(ANALOG, "SUPPLY_DIVIDER")),
            ANALOG,
        ),
    ];
    let rows = rows.map(|(what, value, from)| format!("| {what} | {value} | `{from}` |\n"));
    "| what | value | from |\n|---|---|---|\n".to_owned() + &rows.concat()
}

fn self_test() -> String {
    let snapshot = read(SELF_TEST);
    let body = snapshot
        .splitn(3, "---\n")
        .nth(2)
        .expect("a head and a body");
    format!("```text\n{body}```\n")
}

/// Holds the part of the page that is called `name` to what was made.
fn hold(name: &str, made: &str) {
    let begin =
        format!("<!-- {name}, of the sources: {WRITE}=1 cargo test -p xtask bring_up -->\n");
    let end = format!("<!-- end of {name} -->");
    let page = read(PAGE);
    let (before, rest) = page.split_once(&begin).expect("the line that begins it");
    let (written, after) = rest.split_once(&end).expect("the line that ends it");
    if std::env::var_os(WRITE).is_some() {
        let all = [before, &begin, made, &end, after].concat();
        fs::write(root().join(PAGE), all).expect("it can be written");
        return;
    }
    let differs = written.lines().zip(made.lines()).find(|(a, b)| a != b);
    assert!(
        written == made,
        "{PAGE}: {name} is not what the sources say: {WRITE}=1 cargo test -p xtask bring_up\nwritten and \
         made, the first line that differs: {differs:#?}"
    );
}

/// One test, for they write to one file.
#[test]
fn the_page_says_what_the_sources_say() {
    for (name, made) in [
        ("wiring", wiring()),
        ("figures", figures()),
        ("self-test", self_test()),
    ] {
        hold(name, &made);
    }
}

#[test]
fn the_table_of_pins_is_what_the_code_sets_up() {
    let text = read(BOARD);
    let (table, tokens) = (table(&text), tokens(&text));
    let taken: Vec<String> = pins(&tokens).into_iter().map(|(_, pin)| pin).collect();
    for pin in &taken {
        assert!(use_of(&table, pin).is_some(), "{pin} is not in the table");
    }
    let listed = table.iter().flat_map(|[pins, _]| pins.split(", "));
    for pin in listed.filter(|pin| !NOT_TAKEN.contains(pin)) {
        assert!(
            taken.iter().any(|one| one == pin),
            "{pin} is not in the code"
        );
    }
    let uses: [(&[&str], &[&str]); 10] = [
        (
            &["chip", ".", "SPI1", ","],
            &["X: SPI1 SCLK", "X: SPI1 DOUT", "X: SPI1 DIN"],
        ),
        (
            &["chip", ".", "SPI2", ","],
            &["Y: SPI2 SCLK", "Y: SPI2 DOUT", "Y: SPI2 DIN"],
        ),
        (
            &["chip", ".", "SPI3", ","],
            &["Z: SPI3 SCLK", "Z: SPI3 DOUT", "Z: SPI3 DIN"],
        ),
        (
            &["let", "mut", "drdy", "="],
            &["X: DRDY, EXTI4", "Y: DRDY, EXTI5", "Z: DRDY, EXTI6"],
        ),
        (&["let", "sync", "="], &["SYNC"]),
        (&["let", "mut", "range", "="], &["g-Select"]),
        (&["let", "mut", "self_test", "="], &["self-test"]),
        (&["let", "rx", "="], &["from the host: USART1 RX"]),
        (&["let", "link", "="], &["to the host: USART1 TX"]),
        (
            &["let", "analog", "="],
            &["half the accelerometers' supply"],
        ),
    ];
    for (words, expected) in uses {
        let pins = pins_behind(&tokens, words);
        assert_eq!(pins.len(), expected.len(), "{words:?}: {pins:?}");
        for (pin, expected) in pins.iter().zip(expected) {
            let found = use_of(&table, pin).unwrap_or_default();
            assert!(
                found.starts_with(expected),
                "{pin}: the table says `{found}`, the code `{expected}`"
            );
        }
    }
}

#[test]
fn a_pin_that_moves_in_the_code_or_in_the_table_is_seen() {
    let source = "//! | PA5 | X: SCLK | PC4 | X: DRDY |\nlet x = Spi::new(a.pa6);";
    let table = table(source);
    assert_eq!(use_of(&table, "PC4"), Some("X: DRDY"));
    let tokens = tokens(source);
    assert_eq!(pins_behind(&tokens, &["let", "x"]), ["PA6"]);
    assert_eq!(use_of(&table, "PA6"), None);
}
