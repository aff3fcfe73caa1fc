//! Who is served: the token, the host that is named, the page that opens a socket.

use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, AtomicUsize};

use axum::http::{HeaderMap, header};
use tokio::sync::mpsc::Sender;

use crate::hub::FromPage;

/// What every handler knows.
pub(crate) struct Server {
    pub token: String,
    pub address: SocketAddr,
    pub out: PathBuf,
    pub hub: Sender<FromPage>,
    pub next: AtomicU64,
    pub open: AtomicUsize,
}

impl Server {
    /// Whether the token is the right one; the time it takes does not depend on where it differs.
    pub(super) fn knows(&self, token: &str) -> bool {
        let (ours, theirs) = (self.token.as_bytes(), token.as_bytes());
        let different = ours.iter().zip(theirs).fold(0, |sum, (a, b)| sum | (a ^ b));
        ours.len() == theirs.len() && different == 0
    }

    /// Whether a request names this server as its host.
    pub(super) fn is_host(&self, headers: &HeaderMap) -> bool {
        let Some(host) = headers
            .get(header::HOST)
            .and_then(|host| host.to_str().ok())
        else {
            return false;
        };
        self.is_ours(host)
    }

    /// Whether `host` is an address of this server: on loopback a number or `localhost`, never
    /// another name.
    pub(super) fn is_ours(&self, host: &str) -> bool {
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
    pub(super) fn is_own_page(&self, headers: &HeaderMap) -> bool {
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

#[cfg(test)]
mod tests {
    use tokio::sync::mpsc::channel;

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
}
