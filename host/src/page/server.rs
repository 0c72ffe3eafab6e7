//! The server of the page: a thread of its own, which no recording waits for.

use std::convert::Infallible;
use std::io;
use std::net::TcpListener;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use axum::Router;
use axum::extract::{Request, State};
use axum::http::header::{ALLOW, HOST, ORIGIN};
use axum::http::{HeaderMap, Method, StatusCode};
use axum::response::sse::{Event, KeepAlive};
use axum::response::{IntoResponse, Response, Sse};
use socket2::SockRef;
use tokio::sync::oneshot;
use tokio::time::timeout;
use tokio_stream::StreamExt;
use tokio_stream::wrappers::WatchStream;

use super::command::{Command, said};
use super::files;
use super::guard::{Asked, Guard, Token};
use super::hub::{Hub, Shown};
use crate::live::Controls;

/// Tabs that may look at the same time: each costs a buffer of some 400 kB at most.
const MOST_TABS: usize = 16;

/// Bytes that the system takes ahead of a tab that is slow. Left to itself it takes megabytes, and who looks
/// over a slow line sees what was minutes ago; a fast one has this much for a round trip.
const AHEAD: usize = 128 * 1024;

/// How long the last state may take to reach the tabs: those of a busy machine take their time, and one that takes
/// nothing any more holds up the end for no longer.
const LAST: Duration = Duration::from_secs(3);

/// How often it is looked whether they have it.
const AGAIN: Duration = Duration::from_millis(50);

/// A server that runs until it is dropped.
pub struct Server {
    url: String,
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

struct Site {
    guard: Guard,
    hub: Arc<Hub>,
    controls: Controls,
}

impl Server {
    /// Serves what `hub` has at `listener`.
    ///
    /// # Errors
    /// If the system gives no thread, or no randomness for a token.
    pub fn start(listener: TcpListener, hub: Arc<Hub>, controls: Controls) -> io::Result<Self> {
        listener.set_nonblocking(true)?;
        // Connections have what their listener has.
        SockRef::from(&listener).set_send_buffer_size(AHEAD)?;
        let address = listener.local_addr()?;
        let token = Token::random().map_err(io::Error::other)?;
        let url = format!("http://{address}/{token}/");
        let site = Arc::new(Site {
            guard: Guard::new(token, address),
            hub,
            controls,
        });
        let (end, ended) = oneshot::channel();
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = thread::spawn(move || {
            runtime.block_on(serve(listener, site, ended));
            // Tabs that take nothing any more hold up nobody.
            runtime.shutdown_background();
        });
        Ok(Self {
            url,
            end: Some(end),
            thread: Some(thread),
        })
    }

