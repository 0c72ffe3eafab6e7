//! A simulation as a [`Source`].

use super::axis::AxisSimulation;
use crate::model::effect::Part;
use crate::model::whole::{Model, ModelAxis};
use crate::signal::{Axis, Signal};
use crate::source::{Block, Chunk, Column, Source, SourceError, Values};

/// Samples an axis in one chunk.
const CHUNK: usize = 8192;

/// A simulated record of some axes.
pub struct Simulation {
    signal: Signal,
    axes: Vec<AxisSimulation>,
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
    /// As [`Model::check`], and if an axis follows something that is not in the model.
    pub fn new(model: &Model, length: u64, seed: u64) -> Result<Self, String> {
        model.check()?;
        model.axes.iter().try_for_each(alone)?;
        let mixing = model.mixing()?;
        let axis = |(index, axis)| {
            let weights: Vec<f64> = mixing.row(index).iter().copied().collect();
            AxisSimulation::new(axis, index as u64, &weights, model.rate_hz, seed)
        };
        let described = model.axes.iter().map(|axis| Axis {
            name: axis.name.clone(),
            unit: axis.unit,
            scale: 1.0,
            zero: 0.0,
            chain: axis.chain.clone(),
        });
        Ok(Self {
            signal: Signal {
                name: format!("simulation, seed {seed}"),
                rate_hz: model.rate_hz,
                axes: described.collect(),
                start: None,
            },
            axes: model.axes.iter().enumerate().map(axis).collect(),
            length,
            next: 0,
        })
    }

    /// The next samples of every axis, at most `most`; empty at the end.
    pub fn next_columns(&mut self, most: usize) -> Vec<Vec<f64>> {
        let count = (self.length - self.next).min(most as u64);
        self.next += count;
        self.axes
            .iter_mut()
            .map(|axis| axis.next(count as usize))
            .collect()
    }
}

/// Whether all that is in an axis can be made without a record.
fn alone(axis: &ModelAxis) -> Result<(), String> {
    for effect in &axis.effects {
        if let Part::Follows(follows) = effect.part() {
            return Err(format!(
                "axis {}: effect {} follows {}, which is not in the model; take it out to \
                 simulate the rest",
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

    #[test]
    fn what_follows_a_leader_is_refused() {
        let text = r#"{ "schema": 1, "rate_hz": 100, "axes": [ { "name": "X", "effects": [
            { "effect": "thermal", "parameters": { "gain": 1e-3, "lag_s": 0 } } ] } ] }"#;
        let model = Model::from_json(text).expect("a model");
        let error = Simulation::new(&model, 10, 1)
            .err()
            .expect("no thermometer");
        assert!(
            error.contains("axis X: effect thermal follows the temperature"),
            "{error}"
        );
    }
}
