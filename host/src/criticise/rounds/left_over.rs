//! What is significant still when nothing in the catalogue explains more.

use super::super::bursts;
use super::super::finding::Remark;
use super::super::laws::departure;
use super::super::lines::{self, Group};
use super::{Rounds, spectrum_remark};

impl Rounds<'_> {
    /// What is significant still, and named by nothing.
    pub(super) fn left_over(&mut self) -> Vec<Remark> {
        let level = self.level();
        let mut remarks = Vec::new();
        self.describe_laws();
        let departure = departure::departure(&self.axis.data, &self.axis.fit.expected);
        if let Some(departure) = departure.filter(|one| one.p_value < level) {
            remarks.push(spectrum_remark(&departure));
        }
        let rings = |f_hz: f64| {
            self.axis.laws.iter().any(|law| {
                law.effect.name() == "resonance"
                    && (law.values[0] - f_hz).abs() < 5.0 * law.values[1]
            })
        };
        for group in lines::lines(self.axis, level) {
            if let Group::Cluster {
                f_hz,
                width_hz,
                lines,
            } = group
                && !rings(f_hz)
            {
                let p_value = lines
                    .iter()
                    .map(|line| line.false_alarm)
                    .fold(1.0, f64::min);
                remarks.push(Remark {
                    test: "lines".into(),
                    place: format!(
                        "{:.5} to {:.5} Hz",
                        f_hz - 0.5 * width_hz,
                        f_hz + 0.5 * width_hz
                    ),
                    p_value,
                    description: format!(
                        "power in {} narrow lines that stand too close to be separate: a tone \
                         that wanders or is switched",
                        lines.len()
                    ),
                });
            }
        }
        let seen = self.axis.whole();
        let (whole, density) = (&seen.whole, &seen.density);
        let axis = &*self.axis;
        let powers = bursts::powers(whole, density, |n| axis.usable(n));
        if let Some(wander) = bursts::wander(&powers) {
            if wander.cyclic.0 < level {
                let period_s = wander.cyclic.1 / axis.rate_hz;
                remarks.push(Remark {
                    test: "variance".into(),
                    place: format!("period {period_s:.4} s"),
                    p_value: wander.cyclic.0,
                    description: "the power of the noise rises and falls in a cycle".into(),
                });
            }
            if wander.slow < level {
                remarks.push(Remark {
                    test: "variance".into(),
                    place: "slower than a sixteenth of the record".into(),
                    p_value: wander.slow,
                    description: "the power of the noise wanders in time".into(),
                });
            }
        }
        remarks
    }
}
