//! What the whole-system tests share: ports that misbehave, and records taken apart.
//!
//! The tests themselves are in `tests/tests`, one file per question. None of them needs the
//! board: they put faults between the host library and a virtual board, whose firmware is the
//! image's own.
#![forbid(unsafe_code)]

pub mod campaign;
pub mod golden;
pub mod hidden;
#[cfg(unix)]
pub mod night;
pub mod port;
pub mod promise;
pub mod qemu;
pub mod record;
