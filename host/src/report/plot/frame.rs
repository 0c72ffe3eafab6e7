//! The frame of a picture: a main field with two scales, below it a strip with the same
//! horizontal one.
//!
//! What is drawn is given in values, not in pixels; it may leave the field, the frame cuts it.

use std::fmt::Write;

use super::legend::{self, Mark};
use super::scale::{Scale, power_of_ten};
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

/// A part of the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// The main field.
    Main,
    /// The strip below.
    Strip,
}

/// Ends of a field from top to bottom, pixels.
pub(super) type Span = (f64, f64);

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

/// Titles around the fields.
#[derive(Debug, Clone, Default)]
pub struct Titles {
    /// Above, bold.
    pub head: String,
    /// Title of the axis below.
    pub x: Title,
    /// On the left.
    pub y: Title,
    /// In the strip.
    pub strip: Title,
}

/// A picture in the making.
pub struct Frame<'a> {
    id: &'a str,
    pub(super) theme: &'a Theme,
    pub(super) layout: Layout,
    titles: Titles,
    pub(super) x: Scale,
    main: Scale,
    pub(super) strip: Option<Scale>,
    /// What is in the main field, and in the strip.
    pub(super) drawn: [String; 2],
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
        (x, y): (impl FnOnce(Span) -> Scale, impl FnOnce(Span) -> Scale),
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

    /// Colours that it is drawn in.
    pub const fn theme(&self) -> &'a Theme {
        self.theme
    }

    /// Pixels of a point.
    pub(super) fn at(&self, field: Field, (x, y): (f64, f64)) -> (f64, f64) {
        let scale = match field {
            Field::Main => &self.main,
            Field::Strip => self.strip.as_ref().unwrap_or(&self.main),
        };
        // A value of zero on a logarithmic scale lies far below.
        (self.x.at(x), scale.at(y).clamp(-FAR, FAR))
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
        let _ = write!(
            svg,
            "<rect width=\"{WIDTH}\" height=\"{}\" fill=\"{}\"/>",
            self.layout.height, self.theme.paper
        );
        let mut fields = vec![(self.layout.main(), &self.main)];
        let strip = self.strip.as_ref();
        fields.extend(strip.map(|scale| (self.layout.strip(), scale)));
        self.draw_x(&mut svg, &fields);
        for (number, (span, scale)) in fields.into_iter().enumerate() {
            self.draw_field(&mut svg, number, span, scale);
        }
        self.draw_titles(&mut svg);
        let head = legend::text_width(&self.titles.head, 15.5);
        let left = (LEFT + head + 18.0).max(LEFT);
        legend::draw(&mut svg, self.theme, left, TOP - 12.0, &self.legend);
        svg
    }

    /// The horizontal scale: a line through all fields and a label at each tick.
    fn draw_x(&self, svg: &mut String, fields: &[(Span, &Scale)]) {
        let Self { theme, layout, .. } = self;
        for tick in self.x.ticks() {
            let x = tick.at;
            for ((top, bottom), _) in fields {
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
    }

    /// A field: its vertical scale, what is drawn in it, and its rim.
    fn draw_field(&self, svg: &mut String, number: usize, (top, bottom): Span, scale: &Scale) {
        let Self { id, theme, .. } = self;
        for tick in scale.ticks() {
            let _ = write!(
                svg,
                "<path d=\"M{LEFT} {y:.1}H{RIGHT}\" stroke=\"{}\"/><text x=\"{}\" \
                 y=\"{:.1}\" text-anchor=\"end\" fill=\"{}\">{}</text>",
                theme.grid,
                LEFT - 7.0,
                // Labels at the ends stay within the frame.
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

    /// What stands over the fields, and the titles around them.
    fn draw_titles(&self, svg: &mut String) {
        let Self { theme, layout, .. } = self;
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
    }
}
