//! What stands between the cells of a file, and within its numbers: the way that reads most lines.

use super::super::SourceError;
use super::super::options::Decimal;
use super::cells::{Separator, is_row, is_words};
use super::lines::Line;

/// The ways to write rows, the likelier of two that read the same lines first.
const WAYS: [(Separator, Decimal); 7] = [
    (Separator::Mark(b';'), Decimal::Point),
    (Separator::Mark(b';'), Decimal::Comma),
    (Separator::Mark(b'\t'), Decimal::Point),
    (Separator::Mark(b'\t'), Decimal::Comma),
    (Separator::Mark(b','), Decimal::Point),
    (Separator::Blanks, Decimal::Point),
    (Separator::Blanks, Decimal::Comma),
];

/// What is tried between cells.
const SEPARATORS: [Separator; 4] = [
    Separator::Mark(b';'),
    Separator::Mark(b'\t'),
    Separator::Mark(b','),
    Separator::Blanks,
];

/// The cells of each line, `None` where it has none of the marks.
fn cells(lines: &[&Line], separator: Separator) -> Vec<Option<Vec<String>>> {
    let has = |line: &Line| match separator {
        Separator::Mark(mark) => line.text.as_bytes().contains(&mark),
        Separator::Blanks => true,
    };
    let lines = lines.iter();
    lines
        .map(|line| has(line).then(|| separator.cells(&line.text)))
        .collect()
}

/// The way that reads most lines as rows.
///
/// # Errors
/// If two ways do.
pub fn way(
    name: &str,
    lines: &[Line],
    decimal: Option<Decimal>,
) -> Result<(Separator, Decimal), SourceError> {
    let texts: Vec<&Line> = lines.iter().filter(|line| line.comment.is_none()).collect();
    let cut = SEPARATORS.map(|separator| (separator, cells(&texts, separator)));
    let cut = |separator: Separator| {
        let found = cut.iter().find(|(one, _)| *one == separator);
        found.map_or(&[][..], |(_, cells)| cells)
    };
    let reads = |cells: &Option<Vec<String>>, decimal| {
        cells.as_ref().is_some_and(|cells| is_row(cells, decimal))
    };
    let mut best = None;
    for one in WAYS {
        let rows = cut(one.0).iter().filter(|cells| reads(cells, one.1));
        let count = rows.count();
        let is_allowed = decimal.is_none_or(|decimal| decimal == one.1);
        if is_allowed && count > best.map_or(0, |(most, _)| most) {
            best = Some((count, one));
        }
    }
    let Some((_, best)) = best else {
        let has = |mark| {
            texts
                .first()
                .is_some_and(|line| line.text.as_bytes().contains(&mark))
        };
        let mark = [b';', b'\t', b','].into_iter().find(|&mark| has(mark));
        let separator = mark.map_or(Separator::Blanks, Separator::Mark);
        return Ok((separator, decimal.unwrap_or(Decimal::Point)));
    };
    let column = (Separator::Blanks, Decimal::Comma);
    let two = (Separator::Mark(b','), Decimal::Point);
    let pairs = cut(two.0).iter().filter(|cells| reads(cells, two.1));
    let pairs: Vec<&Vec<String>> = pairs.flatten().collect();
    let both = cut(two.0).iter().zip(cut(column.0));
    let both = both.filter(|(pair, one)| reads(pair, two.1) && reads(one, column.1));
    let is_open = [two, column].contains(&best) && decimal.is_none();
    if is_open && !pairs.is_empty() && both.count() == pairs.len() {
        return commas(name, lines, &pairs, two, column);
    }
    Ok(best)
}

/// `12,34` line after line: two columns of whole numbers, or one with decimal commas?
fn commas(
    name: &str,
    lines: &[Line],
    rows: &[&Vec<String>],
    two: (Separator, Decimal),
    one: (Separator, Decimal),
) -> Result<(Separator, Decimal), SourceError> {
    // Names above the rows, in a comment too, as long as prose does not pass for them.
    let above = lines
        .iter()
        .map(|line| line.comment.as_ref().unwrap_or(&line.text));
    let above = above
        .map(|text| two.0.cells(text))
        .take_while(|cells| is_words(cells, two.1));
    match above.last() {
        Some(names) if names.len() == 2 => return Ok(two),
        Some(_) if lines[0].comment.is_none() => return Ok(one),
        _ => {}
    }
    let fractions = || rows.iter().filter_map(|cells| cells.get(1));
    // No whole number is written 05, and -0 has no sign.
    let is_fraction = |cell: &String| cell.len() > 1 && cell.starts_with('0');
    if fractions().any(is_fraction) || rows.iter().any(|cells| cells[0] == "-0") {
        return Ok(one);
    }
    let digits = |cell: &String| cell.len();
    if fractions().map(digits).min() != fractions().map(digits).max() {
        return Ok(two);
    }
    Err(SourceError {
        place: name.to_owned(),
        message: "the commas may be decimal, or stand between two columns of whole numbers".into(),
        remedy: "give --decimal comma, or --decimal point".into(),
    })
}
