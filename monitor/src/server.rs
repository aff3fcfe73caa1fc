//! The page and its socket: who may have them.
//!
//! | request | needs |
//! |---|---|
//! | script, style, plot library | nothing: they hold no secret |
//! | page, report, record | the token |
//! | socket | the token, and an Origin that is this server |
//!
//! A Host that is not this server is refused everywhere, so that a name which another page points at this computer gains nothing.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use tokio::sync::mpsc::{Sender, channel};
use tokio::sync::oneshot;

use crate::hub::FromPage;

/// Longest message of a page in bytes.
const LONGEST: usize = 4096;

/// Messages that wait for a page: some two seconds.
const WAITING: usize = 128;

/// Pages at once.
const PAGES: usize = 16;

/// What every handler knows.
pub(crate) struct Server {
    pub token: String,
    pub address: SocketAddr,
    pub out: PathBuf,
    pub hub: Sender<FromPage>,
    pub next: AtomicU64,
    pub open: AtomicUsize,
}

/// The token of an address.
#[derive(serde::Deserialize)]
struct Token {
    #[serde(default)]
    token: String,
}

/// The routes.
pub(crate) fn router(server: Arc<Server>) -> Router {
    Router::new()
        .route("/", get(page))
        .route(
            "/app.js",
            get(|| file("text/javascript", include_str!("../page/app.js"))),
        )
        .route(
            "/plots.js",
            get(|| file("text/javascript", include_str!("../page/plots.js"))),
        )
        .route(
            "/style.css",
            get(|| file("text/css", include_str!("../page/style.css"))),
        )
        .route(
            "/uplot.js",
            get(|| {
                file(
                    "text/javascript",
                    include_str!("../page/uplot/uPlot.iife.min.js"),
                )
            }),
        )
        .route(
            "/uplot.css",
            get(|| file("text/css", include_str!("../page/uplot/uPlot.min.css"))),
        )
        .route("/ws", get(socket))
        .route("/report", get(report))
        .route("/record/{name}", get(record))
        .layer(from_fn_with_state(server.clone(), guard))
        .with_state(server)
}

async fn file(kind: &'static str, text: &'static str) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, kind)], text)
}

