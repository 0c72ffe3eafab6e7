//! Just enough SVG: text, escaping, and logarithmic axes.

use std::fmt::Write;

/// Colours of a drawing; any CSS colour, or a variable of the page around it.
#[derive(Debug, Clone, Copy)]
pub struct Theme {
    /// Text and frame.
    pub ink: &'static str,
    /// Less important text.
    pub faint: &'static str,
    /// Grid lines.
    pub grid: &'static str,
    /// Behind everything.
    pub paper: &'static str,
    /// Measured data.
    pub measured: &'static str,
    /// The fit.
    pub fitted: &'static str,
}

/// For paper and bitmaps.
pub const LIGHT: Theme = Theme {
    ink: "#1d232a",
    faint: "#66707c",
    grid: "#e3e7eb",
    paper: "#ffffff",
    measured: "#0b62a4",
    fitted: "#d4550a",
};

/// For a page that defines these variables, light or dark.
pub const PAGE: Theme = Theme {
    ink: "var(--ink)",
    faint: "var(--faint)",
    grid: "var(--grid)",
    paper: "none",
    measured: "var(--measured)",
    fitted: "var(--fitted)",
};

/// Text with the characters that mean something in markup made harmless.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}

/// A unit as it is typeset: `m/s^2/sqrt(s)` becomes `m/s\u{b2}/\u{221a}s`.
pub fn typeset(unit: &str) -> String {
    unit.replace("^2", "\u{b2}")
        .replace("^3", "\u{b3}")
        .replace("sqrt(s)", "\u{221a}s")
        .replace('*', "\u{b7}")
}

/// Maps decades onto a stretch of pixels.
#[derive(Debug, Clone, Copy)]
pub struct LogScale {
    /// Common logarithms at the two ends.
    pub decades: (f64, f64),
    /// Pixels at the two ends.
    pub pixels: (f64, f64),
}

impl LogScale {
    /// Pixel of a value above zero.
    pub fn at(&self, value: f64) -> f64 {
        let part = (value.log10() - self.decades.0) / (self.decades.1 - self.decades.0);
        self.pixels.0 + part * (self.pixels.1 - self.pixels.0)
    }

    /// The whole powers of ten within.
    pub fn powers(&self) -> impl Iterator<Item = i32> + use<> {
        self.decades.0.ceil() as i32..=self.decades.1.floor() as i32
    }
}

/// `M x y L x y ...` through points, with one decimal.
pub fn path(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut path = String::new();
    for (x, y) in points {
        let letter = if path.is_empty() { 'M' } else { 'L' };
        // Writing to a string cannot fail.
        let _ = write!(path, "{letter}{x:.1} {y:.1}");
    }
    path
}

/// A power of ten as text with a raised exponent.
pub fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        _ => {
            let sign = if exponent < 0 { "\u{2212}" } else { "" };
            format!(
                "10<tspan dy=\"-4.5\" font-size=\"8.5\">{sign}{}</tspan>",
                exponent.unsigned_abs()
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_and_escapes() {
        let scale = LogScale {
            decades: (-2.0, 2.0),
            pixels: (0.0, 400.0),
        };
        assert_eq!(scale.at(1.0), 200.0);
        assert_eq!(scale.powers().collect::<Vec<_>>(), [-2, -1, 0, 1, 2]);
        assert_eq!(typeset("m/s^2/sqrt(s)"), "m/s\u{b2}/\u{221a}s");
        assert_eq!(escape("<a&'b'>"), "&lt;a&amp;&#39;b&#39;&gt;");
        assert_eq!(path([(0.0, 1.0), (2.0, 3.04)]), "M0.0 1.0L2.0 3.0");
    }
}
