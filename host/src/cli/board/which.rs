//! Which board is meant: by port, by serial number, or by both.

use std::time::Duration;

use anyhow::{bail, ensure};
use clap::Args;
use inm_protocol::Identity;

use crate::inspect::ports::ports;
use crate::inspect::{Session, serial};
use crate::link::{Connect, LinkError, Patience, SerialConnect};
use crate::source::SourceError;
use crate::virtual_board::VirtualConnect;

/// Stands for a board without hardware in place of a port.
const VIRTUAL: &str = "virtual";

/// Seed of its noise.
const SEED: u64 = 1;

/// The option that names a board, for subcommands that speak to one.
#[derive(Debug, Clone, Args)]
pub(in crate::cli) struct Which {
    /// Serial port of the board (`/dev/ttyUSB0`, `COM3`), or `virtual` for one without hardware;
    /// repeated for several to look for --serial on.
    #[arg(long, value_name = "PORT")]
    port: Vec<String>,
    /// The board with this serial number, or any part of it; looked for on the ports named, or with
    /// --ask on all.
    #[arg(long, value_name = "TEXT")]
    serial: Option<String>,
    /// Ask every port of this machine who is there. Devices of others are written to, too.
    #[arg(long)]
    ask: bool,
    /// Speed of the serial port, bit/s.
    #[arg(long, value_name = "BIT_PER_S", default_value_t = 921_600)]
    baud: u32,
}

/// How long a port is asked that may be anybody's: a board answers within some 10 ms, and one frame in
/// two may be lost to what the port was in the middle of.
pub(super) const WHO_ARE_YOU: Patience = Patience {
    wait: Duration::from_millis(500),
    tries: 2,
    silence: Duration::from_secs(3),
};

/// A board that was found and has said who it is.
pub(in crate::cli) struct Found {
    pub(in crate::cli) port: String,
    pub(in crate::cli) session: Session,
    pub(in crate::cli) identity: Identity,
}

impl Which {
    /// Finds the board.
    ///
    /// # Errors
    /// What the port says; which boards there are, if none or several are meant.
    pub(in crate::cli) fn find(&self) -> anyhow::Result<Found> {
        let names = self.names()?;
        if let ([name], None) = (&names[..], &self.serial) {
            return self
                .open(name, Patience::default())
                .map_err(|error| SourceError::from(error).into());
        }
        let patience = if self.ask {
            WHO_ARE_YOU
        } else {
            Patience::default()
        };
        let (mut meant, mut others) = (Vec::new(), Vec::new());
        for name in &names {
            match self.open(name, patience) {
                Ok(found) if self.is_meant(&found.identity) => meant.push(found),
                Ok(found) => others.push(format!("{name}: board {}", serial(&found.identity))),
                Err(LinkError::NoReply { .. }) => others.push(format!("{name}: no answer")),
                Err(error) => others.push(error.to_string()),
            }
        }
        if meant.len() > 1 {
            let boards: Vec<String> = meant
                .iter()
                .map(|found| format!("{} on {}", serial(&found.identity), found.port))
                .collect();
            bail!(
                "several boards are meant: {}; choose one with --port, or more of its --serial",
                boards.join(", ")
            );
        }
        let wanted = self.serial.as_deref().map_or_else(
            || "no board".to_owned(),
            |text| format!("no board whose serial number contains `{text}`"),
        );
        meant.pop().ok_or_else(|| {
            anyhow::anyhow!(
                "{wanted} answers; {}",
                if others.is_empty() {
                    "this machine has no serial port: plug the board in".to_owned()
                } else {
                    others.join("; ")
                }
            )
        })
    }

    /// Whether it is the board without hardware, and no other.
    pub(in crate::cli) fn is_virtual(&self) -> bool {
        self.port == [VIRTUAL] && self.serial.is_none() && !self.ask
    }

    /// Opens a board without hardware.
    ///
    /// # Errors
    /// What its link says.
    pub(in crate::cli) fn open_virtual(connect: &mut VirtualConnect) -> anyhow::Result<Found> {
        open(connect, Patience::default()).map_err(|error| SourceError::from(error).into())
    }

    /// How to open the port of a board that was found, once more.
    pub(super) fn connect(&self, name: &str) -> Box<dyn Connect> {
        connect(name, self.baud)
    }

    fn open(&self, name: &str, patience: Patience) -> Result<Found, LinkError> {
        open(self.connect(name).as_mut(), patience)
    }

    fn is_meant(&self, identity: &Identity) -> bool {
        let wanted = self.serial.as_deref().unwrap_or("").to_lowercase();
        serial(identity).contains(&wanted)
    }

    /// Ports that may be written to.
    fn names(&self) -> anyhow::Result<Vec<String>> {
        if self.ask {
            let ports = ports(&self.port).into_iter().map(|port| port.name);
            return Ok(ports.collect());
        }
        ensure!(
            !self.port.is_empty(),
            "which port may be asked? Name it with --port, or give --ask for all: what is behind a port \
             of somebody else's moves when it is written to{}",
            match ports(&[])
                .into_iter()
                .map(|port| port.name)
                .collect::<Vec<_>>()
            {
                names if names.is_empty() => "; this machine has no serial port".to_owned(),
                names => format!("; ports of this machine: {}", names.join(", ")),
            }
        );
        Ok(self.port.clone())
    }
}

/// How to open a port, or a board without hardware.
pub(super) fn connect(name: &str, baud: u32) -> Box<dyn Connect> {
    if name == VIRTUAL {
        // As fast as it goes: its host's clock is its own.
        return Box::new(VirtualConnect::published(SEED, 0.0));
    }
    Box::new(SerialConnect::new(name, baud))
}

/// Opens a port and asks who is there.
fn open(connect: &mut dyn Connect, patience: Patience) -> Result<Found, LinkError> {
    let (session, identity) = Session::open(connect, patience)?;
    Ok(Found {
        port: connect.name(),
        session,
        identity,
    })
}