/// Refuses another host, and says what a browser may do with the answer.
async fn guard(State(server): State<Arc<Server>>, request: Request, next: Next) -> Response {
    if !server.is_host(request.headers()) {
        return (StatusCode::FORBIDDEN, "this host is not served").into_response();
    }
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    for (name, value) in [
        (
            header::CONTENT_SECURITY_POLICY,
            "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; connect-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
        ),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::CACHE_CONTROL, "no-store"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

impl Server {
    /// Whether the token is the right one; the time it takes does not depend on where it differs.
    fn knows(&self, token: &str) -> bool {
        let (ours, theirs) = (self.token.as_bytes(), token.as_bytes());
        let different = ours.iter().zip(theirs).fold(0, |sum, (a, b)| sum | (a ^ b));
        ours.len() == theirs.len() && different == 0
    }

    /// Whether a request names this server as its host.
    fn is_host(&self, headers: &HeaderMap) -> bool {
        let Some(host) = headers
            .get(header::HOST)
            .and_then(|host| host.to_str().ok())
        else {
            return false;
        };
        self.is_ours(host)
    }

    /// Whether `host` is an address of this server: on loopback a number or `localhost`, never another name.
    fn is_ours(&self, host: &str) -> bool {
        let Some((name, port)) = host.rsplit_once(':') else {
            return false;
        };
        let port_fits = port.parse() == Ok(self.address.port());
        let bare = name.trim_start_matches('[').trim_end_matches(']');
        let name_fits = match bare.parse::<IpAddr>() {
            Ok(ip) => ip.is_loopback() || !self.address.ip().is_loopback(),
            Err(_) => bare == "localhost",
        };
        port_fits && name_fits
    }

    /// Whether a page of this server opens the socket.
    fn is_own_page(&self, headers: &HeaderMap) -> bool {
        let origin = headers
            .get(header::ORIGIN)
            .and_then(|origin| origin.to_str().ok());
        let host = headers
            .get(header::HOST)
            .and_then(|host| host.to_str().ok());
        let Some(origin) = origin.and_then(|origin| origin.strip_prefix("http://")) else {
            return false;
        };
        host == Some(origin) && self.is_ours(origin)
    }
}

/// The answer to a wrong token.
fn stranger() -> Response {
    let words = "The token of the address is missing or wrong: open the address that the monitor has printed.";
    (StatusCode::FORBIDDEN, words).into_response()
}

async fn page(State(server): State<Arc<Server>>, Query(query): Query<Token>) -> Response {
    if !server.knows(&query.token) {
        return stranger();
    }
    Html(include_str!("../page/index.html")).into_response()
}

async fn report(State(server): State<Arc<Server>>, Query(query): Query<Token>) -> Response {
    if !server.knows(&query.token) {
        return stranger();
    }
    let (to, from) = oneshot::channel();
    let asked = server.hub.send(FromPage::Report(to)).await;
    match (asked, from.await) {
        (Ok(()), Ok(page)) => Html(page).into_response(),
        _ => StatusCode::SERVICE_UNAVAILABLE.into_response(),
    }
}

/// Whether `name` is one that the monitor gives to records.
fn is_record(name: &str) -> bool {
    let number = name
        .strip_prefix("record-")
        .and_then(|rest| rest.strip_suffix(".csv"));
    number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}

async fn record(
    State(server): State<Arc<Server>>,
    Path(name): Path<String>,
    Query(query): Query<Token>,
) -> Response {
    if !server.knows(&query.token) {
        return stranger();
    }
    if !is_record(&name) {
        return StatusCode::NOT_FOUND.into_response();
    }
    match std::fs::read(server.out.join(&name)) {
        Ok(bytes) => {
            let save = format!("attachment; filename=\"{name}\"");
            let kind = String::from("text/csv; charset=utf-8");
            (
                [
                    (header::CONTENT_TYPE, kind),
                    (header::CONTENT_DISPOSITION, save),
                ],
                bytes,
            )
                .into_response()
        }
        Err(_) => StatusCode::NOT_FOUND.into_response(),
    }
}

async fn socket(
    State(server): State<Arc<Server>>,
    Query(query): Query<Token>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !server.knows(&query.token) || !server.is_own_page(&headers) {
        return stranger();
    }
    if server.open.load(Ordering::Relaxed) >= PAGES {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many pages are open").into_response();
    }
    upgrade
        .max_message_size(LONGEST)
        .max_frame_size(LONGEST)
        .on_upgrade(move |socket| talk(server, socket))
}

/// Carries messages between a page and the hub until one of them ends.
async fn talk(server: Arc<Server>, mut socket: WebSocket) {
    let id = server.next.fetch_add(1, Ordering::Relaxed);
    server.open.fetch_add(1, Ordering::Relaxed);
    let (messages, mut for_page) = channel::<String>(WAITING);
    let mut goes_on = server.hub.send(FromPage::Came(id, messages)).await.is_ok();
    while goes_on {
        goes_on = tokio::select! {
            message = for_page.recv() => match message {
                Some(text) => socket.send(Message::Text(text.into())).await.is_ok(),
                None => false,
            },
            message = socket.recv() => match message {
                Some(Ok(Message::Text(text))) => {
                    let text = text.as_str().to_owned();
                    server.hub.send(FromPage::Message(id, text)).await.is_ok()
                }
                Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Binary(_))) => true,
                Some(Ok(Message::Close(_)) | Err(_)) | None => false,
            },
        };
    }
    server.open.fetch_sub(1, Ordering::Relaxed);
    // The hub ends before its pages only at the end of the program.
    let _ = server.hub.send(FromPage::Gone(id)).await;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn server(ip: [u8; 4]) -> Server {
        Server {
            token: "abcdefgh12345678".into(),
            address: (ip, 8765).into(),
            out: PathBuf::new(),
            hub: channel(1).0,
            next: AtomicU64::new(0),
            open: AtomicUsize::new(0),
        }
    }

    fn headers(host: &str, origin: &str) -> HeaderMap {
        let mut headers = HeaderMap::new();
        headers.insert(header::HOST, host.parse().unwrap());
        headers.insert(header::ORIGIN, origin.parse().unwrap());
        headers
    }

    #[test]
    fn only_pages_of_this_server_open_the_socket() {
        let server = server([127, 0, 0, 1]);
        for host in ["127.0.0.1:8765", "localhost:8765", "[::1]:8765"] {
            assert!(
                server.is_own_page(&headers(host, &format!("http://{host}"))),
                "{host}"
            );
        }
        for (host, origin) in [
            ("127.0.0.1:8765", "http://evil.example"),
            ("127.0.0.1:8765", "http://127.0.0.1:8766"),
            ("127.0.0.1:8765", "https://127.0.0.1:8765"),
            ("127.0.0.1:8765", "null"),
            ("evil.example:8765", "http://evil.example:8765"),
            (
                "127.0.0.1.evil.example:8765",
                "http://127.0.0.1.evil.example:8765",
            ),
            ("192.168.1.2:8765", "http://192.168.1.2:8765"),
        ] {
            assert!(
                !server.is_own_page(&headers(host, origin)),
                "{host} {origin}"
            );
        }
        let mut none = headers("127.0.0.1:8765", "x");
        none.remove(header::ORIGIN);
        assert!(!server.is_own_page(&none) && server.is_host(&none));
        assert!(!server.is_host(&HeaderMap::new()));
        // Asked to listen, it is reached by its number.
        let open = self::server([0, 0, 0, 0]);
        assert!(open.is_own_page(&headers("192.168.1.2:8765", "http://192.168.1.2:8765")));
        assert!(!open.is_own_page(&headers("evil.example:8765", "http://evil.example:8765")));
    }

    #[test]
    fn one_token_fits() {
        let server = server([127, 0, 0, 1]);
        assert!(server.knows("abcdefgh12345678"));
        for wrong in [
            "",
            "abcdefgh1234567",
            "abcdefgh123456789",
            "abcdefgh12345679",
        ] {
            assert!(!server.knows(wrong), "{wrong}");
        }
    }

    #[test]
    fn nothing_but_records_is_given_out() {
        assert!(is_record("record-1732.csv"));
        for wrong in [
            "record-.csv",
            "../record-1.csv",
            "record-1/../x.csv",
            "report.html",
            "record-1.csv.bak",
        ] {
            assert!(!is_record(wrong), "{wrong}");
        }
    }
}
