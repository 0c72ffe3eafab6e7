//! `inm board ports`: serial ports, who may open them, and which boards are there.

use std::fmt::Write as _;
use std::process::ExitCode;

use clap::Args;

use super::JsonOption;
use super::which::WHO_ARE_YOU;
use crate::inspect::ports::{Kind, PortInfo, Who, ports};

/// Arguments of `inm board ports`.
#[derive(Debug, Args)]
pub struct Ports {
    /// Ports to ask who is there. No other is opened or written to.
    #[arg(value_name = "PORT")]
    ports: Vec<String>,
    /// Ask every port of this machine. Devices of others are written to, too.
    #[arg(long)]
    ask: bool,
    /// Speed of the serial ports that are asked, bit/s.
    #[arg(long, value_name = "BIT_PER_S", default_value_t = 921_600)]
    baud: u32,
    #[command(flatten)]
    json: JsonOption,
}

/// Where the rule goes: ahead of 73-seat-late.rules, which acts on the tag.
const RULES: &str = "/etc/udev/rules.d/70-inm.rules";

impl Ports {
    /// Runs the subcommand.
    ///
    /// # Errors
    /// If the result cannot be written.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        self.json.check()?;
        let mut ports = ports(&self.ports);
        for port in &mut ports {
            if self.ask || self.ports.contains(&port.name) {
                port.ask(self.baud, WHO_ARE_YOU);
            }
        }
        self.json.write(&ports, &text(&ports))?;
        Ok(ExitCode::SUCCESS)
    }
}

fn text(ports: &[PortInfo]) -> String {
    if ports.is_empty() {
        return "this machine has no serial port: plug the board in, or use `--port virtual`\n"
            .to_owned();
    }
    let mut text = String::new();
    for port in ports {
        let _ = writeln!(text, "{}: {}", port.name, kind(&port.kind));
        if port.permitted == Some(false) {
            text += &remedy(port);
        }
        let _ = match &port.answer {
            None => Ok(()),
            Some(Who::Board {
                serial,
                platform,
                firmware,
            }) => writeln!(
                text,
                "    board {serial}, firmware {firmware} for {platform}"
            ),
            Some(Who::Nobody(why)) => writeln!(text, "    {why}"),
        };
    }
    if ports.iter().all(|port| port.answer.is_none()) {
        text += "nobody was asked: name ports, or give --ask for all\n";
    }
    text
}

fn kind(kind: &Kind) -> String {
    match kind {
        Kind::Usb {
            vendor_id,
            product_id,
            maker,
            product,
            serial,
        } => {
            let mut words = format!("USB adapter {vendor_id:04x}:{product_id:04x}");
            for said in [maker, product].into_iter().flatten() {
                let _ = write!(words, ", {said}");
            }
            if let Some(serial) = serial {
                let _ = write!(words, ", its serial number {serial}");
            }
            words
        }
        Kind::Pci => "part of this machine".to_owned(),
        Kind::Bluetooth => "Bluetooth".to_owned(),
        Kind::Unknown => "of a kind that the system does not tell".to_owned(),
    }
}

/// What gives this user the port.
fn remedy(port: &PortInfo) -> String {
    let mut text = "    this user may not open it".to_owned();
    // A port that is root's alone has no group to join.
    if let Some(group) = port.group.as_deref().filter(|group| *group != "root") {
        let _ = write!(
            text,
            "; join its group and log in anew: sudo usermod -a -G {group} $USER"
        );
    }
    text.push('\n');
    if let Some(rule) = port.udev_rule() {
        let _ = writeln!(
            text,
            "    or for whoever sits here, this line in {RULES}, then `sudo udevadm control --reload` and \
             plug it in anew:\n    {rule}"
        );
    }
    text
}
