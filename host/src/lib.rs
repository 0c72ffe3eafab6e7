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
// What stands behind the face is documented for readers of the source.
#![allow(rustdoc::private_intra_doc_links)]

mod analyse;
mod bins;
mod calibrate;
mod capture;
mod chain;
mod cli;
mod clocks;
mod data_sheet;
mod diagnosis;
mod export;
mod face;
mod fft;
mod fit;
#[cfg(feature = "image")]
mod flash;
mod inspect;
#[doc(hidden)]
#[allow(missing_docs, reason = "each is documented where it is")]
pub mod internals;
mod link;
mod live;
mod model;
mod navigate;
mod numeric;
mod page;
mod plain;
mod report;
mod signal;
mod simulate;
mod source;
mod spectrum;
#[cfg(feature = "image")]
mod update;
mod virtual_board;

pub use analyse::{
    Analysis, AnalysisOptions, AxisAnalysis, CurvePoint, Fits, GapSummary, LikelihoodFit,
    LikelihoodValue, Overlap, PublishedValue, SourceSummary, SpectrumPoint, UnusableSummary,
    WeightedValue, analyse, summarise,
};
pub use bins::{record::Record, taus::Taus};
pub use chain::Chain;
pub use cli::main as command_line;
pub use clocks::{Clocks, Measured};
pub use diagnosis::decision::{Decision, Declined};
pub use diagnosis::loser::Loser;
pub use diagnosis::result::estimate::Estimate;
pub use diagnosis::result::finding::{AxisDiagnosis, Diagnosis, Finding, Remark};
pub use diagnosis::result::value::Value;
pub use export::{Format as ExportFormat, export, input::Input as ExportInput};
pub use face::covariate::covariate;
pub use face::diagnose::{DiagnosisError, DiagnosisOptions, Progress, Refused, Step, diagnose};
pub use face::simulate::simulate;
pub use model::axis::{ModelAxis, ModelEffect};
pub use model::catalogue::find as find_kind;
pub use model::file::ModelError;
pub use model::kind::Kind;
pub use model::whole::Model;
pub use model::{Coefficient, PerCoefficient};
pub use navigate::Growth;
pub use report::Report;
pub use signal::{Axis, Signal, Unit};
pub use simulate::source::Simulation;
pub use source::{
    Block, Chunk, Column, Gap, Source, SourceError, Values,
    open::open,
    options::{ArrayOptions, Decimal, Selector, TimeColumn, TimeUnit},
};
