//! The page and its socket: who may have them.
//!
//! | request | needs |
//! |---|---|
//! | script, style, plot library | nothing: they hold no secret |
//! | page, report, record | the token |
//! | socket | the token, and an Origin that is this server |
//!
//! A Host that is not this server is refused everywhere, so that a name which another page points
//! at this computer gains nothing.

mod access;

use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Path, Query, Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use tokio::sync::mpsc::channel;
use tokio::sync::oneshot;

use crate::hub::FromPage;
pub(crate) use access::Server;

/// Longest message of a page in bytes.
const LONGEST: usize = 4096;

/// Messages that wait for a page: some two seconds.
const WAITING: usize = 128;

/// Pages at once.
const PAGES: usize = 16;

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
            get(|| file("text/javascript", include_str!("../../page/app.js"))),
        )
        .route(
            "/plots.js",
            get(|| file("text/javascript", include_str!("../../page/plots.js"))),
        )
        .route(
            "/style.css",
            get(|| file("text/css", include_str!("../../page/style.css"))),
        )
        .route(
            "/uplot.js",
            get(|| {
                file(
                    "text/javascript",
                    include_str!("../../page/uplot/uPlot.iife.min.js"),
                )
            }),
        )
        .route(
            "/uplot.css",
            get(|| file("text/css", include_str!("../../page/uplot/uPlot.min.css"))),
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

/// The answer to a wrong token.
fn stranger() -> Response {
    let words = "The token of the address is missing or wrong: open the address that the monitor has printed.";
    (StatusCode::FORBIDDEN, words).into_response()
}

async fn page(State(server): State<Arc<Server>>, Query(query): Query<Token>) -> Response {
    if !server.knows(&query.token) {
        return stranger();
    }
    Html(include_str!("../../page/index.html")).into_response()
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
