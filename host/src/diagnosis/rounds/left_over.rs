//! What is significant still when nothing in the catalogue explains more.

use crate::diagnosis::detect::lines::{self, Group};
use crate::diagnosis::doubt::wander::{self, Wander};
use crate::diagnosis::laws::departure;
use crate::diagnosis::result::finding::Remark;
use crate::diagnosis::result::place::Place;
use crate::diagnosis::rounds::{Rounds, spectrum_remark};

impl Rounds<'_> {
    /// What is significant still, and named by nothing.
    pub(crate) fn left_over(&mut self) -> Vec<Remark> {
        let level = self.level();
        let mut remarks = Vec::new();
        let departure = departure::departure(&self.axis.data, &self.axis.fit.expected);
        if let Some(departure) = departure.filter(|one| one.p_value < level) {
            remarks.push(spectrum_remark(&departure));
        }
        let rings = self.resonances();
        let rings = |f_hz: f64| rings.iter().any(|band| band.contains(&f_hz));
        for group in lines::lines(self.axis, level) {
            if let Group::Cluster {
                f_hz,
                width_hz,
                lines,
            } = group
                && !rings(f_hz)
                && !self.axis.apart.iter().any(|band| band.contains(&f_hz))
            {
                let p_value = lines
                    .iter()
                    .map(|line| line.false_alarm)
                    .fold(1.0, f64::min);
                remarks.push(Remark {
                    test: "lines".into(),
                    place: (f_hz - 0.5 * width_hz..f_hz + 0.5 * width_hz).into(),
                    p_value,
                    description: format!(
                        "power in {} narrow lines that stand too close to be separate: {}",
                        lines.len(),
                        lines::wandering(f_hz)
                    ),
                });
            }
        }
        let axis = &*self.axis;
        let powers = axis.powers();
        if let Some(Wander { cyclic, slow }) = wander::wander(&powers) {
            let movements = [
                (
                    cyclic,
                    Place::Period as fn(f64) -> Place,
                    "rises and falls in a cycle",
                ),
                (slow, Place::Slower, "changes in time"),
            ];
            // One movement shows in both: a cycle is the plainer of the two.
            let seen = movements.iter().find(|(one, ..)| one.p_value < level);
            let seen = seen.filter(|_| !self.is_coarse());
            if let Some((movement, place, how)) = seen {
                remarks.push(Remark {
                    test: "variance".into(),
                    place: place(movement.period / axis.rate_hz),
                    p_value: movement.p_value,
                    description: format!("the strength of the noise {how}"),
                });
            }
        }
        remarks
    }
}
