//! The lines of a text file, cleaned: without byte order mark, line end and comment.

use std::io::BufRead;

use super::super::SourceError;

/// Longest line that is believed, bytes. A binary file without line ends stops here.
const LONGEST_LINE: usize = 1 << 16;

/// A line with something on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Its number, from 1.
    pub number: u64,
    /// What stands before the comment.
    pub text: String,
    /// What stands in the comment of a line that holds nothing else.
    pub comment: Option<String>,
    /// Whether a line end follows: not at the end of a file that was cut off.
    pub is_whole: bool,
}

/// Reads lines one by one.
pub struct Lines {
    name: String,
    reader: Box<dyn BufRead>,
    number: u64,
    bytes: Vec<u8>,
}

impl Lines {
    /// Lines of `reader`, which messages call `name`.
    pub fn new(name: &str, reader: Box<dyn BufRead>) -> Self {
        Self {
            name: name.to_owned(),
            reader,
            number: 0,
            bytes: Vec::new(),
        }
    }

    fn error(&self, column: Option<usize>, message: String, remedy: &str) -> SourceError {
        let column = column.map_or(String::new(), |column| format!(":{column}"));
        SourceError {
            place: format!("{}:{}{column}", self.name, self.number),
            message,
            remedy: remedy.to_owned(),
        }
    }

    /// The next line with something on it, `None` at the end.
    ///
    /// # Errors
    /// If the file cannot be read or is no text.
    pub fn next(&mut self) -> Result<Option<Line>, SourceError> {
        loop {
            self.bytes.clear();
            self.number += 1;
            let mut limited = std::io::Read::take(&mut self.reader, LONGEST_LINE as u64);
            let length = limited
                .read_until(b'\n', &mut self.bytes)
                .map_err(|error| self.error(None, format!("cannot be read: {error}"), ""))?;
            if length == 0 {
                return Ok(None);
            }
            if length == LONGEST_LINE {
                return Err(self.error(
                    None,
                    format!("a line of more than {LONGEST_LINE} bytes"),
                    "expected one sample a line, one column per axis",
                ));
            }
            let text = std::str::from_utf8(&self.bytes).map_err(|error| {
                self.error(
                    Some(error.valid_up_to() + 1),
                    "this is not text".into(),
                    "array files are .npy, or text (ASCII or UTF-8) with one sample a line",
                )
            })?;
            let is_whole = text.ends_with('\n');
            let (text, comment) = cut(text.trim_start_matches('\u{feff}'));
            // The reader of cells would begin a row there, of which nobody has a number.
            if text.contains('\r') {
                return Err(self.error(
                    None,
                    "a carriage return within a line".into(),
                    "save with a line feed at the end of each line, as `tr '\\r' '\\n'` writes them",
                ));
            }
            if text.matches('"').count() % 2 == 1 && is_whole {
                return Err(self.error(
                    None,
                    "a quote is opened and not closed".into(),
                    "close the quote, or delete the line",
                ));
            }
            if !text.trim().is_empty() || !comment.is_empty() {
                return Ok(Some(Line {
                    number: self.number,
                    comment: text.trim().is_empty().then(|| comment.to_owned()),
                    text: text.to_owned(),
                    is_whole,
                }));
            }
        }
    }
}

/// A line before and after the mark of a comment: `#` ahead of the line or after a blank, `%` and a
/// blank, or `//`, ahead of the line.
fn cut(line: &str) -> (&str, &str) {
    let line = line.trim_matches([' ', '\r', '\n']);
    let start = line.trim_start();
    for mark in ["% ", "%\t", "//"] {
        if let Some(comment) = start.strip_prefix(mark) {
            return ("", comment.trim());
        }
    }
    let (mut is_quoted, mut before) = (false, ' ');
    for (at, one) in line.char_indices() {
        match one {
            '"' => is_quoted = !is_quoted,
            // Not the `1.#QNAN` of some C libraries, nor the `#N/A` of spreadsheets.
            '#' if !is_quoted && before.is_whitespace() => {
                return (line[..at].trim_end_matches(' '), line[at + 1..].trim());
            }
            _ => {}
        }
        before = one;
    }
    (line, "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_cut_and_words_are_not() {
        for (line, expected) in [
            ("1,2 # why\r\n", ("1,2", "why")),
            ("# t,x\n", ("", "t,x")),
            ("% t x\n", ("", "t x")),
            ("// made by hand", ("", "made by hand")),
            ("%time,x\n", ("%time,x", "")),
            ("\"acc #1\",x\n", ("\"acc #1\",x", "")),
            ("1,1.#QNAN\n", ("1,1.#QNAN", "")),
            ("1,#N/A\n", ("1,#N/A", "")),
            ("1,\t\n", ("1,\t", "")),
        ] {
            assert_eq!(cut(line), expected, "{line}");
        }
    }
}
