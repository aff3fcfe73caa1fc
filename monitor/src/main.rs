//! A live page of a servo loop: telemetry over the wire of `trendid-link`, a button for every
//! request, records.
//!
//! ```text
//! source (thread) -- bytes of the wire --> hub -- JSON --> pages
//! simulated axis, port, record              `--> record, UDP
//! ```
#![allow(missing_docs)] // a program: its documentation is `--help`

mod args;
mod claimed;
mod hub;
#[cfg(feature = "mcap")]
mod mcap;
mod outputs;
mod record;
mod server;
mod source;

use std::io::{ErrorKind, Write};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize};
use std::time::Duration;

use clap::Parser;
use tokio::net::TcpListener;
use tokio::sync::mpsc::channel;

use crate::args::Args;
use crate::hub::Hub;
use crate::server::{Server, router};

/// Messages of all pages that wait for the hub.
const WAITING: usize = 256;

fn main() -> ExitCode {
    let args = Args::parse();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let done = match runtime {
        Ok(runtime) => runtime.block_on(run(args)),
        Err(error) => Err(error.to_string()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(sentence) => {
            eprintln!("error: {sentence}");
            ExitCode::from(2)
        }
    }
}

async fn run(args: Args) -> Result<(), String> {
    let wanted = args.address();
    let listener = TcpListener::bind(wanted)
        .await
        .map_err(|error| format!("{wanted}: {error} (choose another port with --http)"))?;
    let address = listener.local_addr().map_err(|error| error.to_string())?;
    let token = match &args.token {
        Some(token) => token.clone(),
        None => random_token()?,
    };
    if !address.ip().is_loopback() {
        eprintln!(
            "warning: {address} is open to other computers, without encryption: who reads the token on the way can move the axis"
        );
    }
    let (to_hub, from_pages) = channel(WAITING);
    let hub = Hub::new(&args)?;
    let server = Arc::new(Server {
        token: token.clone(),
        address,
        out: args.out.clone(),
        hub: to_hub,
        next: AtomicU64::new(1),
        open: AtomicUsize::new(0),
    });
    print(&format!("http://{address}/?token={token}\n"))?;
    let serving = tokio::spawn(async move { axum::serve(listener, router(server)).await });
    let end = args.seconds.map(Duration::from_secs_f64);
    let summary = hub.run(from_pages, end).await;
    serving.abort();
    print(&summary.text())?;
    summary.check(args.seconds)
}

/// Writes to standard output; a reader that has gone away is no error.
fn print(text: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(format!("cannot write to standard output: {error}"))
        }
        _ => Ok(()),
    }
}

fn random_token() -> Result<String, String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(|error| format!("no random numbers: {error}"))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}
