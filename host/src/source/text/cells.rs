//! The cells of a line, and the number in a cell.

use super::super::options::Decimal;

/// What stands between cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// This character.
    Mark(u8),
    /// Blanks and tabs, as many as there are.
    Blanks,
}

impl Separator {
    /// The one byte between cells of a line that went through [`Self::joined`].
    pub const fn byte(self) -> u8 {
        match self {
            Self::Mark(mark) => mark,
            Self::Blanks => b' ',
        }
    }

    /// A line with one byte between its cells.
    pub fn joined(self, line: &str) -> String {
        if self != Self::Blanks {
            return line.to_owned();
        }
        let mut joined = String::with_capacity(line.len());
        let mut is_quoted = false;
        for one in line.trim().chars() {
            is_quoted ^= one == '"';
            let is_blank = one.is_whitespace() && !is_quoted;
            if !is_blank {
                joined.push(one);
            } else if !joined.ends_with(' ') {
                joined.push(' ');
            }
        }
        joined
    }

    /// The cells of one line.
    pub fn cells(self, line: &str) -> Vec<String> {
        let line = self.joined(line);
        // Most lines have no quotes, and to make a reader takes as long as to read a hundred of them.
        if line.contains(['"', '\r', '\n']) {
            return self.quoted_cells(&line);
        }
        if line.is_empty() {
            return Vec::new();
        }
        let cells = line.split(char::from(self.byte()));
        cells.map(|cell| cell.trim().to_owned()).collect()
    }

    /// The cells of a line that went through [`Self::joined`], any of which may stand in quotes.
    fn quoted_cells(self, line: &str) -> Vec<String> {
        let mut reader = reader(self, line.as_bytes());
        let record = reader.records().next().and_then(Result::ok);
        let record = record.unwrap_or_default();
        record
            .iter()
            .map(|cell| unquoted(cell).to_owned())
            .collect()
    }
}

/// The cells of lines that went through [`Separator::joined`].
pub fn reader(separator: Separator, text: &[u8]) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator.byte())
        .trim(csv::Trim::All)
        .from_reader(text)
}

/// A cell whose quotes do not begin where it does.
fn unquoted(cell: &str) -> &str {
    cell.trim_matches('"').trim()
}

/// The number in a cell, NaN where it is empty or says that there is none.
pub fn number(cell: &str, decimal: Decimal) -> Option<f64> {
    let cell = unquoted(cell);
    let is_none = matches!(
        cell,
        "" | "NA" | "N/A" | "#N/A" | "NULL" | "null" | "None" | "-" | "--"
    );
    // What some C libraries print.
    if is_none || cell.trim_start_matches('-').starts_with("1.#") {
        return Some(f64::NAN);
    }
    match decimal {
        Decimal::Point => cell.parse().ok(),
        Decimal::Comma if cell.contains('.') => None,
        Decimal::Comma => cell.replacen(',', ".", 1).parse().ok(),
    }
}

/// A line with a number and nothing but numbers.
pub fn is_row(cells: &[String], decimal: Decimal) -> bool {
    cells.iter().any(|cell| !cell.is_empty())
        && cells.iter().all(|cell| number(cell, decimal).is_some())
}

/// A line with a word and no number.
pub fn is_words(cells: &[String], decimal: Decimal) -> bool {
    cells.iter().any(|cell| !cell.is_empty())
        && cells
            .iter()
            .all(|cell| cell.is_empty() || number(cell, decimal).is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_without_quotes_has_the_cells_that_it_has_with_the_reader() {
        let lines = [
            "",
            " ",
            ",",
            "1,2",
            " 1 ,\t2,",
            "1;2;;3",
            "a b  c",
            "\t",
            "1\t\t2",
            "\u{a0}1,2\u{2003}",
            "-1e5 , nan",
            "\u{e4},\u{f6}",
        ];
        let marks = [b';', b'\t', b','].map(Separator::Mark);
        for separator in marks.into_iter().chain([Separator::Blanks]) {
            for line in lines {
                let by_reader = separator.quoted_cells(&separator.joined(line));
                assert_eq!(separator.cells(line), by_reader, "{separator:?}: {line:?}");
            }
        }
        let quoted = Separator::Mark(b',').cells("\"a,b\", \"c\"");
        assert_eq!(quoted, ["a,b", "c"]);
    }
}
