//! Where the bins of a spectrum depart from what a model expects of them.

use crate::diagnosis::statistic::p_value;
use crate::fit::likelihood::Data;

/// Where and how far the bins depart from what is expected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Lower end of the band, hertz.
    pub from_hz: f64,
    /// Upper end of it, hertz.
    pub to_hz: f64,
    /// Measured over expected power in it.
    pub ratio: f64,
    /// Probability of as large a departure in any band.
    pub p_value: f64,
}

/// Degrees of freedom of a band that says anything, at least: a tenth of what the bin with the most correlated neighbours
/// keeps, and far more than excluded ones have. By the law of a mean square of next to none, any power at all would be
/// rare.
const LEAST_FREEDOM: f64 = 0.01;

/// The band in which the bins depart most from `expected`, over all bands of 1, 2, 4 ... bins that are not excluded.
pub fn departure(data: &Data, expected: &[f64]) -> Option<Departure> {
    let bins = data.len();
    let mut best: Option<Departure> = None;
    let mut trials = 0.0;
    let mut width = 1;
    while width <= bins {
        for start in (0..=bins - width).step_by((width / 2).max(1)) {
            let band = start..start + width;
            let freedom: f64 = data.dof[band.clone()].iter().sum();
            if freedom < LEAST_FREEDOM {
                continue;
            }
            trials += 1.0;
            let ratio = band
                .clone()
                .map(|b| data.dof[b] * data.psd[b] / expected[b])
                .sum::<f64>()
                / freedom;
            let p = p_value::mean_square(ratio, freedom);
            if best.is_none_or(|best| p < best.p_value) {
                best = Some(Departure {
                    from_hz: data.f_hz[band.start],
                    to_hz: data.f_hz[band.end - 1],
                    ratio,
                    p_value: p,
                });
            }
        }
        width *= 2;
    }
    best.map(|best| Departure {
        p_value: p_value::searched(best.p_value, trials),
        ..best
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forty bins of as many degrees of freedom, but for one that is excluded, at which `power` is measured where 1 is
    /// expected.
    fn with_one_excluded(power: f64) -> Departure {
        let count = 40;
        let f_hz: Vec<f64> = (1..=count).map(f64::from).collect();
        let (mut psd, mut dof) = (vec![1.0; f_hz.len()], vec![40.0; f_hz.len()]);
        (psd[17], dof[17]) = (power, 4e-8);
        let mut data = Data::independent(f_hz, psd, &[40.0; 40]).expect("bins");
        data.dof = dof;
        departure(&data, &[1.0; 40]).expect("bins that count")
    }

    #[test]
    fn power_in_an_excluded_bin_is_no_departure() {
        for power in [0.5, 1.2, 1e6] {
            let found = with_one_excluded(power);
            assert!(found.p_value > 0.5, "{power}: {found:?}");
        }
    }

    #[test]
    fn the_best_of_all_bands_departs_by_chance_no_more_often_than_told() {
        const RECORDS: u64 = 400;
        let chance = (0..RECORDS).filter(|&seed| {
            let mut normal = crate::diagnosis::trial::numbers(seed, 0);
            let mut power = || (0..10).map(|_| normal.draw().powi(2)).sum::<f64>() / 10.0;
            let f_hz: Vec<f64> = (1..=40).map(f64::from).collect();
            let psd = f_hz.iter().map(|_| power()).collect();
            let data = Data::independent(f_hz, psd, &[10.0; 40]).expect("bins");
            departure(&data, &[1.0; 40])
                .expect("bins that count")
                .p_value
                < 0.05
        });
        // At most 20 are expected: five deviations of a Poisson number.
        let count = chance.count() as f64;
        assert!(
            count < 20.0 + 5.0 * f64::sqrt(20.0),
            "{count} of seeds 0 to {RECORDS}"
        );
    }
}
