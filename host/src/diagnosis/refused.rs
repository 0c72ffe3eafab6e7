//! Why a record cannot be diagnosed.

/// Samples below which no spectrum is worth the name: a choice. Tests of single moments leave a
/// quarter of as many out at the ends.
pub const LEAST: usize = 1 << 13;

/// A record that cannot be diagnosed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// The axis holds too few samples that count.
    #[error(
        "axis {axis} has {samples} samples that count; a diagnosis needs {LEAST} or more; record longer"
    )]
    TooShort {
        /// Name of the axis.
        axis: String,
        /// How many samples count.
        samples: usize,
    },
    /// The samples repeat few values, each for as long as a clock has it.
    #[error(
        "its {samples} samples hold {values} values of the sensor, each repeated until the next came; a diagnosis needs {LEAST} or more; record longer"
    )]
    Held {
        /// How many values there are.
        values: usize,
        /// In how many samples.
        samples: usize,
    },
    /// Nowhere enough samples in a row.
    #[error(
        "axis {axis}: more than half of its samples are missing, or gaps of more than 32 samples leave no stretch that is long enough for a spectrum; choose a part of the record with --from and --to"
    )]
    Broken {
        /// Name of the axis.
        axis: String,
    },
    /// No model could be fitted.
    #[error(
        "axis {axis}: no mix of the five terms fits its spectrum; look at it with 'inm analyze', and choose a part of the record with --from and --to"
    )]
    Unfitted {
        /// Name of the axis.
        axis: String,
    },
    /// A spill file cannot be read back.
    #[error(
        "the spill file in {folder} cannot be read: {cause}; free space there, or set TMPDIR to another folder"
    )]
    Lost {
        /// Folder for temporary files.
        folder: String,
        /// What the system says of it.
        cause: String,
    },
    /// All the same, or nothing to fit.
    #[error("axis {axis}: all samples are the same, there is no noise to diagnose")]
    Constant {
        /// Name of the axis.
        axis: String,
    },
}

impl From<std::io::Error> for Refused {
    fn from(error: std::io::Error) -> Self {
        Self::Lost {
            folder: std::env::temp_dir().display().to_string(),
            cause: error.to_string(),
        }
    }
}
