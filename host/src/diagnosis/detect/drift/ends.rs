//! What the slopes at both ends of a course come to beyond the half-waves that are looked at.
//!
//! They fall with the square of their number only: a thousandth of what a slope would rise in the whole record is left at the end
//! itself, which is far above the noise where the course is.

use std::f64::consts::PI;

/// Sum of `fixed_j cos(j angle)` over all `j` beyond those given from 1 on, of which the even ones times the square of their
/// number are all the same, and the odd ones; `angle` from 0 to pi. Zero of fewer than two.
pub fn beyond(fixed: &[f64], angle: f64) -> f64 {
    let [.., last_but_one, last] = fixed else {
        return 0.0;
    };
    let count = fixed.len();
    let both = [
        last_but_one * ((count - 1) as f64).powi(2),
        last * (count as f64).powi(2),
    ];
    let [odd, even] = match count % 2 {
        0 => both,
        _ => [both[1], both[0]],
    };
    0.5 * (even + odd) * tail(count, angle) + 0.5 * (even - odd) * tail(count, PI - angle)
}

/// Sum of `cos(j angle) / j^2` over all `j` beyond `count`: over all of them it is `pi^2/6 - pi angle/2 + angle^2/4`.
fn tail(count: usize, angle: f64) -> f64 {
    let terms = (1..=count).map(|j| (j as f64 * angle).cos() / (j * j) as f64);
    PI * PI / 6.0 - 0.5 * PI * angle + 0.25 * angle * angle - terms.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_of_a_sum_is_that_of_its_terms() {
        let term = |j: usize| (if j.is_multiple_of(2) { 2.0 } else { -0.5 }) / (j * j) as f64;
        for count in [8, 15] {
            let fixed: Vec<f64> = (1..=count).map(term).collect();
            for angle in [0.0, 0.1, 1.0, 3.0, PI] {
                const MANY: usize = 200_000;
                let all = (count + 1..MANY).map(|j| term(j) * (j as f64 * angle).cos());
                let off = beyond(&fixed, angle) - all.sum::<f64>();
                // Two over the number of terms are left of the sum of the squares.
                assert!(off.abs() < 2.0 / MANY as f64, "{count}, {angle}: {off}");
            }
        }
    }
}
