//! A browser, Chromium, where one is installed: driven over the DevTools protocol
//! (<https://chromedevtools.github.io/devtools-protocol>) on a pair of pipes.

use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

use crate::served::PATIENCE;

/// Names of the program, as systems install it.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Between two looks at a condition: often enough that nobody waits.
const AGAIN: Duration = Duration::from_millis(50);

/// No picture of its own, no word to the network, and no sandbox, which root of a container cannot have: the
/// only page that it sees is ours. It speaks on its file descriptors 3 and 4.
const OPTIONS: [&str; 10] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-sync",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--remote-debugging-pipe",
];

/// Makes standard input and output the descriptors 3 and 4 of the program that follows.
const PIPES: &str = r#"exec "$@" 3<&0 4>&1 </dev/null >/dev/null 2>&1"#;

/// How long a browser that was told to end may take for it.
const END: Duration = Duration::from_secs(5);

/// A browser.
pub struct Browser {
    child: Child,
    input: Option<ChildStdin>,
    said: Receiver<Value>,
    /// Commands so far, which are told apart by their number.
    sent: u64,
    /// What its consoles call an error.
    pub errors: Vec<Value>,
    /// Its files, as long as it lives.
    _profile: tempfile::TempDir,
}

/// A tab.
pub struct Tab {
    /// What is closed.
    pub(super) target: String,
    /// The session with it.
    session: String,
}

/// Where it is installed.
fn program() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let folders = std::env::split_paths(&path);
    folders
        .flat_map(|folder| NAMES.map(|name| folder.join(name)))
        .find(|file| file.is_file())
}

impl Browser {
    /// Starts it; where there is none, says so even where the output of tests is held back.
    pub fn start() -> Option<Self> {
        let Some(program) = program() else {
            let words = "NOT TESTED: the page in a browser; `apt-get install -y --no-remove chromium` brings one";
            writeln!(std::io::stderr(), "{words}").expect("it is heard");
            return None;
        };
        let profile = tempfile::tempdir().expect("a folder");
        let mut child = Command::new("sh")
            .args(["-c", PIPES, "sh"])
            .arg(program)
            .args(OPTIONS)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell");
        let output = BufReader::new(child.stdout.take().expect("it was asked for"));
        let (tell, said) = mpsc::channel();
        thread::spawn(move || {
            for message in output.split(0).map_while(Result::ok) {
                let message = serde_json::from_slice(&message).expect("JSON");
                if tell.send(message).is_err() {
                    break;
                }
            }
        });
        Some(Self {
            input: child.stdin.take(),
            child,
            said,
            sent: 0,
            errors: Vec::new(),
            _profile: profile,
        })
    }

    /// The answer to a command to the browser, or to the tab of a session.
    #[track_caller]
    pub(super) fn ask(&mut self, tab: Option<&Tab>, method: &str, params: &Value) -> Value {
        self.sent += 1;
        let mut command = json!({ "id": self.sent, "method": method, "params": params });
        if let Some(tab) = tab {
            command["sessionId"] = tab.session.as_str().into();
        }
        let input = self.input.as_mut().expect("it is open");
        write!(input, "{command}\0").expect("it hears");
        loop {
            let message = self.said.recv_timeout(PATIENCE).expect(method);
            if message["id"] == self.sent {
                return message;
            }
            let error = match message["method"].as_str() {
                Some("Runtime.exceptionThrown") => true,
                Some("Log.entryAdded") => message["params"]["entry"]["level"] == "error",
                Some("Runtime.consoleAPICalled") => message["params"]["type"] == "error",
                _ => false,
            };
            if error {
                self.errors.push(message);
            }
        }
    }

    /// A tab on `url`.
    pub fn open(&mut self, url: &str) -> Tab {
        let tab = self.blank();
        self.go(&tab, url);
        tab
    }

    /// An empty tab, which shares no process with another.
    pub fn blank(&mut self) -> Tab {
        let text = |value: &Value| value.as_str().expect("a text").to_owned();
        let answer = self.ask(None, "Target.createBrowserContext", &json!({}));
        let blank = json!({
            "url": "about:blank",
            "browserContextId": answer["result"]["browserContextId"],
        });
        let answer = self.ask(None, "Target.createTarget", &blank);
        let target = text(&answer["result"]["targetId"]);
        let params = json!({ "targetId": target, "flatten": true });
        let answer = self.ask(None, "Target.attachToTarget", &params);
        let session = text(&answer["result"]["sessionId"]);
        let tab = Tab { target, session };
        for part in ["Page.enable", "Runtime.enable", "Log.enable"] {
            self.ask(Some(&tab), part, &json!({}));
        }
        tab
    }

    /// Leads a tab to `url`.
    pub fn go(&mut self, tab: &Tab, url: &str) {
        self.ask(Some(tab), "Page.navigate", &json!({ "url": url }));
    }

    /// What an expression is in a tab.
    #[track_caller]
    pub fn value(&mut self, tab: &Tab, expression: &str) -> Value {
        let params = json!({
            "expression": expression,
            "returnByValue": true,
            "awaitPromise": true,
        });
        let answer = self.ask(Some(tab), "Runtime.evaluate", &params);
        answer["result"]["result"]["value"].clone()
    }

    /// Clicks on what a selector finds, and answers yes if the page asks anything.
    #[track_caller]
    pub fn click(&mut self, tab: &Tab, selector: &str, asks: bool) {
        // A question holds up what asked it, so it is asked later.
        let click = format!("setTimeout(() => document.querySelector('{selector}').click())");
        self.value(tab, &click);
        if asks {
            self.agree(tab);
        }
    }

    /// Draws pages in the colours of `scheme`, on a screen of so many pixels.
    pub fn look(&mut self, tab: &Tab, scheme: &str, [width, height]: [u32; 2]) {
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.ask(
            Some(tab),
            "Emulation.setEmulatedMedia",
            &json!({ "features": features }),
        );
        let params = json!({
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600,
        });
        self.ask(Some(tab), "Emulation.setDeviceMetricsOverride", &params);
    }

    /// What is to be seen in a tab, as a PNG file.
    pub fn picture(&mut self, tab: &Tab) -> Vec<u8> {
        let params = json!({ "format": "png", "optimizeForSpeed": false });
        let answer = self.ask(Some(tab), "Page.captureScreenshot", &params);
        let data = answer["result"]["data"].as_str().expect("a picture");
        BASE64_STANDARD.decode(data).expect("base 64")
    }

    /// Waits until a condition holds in a tab.
    #[track_caller]
    pub fn wait_for(&mut self, tab: &Tab, condition: &str) {
        // An unoptimised program on a busy machine takes most of a minute for its next analysis.
        let deadline = Instant::now() + 2 * PATIENCE;
        while self.value(tab, condition) != true {
            assert!(Instant::now() < deadline, "never: {condition}");
            thread::sleep(AGAIN);
        }
    }

    /// Answers yes to what a tab asks, as soon as it does.
    #[track_caller]
    fn agree(&mut self, tab: &Tab) {
        let deadline = Instant::now() + PATIENCE;
        let yes = json!({ "accept": true });
        let agrees = "Page.handleJavaScriptDialog";
        while !self.ask(Some(tab), agrees, &yes)["error"].is_null() {
            assert!(Instant::now() < deadline, "nothing is asked");
            thread::sleep(AGAIN);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if let Some(mut input) = self.input.take() {
            let _ = write!(input, "{{\"id\":0,\"method\":\"Browser.close\"}}\0");
        }
        let deadline = Instant::now() + END;
        while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < deadline {
            thread::sleep(AGAIN);
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
