//! The frame of a picture: a main field with two scales, below it a strip with the same
//! horizontal one.
//!
//! What is drawn is given in values, not in pixels; it may leave the field, the frame cuts it.

use std::fmt::Write;

use super::legend::{self, Mark};
use super::scale::{Scale, power_of_ten};
use super::tags::{self, Tag};
use super::{Stroke, legend::cross};
use crate::report::svg::Theme;

/// Width of a picture, pixels.
pub const WIDTH: f64 = 760.0;

/// The field, pixels.
pub const LEFT: f64 = 64.0;
/// The field, pixels.
pub const RIGHT: f64 = WIDTH - 18.0;
/// The field, pixels.
pub const TOP: f64 = 34.0;

/// Height of the strip, of the space above it, and of what lies below both.
const STRIP: f64 = 90.0;
const SPACE: f64 = 26.0;
const FOOT: f64 = 52.0;

/// Pixels beyond which nothing is worth a number.
const FAR: f64 = 1e4;

/// Height of a bar on the lower edge.
const UNDERLINE: f64 = 5.0;

/// Height of a row of tags.
const ROW: f64 = 13.0;

/// A part of the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// The main field.
    Main,
    /// The strip below.
    Strip,
}

/// Ends of a field from top to bottom, pixels.
type Span = (f64, f64);

/// Where things are in a picture.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// Height of the picture, pixels.
    pub height: f64,
    /// Whether there is a strip.
    pub strip: bool,
}

impl Layout {
    /// The main field from top to bottom.
    pub const fn main(self) -> Span {
        let room = if self.strip { STRIP + SPACE } else { 0.0 };
        (TOP, self.height - FOOT - room)
    }

    /// The strip from top to bottom.
    pub const fn strip(self) -> Span {
        (self.height - FOOT - STRIP, self.height - FOOT)
    }
}

/// What an axis shows, and its unit, as SVG text.
#[derive(Debug, Clone, Default)]
pub struct Title {
    name: String,
    unit: String,
}

impl Title {
    /// Of the quantity `name` in `unit`.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        let (name, unit) = (name.into(), unit.into());
        Self { name, unit }
    }

    /// With the power of ten that the labels of `scale` leave out.
    fn text(&self, scale: &Scale) -> String {
        let Self { name, unit } = self;
        let power = match scale.exponent() {
            0 => String::new(),
            exponent => power_of_ten(exponent),
        };
        match (power.as_str(), unit.as_str()) {
            ("", "") => name.clone(),
            (power, "") => format!("{name}, {power}"),
            ("", unit) => format!("{name}, {unit}"),
            (power, unit) => format!("{name}, {power} {unit}"),
        }
    }
}

/// What stands beside the fields.
#[derive(Debug, Clone, Default)]
pub struct Titles {
    /// Above, bold.
    pub head: String,
    /// Below.
    pub x: Title,
    /// On the left.
    pub y: Title,
    /// In the strip.
    pub strip: Title,
}

/// A picture in the making.
pub struct Frame<'a> {
    id: &'a str,
    theme: &'a Theme,
    layout: Layout,
    titles: Titles,
    x: Scale,
    main: Scale,
    strip: Option<Scale>,
    drawn: [String; 2],
    over: String,
    legend: Vec<(Mark, String)>,
}

impl<'a> Frame<'a> {
    /// An empty one; `id` is unique within the document. The scales' values are given, their pixels
    /// are the layout's.
    pub fn new(
        id: &'a str,
        theme: &'a Theme,
        layout: Layout,
        titles: Titles,
        x: impl FnOnce(Span) -> Scale,
        y: impl FnOnce(Span) -> Scale,
    ) -> Self {
        let (top, bottom) = layout.main();
        Self {
            id,
            theme,
            layout,
            titles,
            x: x((LEFT, RIGHT)),
            main: y((bottom, top)),
            strip: None,
            drawn: Default::default(),
            over: String::new(),
            legend: Vec::new(),
        }
    }

    /// Gives the strip its scale.
    pub fn set_strip(&mut self, ends: (f64, f64)) {
        let (top, bottom) = self.layout.strip();
        self.strip = Some(Scale::linear(ends, (bottom, top)));
    }

    /// The horizontal scale.
    pub const fn x(&self) -> &Scale {
        &self.x
    }

    /// The main field's vertical scale.
    pub const fn y(&self) -> &Scale {
        &self.main
    }

