//! The log of an image as text.

use std::path::Path;

use defmt_decoder::{DecodeError, Table};

/// The lines that `image` logged as `stream`.
pub(crate) fn lines(image: &Path, stream: &[u8]) -> Result<Vec<String>, String> {
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
