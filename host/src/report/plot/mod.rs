//! What every picture is made of: scales, a frame with its strip, a legend, tags. Knows pixels and
//! colours, nothing of noise.

pub mod frame;
pub mod legend;
mod marks;
pub mod ratio;
pub mod scale;
pub mod tags;

/// How a line is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    /// Colour of the line, as SVG has it.
    pub colour: &'static str,
    /// Width, pixels.
    pub width: f64,
    /// Lengths of dashes and holes as in SVG; empty for a line without holes.
    pub dash: &'static str,
}

impl Stroke {
    /// A line without holes.
    pub const fn solid(colour: &'static str, width: f64) -> Self {
        Self::dashed(colour, width, "")
    }

    /// A line of dashes.
    pub const fn dashed(colour: &'static str, width: f64, dash: &'static str) -> Self {
        Self {
            colour,
            width,
            dash,
        }
    }

    /// The attributes of an SVG path.
    pub fn attributes(self) -> String {
        let Self {
            colour,
            width,
            dash,
        } = self;
        let dash = match dash {
            "" => String::new(),
            dash => format!(" stroke-dasharray=\"{dash}\" stroke-linecap=\"round\""),
        };
        format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dash}")
    }
}