    /// Colours.
    pub const fn theme(&self) -> &'a Theme {
        self.theme
    }

    fn at(&self, field: Field, (x, y): (f64, f64)) -> (f64, f64) {
        let scale = match field {
            Field::Main => &self.main,
            Field::Strip => self.strip.as_ref().unwrap_or(&self.main),
        };
        // A value of zero on a logarithmic scale lies far below.
        (self.x.at(x), scale.at(y).clamp(-FAR, FAR))
    }

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

    /// Dots.
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

    /// Crosses.
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

    /// Text that stands over everything else, with a rim of the paper's colour; pixels.
    pub fn text(&mut self, x: f64, y: f64, attributes: &str, text: &str) {
        let _ = write!(
            self.over,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" {attributes} stroke=\"{}\" stroke-width=\"4\" \
             paint-order=\"stroke\">{text}</text>",
            self.theme.rim
        );
    }

    /// One more entry of the legend.
    pub fn explain(&mut self, mark: Mark, text: impl Into<String>) {
        self.legend.push((mark, text.into()));
    }

    /// The picture as SVG elements.
    pub fn finish(self) -> String {
        let mut svg = String::new();
        let Self {
            id, theme, layout, ..
        } = self;
        let mut fields = vec![(layout.main(), &self.main)];
        fields.extend(self.strip.as_ref().map(|scale| (layout.strip(), scale)));
        let _ = write!(
            svg,
            "<rect width=\"{WIDTH}\" height=\"{}\" fill=\"{}\"/>",
            layout.height, theme.paper
        );
        for tick in self.x.ticks() {
            let x = tick.at;
            for ((top, bottom), _) in &fields {
                let _ = write!(
                    svg,
                    "<path d=\"M{x:.1} {top}V{bottom}\" stroke=\"{}\"/>",
                    theme.grid
                );
            }
            let _ = write!(
                svg,
                "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\" fill=\"{}\">{}</text>",
                layout.height - FOOT + 17.0,
                theme.faint,
                tick.label
            );
        }
        for (number, ((top, bottom), scale)) in fields.into_iter().enumerate() {
            for tick in scale.ticks() {
                let _ = write!(
                    svg,
                    "<path d=\"M{LEFT} {y:.1}H{RIGHT}\" stroke=\"{}\"/><text x=\"{}\" \
                     y=\"{:.1}\" text-anchor=\"end\" fill=\"{}\">{}</text>",
                    theme.grid,
                    LEFT - 7.0,
                    // Labels at the ends stay beside the frame.
                    (tick.at + 4.0).clamp(top + 8.0, bottom),
                    theme.faint,
                    tick.label,
                    y = tick.at,
                );
            }
            let _ = write!(
                svg,
                "<clipPath id=\"{id}-{number}\"><rect x=\"{LEFT}\" y=\"{top}\" width=\"{w}\" \
                 height=\"{h}\"/></clipPath><g clip-path=\"url(#{id}-{number})\">{}</g>\
                 <rect x=\"{LEFT}\" y=\"{top}\" width=\"{w}\" height=\"{h}\" fill=\"none\" \
                 stroke=\"{}\"/>",
                self.drawn[number],
                theme.faint,
                w = RIGHT - LEFT,
                h = bottom - top,
            );
        }
        let (top, bottom) = layout.main();
        let _ = write!(
            svg,
            "{}<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"{ink}\">{}</text>\
             <text transform=\"translate(15 {}) rotate(-90)\" text-anchor=\"middle\" \
             fill=\"{ink}\">{}</text>",
            self.over,
            0.5 * (LEFT + RIGHT),
            layout.height - 12.0,
            self.titles.x.text(&self.x),
            0.5 * (top + bottom),
            self.titles.y.text(&self.main),
            ink = theme.ink,
        );
        if let Some(scale) = &self.strip {
            let _ = write!(
                svg,
                "<text x=\"{}\" y=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"4\" \
                 paint-order=\"stroke\">{}</text>",
                LEFT + 8.0,
                layout.strip().0 + 15.0,
                theme.ink,
                theme.rim,
                self.titles.strip.text(scale)
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{LEFT}\" y=\"{}\" font-size=\"14\" font-weight=\"bold\" fill=\"{}\">{}</text>",
            TOP - 12.0,
            theme.ink,
            self.titles.head
        );
        let head = legend::text_width(&self.titles.head, 15.5);
        let left = (LEFT + head + 18.0).max(LEFT);
        legend::draw(&mut svg, theme, left, TOP - 12.0, &self.legend);
        svg
    }
}
