//! That law, spectrum and samples of what has no name belong together.

use super::*;
use crate::model::kernel::{self, Kernel};
use crate::model::trial;

#[test]
fn allan_variance_and_spectrum_belong_together() {
    for (f_hz, width_hz) in [
        (0.0, 0.3),
        (0.0, 200.0),
        (3.0, 2.0),
        (120.0, 40.0),
        (480.0, 90.0),
    ] {
        let band = Band {
            f_hz,
            width_hz,
            amplitude: 2.0,
        };
        let power = 2.0 * kernel::panels(0.0, 500.0, |_| 0.05, |f| band.spectrum(f, 1000.0));
        assert!(
            (power / 4.0 - 1.0).abs() < 1e-6,
            "{f_hz} {width_hz}: {power}"
        );
        for m in [1, 2, 7, 40] {
            let density = |f: f64| band.spectrum(f, 1000.0);
            let expected = kernel::variance(Kernel::Allan, m, 1000.0, density);
            let variance = band.allan_variance(m, 1000.0);
            assert!(
                (variance / expected - 1.0).abs() < 1e-5,
                "{f_hz} {width_hz} {m}: {variance} {expected}"
            );
        }
    }
}

#[test]
fn sampled_fast_enough_the_spectrum_is_that_in_continuous_time() {
    let band = Band {
        f_hz: 1.0,
        width_hz: 0.5,
        amplitude: 1.0,
    };
    for f_hz in [0.01, 0.8, 1.3, 6.0] {
        let ratio = band.spectrum(f_hz, 1e4) / band.spectrum_ahead(f_hz, 1e4);
        assert!((ratio - 1.0).abs() < 1e-4, "{f_hz}: {ratio}");
    }
}

#[test]
fn the_rest_of_an_exponential_series_keeps_its_digits() {
    for x in [1e-9_f64, 1e-3, 0.7, 30.0] {
        let all = exponential_from(x, 1);
        assert!((all / -f64::exp_m1(-x) - 1.0).abs() < 1e-12, "{x}");
        let (second, third) = (exponential_from(x, 2), exponential_from(x, 3));
        assert!(
            (all - second - x * (-x).exp()).abs() <= 1e-15 + 1e-12 * all,
            "{x}"
        );
        assert!(
            (second - third - 0.5 * x * x * (-x).exp()).abs() <= 1e-15 + 1e-12 * second,
            "{x}"
        );
    }
}

#[test]
fn bands_make_what_the_law_says_about_zero_and_elsewhere() {
    let axis = trial::axis(
        r#""N": 0.01"#,
        r#"{"effect": "unnamed", "parameters": {"f_hz": 0, "width_hz": 20, "amplitude": 2}},
           {"effect": "unnamed", "parameters": {"f_hz": 90, "width_hz": 30, "amplitude": 1}}"#,
    );
    trial::assert_allan_variance(&axis, 1000.0, &[1, 4, 16, 64, 256]);
}

#[test]
fn covariances_are_those_at_the_multiples_of_a_lag() {
    let band = Band {
        f_hz: 3.7,
        width_hz: 0.2,
        amplitude: 1.5,
    };
    let lag_s = 0.013;
    for (lag, found) in band.covariances(lag_s).take(1000).enumerate() {
        let exact = band.covariance(lag as f64 * lag_s);
        assert!((found - exact).abs() < 1e-12, "{lag}: {found}, {exact}");
    }
}
