//! Numbers for people.

/// A number with `digits` significant digits, in plain notation where that is short.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    // The exponent after rounding, so that 9.99 becomes 10.0 and not 10.00.
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = scientific
        .rsplit_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0);
    if (-3..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        scientific
    }
}

/// A number with up to seven significant digits and no superfluous zeros.
pub fn plain(value: f64) -> String {
    let text = significant(value, 7);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A count with a space between its thousands.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let lead = digits.len() % 3;
    let mut text = digits[..lead].to_owned();
    for group in digits.as_bytes()[lead..].chunks(3) {
        if !text.is_empty() {
            text.push(' ');
        }
        text.extend(group.iter().map(|&digit| char::from(digit)));
    }
    text
}

/// A length of time: `1 h 30 min`, `2 min 5 s`, `0.25 s`.
pub fn duration(seconds: f64) -> String {
    if seconds < 60.0 {
        return format!("{} s", significant(seconds, 3));
    }
    let whole = seconds.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    let parts = [(hours, "h"), (minutes, "min"), (rest, "s")];
    let shown = parts.iter().filter(|(count, _)| *count > 0);
    shown
        .map(|(count, unit)| format!("{count} {unit}"))
        .collect::<Vec<_>>()
        .join(" ")
}

/// A value and the ends of its interval, with six significant digits or as many more as it takes for
/// the interval to be seen.
pub fn estimated(value: f64, lo: f64, hi: f64) -> [String; 3] {
    let apart = (value / (hi - lo)).abs().log10().ceil();
    let digits = if apart.is_finite() {
        (apart as usize + 1).clamp(6, 17)
    } else {
        6
    };
    [value, lo, hi].map(|one| significant(one, digits))
}

/// A probability; what is smaller than anyone can mean is not written out.
pub fn probability(p: f64) -> String {
    if p < 1e-12 {
        "below 1e-12".to_owned()
    } else {
        significant(p, 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes() {
        assert_eq!(significant(0.000_123_456, 3), "1.23e-4");
        assert_eq!(significant(0.001_234_56, 3), "0.00123");
        assert_eq!(significant(9.999, 3), "10.0");
        assert_eq!(significant(-123_456.7, 3), "-123457");
        assert_eq!(significant(1.0e7, 2), "1.0e7");
        let shown = estimated(50.02, 50.019_999, 50.020_001);
        assert_eq!(shown, ["50.0200000", "50.0199990", "50.0200010"]);
        assert_eq!(estimated(1.0, -2.0, 4.0)[1], "-2.00000");
        assert_eq!(grouped(10_800_000), "10 800 000");
        assert_eq!(
            (plain(2000.0).as_str(), plain(0.5).as_str()),
            ("2000", "0.5")
        );
        assert_eq!(grouped(42), "42");
        assert_eq!(duration(5400.0), "1 h 30 min");
        assert_eq!(duration(0.25), "0.250 s");
        assert_eq!(duration(3601.0), "1 h 1 s");
    }
}
