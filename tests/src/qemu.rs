//! The firmware's image in QEMU, and the far end of its link.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use inm_protocol::{
    Answer, Decoder, Identity, MAX_FRAME, Refusal, Request, ToBoard, ToHost, encode,
};
use serialport::SerialPort;

/// Names the image for QEMU; set by `cargo xtask test`.
pub const IMAGE_VARIABLE: &str = "INM_QEMU_IMAGE";

/// Nanoseconds of an instruction, as a power of two. At 4 ns three emulated converters keep up
/// with 4000/s; a slower core would only stretch bench time.
const SHIFT: u32 = 2;

/// QEMU is up within seconds on an idle machine; this one may build at the same time.
const PATIENCE: Duration = Duration::from_secs(60);

/// Times a request is sent before the board is given up. QEMU drops what the board says until
/// it has noticed, once a second, that somebody listens.
const TRIES: u32 = 20;

/// A virtual machine; killed when dropped.
struct Machine(Child);

impl Drop for Machine {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The board in QEMU, reached through a serial port of this machine.
pub struct QemuBoard {
    port: Box<dyn SerialPort>,
    decoder: Decoder,
    inbox: VecDeque<ToHost>,
    next_id: u16,
    _machine: Machine,
}

impl QemuBoard {
    /// Starts the image that [`IMAGE_VARIABLE`] names and opens its port.
    ///
    /// # Errors
    /// No image, no QEMU, or a QEMU that says something unexpected.
    pub fn start() -> io::Result<Self> {
        let image = std::env::var_os(IMAGE_VARIABLE).map(PathBuf::from).ok_or_else(|| {
            io::Error::other(format!("{IMAGE_VARIABLE} is not set; run: cargo xtask test"))
        })?;
        let (machine, path) = launch(&image.into_os_string())?;
        let port = serialport::new(path, 921_600).timeout(Duration::from_millis(100)).open()?;
        Ok(Self {
            port,
            decoder: Decoder::new(),
            inbox: VecDeque::new(),
            next_id: 1,
            _machine: machine,
        })
    }

    /// The next message.
    ///
    /// # Errors
    /// None within the patience, or the port is gone, or a frame was damaged: a pty loses
    /// nothing.
    pub fn next(&mut self) -> io::Result<ToHost> {
        self.next_within(PATIENCE)
    }

    /// Asks until the board answers. What else arrives stays for [`QemuBoard::next`].
    ///
    /// # Errors
    /// As [`QemuBoard::next`].
    pub fn ask(&mut self, request: Request) -> io::Result<Result<Answer, Refusal>> {
        for _ in 0..TRIES {
            let id = self.next_id;
            self.next_id += 1;
            self.send(id, request)?;
            let mut aside = VecDeque::new();
            let deadline = Instant::now() + Duration::from_secs(3);
            while let Some(left) = deadline.checked_duration_since(Instant::now()) {
                match self.next_within(left) {
                    Ok(ToHost::Reply(reply)) if reply.id == id => {
                        aside.append(&mut self.inbox);
                        self.inbox = aside;
                        return Ok(reply.result);
                    }
                    Ok(message) => aside.push_back(message),
                    Err(error) if error.kind() == io::ErrorKind::TimedOut => {}
                    Err(error) => return Err(error),
                }
            }
            self.inbox = aside;
        }
        Err(io::Error::other(format!("no reply to {request:?}")))
    }

    /// [`Request::Identify`].
    ///
    /// # Errors
    /// As [`QemuBoard::next`].
    pub fn identify(&mut self) -> io::Result<Identity> {
        match self.ask(Request::Identify)? {
            Ok(Answer::Identity(identity)) => Ok(identity),
            other => Err(io::Error::other(format!("not an identity: {other:?}"))),
        }
    }

    /// Forgets what has arrived and not been looked at.
    pub fn discard(&mut self) {
        self.inbox.clear();
    }

    fn send(&mut self, id: u16, request: Request) -> io::Result<()> {
        let command = ToBoard::Command(inm_protocol::Command { id, request });
        // A zero first ends whatever the board believes to be in.
        let mut frame = [0; MAX_FRAME + 1];
        let len = encode(&command, &mut frame[1..]).map_err(io::Error::other)?;
        self.port.write_all(&frame[..=len])
    }

    fn next_within(&mut self, patience: Duration) -> io::Result<ToHost> {
        let deadline = Instant::now() + patience;
        let mut buf = [0; 1 << 14];
        loop {
            if let Some(message) = self.inbox.pop_front() {
                return Ok(message);
            }
            match self.port.read(&mut buf) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(len) => {
                    let mut bytes = &buf[..len];
                    while let Some(message) = self.decoder.next(&mut bytes) {
                        self.inbox.push_back(message.map_err(io::Error::other)?);
                    }
                }
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                    if Instant::now() > deadline {
                        return Err(error);
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }
}

/// Starts QEMU and waits until it says where its serial port is.
fn launch(image: &OsString) -> io::Result<(Machine, String)> {
    let child = Command::new("qemu-system-arm")
        .args(["-M", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "pty"])
        .args(["-icount", &format!("shift={SHIFT},sleep=off"), "-kernel"])
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| io::Error::other(format!("qemu-system-arm: {error}")))?;
    let mut machine = Machine(child);
    let output = machine.0.stdout.take().ok_or_else(|| io::Error::other("no output"))?;
    let mut said = String::new();
    // "char device redirected to /dev/pts/3 (label serial0)"
    BufReader::new(output).read_line(&mut said)?;
    let path = said.split_whitespace().find(|word| word.starts_with("/dev/"));
    match path {
        Some(path) => Ok((machine, path.to_owned())),
        None => Err(io::Error::other(format!("QEMU names no port, it says: {said:?}"))),
    }
}
