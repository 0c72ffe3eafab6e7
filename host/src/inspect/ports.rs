//! Serial ports of this machine, looked at without a byte sent and without one opened: to open a port
//! moves its DTR and RTS lines, which restarts some devices, and others' devices act on what is written.

use serde::Serialize;
use serialport::SerialPortType;

use super::{Session, serial};
use crate::link::{LinkError, Patience, SerialConnect};

/// A serial port.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PortInfo {
    /// What it is opened by: `/dev/ttyUSB0`, `COM3`.
    pub name: String,
    /// What it belongs to.
    pub kind: Kind,
    /// Whether this user may open it; `None` where the system does not say.
    pub permitted: Option<bool>,
    /// Group of users that may; `None` where it has none, or none with a name.
    pub group: Option<String>,
    /// Who answered there; `None` where nobody was asked.
    pub answer: Option<Who>,
}

/// What a port belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A USB adapter.
    Usb {
        /// Number of its maker.
        vendor_id: u16,
        /// Number of the product.
        product_id: u16,
        /// Its maker, as it says.
        maker: Option<String>,
        /// The product, as it says.
        product: Option<String>,
        /// Serial number of the adapter, which is not the board's.
        serial: Option<String>,
    },
    /// A card or a chip of this machine.
    Pci,
    /// A radio link.
    Bluetooth,
    /// Not known.
    Unknown,
}

/// Who answered on a port.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Who {
    /// A board of this protocol.
    Board {
        /// Unique number of its microcontroller, 24 hexadecimal digits.
        serial: String,
        /// What its image was built for.
        platform: String,
        /// Release of its firmware.
        firmware: String,
    },
    /// No board, or one that this program cannot speak to; why, in words.
    Nobody(String),
}

/// All ports of this machine, and those that were `named` and that the system does not list. A system
/// that lists none gives no others.
pub fn ports(named: &[String]) -> Vec<PortInfo> {
    let listed = serialport::available_ports().unwrap_or_default();
    let mut ports: Vec<PortInfo> = listed
        .into_iter()
        .map(|port| PortInfo::of(port.port_name, port.port_type))
        .collect();
    for name in named {
        if !ports.iter().any(|port| port.name == *name) {
            ports.push(PortInfo::of(name.clone(), SerialPortType::Unknown));
        }
    }
    ports.sort_by(|one, other| one.name.cmp(&other.name));
    ports
}

impl PortInfo {
    fn of(name: String, port_type: SerialPortType) -> Self {
        let kind = match port_type {
            SerialPortType::UsbPort(usb) => Kind::Usb {
                vendor_id: usb.vid,
                product_id: usb.pid,
                maker: usb.manufacturer,
                product: usb.product,
                serial: usb.serial_number,
            },
            SerialPortType::PciPort => Kind::Pci,
            SerialPortType::BluetoothPort => Kind::Bluetooth,
            SerialPortType::Unknown => Kind::Unknown,
        };
        Self {
            permitted: permission::permitted(&name),
            group: permission::group(&name),
            name,
            kind,
            answer: None,
        }
    }

    /// Opens the port at `baud` bit/s and asks who is there.
    pub fn ask(&mut self, baud: u32, patience: Patience) {
        let mut connect = SerialConnect::new(self.name.as_str(), baud);
        let found = Session::open(&mut connect, patience);
        self.answer = Some(match found {
            Ok((_, identity)) => Who::Board {
                serial: serial(&identity),
                platform: identity.platform.to_string(),
                firmware: identity.firmware.to_string(),
            },
            Err(LinkError::NoReply { .. }) => Who::Nobody("no answer".to_owned()),
            Err(error) => Who::Nobody(error.to_string()),
        });
    }

    /// The line of a udev rule that lets whoever sits at this machine open the adapter; `None` for what
    /// is no USB adapter.
    pub fn udev_rule(&self) -> Option<String> {
        let Kind::Usb {
            vendor_id,
            product_id,
            ..
        } = self.kind
        else {
            return None;
        };
        Some(format!(
            "SUBSYSTEM==\"tty\", ATTRS{{idVendor}}==\"{vendor_id:04x}\", \
             ATTRS{{idProduct}}==\"{product_id:04x}\", TAG+=\"uaccess\""
        ))
    }
}

#[cfg(unix)]
mod permission {
    use std::os::unix::fs::MetadataExt;

    use rustix::fs::{Access, access};

    /// Whether this user may read and write the port; `None` if it is not there.
    pub fn permitted(name: &str) -> Option<bool> {
        std::fs::metadata(name).ok()?;
        Some(access(name, Access::READ_OK | Access::WRITE_OK).is_ok())
    }

    /// Name of the group that the port belongs to.
    pub fn group(name: &str) -> Option<String> {
        let number = std::fs::metadata(name).ok()?.gid().to_string();
        let groups = std::fs::read_to_string("/etc/group").ok()?;
        named(&groups, &number)
    }

    /// The name of group `number` in the lines `name:password:number:members` of `groups`.
    pub fn named(groups: &str, number: &str) -> Option<String> {
        let mut lines = groups.lines().map(|line| line.split(':'));
        lines.find_map(|mut fields| {
            let name = fields.next()?;
            (fields.nth(1)? == number).then(|| name.to_owned())
        })
    }
}

#[cfg(not(unix))]
mod permission {
    pub fn permitted(_: &str) -> Option<bool> {
        None
    }

    pub fn group(_: &str) -> Option<String> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_udev_rule_names_the_adapter_and_nothing_else() {
        let mut port = PortInfo {
            name: "/dev/ttyUSB0".to_owned(),
            kind: Kind::Usb {
                vendor_id: 0x0403,
                product_id: 0x6001,
                maker: None,
                product: None,
                serial: None,
            },
            permitted: Some(false),
            group: None,
            answer: None,
        };
        let rule = "SUBSYSTEM==\"tty\", ATTRS{idVendor}==\"0403\", ATTRS{idProduct}==\"6001\", \
                    TAG+=\"uaccess\"";
        assert_eq!(port.udev_rule().as_deref(), Some(rule));
        port.kind = Kind::Pci;
        assert_eq!(port.udev_rule(), None);
    }

    #[cfg(unix)]
    #[test]
    fn a_group_is_found_by_its_number_and_not_by_a_part_of_it() {
        let groups = "root:x:0:\ndialout:x:20:me\nother:x:2:\n";
        assert_eq!(permission::named(groups, "20").as_deref(), Some("dialout"));
        assert_eq!(permission::named(groups, "2").as_deref(), Some("other"));
        assert_eq!(permission::named(groups, "7"), None);
    }
}
