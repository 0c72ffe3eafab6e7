//! The highest point of a smooth curve near a place.

/// Place and height of a top near `start`: goes a `step` to either side wherever that is higher, then
/// half of it, until it is no longer above `finest`. Reaches at most twice the first step.
pub fn climb(start: f64, step: f64, finest: f64, height: impl Fn(f64) -> f64) -> (f64, f64) {
    let mut best = (start, height(start));
    let mut step = step;
    while step > finest {
        for place in [best.0 - step, best.0 + step] {
            let value = height(place);
            if value > best.1 {
                best = (place, value);
            }
        }
        step *= 0.5;
    }
    best
}

/// Place of the only top between `low` and `high`, by the golden section: each of the `steps` leaves
/// 0.62 of what was left.
pub fn golden_section(low: f64, high: f64, steps: u32, height: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5_f64.sqrt() - 1.0);
    let (mut low, mut high) = (low, high);
    let inner = |low: f64, high: f64| [high - ratio * (high - low), low + ratio * (high - low)];
    let mut heights = inner(low, high).map(&height);
    for _ in 0..steps {
        // The inner place that stays is one of the next two.
        if heights[0] > heights[1] {
            high = inner(low, high)[1];
            heights = [height(inner(low, high)[0]), heights[0]];
        } else {
            low = inner(low, high)[0];
            heights = [heights[1], height(inner(low, high)[1])];
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_find_the_top_of_a_parabola() {
        for top in [-0.3, 0.0, 0.123, 0.4] {
            let height = |x: f64| 1.0 - (x - top) * (x - top);
            let (place, value) = climb(0.0, 0.25, 1e-4, height);
            assert!((place - top).abs() <= 1e-4, "{top}: {place}");
            assert_eq!(value, height(place));
            // A parabola is flat to rounding within 1e-8 of its top.
            let place = golden_section(-0.5, 0.5, 40, height);
            assert!((place - top).abs() < 3e-8, "{top}: {place}");
        }
    }
}
