//! What the board can be told to do with its converters.

use serde::{Deserialize, Serialize};

/// Output data rate of the FIR filter at fCLK = 4.096 MHz (ADS1281, SBAS378D, pages 11 and 15).
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Rate {
    /// 250 conversions a second.
    Sps250,
    /// 500 conversions a second.
    Sps500,
    /// 1000 conversions a second, the converter's reset value.
    Sps1000,
    /// 2000 conversions a second, the rate of the published experiment.
    #[default]
    Sps2000,
    /// 4000 conversions a second.
    Sps4000,
}

impl Rate {
    /// All rates, slowest first.
    pub const ALL: [Self; 5] = [
        Self::Sps250,
        Self::Sps500,
        Self::Sps1000,
        Self::Sps2000,
        Self::Sps4000,
    ];

    /// Conversions a second.
    pub const fn hz(self) -> u32 {
        match self {
            Self::Sps250 => 250,
            Self::Sps500 => 500,
            Self::Sps1000 => 1000,
            Self::Sps2000 => 2000,
            Self::Sps4000 => 4000,
        }
    }

    /// The rate of that many conversions a second, if the converter has it.
    pub fn from_hz(hz: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|rate| rate.hz() == hz)
    }
}

/// Impulse response of the converter's FIR stages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Phase {
    /// Symmetric, group delay 31 conversions.
    #[default]
    Linear,
    /// Shortest delay, about 5 conversions at DC.
    Minimum,
}

/// What leaves the converter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Filter {
    /// Modulator bits, digital filter off: fMOD = 1.024 MHz. The link cannot carry it.
    Modulator,
    /// Sinc stage only, 32 times the data rate. The link cannot carry it.
    Sinc,
    /// Sinc and FIR stages.
    Fir {
        /// Phase response of the FIR stages.
        phase: Phase,
        /// High-pass filter: its HPF register word, or `None` for off.
        ///
        /// Off is right for drift work: the filter deletes what long averaging looks for.
        high_pass: Option<u16>,
    },
}

impl Default for Filter {
    fn default() -> Self {
        Self::Fir {
            phase: Phase::Linear,
            high_pass: None,
        }
    }
}

/// Acceleration range of the MMA7331L, chosen by its g-Select pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum SensorRange {
    /// g-Select low: 4 g, 308 mV/g at 2.8 V.
    #[default]
    G4,
    /// g-Select high: 12 g, 83.6 mV/g at 2.8 V.
    G12,
}

/// How the converters are set up; the same for all three.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Settings {
    /// Output data rate.
    pub rate: Rate,
    /// Digital filter.
    pub filter: Filter,
}
