//! Library behind `inm`, the noise bench for inertial accelerometers.
//!
//! [`open`] a record or [`simulate`](simulate()) one, then [`analyse`](analyse()) or
//! [`diagnose`](diagnose()) it; [`export`](export()) a model to another program. A [`Report`] shows
//! what came of it.
//!
//! Data flows one way:
//!
//! ```text
//! source -> bins, spectrum -> fit -> diagnosis -> report
//! ```
#![forbid(unsafe_code)]

pub mod analyse;
pub mod bins;
pub mod capture;
pub mod chain;
pub mod cli;
pub mod data_sheet;
pub mod diagnosis;
pub mod export;
pub mod face;
pub mod fft;
pub mod fit;
#[cfg(feature = "flash")]
pub mod flash;
pub mod link;
pub mod live;
pub mod model;
pub mod navigate;
pub mod numeric;
pub mod report;
pub mod signal;
pub mod simulate;
pub mod source;
pub mod spectrum;
pub mod virtual_board;

pub use analyse::{Analysis, AnalysisOptions, analyse, summarise};
pub use diagnosis::result::finding::Diagnosis;
pub use export::{Format as ExportFormat, export, input::Input as ExportInput};
pub use face::covariate::covariate;
pub use face::diagnose::{DiagnosisError, DiagnosisOptions, Refused, Step, diagnose};
pub use face::simulate::simulate;
pub use model::axis::{ModelAxis, ModelEffect};
pub use model::file::ModelError;
pub use model::whole::Model;
pub use report::Report;
pub use simulate::source::Simulation;
pub use source::{
    Source, SourceError,
    open::open,
    options::{ArrayOptions, Selector},
};
