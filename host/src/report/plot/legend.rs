//! What the marks of a picture mean, in one row above it.

use std::fmt::Write;

use super::Stroke;
use crate::report::svg::Theme;

/// Width of a mark, and of the space behind it, pixels.
const MARK: f64 = 24.0;
const GAP: f64 = 6.0;

/// Space between two entries.
const APART: f64 = 14.0;

/// Width of a letter, as a part of the font's size: of DejaVu Sans on average, which is wide.
const LETTER: f64 = 0.58;

/// Size of the text.
const FONT: f64 = 12.0;

/// What stands before the text of an entry.
#[derive(Debug, Clone, Copy)]
pub enum Mark {
    /// A line.
    Line(Stroke),
    /// A dot on a band of the same colour and this opacity.
    DotOnBand(&'static str, f64),
    /// A line on a band of the same colour and this opacity.
    LineOnBand(Stroke, f64),
    /// A small cross.
    Cross(&'static str),
    /// An area of this opacity.
    Area(&'static str, f64),
}

/// Width of a text, pixels, on average.
pub fn text_width(text: &str, font: f64) -> f64 {
    text.chars().count() as f64 * LETTER * font
}

/// Draws the entries from `left` on, on the line of text `y`.
pub fn draw(svg: &mut String, theme: &Theme, left: f64, y: f64, entries: &[(Mark, String)]) {
    let mut x = left;
    for (mark, text) in entries {
        let (top, line) = (y - 9.5, y - 4.0);
        let middle = x + 0.5 * MARK;
        let area = |colour: &str, opacity: f64| {
            format!(
                "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"{MARK}\" height=\"11\" \
                 fill=\"{colour}\" fill-opacity=\"{opacity}\"/>"
            )
        };
        let stroke = |stroke: Stroke| {
            format!(
                "<path d=\"M{x:.1} {line}h{MARK}\" {}/>",
                stroke.attributes()
            )
        };
        let drawn = match *mark {
            Mark::Line(one) => stroke(one),
            Mark::DotOnBand(colour, opacity) => format!(
                "{}<circle cx=\"{middle:.1}\" cy=\"{line}\" r=\"2.6\" fill=\"{colour}\"/>",
                area(colour, opacity)
            ),
            Mark::LineOnBand(one, opacity) => {
                format!("{}{}", area(one.colour, opacity), stroke(one))
            }
            Mark::Cross(colour) => cross(middle, line, colour),
            Mark::Area(colour, opacity) => area(colour, opacity),
        };
        // Writing to a string cannot fail.
        let _ = write!(
            svg,
            "{drawn}<text x=\"{:.1}\" y=\"{y}\" fill=\"{}\">{text}</text>",
            x + MARK + GAP,
            theme.ink
        );
        x += MARK + GAP + text_width(text, FONT) + APART;
    }
}

/// A small upright cross.
pub fn cross(x: f64, y: f64, colour: &str) -> String {
    format!(
        "<path d=\"M{:.1} {y:.1}h5M{x:.1} {:.1}v5\" fill=\"none\" stroke=\"{colour}\" \
         stroke-width=\"1.2\"/>",
        x - 2.5,
        y - 2.5
    )
}
