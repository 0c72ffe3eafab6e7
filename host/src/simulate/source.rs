//! A simulation as a [`Source`].

use std::sync::Arc;

use super::axis::AxisSimulation;
use crate::model::axis::ModelAxis;
use crate::model::effect::Part;
use crate::model::follows::Leader;
use crate::model::whole::Model;
use crate::signal::{Axis, Signal, Unit};
use crate::source::{Block, Chunk, Column, Source, SourceError, Values};

/// Samples an axis in one chunk.
const CHUNK: usize = 8192;

/// A simulated record of some axes.
pub struct Simulation {
    signal: Signal,
    axes: Vec<AxisSimulation>,
    /// The column of the temperature, where there is one.
    temperature: Option<Arc<[f64]>>,
    /// True data rate over the nominal one, of the first axis, whose edges a board stamps.
    clock: f64,
    length: u64,
    next: u64,
}

impl Simulation {
    /// Simulates `length` samples an axis of `model`. Every axis and every term has its own
    /// random numbers; the same seed gives the same record, whatever its length and however it
    /// is read.
    ///
    /// The random numbers behind K, B, N and Q of axis `i` are `sum_j L_ij z_j`, `z_j` being those
    /// that axis `j` would have alone and `L` the lower Cholesky factor of the model's
    /// correlation; effects are independent.
    ///
    /// # Errors
    /// As [`Model::check`], and if an axis follows the temperature, or shares what no `correlation` says.
    pub fn new(model: &Model, length: u64, seed: u64) -> Result<Self, String> {
        Self::beside(model, length, seed, None)
    }

    /// The same together with a record of the temperature, one value a sample, which axes follow about its mean.
    /// It becomes one more column behind the axes.
    ///
    /// # Errors
    /// As [`Self::new`], and if it is shorter than the simulation.
    pub fn at_temperature(
        model: &Model,
        length: u64,
        seed: u64,
        temperature: Vec<f64>,
    ) -> Result<Self, String> {
        let there = temperature.len() as u64;
        if there < length {
            return Err(format!(
                "the temperature has {there} values, one a sample; {length} samples were asked for"
            ));
        }
        Self::beside(model, length, seed, Some(&temperature.into()))
    }

    fn beside(
        model: &Model,
        length: u64,
        seed: u64,
        temperature: Option<&Arc<[f64]>>,
    ) -> Result<Self, String> {
        model.check()?;
        let has_leader = |leader: Leader| match leader {
            Leader::Temperature => temperature.is_some(),
            Leader::Shared => model.correlation.is_some(),
        };
        let mut axes = model.axes.iter();
        axes.try_for_each(|axis| led(axis, has_leader))?;
        let mixing = model.mixing()?;
        let axis = |(index, axis)| {
            let weights: Vec<f64> = mixing.row(index).iter().copied().collect();
            let mut made = AxisSimulation::new(axis, index as u64, &weights, model.rate_hz, seed);
            if let Some(temperature) = temperature {
                made.follow(axis, model.rate_hz, temperature);
            }
            made
        };
        let described = model.axes.iter().map(|axis| Axis {
            name: axis.name.clone(),
            unit: axis.unit,
            scale: 1.0,
            zero: 0.0,
            chain: axis.chain.clone(),
        });
        let beside = temperature.iter().map(|_| Axis {
            name: "temperature".to_owned(),
            unit: Unit::Counts,
            scale: 1.0,
            zero: 0.0,
            chain: None,
        });
        Ok(Self {
            signal: Signal {
                name: format!("simulation, seed {seed}"),
                rate_hz: model.rate_hz,
                axes: described.chain(beside).collect(),
                start: None,
            },
            axes: model.axes.iter().enumerate().map(axis).collect(),
            temperature: temperature.cloned(),
            clock: model.axes.first().map_or(1.0, ModelAxis::clock),
            length,
            next: 0,
        })
    }

    /// Samples a second of a clock that is right, of the first axis.
    pub fn true_rate_hz(&self) -> f64 {
        self.clock * self.signal.rate_hz
    }

