//! Which noise rules at an averaging time: by the local slope of the Allan curve.
//!
//! The slope of `log sigma^2` over `log tau` is -2 for quantisation, -1 for white, 0 for flicker
//! and +1 for walk noise. It is taken by least squares over the points within an octave on
//! either side, weighted by nothing: it only chooses between types whose intervals differ by a
//! few tens of percent. A ramp, steeper still, counts as walk noise.

use inm_allan::edf::Noise;

/// Noise types at each of `points`, given as averaging factor and variance, ascending.
pub fn identify(points: &[(u64, f64)]) -> Vec<Noise> {
    (0..points.len())
        .map(|at| noise_of(slope(points, at)))
        .collect()
}

/// Local slope of `log variance` over `log m` around point `at`.
fn slope(points: &[(u64, f64)], at: usize) -> f64 {
    let centre = points[at].0 as f64;
    let near = |&&(m, variance): &&(u64, f64)| {
        let ratio = m as f64 / centre;
        (0.499..=2.001).contains(&ratio) && variance > 0.0
    };
    let mut near: Vec<_> = points.iter().filter(near).collect();
    if near.len() < 2 {
        // Coarse averaging times: the neighbours, however far.
        near = points[at.saturating_sub(1)..(at + 2).min(points.len())]
            .iter()
            .filter(|point| point.1 > 0.0)
            .collect();
    }
    let logs = near
        .iter()
        .map(|(m, variance)| ((*m as f64).ln(), variance.ln()));
    let n = near.len() as f64;
    let (sx, sy) = logs
        .clone()
        .fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x, sy + y));
    let (mx, my) = (sx / n, sy / n);
    let (sxx, sxy) = logs.fold((0.0, 0.0), |(sxx, sxy), (x, y)| {
        (sxx + (x - mx) * (x - mx), sxy + (x - mx) * (y - my))
    });
    sxy / sxx
}

fn noise_of(slope: f64) -> Noise {
    // A constant record has no slope (NaN): treated as white.
    if slope < -1.5 {
        Noise::Quantisation
    } else if slope >= 0.5 {
        Noise::Walk
    } else if slope >= -0.5 {
        Noise::Flicker
    } else {
        Noise::White
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_of_the_five_terms() {
        for (exponent, noise) in [
            (-2.0, Noise::Quantisation),
            (-1.0, Noise::White),
            (0.0, Noise::Flicker),
            (1.0, Noise::Walk),
            (2.0, Noise::Walk),
        ] {
            for spacing in [2, 10] {
                let points: Vec<_> = (0..8)
                    .map(|k| spacing_power(spacing, k))
                    .map(|m| (m, 3.0 * (m as f64).powf(exponent)))
                    .collect();
                assert_eq!(
                    identify(&points),
                    [noise; 8],
                    "slope {exponent}, spacing {spacing}"
                );
            }
        }
        assert_eq!(identify(&[(1, 0.0), (2, 0.0)]), [Noise::White; 2]);
        assert_eq!(identify(&[(1, 2.0)]), [Noise::White]);
    }

    fn spacing_power(spacing: u64, k: u32) -> u64 {
        spacing.pow(k)
    }
}
