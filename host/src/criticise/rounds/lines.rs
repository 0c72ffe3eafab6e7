//! Lines: single ones, and mains with its harmonics.

use super::super::axis::AxisState;
use super::super::finding::Value;
use super::super::lines::{Group, Measured};
use super::super::mend::Wave;
use super::{Rounds, Snapshot, named};

impl Rounds<'_> {
    /// Takes out every line.
    pub(super) fn lines(&mut self, groups: Vec<Group>) -> Option<bool> {
        let mut any = false;
        for group in groups {
            match group {
                Group::Single(one) => any |= self.single(one)?,
                Group::Hum {
                    base_hz,
                    base_sd_hz,
                    lines,
                } => any |= self.hum(base_hz, base_sd_hz, lines)?,
                Group::Cluster { .. } => {}
            }
        }
        Some(any)
    }

    pub(super) fn single(&mut self, one: Measured) -> Option<bool> {
        // What is left beside a line that was taken out is no second one.
        let duration_s = self.axis.filled.len() as f64 / self.axis.rate_hz;
        let near = self.axis.mended.waves.iter().any(|wave| match wave {
            Wave::Line { cycles, .. } => {
                let f_hz = cycles * self.axis.rate_hz;
                (f_hz - one.line.frequency_hz).abs() < (40.0 / duration_s).max(0.004 * f_hz)
            }
            _ => false,
        });
        if near {
            return Some(false);
        }
        let parameters = named([
            (
                "f_hz",
                Value::normal(one.line.frequency_hz, one.line.frequency_sd_hz),
            ),
            ("amplitude", self.ahead_of_chain(&one)),
        ]);
        let p_value = one.line.false_alarm;
        self.accept("sinusoid", parameters, p_value, 3.0, None, |axis| {
            axis.mended.waves.push(one.wave);
            axis.refresh(false)
        })
    }

    /// Amplitude of a line as it was ahead of the declared chain, like that of all other effects.
    fn ahead_of_chain(&self, one: &Measured) -> Value {
        let passed = self.axis.frame.chain_power(one.line.frequency_hz).sqrt();
        Value::normal(one.line.amplitude / passed, one.amplitude_sd / passed)
    }

    pub(super) fn hum(
        &mut self,
        base_hz: f64,
        base_sd_hz: f64,
        lines: Vec<(u32, Measured)>,
    ) -> Option<bool> {
        let p_value = lines
            .iter()
            .map(|(_, one)| one.line.false_alarm)
            .fold(1.0, f64::min);
        let mut parameters = named([("f_hz", Value::normal(base_hz, base_sd_hz))]);
        for (number, one) in &lines {
            parameters.insert(format!("amplitude_{number}"), self.ahead_of_chain(one));
        }
        let freedom = 1.0 + 2.0 * lines.len() as f64;
        let change = |axis: &mut AxisState| {
            axis.mended
                .waves
                .extend(lines.into_iter().map(|(_, one)| one.wave));
            axis.refresh(false)
        };
        if self.find("hum").is_some() {
            change(self.axis)?;
            let with = Snapshot::of(self.axis);
            let one = self.find("hum")?;
            for (name, value) in parameters {
                one.parameters.entry(name).or_insert(value);
            }
            one.with = with;
            one.freedom += freedom;
        } else {
            return self.accept("hum", parameters, p_value, freedom, None, change);
        }
        Some(true)
    }
}
