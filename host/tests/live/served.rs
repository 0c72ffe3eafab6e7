//! A recording of a virtual board with a page, and tabs that look at it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Longest wait for anything: a busy machine takes its time, and a defect for ever.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// A recording with a page.
pub struct Served {
    child: Child,
    /// Address and port.
    pub host: String,
    /// Path of the page, with its token.
    pub path: String,
    /// What it says on standard error behind that.
    said: Option<JoinHandle<String>>,
}

impl Served {
    /// Records a virtual board at ten times its speed.
    pub fn start(capture: &Path, board_s: u32) -> Self {
        Self::on(&["virtual", "--speed", "10"], capture, board_s)
    }

    /// Records the board of a source.
    pub fn on(source: &[&str], capture: &Path, board_s: u32) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_inm"))
            // So that its name is short, and the same in every run.
            .current_dir(capture.parent().expect("a folder"))
            .args(["live", "--plain", "--page", "--source"])
            .args(source)
            .arg("--duration")
            .arg(board_s.to_string())
            .arg("-o")
            .arg(capture.file_name().expect("a name"))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("inm runs");
        let mut said = BufReader::new(child.stderr.take().expect("it was asked for"));
        let told = (&mut said).lines().map_while(Result::ok);
        let line = told.into_iter().find(|line| line.starts_with("page: "));
        let line = line.expect("it says where the page is");
        // A pipe that nobody reads holds what is written to it.
        let said = thread::spawn(move || {
            let mut rest = String::new();
            said.read_to_string(&mut rest).expect("text");
            rest
        });
        let url = line.trim().strip_prefix("page: http://");
        let (host, path) = url.and_then(|url| url.split_once('/')).expect("an address");
        Self {
            child,
            host: host.to_owned(),
            path: format!("/{path}"),
            said: Some(said),
        }
    }

    /// The address of the page.
    pub fn url(&self) -> String {
        format!("http://{}{}", self.host, self.path)
    }

    /// A tab: the stream of what changes.
    pub fn tab(&self) -> BufReader<TcpStream> {
        let mut tab = TcpStream::connect(&self.host).expect("it listens");
        tab.set_read_timeout(Some(PATIENCE)).expect("set");
        let request = self.request("GET", "events", &[], "");
        tab.write_all(request.as_bytes()).expect("it hears");
        BufReader::new(tab)
    }

    pub fn request(&self, method: &str, what: &str, headers: &[&str], body: &str) -> String {
        let headers: String = headers.iter().map(|one| format!("{one}\r\n")).collect();
        format!(
            "{method} {}{what} HTTP/1.1\r\nHost: {}\r\nContent-Length: {}\r\n{headers}\r\n{body}",
            self.path,
            self.host,
            body.len()
        )
    }

    /// The status of the answer to a request.
    #[track_caller]
    pub fn status(&self, request: &str) -> u16 {
        let mut stream = TcpStream::connect(&self.host).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("set");
        // An answer may come before all was sent.
        let _ = stream.write_all(request.as_bytes());
        let mut line = String::new();
        BufReader::new(stream)
            .read_line(&mut line)
            .expect("an answer");
        let status = line
            .split(' ')
            .nth(1)
            .and_then(|status| status.parse().ok());
        status.unwrap_or_else(|| panic!("no status: {line}"))
    }

    /// Ends it, and waits for it.
    pub fn stop(mut self) {
        assert_eq!(self.command("end", ""), 204);
        self.end();
    }

    /// Resident memory of the program, MB; `None` where the system does not tell it in Linux's way.
    pub fn resident_mb(&self) -> Option<f64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix("VmRSS:"))?;
        let kb: f64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
        Some(kb / 1024.0)
    }

    /// Waits for its end, in good order and without a gap; what it has said.
    pub fn end(&mut self) -> String {
        let (status, said) = self.ended();
        assert_eq!(status, Some(0), "{said}");
        said
    }

    /// Waits for its end: exit status, and what it has said.
    pub fn ended(&mut self) -> (Option<i32>, String) {
        let deadline = Instant::now() + 2 * PATIENCE;
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("our child") {
                break status;
            }
            assert!(Instant::now() < deadline, "it does not end");
            thread::sleep(Duration::from_millis(20));
        };
        let said = self.said.take().expect("it ends once");
        (status.code(), said.join().expect("text"))
    }

    /// The status of the answer to a command of the page.
    #[track_caller]
    pub fn command(&self, what: &str, body: &str) -> u16 {
        self.status(&self.request("POST", what, &[], body))
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // A test that has failed leaves nothing behind.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Reads from a tab until `text` comes.
#[track_caller]
pub fn wait_for(tab: &mut BufReader<TcpStream>, text: &str) -> String {
    loop {
        let mut line = String::new();
        let len = tab.read_line(&mut line).expect("a tab that goes on");
        assert!(len > 0, "the tab ends without `{text}`");
        if line.contains(text) {
            return line;
        }
    }
}

/// What `analyze` reads from a capture, of its source.
pub fn source(capture: &Path) -> serde_json::Value {
    let output = Command::new(env!("CARGO_BIN_EXE_inm"))
        .arg("analyze")
        .arg(capture)
        .args(["--json", "-"])
        .output()
        .expect("inm runs");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    json["source"].clone()
}
