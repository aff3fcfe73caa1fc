//! The log of an image as text, by the decoder in `xtask/log`.

use std::io::Write;
use std::path::Path;
use std::process::Stdio;

use crate::process::cargo;

/// The lines that `image` logged as `stream`.
pub(crate) fn lines(image: &Path, stream: &[u8]) -> Result<Vec<String>, String> {
    let failed = |error: &dyn std::fmt::Display| format!("the decoder of the log: {error}");
    let mut decoder = cargo(&["run", "-q", "--release", "-p", "trendid-log", "--"])
        .arg(image)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| failed(&error))?;
    if let Some(mut input) = decoder.stdin.take() {
        // The decoder reads everything before it writes.
        input.write_all(stream).map_err(|error| failed(&error))?;
    }
    let output = decoder.wait_with_output().map_err(|error| failed(&error))?;
    if !output.status.success() {
        return Err(failed(&output.status));
    }
    let text = String::from_utf8(output.stdout).map_err(|error| failed(&error))?;
    Ok(text.lines().map(str::to_owned).collect())
}
