//! A frame to words: number of the string, time, arguments in the order of the string.

use defmt_parser::{DisplayHint, Fragment, ParserMode, Type, parse};

use super::Line;
use super::table::LogTable;

/// Depth to which what is logged may hold what is logged: more is no frame of ours.
const DEEPEST: u32 = 16;

/// Seconds of a time stamp in microseconds.
const MICROSECOND_S: f64 = 1e-6;

/// What a whole frame says; `None` where it says nothing that the table knows.
pub(super) fn line(table: &LogTable, frame: &[u8]) -> Option<Line> {
    let mut rest = Rest(frame);
    let entry = table.entry(rest.u16()?)?;
    let level = match entry.tag.as_str() {
        "defmt_trace" => "trace",
        "defmt_debug" => "debug",
        "defmt_info" => "info",
        "defmt_warn" => "warn",
        "defmt_error" => "error",
        _ => return None,
    };
    let up_s = match table.timestamp() {
        None => None,
        // The board's own, whose format is said in `firmware/src/image/clock.rs`.
        Some("{=u64:us}") => Some(rest.number(8)? as f64 * MICROSECOND_S),
        Some(_) => return None,
    };
    let what = text(table, &entry.data, &mut rest, 0)?;
    Some(Line {
        up_s,
        level: Some(level),
        from: entry.crate_name.clone(),
        ..Line::say(what)
    })
}

/// A format string with its arguments.
fn text(table: &LogTable, format: &str, rest: &mut Rest<'_>, depth: u32) -> Option<String> {
    if depth > DEEPEST {
        return None;
    }
    let fragments = parse(format, ParserMode::ForwardsCompatible).ok()?;
    let mut arguments: Vec<String> = Vec::new();
    let mut said = String::new();
    for fragment in &fragments {
        match fragment {
            Fragment::Literal(literal) => said += literal,
            Fragment::Parameter(parameter) => {
                // Each comes once, in its order; the same one may be said again.
                if parameter.index == arguments.len() {
                    let hint = parameter.hint.as_ref();
                    arguments.push(argument(table, &parameter.ty, hint, rest, depth)?);
                }
                said += arguments.get(parameter.index)?;
            }
        }
    }
    Some(said)
}

/// One argument in words; `None` of a type that no firmware of this project logs.
fn argument(
    table: &LogTable,
    of: &Type,
    hint: Option<&DisplayHint>,
    rest: &mut Rest<'_>,
    depth: u32,
) -> Option<String> {
    let bytes = match of {
        Type::U8 | Type::I8 => 1,
        Type::U16 | Type::I16 => 2,
        Type::U32 | Type::I32 | Type::Usize | Type::Isize => 4,
        Type::U64 | Type::I64 => 8,
        Type::Bool => return Some((rest.number(1)? != 0).to_string()),
        Type::F32 => return Some(f32::from_bits(u32::try_from(rest.number(4)?).ok()?).to_string()),
        Type::Str => {
            let length = usize::try_from(rest.number(4)?).ok()?;
            return String::from_utf8(rest.take(length)?.to_vec()).ok();
        }
        Type::IStr => return Some(table.entry(rest.u16()?)?.data.clone()),
        // Text without a length, up to a byte that no text has.
        Type::Debug | Type::Display => {
            let length = rest.0.iter().position(|&byte| byte == 0xff)?;
            let text = String::from_utf8(rest.take(length)?.to_vec()).ok();
            rest.take(1)?;
            return text;
        }
        Type::Format => {
            let format = &table.entry(rest.u16()?)?.data;
            let format = variant(format, rest)?;
            return text(table, format, rest, depth + 1);
        }
        _ => return None,
    };
    let number = rest.number(bytes)?;
    let signed = matches!(
        of,
        Type::I8 | Type::I16 | Type::I32 | Type::I64 | Type::Isize
    );
    Some(match hint {
        Some(DisplayHint::Hexadecimal { zero_pad, .. }) => format!("{number:0zero_pad$x}"),
        _ if signed => {
            let unused = 64 - 8 * bytes as u32;
            ((number << unused) as i64 >> unused).to_string()
        }
        _ => number.to_string(),
    })
}

/// Of a type with variants, `A|B|C`, the one that comes; others as they are.
fn variant<'f>(format: &'f str, rest: &mut Rest<'_>) -> Option<&'f str> {
    if !format.contains('|') {
        return Some(format);
    }
    // As many bytes as the number of the last one takes; none of ours has more than 256.
    let number = usize::try_from(rest.number(1)?).ok()?;
    format.split('|').nth(number)
}

/// What is left of a frame.
struct Rest<'f>(&'f [u8]);

impl<'f> Rest<'f> {
    fn take(&mut self, bytes: usize) -> Option<&'f [u8]> {
        let (taken, rest) = self.0.split_at_checked(bytes)?;
        self.0 = rest;
        Some(taken)
    }

    /// A number of so many bytes, the lowest first.
    fn number(&mut self, bytes: usize) -> Option<u64> {
        let taken = self.take(bytes)?.iter().rev();
        Some(taken.fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }

    fn u16(&mut self) -> Option<u16> {
        u16::try_from(self.number(2)?).ok()
    }
}
