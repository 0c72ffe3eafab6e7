//! What a user may say of an array file, chosen by a byte.

use inm_host::{ArrayOptions, Decimal, Selector, TimeColumn, TimeUnit, Unit};

/// The options that `choice` stands for: its lower six bits, two at a time.
pub fn chosen(choice: u8) -> ArrayOptions {
    let time = |unit| {
        let column = Selector::Number(0);
        Some(TimeColumn { column, unit })
    };
    let (rate_hz, time) = match choice & 3 {
        0 => (Some(2000.0), None),
        1 => (None, time(None)),
        2 => (None, time(Some(TimeUnit::Microseconds))),
        _ => (Some(100.0), time(Some(TimeUnit::Nanoseconds))),
    };
    let decimal = [None, Some(Decimal::Comma), Some(Decimal::Point), None];
    let (columns, from_s, to_s) = match choice >> 4 & 3 {
        0 => (vec![Selector::Number(1)], None, None),
        1 => (Vec::new(), Some(0.001), Some(1.0)),
        _ => (Vec::new(), None, None),
    };
    ArrayOptions {
        rate_hz,
        time,
        decimal: decimal[usize::from(choice >> 2 & 3)],
        columns,
        // Half of them leave it to the names of the columns.
        unit: (choice >> 4 & 3 != 3).then_some(Unit::MetrePerSecondSquared),
        from_s,
        to_s,
        ..ArrayOptions::default()
    }
}