    /// The address for the browser, with its token.
    pub fn url(&self) -> &str {
        &self.url
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(end) = self.end.take() {
            let _ = end.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

async fn serve(listener: TcpListener, site: Arc<Site>, ended: oneshot::Receiver<()>) {
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
        return;
    };
    let hub = Arc::clone(&site.hub);
    let router = Router::new().fallback(answer).with_state(site);
    let server = axum::serve(listener, router).into_future();
    tokio::select! {
        _ = server => {}
        _ = ended => {
            let told = async {
                // A tab that has been told leaves when it is told again.
                while hub.tabs() > 0 {
                    hub.end();
                    tokio::time::sleep(AGAIN).await;
                }
            };
            let _ = timeout(LAST, told).await;
        }
    }
}

/// The answer to any request.
async fn answer(State(site): State<Arc<Site>>, request: Request) -> Response {
    let (head, body) = request.into_parts();
    let asked = asked(head.uri.path(), &head.headers);
    let what = match site.guard.admit(&asked) {
        Ok(what) => what,
        Err(refused) => return said(StatusCode::FORBIDDEN, refused.to_string()),
    };
    let command = Command::at(what);
    let is_shown = what == "/events" || files::find(what).is_some();
    match (head.method, command) {
        (Method::POST, Some(command)) => command.carry_out(&site.controls.desk, body).await,
        (Method::GET, None) if what == "/events" => events(&site.hub),
        (Method::GET, None) if is_shown => files::answer(what),
        (_, Some(_)) => ([(ALLOW, "POST")], StatusCode::METHOD_NOT_ALLOWED).into_response(),
        (_, None) if is_shown => ([(ALLOW, "GET")], StatusCode::METHOD_NOT_ALLOWED).into_response(),
        _ => said(
            StatusCode::NOT_FOUND,
            "there is no such thing here".to_owned(),
        ),
    }
}

fn asked<'a>(path: &'a str, headers: &'a HeaderMap) -> Asked<'a> {
    // What is no text is no name of ours either.
    let text = |name| {
        let value = headers.get::<axum::http::HeaderName>(name);
        value.map(|value| value.to_str().unwrap_or("?"))
    };
    Asked {
        path,
        host: text(HOST),
        origin: text(ORIGIN),
        site: text(axum::http::HeaderName::from_static("sec-fetch-site")),
    }
}

/// The parts of the page as they change.
fn events(hub: &Hub) -> Response {
    if hub.tabs() >= MOST_TABS {
        let words = format!("{MOST_TABS} tabs look at this recording already: close one");
        return said(StatusCode::SERVICE_UNAVAILABLE, words);
    }
    let mut seen = 0;
    let mut told = false;
    let states = WatchStream::new(hub.follow());
    let states = states.take_while(move |shown| !std::mem::replace(&mut told, shown.ended));
    let events = states.map(move |shown| Ok::<_, Infallible>(event(&shown, &mut seen)));
    Sse::new(events)
        .keep_alive(KeepAlive::default())
        .into_response()
}

fn event(shown: &Shown, seen: &mut u64) -> Event {
    let parts = shown.since(seen);
    let parts: Vec<[&str; 2]> = parts.iter().map(|part| [&*part.id, &*part.html]).collect();
    let name = if shown.ended { "end" } else { "parts" };
    // Lists of texts are JSON in any case.
    let text = serde_json::to_string(&parts).unwrap_or_default();
    Event::default().event(name).data(text)
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Write};
    use std::net::TcpStream;

    use super::*;
    use crate::live::Desk;
    use crate::source::board::Stop;

    /// Bytes of a state, as of a page with three axes.
    const STATE: usize = 100_000;

    /// States that come while a tab does not read: 20 MB.
    const STATES: usize = 200;

    /// What hyper writes ahead (400 kB), what the system takes at both ends, and the newest state.
    const MOST: usize = 1_500_000;

    #[test]
    fn a_tab_that_reads_late_has_little_that_is_old_and_the_newest() {
        let hub = Arc::new(Hub::default());
        let controls = Controls {
            desk: Desk::new(Stop::default()),
            interrupt: Arc::new(|| {}),
        };
        let listener = TcpListener::bind("127.0.0.1:0").expect("an address");
        let server = Server::start(listener, Arc::clone(&hub), controls).expect("a server");
        let address = server.url().strip_prefix("http://").expect("an address");
        let (host, path) = address.split_once('/').expect("a path");
        let mut tab = TcpStream::connect(host).expect("it listens");
        let request = format!("GET /{path}events HTTP/1.1\r\nHost: {host}\r\n\r\n");
        tab.write_all(request.as_bytes()).expect("it hears");
        while hub.tabs() == 0 {
            thread::sleep(AGAIN);
        }
        let state = |number: usize| format!("{number}:{}", "x".repeat(STATE));
        for number in 0..STATES {
            hub.put([("allan".to_owned(), state(number))]);
            thread::sleep(Duration::from_millis(5));
        }
        let ending = thread::spawn(move || drop(server));
        let mut all = String::new();
        tab.read_to_string(&mut all).expect("text");
        ending.join().expect("it ends");
        assert!(all.contains(&state(STATES - 1)), "the newest is missing");
        assert!(all.len() < MOST, "{} bytes of old states", all.len());
    }
}
