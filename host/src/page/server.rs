//! The server of the page: a thread of its own, which no recording waits for.

use std::convert::Infallible;
use std::io;
use std::net::TcpListener;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::header::{
    ALLOW, CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, ORIGIN, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, Method, StatusCode};
use axum::response::sse::{Event, KeepAlive};
use axum::response::{IntoResponse, Response, Sse};
use tokio::sync::oneshot;
use tokio::time::timeout;
use tokio_stream::StreamExt;
use tokio_stream::wrappers::WatchStream;

use super::files;
use super::guard::{Asked, Guard, Token};
use super::hub::{Hub, Shown};
use super::wanted;
use crate::live::{Controls, Declined, Desk};

/// Tabs that may look at the same time: each costs a buffer of some 400 kB at most.
const MOST_TABS: usize = 16;

/// Longest body of a command, bytes: a note of a mark is 120.
const MOST_BODY: usize = 1024;

/// How long a command may take to arrive.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long the last state may take to reach the tabs: those of a busy machine take their time, and one that takes
/// nothing any more holds up the end for no longer.
const LAST: Duration = Duration::from_secs(3);

/// How often it is looked whether they have it.
const AGAIN: Duration = Duration::from_millis(50);

/// What the page may load: what is its own, and nothing from elsewhere.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
                      img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

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
        (Method::POST, Some(command)) => carry_out(&site.controls.desk, command, body).await,
        (Method::GET, None) if what == "/events" => events(&site.hub),
        (Method::GET, None) if is_shown => file(what),
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

fn file(what: &str) -> Response {
    let Some((kind, text)) = files::find(what) else {
        return StatusCode::NOT_FOUND.into_response();
    };
    let headers = [
        (CONTENT_TYPE, kind),
        (CONTENT_SECURITY_POLICY, POLICY),
        (CACHE_CONTROL, "no-store"),
        (REFERRER_POLICY, "no-referrer"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    (headers, text).into_response()
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

/// What a tab may ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Command {
    Mark,
    Stop,
    Record,
    Test,
    End,
}

impl Command {
    /// The command at `path`.
    fn at(path: &str) -> Option<Self> {
        Some(match path {
            "/mark" => Self::Mark,
            "/stop" => Self::Stop,
            "/record" => Self::Record,
            "/selftest" => Self::Test,
            "/end" => Self::End,
            _ => return None,
        })
    }
}

/// Carries out a command as far as a tab can: the bench does the rest.
async fn carry_out(desk: &Desk, command: Command, body: Body) -> Response {
    let body = match timeout(PATIENCE, to_bytes(body, MOST_BODY)).await {
        Ok(Ok(body)) => body,
        Ok(Err(_)) => {
            let words = format!("a command has at most {MOST_BODY} bytes");
            return said(StatusCode::PAYLOAD_TOO_LARGE, words);
        }
        Err(_) => return StatusCode::REQUEST_TIMEOUT.into_response(),
    };
    let unfit = |words| said(StatusCode::UNPROCESSABLE_ENTITY, words);
    let done = match command {
        Command::Mark => match std::str::from_utf8(&body) {
            Ok(text) => desk.mark(text),
            Err(_) => return unfit("the note of a mark is UTF-8".to_owned()),
        },
        Command::Record => match wanted::settings(&body) {
            Ok(settings) => desk.record(settings),
            Err(bad) => return unfit(bad.to_string()),
        },
        Command::Stop => desk.stop(),
        Command::Test => desk.test(),
        Command::End => {
            desk.end();
            Ok(())
        }
    };
    match done {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(Declined::Mark(error)) => unfit(error.to_string()),
        Err(declined) => said(StatusCode::CONFLICT, declined.to_string()),
    }
}

fn said(status: StatusCode, words: String) -> Response {
    let headers = [
        (CONTENT_TYPE, "text/plain; charset=utf-8"),
        (CACHE_CONTROL, "no-store"),
    ];
    (status, headers, words + "\n").into_response()
}
