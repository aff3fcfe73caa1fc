//! The playground as static files: three WebAssembly modules, one page with everything that its
//! first paint needs.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::process::{self, Done, cargo, root, target_directory};
use crate::setup::add_targets;

/// Target of the modules.
const TARGET: &str = "wasm32-unknown-unknown";

/// Largest page in bytes, compressed.
const LARGEST: usize = 150_000;

/// Builds; gives the sizes.
pub(crate) fn run() -> Result<String, String> {
    let place = build()?;
    let mut text = format!("{:16} {:>9} {:>9}\n", "file", "bytes", "gzip -9");
    let mut page = 0;
    for name in ["index.html", "loop.js", "record.js", "identify.js"] {
        let bytes = read(&place.join(name))?;
        let small = compressed(bytes.as_bytes())?;
        text += &format!("{name:16} {:9} {small:9}\n", bytes.len());
        if name == "index.html" {
            page = small;
        }
    }
    if page > LARGEST {
        return Err(format!(
            "the page has more than {LARGEST} bytes compressed:\n{text}"
        ));
    }
    Ok(text)
}

/// Builds the playground; gives its folder.
pub(crate) fn build() -> Result<PathBuf, String> {
    add_targets(&[TARGET])?;
    // Libraries of C for the browser alone: as such they do not link on a host with the log of the
    // firmware.
    for package in ["trendid-web", "trendid-web-loop", "trendid-web-identify"] {
        process::run(cargo(&[
            "rustc",
            "-q",
            "--lib",
            "--crate-type",
            "cdylib",
            "--profile",
            "web",
            "--target",
            TARGET,
            "-p",
            package,
        ]))?;
    }
    let target = target_directory()?;
    let module = |name: &str| -> Result<String, String> {
        let path = module(&target, name);
        let bytes = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(STANDARD.encode(gzip(&bytes)?))
    };
    let page = root().join("web/page");
    let shared = root().join("monitor/page");
    let scripts = [
        read(&shared.join("uplot/uPlot.iife.min.js"))?,
        without_comments(&read(&shared.join("plots.js"))?),
        without_comments(&read(&page.join("play.js"))?),
        format!(
            "\"use strict\";const CORE=\"{}\";start();",
            module("trendid_web")?
        ),
    ];
    let scripts: String = scripts
        .iter()
        .map(|script| format!("<script>{script}</script>\n"))
        .collect();
    let styles = read(&shared.join("uplot/uPlot.min.css"))? + &read(&page.join("style.css"))?;
    let html = read(&page.join("index.html"))?
        .replace("<!-- style -->", &format!("<style>{styles}</style>"))
        .replace("<!-- scripts -->", &scripts);
    let place = target.join("web-page");
    fs::create_dir_all(&place).map_err(|error| format!("{}: {error}", place.display()))?;
    write(&place.join("index.html"), &html)?;
    let part = without_comments(&read(&page.join("loop.js"))?);
    let axis = module("trendid_web_loop")?;
    write(
        &place.join("loop.js"),
        &format!("{part}const LOOP=\"{axis}\";"),
    )?;
    let record = without_comments(&read(&page.join("record.js"))?);
    write(&place.join("record.js"), &record)?;
    let identify = format!("window.IDENTIFY=\"{}\";", module("trendid_web_identify")?);
    write(&place.join("identify.js"), &identify)?;
    write(
        &place.join("LICENSE-uPlot"),
        &read(&shared.join("uplot/LICENSE"))?,
    )?;
    Ok(place)
}

/// Where a module lies that was built.
pub(crate) fn module(target: &Path, name: &str) -> PathBuf {
    target.join(TARGET).join("web").join(format!("{name}.wasm"))
}

/// A script of ours without the lines that are comments.
fn without_comments(script: &str) -> String {
    let code = |line: &&str| {
        let line = line.trim_start();
        !(line.starts_with("//") || line.starts_with("/**"))
    };
    let lines = script.lines().filter(code);
    lines.flat_map(|line| [line.trim_start(), "\n"]).collect()
}

/// Bytes after gzip, as a server would send them.
fn compressed(bytes: &[u8]) -> Result<usize, String> {
    gzip(bytes).map(|bytes| bytes.len())
}

fn gzip(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let failed = |error: std::io::Error| format!("gzip: {error}");
    let mut gzip = Command::new("gzip")
        .args(["-9", "-n", "-c"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(failed)?;
    let mut input = gzip.stdin.take().ok_or("gzip takes nothing")?;
    let bytes = bytes.to_vec();
    let feed = std::thread::spawn(move || input.write_all(&bytes));
    let output = gzip.wait_with_output().map_err(failed)?;
    feed.join()
        .map_err(|_| "gzip takes nothing")?
        .map_err(failed)?;
    Ok(output.stdout)
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn write(path: &Path, text: &str) -> Done {
    fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}
