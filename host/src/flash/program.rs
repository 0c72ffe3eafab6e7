//! An image into the flash of a board behind a debug probe.

use probe_rs::flashing::{
    DownloadOptions, FlashLoader, FlashProgress, ProgressEvent, ProgressOperation,
};
use probe_rs::probe::Probe;
use probe_rs::probe::list::Lister;
use probe_rs::{Permissions, Session, flashing};

use super::{CHIP, FLASH_ORIGIN, Image};

/// Why the board could not be programmed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FlashError {
    /// No probe is plugged in.
    #[error(
        "no debug probe found; plug one in (ST-Link, J-Link, CMSIS-DAP) and check that this user \
         may open it, or use `--dry-run` to check the image alone"
    )]
    NoProbe,
    /// More than one, and none was chosen.
    #[error("{} debug probes found; choose one with `--probe`: {}", .0.len(), .0.join(", "))]
    ManyProbes(Vec<String>),
    /// The one asked for is not there.
    #[error("no debug probe `{asked}`; found: {}", if found.is_empty() { "none".to_owned() } else { found.join(", ") })]
    UnknownProbe {
        /// What `--probe` said.
        asked: String,
        /// What is plugged in.
        found: Vec<String>,
    },
    /// The probe does not open.
    #[error("the debug probe cannot be opened; is another program using it?")]
    Probe(#[from] probe_rs::probe::DebugProbeError),
    /// The probe sees no such chip.
    #[error(
        "no {CHIP} answers behind the probe; is the board powered, is the SWD cable right? `--connect-under-reset` helps where a program keeps the probe out"
    )]
    Attach(#[source] probe_rs::Error),
    /// The chip is not known to this build.
    #[error("the description of {CHIP} is missing from this build")]
    Target(#[from] probe_rs::config::RegistryError),
    /// Erasing, programming or verifying failed.
    #[error("programming failed; power the board anew and try again")]
    Program(#[source] flashing::FlashError),
    /// The image does not fit the chip.
    #[error("the image does not fit the flash of {CHIP}")]
    Layout(#[source] flashing::FlashError),
    /// The chip does not restart.
    #[error("the board was programmed and verified but does not restart; power it anew")]
    Reset(#[source] probe_rs::Error),
}

/// How far programming has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// A stage has begun (`erase`, `program`, `verify`) with this many bytes to do.
    Stage(&'static str, u64),
    /// So many bytes more of it are done.
    Bytes(&'static str, u64),
}

/// The only probe there is, or the one whose description contains `wanted`.
///
/// # Errors
/// [`FlashError`] if there is none, more than one, or it does not open.
pub fn choose_probe(wanted: Option<&str>) -> Result<Probe, FlashError> {
    let probes = Lister::new().list_all();
    let names = || probes.iter().map(ToString::to_string).collect::<Vec<_>>();
    let matching: Vec<_> = probes
        .iter()
        .filter(|probe| wanted.is_none_or(|text| probe.to_string().contains(text)))
        .collect();
    match (matching.as_slice(), wanted) {
        ([one], _) => Ok(one.open()?),
        ([], Some(asked)) => Err(FlashError::UnknownProbe {
            asked: asked.to_owned(),
            found: names(),
        }),
        ([], None) => Err(FlashError::NoProbe),
        (_, _) => Err(FlashError::ManyProbes(names())),
    }
}

/// The probes that are plugged in, as they are called.
pub fn probes() -> Vec<String> {
    let probes = Lister::new().list_all();
    probes.iter().map(ToString::to_string).collect()
}

/// The board behind a probe, whatever it does at the moment. With `under_reset` it is held in reset meanwhile: of a
/// program that sleeps too deeply or has taken the debug pins nothing else helps. That needs the wire NRST.
///
/// # Errors
/// [`FlashError::Attach`].
pub fn attach(probe: Probe, under_reset: bool) -> Result<Session, FlashError> {
    let session = match under_reset {
        true => probe.attach_under_reset(CHIP, Permissions::default()),
        false => probe.attach(CHIP, Permissions::default()),
    };
    session.map_err(FlashError::Attach)
}

/// Programs, verifies and restarts the board in `session`.
///
/// With `dry_run` everything is prepared (flash layout, loader algorithm) and nothing is
/// written or restarted.
///
/// # Errors
/// [`FlashError`] naming the stage that failed.
pub fn program(
    session: &mut Session,
    image: &Image,
    dry_run: bool,
    mut progress: impl FnMut(Progress),
) -> Result<(), FlashError> {
    let loader = stage(session, image)?;
    let mut options = DownloadOptions::default();
    options.verify = true;
    options.dry_run = dry_run;
    options.progress = FlashProgress::new(move |event| {
        let told = match event {
            ProgressEvent::AddProgressBar { operation, total } => {
                stage_name(operation).map(|name| Progress::Stage(name, total.unwrap_or(0)))
            }
            ProgressEvent::Progress {
                operation, size, ..
            } => stage_name(operation).map(|name| Progress::Bytes(name, size)),
            _ => None,
        };
        if let Some(told) = told {
            progress(told);
        }
    });
    loader
        .commit(session, options)
        .map_err(FlashError::Program)?;
    if dry_run {
        return Ok(());
    }
    session
        .core(0)
        .and_then(|mut core| core.reset())
        .map_err(FlashError::Reset)
}

/// The image laid out over the chip's flash.
fn stage(session: &Session, image: &Image) -> Result<FlashLoader, FlashError> {
    let mut loader = session.target().flash_loader();
    for (address, bytes) in &image.segments {
        loader
            .add_data(*address, bytes)
            .map_err(FlashError::Layout)?;
    }
    loader.set_vector_table_addr(FLASH_ORIGIN);
    Ok(loader)
}

fn stage_name(operation: ProgressOperation) -> Option<&'static str> {
    match operation {
        ProgressOperation::Erase => Some("erase"),
        ProgressOperation::Program => Some("program"),
        ProgressOperation::Verify => Some("verify"),
        ProgressOperation::Fill => None,
    }
}
