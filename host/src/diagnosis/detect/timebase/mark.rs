//! A place in the spectrum, and how surely it is known: on the axis, and on a logarithmic one where a wrong rate is a shift.

/// Standard deviations within which two lines are the same one: of 16 000 pairs that are, one lies
/// further off.
pub(super) const SAME: f64 = 4.0;

/// Smallest relative standard deviation of a frequency: clocks and machines are no better than 2 in
/// 100 000.
const STEADY: f64 = 2e-5;

/// A line, or something else that has its place in the spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Frequency, hertz.
    pub f_hz: f64,
    /// Standard deviation of the frequency, hertz.
    pub f_sd_hz: f64,
    /// Whether that is by how much it wanders.
    pub wanders: bool,
}

impl Mark {
    /// Whether another one may be the same.
    pub fn is(&self, other: &Self) -> bool {
        let sd = self.f_sd_hz.hypot(other.f_sd_hz).max(STEADY * self.f_hz);
        (self.f_hz - other.f_hz).abs() < SAME * sd
    }
}

/// A line on a logarithmic axis.
#[derive(Clone, Copy)]
pub(super) struct Log {
    pub(super) log: f64,
    pub(super) sd: f64,
    pub(super) wanders: bool,
}

pub(super) fn logarithms(lines: &[Mark]) -> Vec<Log> {
    lines
        .iter()
        .filter(|line| line.f_hz > 0.0 && line.f_sd_hz.is_finite())
        .map(|line| Log {
            log: line.f_hz.ln(),
            sd: (line.f_sd_hz / line.f_hz).hypot(STEADY),
            wanders: line.wanders,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_which_nothing_is_known_is_no_mark() {
        let mark = |f_hz: f64, f_sd_hz: f64| Mark {
            f_hz,
            f_sd_hz,
            wanders: false,
        };
        let marks = [mark(20.0, 1e-3), mark(20.0, f64::INFINITY), mark(0.0, 1e-3)];
        assert_eq!(logarithms(&marks).len(), 1);
    }
}
