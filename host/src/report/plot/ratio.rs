//! The strip below a curve: how far the measurement lies from a model, in percent.

use super::Stroke;
use super::frame::{Field, Frame};

/// Limits that a strip can have, percent.
const LIMITS: [f64; 6] = [2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
const WIDEST: f64 = 200.0;

/// A measured value with its interval over what a model expects.
#[derive(Debug, Clone, Copy)]
pub struct Compared {
    /// Place on the horizontal axis.
    pub x: f64,
    /// Measured value.
    pub measured: f64,
    /// Lower end of its interval.
    pub lo: f64,
    /// Upper end of its interval.
    pub hi: f64,
    /// What is expected, above zero.
    pub expected: f64,
}

impl Compared {
    fn percent(&self, value: f64) -> f64 {
        100.0 * (value / self.expected - 1.0)
    }

    /// Measured over expected, minus one, percent.
    pub fn off(&self) -> f64 {
        self.percent(self.measured)
    }

    /// Width of the interval, percent.
    pub fn width(&self) -> f64 {
        self.percent(self.hi) - self.percent(self.lo)
    }

    /// How far the interval reaches from zero, percent.
    pub fn reach(&self) -> f64 {
        self.percent(self.hi).abs().max(self.percent(self.lo).abs())
    }
}

/// The limit of a strip in which `largest` percent should be seen.
pub fn limit(largest: f64) -> f64 {
    LIMITS
        .into_iter()
        .find(|&limit| limit >= 1.1 * largest)
        .unwrap_or(WIDEST)
}

/// Gives the strip a scale from `-limit` to `limit` percent and a line at zero.
pub fn open(frame: &mut Frame<'_>, limit: f64) {
    frame.set_strip((-limit, limit));
    let (from, to) = frame.x().ends();
    let zero = Stroke::solid(frame.theme().fitted, 1.4);
    frame.line(Field::Strip, [(from, 0.0), (to, 0.0)], zero);
}

/// Draws the points, with their intervals, into the strip.
pub fn points(frame: &mut Frame<'_>, points: &[Compared], radius: f64) {
    let colour = frame.theme().measured;
    let interval = |one: &Compared| (one.x, one.percent(one.lo), one.percent(one.hi));
    frame.intervals(Field::Strip, points.iter().map(interval), colour, 0.4);
    let dot = |one: &Compared| (one.x, one.off());
    frame.dots(Field::Strip, points.iter().map(dot), radius, colour);
}
