//! The top of a height in a few dimensions, without its slope.

/// Where a height is greatest near `first`: J. A. Nelder and R. Mead, Comput. J. 7 (1965) 308.
pub fn climbed(first: &[f64], steps: &[f64], height: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    /// Moves, and the height by which corners differ in the end: a tenth of a nat decides nothing.
    const MOVES: usize = 120;
    const CLOSE: f64 = 1e-3;
    let mut corners: Vec<(f64, Vec<f64>)> = vec![(height(first), first.to_vec())];
    for (number, step) in steps.iter().enumerate() {
        let mut corner = first.to_vec();
        corner[number] += step;
        corners.push((height(&corner), corner));
    }
    let last = corners.len() - 1;
    for _ in 0..MOVES {
        corners.sort_by(|a, b| b.0.total_cmp(&a.0));
        if corners[0].0 - corners[last].0 < CLOSE {
            break;
        }
        let centre: Vec<f64> = (0..first.len())
            .map(|n| corners[..last].iter().map(|(_, at)| at[n]).sum::<f64>() / last as f64)
            .collect();
        let moved = |by: f64| -> (f64, Vec<f64>) {
            let worst = &corners[last].1;
            let at: Vec<f64> = centre
                .iter()
                .zip(worst)
                .map(|(c, w)| c + by * (w - c))
                .collect();
            (height(&at), at)
        };
        let reflected = moved(-1.0);
        let next = if reflected.0 > corners[0].0 {
            let further = moved(-2.0);
            if further.0 > reflected.0 {
                further
            } else {
                reflected
            }
        } else if reflected.0 > corners[last - 1].0 {
            reflected
        } else {
            let nearer = if reflected.0 > corners[last].0 {
                moved(-0.5)
            } else {
                moved(0.5)
            };
            if nearer.0 > corners[last].0.max(reflected.0) {
                nearer
            } else {
                draw_together(&mut corners, &height);
                continue;
            }
        };
        corners[last] = next;
    }
    corners.sort_by(|a, b| b.0.total_cmp(&a.0));
    corners.swap_remove(0).1
}

/// Moves every corner halfway to the first.
fn draw_together(corners: &mut [(f64, Vec<f64>)], height: impl Fn(&[f64]) -> f64) {
    let best = corners[0].1.clone();
    for (value, at) in &mut corners[1..] {
        at.iter_mut()
            .zip(&best)
            .for_each(|(one, best)| *one = 0.5 * (*one + best));
        *value = height(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simplex_climbs_to_the_top() {
        let top = climbed(&[0.0, 0.0, 0.0], &[0.5, 0.5, 0.5], |at| {
            -10.0 * (at[0] - 1.0).powi(2) - (at[1] + 0.5 * at[0]).powi(2) - (at[2] - 0.2).powi(2)
        });
        for (found, expected) in top.iter().zip([1.0, -0.5, 0.2]) {
            assert!((found - expected).abs() < 0.05, "{top:?}");
        }
    }
}
