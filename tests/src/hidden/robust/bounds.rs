//! What the parameters of a finding can be at most, whatever the record: rules by the parameter's
//! name, as reports give it.

use crate::hidden::judge::answer::Interval;

/// Beyond its bound by rounding: a share.
const ROUNDING: f64 = 1e-9;

/// Share by which the estimate of a size that fills the whole range may be beyond it.
const BEYOND: f64 = 0.06;

/// What one axis of a record can hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// Samples.
    pub samples: usize,
    /// Samples a second.
    pub rate_hz: f64,
    /// Smallest finite value, in the unit of the report.
    pub least: f64,
    /// Largest one.
    pub most: f64,
    /// Whether a chain is declared: what is said of ahead of it may be larger than what came
    /// through.
    pub chain: bool,
}

impl Room {
    /// Length, seconds.
    pub fn duration_s(&self) -> f64 {
        self.samples as f64 / self.rate_hz
    }

    /// How large what is in the values can be.
    fn range(&self) -> f64 {
        if self.chain {
            return f64::INFINITY;
        }
        (1.0 + BEYOND) * (self.most - self.least)
    }
}

/// A rule that a value breaks, in words; `name` is that of the parameter.
pub fn broken(effect: &str, name: &str, said: &Interval, room: &Room) -> Option<&'static str> {
    let value = said.value?;
    let inside = |least: f64, most: f64| {
        let slack = ROUNDING * (least.abs().max(most.abs()));
        (least - slack..=most + slack).contains(&value)
    };
    let (lo, hi) = (
        said.lo.unwrap_or(f64::NEG_INFINITY),
        said.hi.unwrap_or(f64::INFINITY),
    );
    if !(lo..=hi).contains(&value) {
        return Some("a value outside its own interval");
    }
    let top_hz = 0.5 * room.rate_hz;
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let is_numbered = base.ends_with('_');
    let rule = match base.trim_end_matches('_') {
        "from_s" | "to_s" => (
            inside(0.0, room.duration_s()),
            "an instant outside the record",
        ),
        "time_s" if is_numbered => (
            inside(0.0, room.duration_s()),
            "an instant outside the record",
        ),
        "dwell_s" | "period_s" | "duration_s" => (
            inside(0.0, room.duration_s()),
            "a time longer than the record",
        ),
        "time_s" | "lag_s" => (value >= 0.0, "a negative time"),
        "f_hz" => (inside(0.0, top_hz), "a frequency outside the band"),
        "rate_hz" => (inside(0.0, room.rate_hz), "more than one a sample"),
        "width_hz" => (
            inside(1.0 / room.duration_s(), top_hz),
            "a width that is none between 1/T and the band",
        ),
        // Two that settle against each other, the one twice as fast as the other: a quarter is left.
        "amplitude" if effect == "warmup" => (
            inside(-4.0 * room.range(), 4.0 * room.range()),
            "larger than the range of the values",
        ),
        "height" | "amplitude" | "size" | "step" | "peak" => (
            inside(-room.range(), room.range()),
            "larger than the range of the values",
        ),
        "level" if effect == "clipping" => {
            (inside(room.least, room.most), "a level beyond the values")
        }
        "share" | "depth" => (inside(0.0, 1.0), "a share that is none"),
        "side" => (value.abs() == 1.0, "a side that is none"),
        "samples" => (
            inside(1.0, room.samples as f64),
            "more samples than there are",
        ),
        "factor" | "ratio" => (value > 0.0, "a factor that is not positive"),
        _ => (true, ""),
    };
    (!rule.0).then_some(rule.1)
}
