//! Just enough SVG: colours, and text that is harmless.

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
    /// The fit; in a diagnosis, the extended model.
    pub fitted: &'static str,
    /// In a diagnosis, the model of five terms alone.
    pub before: &'static str,
    /// A simulated record.
    pub simulated: &'static str,
    /// Where measurement and model differ.
    pub differs: &'static str,
    /// Around text that stands over something else.
    pub rim: &'static str,
}

/// For paper and bitmaps.
pub const LIGHT: Theme = Theme {
    ink: "#1d232a",
    faint: "#66707c",
    grid: "#e3e7eb",
    paper: "#ffffff",
    measured: "#0b62a4",
    fitted: "#d4550a",
    before: "#7a5195",
    simulated: "#1a8a5a",
    differs: "#c9302c",
    rim: "#ffffff",
};

/// For a page that defines these variables, light or dark.
pub const PAGE: Theme = Theme {
    ink: "var(--ink)",
    faint: "var(--faint)",
    grid: "var(--grid)",
    paper: "none",
    measured: "var(--measured)",
    fitted: "var(--fitted)",
    before: "var(--before)",
    simulated: "var(--simulated)",
    differs: "var(--differs)",
    rim: "var(--paper)",
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

/// A unit squared, as it is typeset.
pub fn squared(unit: &str) -> String {
    if unit.chars().all(char::is_alphabetic) {
        format!("{unit}\u{b2}")
    } else {
        format!("({unit})\u{b2}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typesets_and_escapes() {
        assert_eq!(typeset("m/s^2/sqrt(s)"), "m/s\u{b2}/\u{221a}s");
        assert_eq!(escape("<a&'b'>"), "&lt;a&amp;&#39;b&#39;&gt;");
    }
}
