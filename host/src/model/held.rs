//! Held values: the sensor is slower than its reader.

use super::effect::{Effect, Parameter, Part, Quantity};
use super::kind::Kind;

/// Held values in the catalogue: the sensor has so many new values a second, and each is written until there is the next.
///
/// All the rest of the axis is that of the sensor's own values, at their own rate: sample `i` is value `floor(i r)`, with `r`
/// values a sample.
struct Entry;

/// The same by its identity.
pub const KIND: Kind = Kind::of(&Entry);

impl Effect for Entry {
    fn name(&self) -> &'static str {
        "held"
    }

    fn meaning(&self) -> &'static str {
        "the sensor has a new value less often than the logger writes one, and each is written until there is the next; all \
         else is told of the sensor's own values, each once"
    }

    fn parameters(&self, _values: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new(
            "sensor_hz",
            Quantity::Hertz,
            "new values a second",
        )]
    }

    fn check(&self, values: &[f64]) -> String {
        format!(
            "look up the sensor's data rate: {:.6} a second are seen; read it on its ready signal, or set the logger to that \
             rate, for what is written in between is no measurement",
            values[0]
        )
    }

    fn part(&self, values: &[f64]) -> Part {
        Part::Hold(values[0])
    }
}

#[cfg(test)]
mod tests {
    use crate::model::kernel::{self, Kernel};
    use crate::model::trial;

    fn held(sensor_hz: f64) -> String {
        format!(r#"{{ "effect": "held", "parameters": {{ "sensor_hz": {sensor_hz} }} }}"#)
    }

    #[test]
    fn each_value_is_written_until_there_is_the_next() {
        // A step says which value is the first of its second half: values know their own time.
        let step = r#"{ "effect": "steps", "parameters": { "time_s_1": 2, "height_1": 1 } }"#;
        let axis = trial::axis("", &format!("{step}, {}", held(300.0)));
        let samples = trial::record(&axis, 1000.0, 4000, 1, 77);
        let up = samples.iter().position(|&x| x > 0.5).expect("a step");
        assert!((2000..=2004).contains(&up), "{up}");
        let noisy = trial::axis(r#""N": 0.1"#, &held(300.0));
        let samples = trial::record(&noisy, 1000.0, 10_000, 1, 77);
        let runs: Vec<usize> = samples.chunk_by(|a, b| a == b).map(<[f64]>::len).collect();
        assert_eq!(runs.len(), 3000);
        assert!(runs.iter().all(|run| (3..=4).contains(run)));
    }

    #[test]
    fn allan_variance_follows_the_law() {
        for sensor_hz in [130.0, 300.0, 910.0] {
            let axis = trial::axis(r#""N": 0.02, "K": 3, "Q": 4e-4"#, &held(sensor_hz));
            trial::assert_allan_variance(&axis, 1000.0, &[1, 2, 3, 8, 30, 300]);
        }
    }

    #[test]
    fn its_density_is_that_of_its_allan_variance() {
        let axis = trial::axis(r#""N": 0.02, "Q": 4e-4"#, &held(130.0));
        let law = axis.law(1000.0);
        for m in [4, 30] {
            let integral = kernel::variance(Kernel::Allan, m, 1000.0, |f_hz| law.density(f_hz));
            let ratio = law.allan_variance(m) / integral;
            // What folds back from above half the rate is left out.
            assert!((ratio - 1.0).abs() < 0.05, "m = {m}: {ratio}");
        }
    }
}
