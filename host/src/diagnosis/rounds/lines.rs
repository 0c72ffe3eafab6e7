//! Lines: single ones, and mains with its harmonics.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::lines::{self, Group, Measured};
use crate::diagnosis::doubt::tone;
use crate::diagnosis::record::residual::Wave;
use crate::diagnosis::result::finding::{Remark, Value};
use crate::diagnosis::result::place::Place;
use crate::diagnosis::rounds::{Rounds, Snapshot, named};

impl Rounds<'_> {
    /// Takes out every line.
    pub(crate) fn lines(&mut self, groups: Vec<Group>) -> Option<bool> {
        let mut any = false;
        for group in groups {
            match group {
                Group::Single(one) if self.wanders(&one) => {}
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

    /// Leaves out the lines that wander, where no resonance makes them.
    pub(crate) fn wandering_lines(&mut self) -> Option<bool> {
        let mut any = false;
        for group in lines::lines(self.axis, self.level()) {
            if let Group::Single(one) = group
                && self.wanders(&one)
            {
                any |= self.set_apart(&one)?;
            }
        }
        Some(any)
    }

    /// Bands about the resonances that are there: lines in them are their tops.
    pub(crate) fn resonances(&self) -> Vec<std::ops::Range<f64>> {
        /// Widths on either side.
        const REACH: f64 = 5.0;
        let laws = self.axis.laws.iter();
        laws.filter(|law| law.effect.name() == "resonance")
            .map(|law| {
                let (f_hz, reach_hz) = (law.values[0], REACH * law.values[1]);
                f_hz - reach_hz..f_hz + reach_hz
            })
            .collect()
    }

    /// Whether a line does not keep its size and phase.
    fn wanders(&self, one: &Measured) -> bool {
        let cycles = one.line.frequency_hz / self.axis.rate_hz;
        tone::p_steady(self.axis, cycles) < self.level()
    }

    /// Leaves a line that wanders out of what fits and tests look at, and remarks on it.
    fn set_apart(&mut self, one: &Measured) -> Option<bool> {
        /// Width of what is left out, 1/T on either side.
        const REACH: f64 = 40.0;
        let f_hz = one.line.frequency_hz;
        let rings = self.resonances();
        let mut known = self.axis.apart.iter().chain(&rings);
        if known.any(|band| band.contains(&f_hz)) {
            return Some(false);
        }
        let width_hz = REACH * self.axis.rate_hz / self.axis.filled.len() as f64;
        self.unsteady.push(Remark {
            test: "lines".into(),
            place: Place::Line(f_hz),
            p_value: one.line.false_alarm,
            description: format!(
                "a line of amplitude {:.3e} that does not keep its size and phase: {}",
                one.line.amplitude,
                lines::wandering(f_hz)
            ),
        });
        self.axis.apart.push(f_hz - width_hz..f_hz + width_hz);
        self.axis.refresh()?;
        Some(true)
    }

    pub(crate) fn single(&mut self, one: Measured) -> Option<bool> {
        if self
            .resonances()
            .iter()
            .any(|band| band.contains(&one.line.frequency_hz))
        {
            return Some(false);
        }
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
            axis.refresh()
        })
    }

    /// A resonance too narrow for the record to resolve: a line.
    pub(crate) fn unresolved(&mut self, f_hz: f64, p_value: f64) -> Option<bool> {
        let one = lines::measure_near(self.axis, f_hz, p_value);
        self.single(one)
    }

    /// Amplitude of a line as it was ahead of the declared chain, like that of all other effects.
    fn ahead_of_chain(&self, one: &Measured) -> Value {
        let passed = self.axis.frame.chain_power(one.line.frequency_hz).sqrt();
        Value::normal(one.line.amplitude / passed, one.amplitude_sd / passed)
    }

    pub(crate) fn hum(
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
            axis.refresh()
        };
        if self.find("hum").is_some() {
            change(self.axis)?;
            let (with, after) = (Snapshot::of(self.axis), self.axis.fit.clone());
            let one = self.find("hum")?;
            for (name, value) in parameters {
                one.parameters.entry(name).or_insert(value);
            }
            (one.with, one.after) = (with, after);
            one.freedom += freedom;
        } else {
            return self.accept("hum", parameters, p_value, freedom, None, change);
        }
        Some(true)
    }
}
