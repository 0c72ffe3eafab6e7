//! A serial port of this machine, found again after its adapter was plugged in anew.

use std::io::{self, Read, Write};
use std::path::Path;

use serialport::SerialPortType;

use super::port::READ_TIMEOUT;
use super::{Connect, LinkError, Port};

/// What tells one USB adapter from another: maker, product, and a number, which many lack.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Adapter {
    vid: u16,
    pid: u16,
    serial: Option<String>,
}

/// A port of this machine.
#[derive(Debug, Clone)]
struct Found {
    name: String,
    /// `None` for a port that is no USB adapter's.
    adapter: Option<Adapter>,
}

/// A serial port; behind a USB adapter, whichever port has that adapter.
#[derive(Debug, Clone)]
pub struct SerialConnect {
    path: String,
    baud: u32,
    /// The adapter behind the path when it was first opened; `None` for a port that is none.
    adapter: Option<Adapter>,
    /// Where it was last opened.
    current: String,
    /// Ports opened that were not the right one.
    rejected: usize,
}

impl SerialConnect {
    /// The port at `path` (`/dev/ttyUSB0`, `COM3`) at `baud` bit/s.
    pub fn new(path: impl Into<String>, baud: u32) -> Self {
        let path = path.into();
        Self {
            current: path.clone(),
            path,
            baud,
            adapter: None,
            rejected: 0,
        }
    }

    fn open_at(&self, path: &str) -> Result<Box<dyn Port>, LinkError> {
        serialport::new(path, self.baud)
            .timeout(READ_TIMEOUT)
            .open()
            .map(|port| Box::new(Serial(port)) as Box<dyn Port>)
            .map_err(|source| LinkError::Open {
                port: path.to_owned(),
                available: ports().into_iter().map(|port| port.name).collect(),
                source,
            })
    }
}

impl Connect for SerialConnect {
    fn name(&self) -> String {
        self.current.clone()
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        let mut paths = vec![self.path.clone()];
        if let Some(adapter) = &self.adapter {
            paths.extend(elsewhere(&self.path, adapter, ports()));
        }
        let first = self.rejected % paths.len();
        paths.rotate_left(first);
        let mut refused = None;
        for path in paths {
            match self.open_at(&path) {
                Ok(port) => {
                    if self.adapter.is_none() {
                        self.adapter = adapter(&path, ports());
                    }
                    self.current = path;
                    return Ok(port);
                }
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        // There is one path at least, and it was refused.
        refused.map_or_else(|| self.open_at(&self.path), Err)
    }

    fn reject(&mut self) {
        self.rejected += 1;
    }
}

/// Ports of this machine.
fn ports() -> Vec<Found> {
    let ports = serialport::available_ports().unwrap_or_default();
    let found = ports.into_iter().map(|port| Found {
        name: port.port_name,
        adapter: match port.port_type {
            SerialPortType::UsbPort(usb) => Some(Adapter {
                vid: usb.vid,
                pid: usb.pid,
                serial: usb.serial_number,
            }),
            _ => None,
        },
    });
    found.collect()
}

/// The USB adapter behind a path, which may be a link such as those in `/dev/serial/by-id`.
fn adapter(path: &str, ports: Vec<Found>) -> Option<Adapter> {
    let real = std::fs::canonicalize(path).ok();
    let here = |name: &str| name == path || real.as_deref() == Some(Path::new(name));
    ports.into_iter().find(|port| here(&port.name))?.adapter
}

/// The ports other than `path` that have the same adapter, as far as adapters can be told apart:
/// where they have no number, the board has to tell.
fn elsewhere(path: &str, adapter: &Adapter, ports: Vec<Found>) -> Vec<String> {
    let there = ports
        .into_iter()
        .filter(|port| port.name != path && port.adapter.as_ref() == Some(adapter));
    there.map(|port| port.name).collect()
}

/// A [`serialport::SerialPort`] whose end of file is an error: a terminal has no end, so a
/// read of nothing means that the other side has hung up.
struct Serial(Box<dyn serialport::SerialPort>);

impl Read for Serial {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buf) {
            Ok(0) => Err(io::ErrorKind::BrokenPipe.into()),
            other => other,
        }
    }
}

impl Write for Serial {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        self.0.write(buf)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn usb(name: &str, serial: Option<&str>) -> Found {
        Found {
            name: name.to_owned(),
            adapter: Some(Adapter {
                vid: 0x0403,
                pid: 0x6001,
                serial: serial.map(str::to_owned),
            }),
        }
    }

    #[test]
    fn an_adapter_that_was_plugged_in_again_is_found_under_its_new_name() {
        let plain = Found {
            name: "/dev/ttyS0".to_owned(),
            adapter: None,
        };
        let before = vec![plain.clone(), usb("/dev/ttyUSB0", Some("A1"))];
        let known = adapter("/dev/ttyUSB0", before).expect("a USB adapter");
        let after = vec![
            plain.clone(),
            usb("/dev/ttyUSB1", Some("A1")),
            usb("/dev/ttyUSB2", Some("B7")),
        ];
        let found = elsewhere("/dev/ttyUSB0", &known, after);
        assert_eq!(found, ["/dev/ttyUSB1"]);
        assert_eq!(adapter("/dev/ttyS0", vec![plain]), None);
    }

    #[test]
    fn adapters_without_a_number_are_all_looked_at() {
        let known = adapter("/dev/ttyUSB0", vec![usb("/dev/ttyUSB0", None)]);
        let ports = vec![usb("/dev/ttyUSB1", None), usb("/dev/ttyUSB2", None)];
        let found = elsewhere("/dev/ttyUSB0", &known.expect("a USB adapter"), ports);
        assert_eq!(found, ["/dev/ttyUSB1", "/dev/ttyUSB2"]);
    }
}
