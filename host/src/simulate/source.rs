//! A simulation as a [`Source`].

use super::Generator;
use crate::model::{Coefficient, PerCoefficient, Seed};
use crate::signal::{Axis, Signal, Unit};
use crate::source::{Block, Chunk, Column, Source, SourceError, Values};

/// Samples an axis in one block.
const BLOCK: usize = 8192;

/// Streams of random numbers that an axis reserves for its terms.
const STREAMS_PER_AXIS: u64 = 64;

/// What to simulate on one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedAxis {
    /// Name of the axis.
    pub name: String,
    /// Unit of the signal.
    pub unit: Unit,
    /// The five terms.
    pub coefficients: PerCoefficient<f64>,
}

/// A simulated record of some axes.
pub struct Simulation {
    signal: Signal,
    generators: Vec<Vec<Box<dyn Generator>>>,
    length: u64,
    next: u64,
}

impl Simulation {
    /// Simulates `length` samples an axis. Every axis and every term has its own random
    /// numbers; the same seed gives the same record, whatever its length.
    pub fn new(axes: &[SimulatedAxis], rate_hz: f64, length: u64, seed: u64) -> Self {
        let generators = (0..).zip(axes).map(|(index, axis): (u64, _)| {
            let stream = |term: u64| Seed {
                seed,
                stream: index * STREAMS_PER_AXIS + term,
            };
            (0..)
                .zip(Coefficient::ALL)
                .filter(|&(_, coefficient)| *axis.coefficients.get(coefficient) != 0.0)
                .map(|(term, coefficient)| {
                    let value = *axis.coefficients.get(coefficient);
                    coefficient.term(value).generator(rate_hz, stream(term))
                })
                .collect()
        });
        let axis = |axis: &SimulatedAxis| Axis {
            name: axis.name.clone(),
            unit: axis.unit,
            scale: 1.0,
            zero: 0.0,
            chain: None,
        };
        Self {
            generators: generators.collect(),
            signal: Signal {
                name: format!("simulation, seed {seed}"),
                rate_hz,
                axes: axes.iter().map(axis).collect(),
                start: None,
            },
            length,
            next: 0,
        }
    }

    /// The next samples of every axis, at most `most`; empty at the end.
    pub fn next_columns(&mut self, most: usize) -> Vec<Vec<f64>> {
        let count = (self.length - self.next).min(most as u64);
        self.next += count;
        let column = |terms: &mut Vec<Box<dyn Generator>>| {
            let mut samples = vec![0.0; count as usize];
            terms.iter_mut().for_each(|term| term.add_to(&mut samples));
            samples
        };
        self.generators.iter_mut().map(column).collect()
    }
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
        let columns = self.next_columns(BLOCK).into_iter().map(|samples| Column {
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
