//! The README shows what `inm demo` prints.

use assert_cmd::Command;

#[path = "../../xtask/src/excerpt.rs"]
mod excerpt;

/// Units of the last digit shown that a number may be off by: the mathematical functions and the
/// order of the sums differ from machine to machine in bits far below, which can still tip a digit.
const UNITS: f64 = 1.0;

#[test]
fn the_readme_shows_what_the_demonstration_prints() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = Command::new(assert_cmd::cargo::cargo_bin!("inm"))
        .current_dir(folder.path())
        .arg("demo")
        .assert()
        .success();
    let printed = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    let printed = excerpt::of_output(&printed).expect("a diagnosis, and what was hidden");
    let readme = std::fs::read_to_string("../README.md").expect("a README");
    let [_, shown, _] = excerpt::of_readme(&readme).expect("the markers of the demonstration");
    assert_eq!(
        shown.lines().count(),
        printed.lines().count(),
        "run `cargo xtask docs`: the demonstration now prints\n{printed}"
    );
    for (shown, printed) in shown.lines().zip(printed.lines()) {
        assert!(
            same(shown, printed),
            "run `cargo xtask docs`: README.md has\n{shown}\nthe demonstration prints\n{printed}"
        );
    }
}

/// Whether two lines have the same words, and numbers within [`UNITS`].
fn same(one: &str, other: &str) -> bool {
    let words = |line: &str| -> Vec<String> {
        line.split(|c: char| c.is_whitespace() || "(),;".contains(c))
            .filter(|word| !word.is_empty())
            .map(str::to_owned)
            .collect()
    };
    let (one, other) = (words(one), words(other));
    one.len() == other.len()
        && one.iter().zip(&other).all(|(one, other)| {
            let numbers = one.parse::<f64>().ok().zip(other.parse::<f64>().ok());
            one == other
                || numbers.is_some_and(|(a, b)| {
                    // Rounding of both to the digits shown, and of their difference to f64.
                    (a - b).abs() <= (UNITS + 1e-6) * unit(one).max(unit(other))
                })
        })
}

/// A unit of the last digit of a number as it is written.
fn unit(number: &str) -> f64 {
    let (digits, exponent) = number.split_once('e').unwrap_or((number, "0"));
    let decimals = digits.split_once('.').map_or(0, |(_, behind)| behind.len());
    10_f64.powi(exponent.parse::<i32>().unwrap_or(0) - decimals as i32)
}

#[test]
fn numbers_may_differ_in_their_last_digit_alone() {
    assert!(same(
        "f_hz 50.0146 (50.01 to 3.51e-5)",
        "f_hz 50.0147 (50.00 to 3.52e-5)"
    ));
    assert!(!same("f_hz 50.0146", "f_hz 50.0148"));
    assert!(!same("3.51e-5", "3.53e-5"));
    assert!(!same("9498 nats", "9500 nats"));
    assert!(!same("hum 1", "hum"));
    assert!(!same("hum", "sinusoid"));
}
