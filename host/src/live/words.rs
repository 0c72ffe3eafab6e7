//! Numbers of a view as words that fit a column.

use super::{Cell, Noise};

/// Seconds in a minute, an hour and a day, with what follows their number. Longer waits than
/// [`LONGEST_S`] are not told.
const SPANS: [(f64, &str); 4] = [(86_400.0, "d"), (3600.0, "h"), (60.0, "min"), (1.0, "s")];

/// Longest wait that is told: a hundred days. A record that long is another bench's affair.
const LONGEST_S: f64 = 8.64e6;

/// An Allan deviation and half of its interval.
pub fn deviation(cell: Option<Cell>) -> String {
    cell.map_or("-".to_owned(), |cell| value(cell.adev, cell.relative))
}

/// A coefficient: found, or its bound and how much longer it takes.
pub fn coefficient(noise: Option<Noise>) -> String {
    match noise {
        Some(Noise::Value(best, relative)) => value(best, relative),
        Some(Noise::Below { bound, more_s }) => {
            let wait = more_s.and_then(more);
            let wait = wait.map_or(String::new(), |wait| format!(", {wait}"));
            format!("< {bound:.2e}{wait}")
        }
        None => "-".to_owned(),
    }
}

/// Two digits of the interval are enough.
fn value(best: f64, relative: f64) -> String {
    let percent = 100.0 * relative;
    let decimals = match percent {
        ..1.0 => 2,
        ..10.0 => 1,
        _ => 0,
    };
    format!("{best:.3e} ±{percent:.decimals$} %")
}

/// How much longer, to one or two digits; `None` where nobody would wait for it.
fn more(seconds: f64) -> Option<String> {
    if !(0.0..=LONGEST_S).contains(&seconds) {
        return None;
    }
    let (span, unit) = SPANS
        .into_iter()
        .find(|(span, _)| seconds >= *span)
        .unwrap_or((1.0, "s"));
    Some(format!("{:.0} {unit} more", (seconds / span).ceil()))
}

/// A time in seconds to four digits without trailing zeros.
pub fn short(seconds: f64) -> String {
    if (0.001..1e5).contains(&seconds) {
        let digits = (3 - seconds.log10().floor() as i32).max(0) as usize;
        let text = format!("{seconds:.digits$}");
        if text.contains('.') {
            return text.trim_end_matches('0').trim_end_matches('.').to_owned();
        }
        return text;
    }
    format!("{seconds:.3e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short() {
        let shown = [0.0005, 0.001, 0.0125, 1.0, 32.768, 1234.5].map(short);
        assert_eq!(shown, ["5.000e-4", "0.001", "0.0125", "1", "32.77", "1234"]);
    }

    #[test]
    fn a_wait_is_told_in_the_unit_that_fits_it() {
        let waits = [0.2, 59.0, 61.0, 3600.0, 1e5, 1e7, f64::NAN].map(more);
        let told = waits.map(|wait| wait.unwrap_or_default());
        assert_eq!(
            told,
            [
                "1 s more",
                "59 s more",
                "2 min more",
                "1 h more",
                "2 d more",
                "",
                ""
            ]
        );
    }

    #[test]
    fn a_coefficient_is_found_or_bounded() {
        let below = |more_s| Noise::Below {
            bound: 1.98e-6,
            more_s,
        };
        let told = [
            Some(Noise::Value(1.058e-4, 0.021)),
            Some(below(Some(700.0))),
            Some(below(None)),
            None,
        ];
        assert_eq!(
            told.map(coefficient),
            [
                "1.058e-4 ±2.1 %",
                "< 1.98e-6, 12 min more",
                "< 1.98e-6",
                "-"
            ]
        );
    }
}
