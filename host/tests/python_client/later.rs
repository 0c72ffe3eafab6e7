//! A board that speaks a version of the protocol which is still to come.

use std::io::{self, Read};

use inm_host::internals::link::{Connect, LinkError, Port};
use inm_protocol::{Hello, MAX_FRAME};

/// A board of a version to come: to whatever it is asked it says hello, and then something unknown.
struct Later(Vec<u8>);

impl Read for Later {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        if self.0.is_empty() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        let len = self.0.len().min(buf.len());
        buf[..len].copy_from_slice(&self.0[..len]);
        self.0.drain(..len);
        Ok(len)
    }
}

impl io::Write for Later {
    fn write(&mut self, buf: &[u8]) -> io::Result<usize> {
        let hello = Hello {
            version: 9,
            serial: [1, 2, 3],
            firmware: "9.1.0".try_into().expect("short"),
            platform: "stm32f405".try_into().expect("short"),
        };
        let mut frame = [0; MAX_FRAME];
        let len = hello.encode(&mut frame).expect("fits");
        self.0.extend(&frame[..len]);
        Ok(buf.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Opens one.
pub struct ConnectLater;

impl Connect for ConnectLater {
    fn name(&self) -> String {
        "later".into()
    }

    fn open(&mut self) -> Result<Box<dyn Port>, LinkError> {
        Ok(Box::new(Later(Vec::new())))
    }
}
