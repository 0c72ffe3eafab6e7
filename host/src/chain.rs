//! The signal chain between a quantity and its samples: sensor pole, converter filter.
//!
//! Written as in `--chain ads1281:linear+400hz`; captures carry it in their header.

use inm_protocol::Phase;

/// What the quantity passes on its way to the samples.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chain {
    /// Digital filter of an ADS1281 (sinc5 and FIR), if there is one.
    pub converter: Option<Phase>,
    /// Corner frequencies of one-pole low-passes ahead of the converter, hertz.
    pub poles_hz: Vec<f64>,
}
