//! Time base: the samples are not taken at the rate that the record claims.

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;

/// Wrong data rate in the catalogue: the true one is `ratio` times the nominal one, steadily.
///
/// All the rest of the axis, its signal chain included, keeps true time, and what is seen by the
/// nominal rate follows: a line at `f` is seen at `f / ratio`, a density at `f` at `f / ratio` and
/// `ratio` times as large, and the Allan variance of `m` samples is that of the true time.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "timebase"
    }

    fn meaning(&self) -> &'static str {
        "the samples are taken faster or slower than the record claims: a clock that is off, or a \
         divider that rounds"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new(
            "ratio",
            Quantity::Factor,
            "true data rate over the nominal one",
        )]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "count samples against a clock for a minute: {:+.1} millionths more than nominal are \
             expected; give the true rate with --rate",
            1e6 * (values[0] - 1.0)
        )
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Clock(values[0])
    }
}

#[cfg(test)]
mod tests {
    use crate::model::kernel::{self, Kernel};
    use crate::model::trial;

    const TIME_BASE: &str = r#"{ "effect": "timebase", "parameters": { "ratio": 1.25 } }"#;

    #[test]
    fn lines_are_seen_elsewhere() {
        let sinusoid = r#"{ "effect": "sinusoid", "parameters": { "f_hz": 100, "amplitude": 2 } }"#;
        let axis = trial::axis("", &format!("{sinusoid}, {TIME_BASE}"));
        let law = axis.law(1000.0);
        let seen = law.lines()[0];
        assert_eq!((seen.f_hz, seen.power), (80.0, 2.0));
        // Whole periods: the sum over the samples is exact.
        let samples = trial::record(&axis, 1000.0, 2009, 1, 100);
        for m in [1, 3, 5] {
            let measured = trial::allan_variance(&samples[..2000 + 2 * m - 1], m);
            let expected = law.allan_variance(m as u64);
            assert!(
                (measured - expected).abs() < 1e-9,
                "m = {m}: {measured} for {expected}"
            );
        }
    }

    #[test]
    fn densities_and_allan_variances_agree() {
        let stale = r#"{ "effect": "stale", "parameters": { "share": 0.1 } }"#;
        let outliers = r#"{ "effect": "outliers", "parameters": { "rate_hz": 9, "size": 4 } }"#;
        let coefficients = r#""N": 0.02, "K": 3, "Q": 1e-4"#;
        for effects in [
            TIME_BASE.to_owned(),
            format!("{stale}, {TIME_BASE}, {outliers}"),
        ] {
            let axis = trial::axis(coefficients, &effects);
            let law = axis.law(1000.0);
            for m in [1, 4, 100] {
                let integral = kernel::variance(Kernel::Allan, m, 1000.0, |f_hz| law.density(f_hz));
                let ratio = law.allan_variance(m) / integral;
                assert!((ratio - 1.0).abs() < 4e-6, "{effects}, m = {m}: {ratio}");
            }
            trial::assert_allan_variance(&axis, 1000.0, &[1, 4, 30]);
        }
    }
}
