//! The log of a firmware image as text: `trendid-log IMAGE < STREAM` prints one line per message.
//!
//! A program of its own, which only `cargo xtask firmware` builds.

use std::io::Read;
use std::path::Path;
use std::process::ExitCode;

use defmt_decoder::{DecodeError, Table};

/// The lines that `image` logged as `stream`.
fn lines(image: &Path, stream: &[u8]) -> Result<Vec<String>, String> {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", image.display());
    let bytes = std::fs::read(image).map_err(|error| named(&error))?;
    let table = Table::parse(&bytes)
        .map_err(|error| named(&error))?
        .ok_or_else(|| named(&"the image has no log"))?;
    let mut decoder = table.new_stream_decoder();
    decoder.received(stream);
    let mut lines = Vec::new();
    loop {
        match decoder.decode() {
            Ok(frame) => {
                let level = frame
                    .level()
                    .map_or("", |level| level.as_str())
                    .to_uppercase();
                lines.push(format!("{level:5} {}", frame.display_message()));
            }
            Err(DecodeError::UnexpectedEof) => return Ok(lines),
            Err(DecodeError::Malformed) => return Err(named(&"a frame of the log is damaged")),
        }
    }
}

fn decode() -> Result<Vec<String>, String> {
    let image = std::env::args_os()
        .nth(1)
        .ok_or("usage: trendid-log IMAGE < STREAM")?;
    let mut stream = Vec::new();
    std::io::stdin()
        .read_to_end(&mut stream)
        .map_err(|error| format!("standard input: {error}"))?;
    lines(Path::new(&image), &stream)
}

fn main() -> ExitCode {
    match decode() {
        Ok(lines) => {
            for line in lines {
                println!("{line}");
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
