//! Names and messages that come from elsewhere (a file, a board, a folder), where they are shown or
//! written into a file that a program reads: none of them may move the cursor of a terminal, begin a
//! line of its own or turn the direction of writing.

use std::borrow::Cow;

/// What a name is to be, for messages.
pub const PLAIN: &str = "a name without control characters";

/// Whether `name` is one that can stand in a header line, a comment or a table: not empty, and of
/// characters that show.
pub fn is_plain(name: &str) -> bool {
    !name.is_empty() && !name.chars().any(is_hidden)
}

/// The text with all that does not show written out, but for line feeds and tabs where they are
/// the program's own.
pub fn shown(text: &str) -> Cow<'_, str> {
    written_out(text, |c| is_hidden(c) && !matches!(c, '\n' | '\t'))
}

/// As [`shown`], on one line.
pub fn on_a_line(text: &str) -> Cow<'_, str> {
    written_out(text, is_hidden)
}

fn written_out(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if hidden(c) {
            plain.extend(c.escape_default());
        } else {
            plain.push(c);
        }
    }
    Cow::Owned(plain)
}

/// Control characters; and of those that format, the line and paragraph separators, which end a line
/// in YAML and JavaScript, and what turns the direction of writing (Unicode 16, table 23-2).
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_show_is_written_out() {
        assert_eq!(
            shown("a\u{1b}[2Jb\n\tc\u{202e}"),
            "a\\u{1b}[2Jb\n\tc\\u{202e}"
        );
        assert_eq!(on_a_line("run\nimport os"), "run\\nimport os");
        assert!(matches!(shown("Größe, µg/√Hz"), Cow::Borrowed(_)));
    }

    #[test]
    fn a_name_is_of_characters_that_show() {
        for name in ["X", "ax [g]", "Größe", "加速度"] {
            assert!(is_plain(name), "{name}");
        }
        for name in [
            "",
            "x\ny",
            "x\u{1b}[31m",
            "x\u{2028}y",
            "\u{202e}x",
            "x\u{85}y",
        ] {
            assert!(!is_plain(name), "{name:?}");
        }
    }
}