    /// The next samples of every axis, at most `most`; empty at the end.
    pub fn next_columns(&mut self, most: usize) -> Vec<Vec<f64>> {
        let count = (self.length - self.next).min(most as u64) as usize;
        let from = self.next as usize;
        self.next += count as u64;
        let axes = self.axes.iter_mut().map(|axis| axis.next(count));
        let beside = self.temperature.iter();
        axes.chain(beside.map(|column| column[from..from + count].to_vec()))
            .collect()
    }
}

/// Whether there is all that an axis follows.
fn led(axis: &ModelAxis, has_leader: impl Fn(Leader) -> bool) -> Result<(), String> {
    for effect in &axis.effects {
        let Part::Follows(follows) = effect.part() else {
            continue;
        };
        if !has_leader(follows.leader) {
            let wanted = match follows.leader {
                Leader::Temperature => "give its record with --temperature",
                Leader::Shared => "give the model its `correlation`",
            };
            return Err(format!(
                "axis {}: effect {} follows {}, which is not in the model; {wanted}, or take the \
                 effect out to simulate the rest",
                axis.name,
                effect.kind().name(),
                follows.leader.name()
            ));
        }
    }
    Ok(())
}

impl Source for Simulation {
    fn signal(&self) -> &Signal {
        &self.signal
    }

    fn expected_len(&self) -> Option<u64> {
        Some(self.length)
    }

    fn next_chunk(&mut self) -> Result<Option<Chunk>, SourceError> {
        let first = self.next;
        let columns = self.next_columns(CHUNK).into_iter().map(|samples| Column {
            values: Values::Floats(samples),
            invalid: Vec::new(),
        });
        let block = Block {
            first,
            columns: columns.collect(),
        };
        Ok((!block.is_empty()).then_some(Chunk::Samples(block)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(effect: &str) -> Model {
        let text = format!(
            r#"{{ "schema": 1, "rate_hz": 100, "axes": [ {{ "name": "X", "mean": 9.8,
                "effects": [ {effect} ] }} ] }}"#
        );
        Model::from_json(&text).expect("a model")
    }

    const THERMAL: &str = r#"{ "effect": "thermal", "parameters": { "gain": 1e-3, "lag_s": 0 } }"#;

    fn refusal(simulation: Result<Simulation, String>) -> String {
        simulation.err().expect("a reason")
    }

    #[test]
    fn what_follows_a_leader_is_refused_without_one() {
        let error = refusal(Simulation::new(&model(THERMAL), 10, 1));
        assert!(
            error.contains("axis X: effect thermal follows the temperature"),
            "{error}"
        );
        let common = r#"{ "effect": "common_mode", "parameters": { "gain": 1 } }"#;
        let error = refusal(Simulation::new(&model(common), 10, 1));
        assert!(error.contains("`correlation`"), "{error}");
    }

    #[test]
    fn the_temperature_is_followed_about_its_mean_and_stands_beside() {
        let temperature: Vec<f64> = (0..10_000).map(|n| 20.0 + f64::from(n % 1000)).collect();
        let mean = temperature.iter().sum::<f64>() / 10_000.0;
        let beside = |length| {
            let temperature = temperature.clone();
            Simulation::at_temperature(&model(THERMAL), length, 1, temperature)
        };
        let mut simulation = beside(10_000).expect("long enough");
        assert_eq!(simulation.signal().axes[1].name, "temperature");
        let mut rows = 0;
        // Blocks of a length that is no part of the generators' own.
        while let [axis, column] = &simulation.next_columns(777)[..]
            && !axis.is_empty()
        {
            for (value, degrees) in axis.iter().zip(column) {
                assert_eq!(*degrees, temperature[rows], "row {rows}");
                let expected = 9.8 + 1e-3 * (degrees - mean);
                assert!((value - expected).abs() < 1e-12, "row {rows}: {value}");
                rows += 1;
            }
        }
        assert_eq!(rows, 10_000);
        let error = refusal(beside(10_001));
        assert!(error.contains("10000 values"), "{error}");
    }
}
