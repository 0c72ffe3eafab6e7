//! What can be drawn in a frame: lines, bands, dots, shades, names. Places are values, not pixels.

use std::fmt::Write;

use super::Stroke;
use super::frame::{Field, Frame, LEFT, RIGHT, Span, TOP};
use super::legend::cross;
use super::tags::{self, Tag};

/// Height of a bar on the lower edge.
const UNDERLINE: f64 = 5.0;

/// Height of a row of tags.
const ROW: f64 = 13.0;

impl Frame<'_> {
    /// A line through points, with a hole wherever one is not a number.
    pub fn line(
        &mut self,
        field: Field,
        points: impl IntoIterator<Item = (f64, f64)>,
        stroke: Stroke,
    ) {
        let mut path = String::new();
        let mut letter = 'M';
        for point in points {
            let (x, y) = self.at(field, point);
            if x.is_nan() || y.is_nan() {
                letter = 'M';
                continue;
            }
            let _ = write!(path, "{letter}{x:.1} {y:.1}");
            letter = 'L';
        }
        let _ = write!(
            self.drawn[field as usize],
            "<path d=\"{path}\" {}/>",
            stroke.attributes()
        );
    }

    /// The area between two curves, given as `(x, low, high)`, with a hole wherever one is not a
    /// number.
    pub fn band(&mut self, field: Field, points: &[(f64, f64, f64)], colour: &str, opacity: f64) {
        let sound = |&(x, low, high): &(f64, f64, f64)| !(x + low + high).is_nan();
        let mut path = String::new();
        for piece in points.split(|point| !sound(point)) {
            let upper = piece.iter().map(|&(x, _, high)| (x, high));
            let lower = piece.iter().rev().map(|&(x, low, _)| (x, low));
            let mut letter = 'M';
            for point in upper.chain(lower) {
                let (x, y) = self.at(field, point);
                let _ = write!(path, "{letter}{x:.1} {y:.1}");
                letter = 'L';
            }
            if letter == 'L' {
                path.push('Z');
            }
        }
        let _ = write!(
            self.drawn[field as usize],
            "<path d=\"{path}\" fill=\"{colour}\" fill-opacity=\"{opacity}\"/>"
        );
    }

    /// Draws a dot at each of the points.
    pub fn dots(
        &mut self,
        field: Field,
        points: impl IntoIterator<Item = (f64, f64)>,
        radius: f64,
        colour: &str,
    ) {
        for point in points {
            let (x, y) = self.at(field, point);
            let _ = write!(
                self.drawn[field as usize],
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{colour}\"/>"
            );
        }
    }

    /// Draws a cross at each of the points.
    pub fn crosses(&mut self, field: Field, points: impl IntoIterator<Item = (f64, f64)>) {
        let colour = self.theme.simulated;
        for point in points {
            let (x, y) = self.at(field, point);
            self.drawn[field as usize].push_str(&cross(x, y, colour));
        }
    }

    /// Upright intervals, given as `(x, low, high)`.
    pub fn intervals(
        &mut self,
        field: Field,
        intervals: impl IntoIterator<Item = (f64, f64, f64)>,
        colour: &str,
        opacity: f64,
    ) {
        let mut path = String::new();
        for (x, low, high) in intervals {
            let ((x, y0), (_, y1)) = (self.at(field, (x, low)), self.at(field, (x, high)));
            let _ = write!(path, "M{x:.1} {y0:.1}V{y1:.1}");
        }
        let _ = write!(
            self.drawn[field as usize],
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\"{opacity}\"/>"
        );
    }

    /// Shades main field and strip between two values, at least two pixels wide.
    pub fn shade(&mut self, from: f64, to: f64, colour: &str, opacity: f64) {
        let ends = (self.x.at(from), self.x.at(to));
        let middle = 0.5 * (ends.0 + ends.1);
        let left = ends.0.min(middle - 1.0).max(LEFT);
        let right = ends.1.max(middle + 1.0).min(RIGHT);
        if right <= left {
            return;
        }
        let rect = |(top, bottom): Span| {
            format!(
                "<rect x=\"{left:.1}\" y=\"{top}\" width=\"{:.1}\" height=\"{}\" \
                 fill=\"{colour}\" fill-opacity=\"{opacity}\"/>",
                right - left,
                bottom - top
            )
        };
        let (main, strip) = (rect(self.layout.main()), rect(self.layout.strip()));
        self.drawn[0].push_str(&main);
        if self.strip.is_some() {
            self.drawn[1].push_str(&strip);
        }
    }

    /// A bar on the lower edge of the main field between two values, at least two pixels wide.
    pub fn underline(&mut self, from: f64, to: f64, colour: &str) {
        let middle = 0.5 * (self.x.at(from) + self.x.at(to));
        let left = self.x.at(from).min(middle - 1.0).max(LEFT);
        let right = self.x.at(to).max(middle + 1.0).min(RIGHT);
        let bottom = self.layout.main().1;
        let _ = write!(
            self.drawn[0],
            "<rect x=\"{left:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{UNDERLINE}\" \
             fill=\"{colour}\"/>",
            bottom - UNDERLINE,
            (right - left).max(0.0)
        );
    }

    /// An upright line through main field and strip.
    pub fn upright(&mut self, x: f64, stroke: Stroke) {
        let x = self.x.at(x);
        let path = |(top, bottom): Span| {
            format!(
                "<path d=\"M{x:.1} {top}V{bottom}\" {}/>",
                stroke.attributes()
            )
        };
        let (main, strip) = (path(self.layout.main()), path(self.layout.strip()));
        self.drawn[0].push_str(&main);
        if self.strip.is_some() {
            self.drawn[1].push_str(&strip);
        }
    }

    /// Names at values of the horizontal axis, along the upper edge; the first in the list find
    /// their places first.
    pub fn tags(&mut self, names: impl IntoIterator<Item = (f64, String)>, colour: &str) {
        let tags: Vec<Tag> = names
            .into_iter()
            .map(|(x, text)| Tag {
                at: self.x.at(x),
                text,
            })
            .filter(|tag| (LEFT..=RIGHT).contains(&tag.at))
            .collect();
        for one in tags::place(&tags, LEFT, RIGHT) {
            self.text(
                one.left,
                TOP + ROW * (one.row as f64 + 1.0),
                &format!("fill=\"{colour}\" font-size=\"{}\"", tags::FONT),
                &one.tag.text,
            );
        }
    }
}
