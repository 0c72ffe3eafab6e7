//! How much the tests try: as usual, and where Miri interprets every step, some thousand times slower.

use proptest::test_runner::Config;

/// A length or number, `usual` or as `interpreted`.
pub const fn size(usual: usize, interpreted: usize) -> usize {
    if cfg!(miri) { interpreted } else { usual }
}

/// Cases of a property test; `PROPTEST_CASES` takes the place of the `usual` number. Nothing is
/// written where one fails: the message has all of it.
pub fn cases(usual: u32, interpreted: u32) -> Config {
    let default = Config::default();
    let cases = if cfg!(miri) {
        interpreted
    } else if std::env::var_os("PROPTEST_CASES").is_some() {
        default.cases
    } else {
        usual
    };
    Config {
        cases,
        failure_persistence: None,
        ..default
    }
}
