//! Noise models in the formats of those who use them.
//!
//! ```text
//! model file, published table, analysis -> input -> one file a format
//! ```
//!
//! Every file says what its numbers are: the unit, one- or two-sided, and what of the model is
//! not in it. What a format cannot hold is named, and where the rest was adapted to make up for
//! it, the file says how well.

pub mod curve;
pub mod factor;
pub mod gnss_ins_sim;
pub mod input;
pub mod kalibr;
pub mod matlab;
pub mod sensor;
pub mod shaping_filter;
pub mod state_space;
pub mod state_space_json;

/// Formats of other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// imu.yaml of kalibr.
    Kalibr,
    /// Error model of gnss-ins-sim, as a Python file.
    GnssInsSim,
    /// accelparams or gyroparams for imuSensor of MATLAB.
    Matlab,
    /// Shaping filter as discrete state space (F, G, H, Q), JSON.
    StateSpace,
    /// Allan deviation of the model as text.
    Csv,
    /// Allan deviation of the model as a NumPy array.
    Npy,
}

/// The model of `input` in `format`.
///
/// # Errors
/// If the format cannot hold the model: the message says why and what to do.
///
/// ```
/// use inm_host::{ExportFormat, ExportInput, export};
///
/// let input = ExportInput::open("published:X")?;
/// let table = String::from_utf8(export(&input, ExportFormat::Csv)?)?;
/// assert!(table.lines().count() > 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn export(input: &input::Input, format: Format) -> anyhow::Result<Vec<u8>> {
    Ok(match format {
        Format::Kalibr => kalibr::render(input)?.into_bytes(),
        Format::GnssInsSim => gnss_ins_sim::render(input)?.into_bytes(),
        Format::Matlab => matlab::render(input)?.into_bytes(),
        Format::StateSpace => state_space_json::render(input)?.into_bytes(),
        Format::Csv => curve::csv(input).into_bytes(),
        Format::Npy => curve::npy(input),
    })
}
