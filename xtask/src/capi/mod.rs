//! The C interface: header, archives, panics, the example on host and target against Rust, what the
//! edge costs.

mod archive;
mod example;
mod release;
mod tools;

use std::fmt::Write;
use std::time::Duration;

use crate::process::{Done, M4F, root, run};

pub(crate) use archive::Archive;

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Write the header that cbindgen makes now, instead of comparing.
    #[arg(long)]
    write: bool,
    /// Build the archives of every core, with header and table, into target/capi-release.
    #[arg(long, conflicts_with = "write")]
    release: bool,
    /// Only the instructions of a call over the edge and in Rust.
    #[arg(long, conflicts_with_all = ["write", "release"])]
    edge: bool,
    /// Only bytes of objects, code and archives of every core, as `--release` builds them.
    #[arg(long, conflicts_with_all = ["write", "release", "edge"])]
    sizes: bool,
    /// Only the stack of a call, of the fastest and of the smallest code.
    #[arg(long, conflicts_with_all = ["write", "release", "edge", "sizes"])]
    stack: bool,
}

/// Does it and gives what documents quote.
pub(crate) fn task(options: &Options) -> Result<String, String> {
    if options.write {
        tools::cbindgen()?;
        return header(true).map(|()| String::new());
    }
    if options.edge {
        return edge();
    }
    if options.stack {
        return stack();
    }
    if options.release || options.sizes {
        return release::run();
    }
    tools::all()?;
    header(false)?;
    let mut text = String::new();
    for (archive, name) in [(Archive::M4F_FAST, "-O3"), (Archive::M4F_SMALL, "-Os")] {
        archive.build()?;
        let functions = archive.without_panics()?;
        let _ = writeln!(text, "{name}: {functions} functions, none reaches a panic");
    }
    text += &example::run_all()?;
    text += &edge()?;
    Ok(text)
}

/// The header is what cbindgen makes of the sources.
fn header(write: bool) -> Done {
    let kept = root().join("capi/include/trendid.h");
    let made = crate::process::target_directory()?.join("trendid.h");
    let mut command = tools::command(tools::CBINDGEN)?;
    command
        .current_dir(root().join("capi"))
        .args([
            "--quiet",
            "--config",
            "cbindgen.toml",
            "--crate",
            "trendid-capi",
            "--output",
        ])
        .arg(if write { &kept } else { &made });
    run(command)?;
    let read = |path: &std::path::Path| {
        std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
    };
    if write || read(&kept)? == read(&made)? {
        Ok(())
    } else {
        Err("capi/include/trendid.h is not what cbindgen makes of the sources; `cargo xtask capi --write` renews it".into())
    }
}

/// More instructions than this factor of those in Rust fail.
const EDGE: f64 = 1.05;

/// The lines of the image that counts, with as many fields as `N`; comments and other lines are
/// left out.
fn counted<const N: usize>(profile: &str) -> Result<Vec<[String; N]>, String> {
    let image = M4F.build_of("trendid-capi", "edge", profile)?;
    let lines = M4F.lines(&image, Duration::from_secs(300))?;
    let rows = lines.iter().filter(|line| !line.starts_with('#'));
    let fields = rows.map(|line| line.split(';').map(str::to_owned).collect::<Vec<_>>());
    let rows: Vec<_> = fields.filter_map(|row| row.try_into().ok()).collect();
    if rows.is_empty() {
        Err(format!("no line of {N} fields: {}", lines.join("\n")))
    } else {
        Ok(rows)
    }
}

/// Instructions of a call in Rust and over the edge, counted in one image.
fn edge() -> Result<String, String> {
    let mut text = String::from(
        "| call | Rust, mean | C, mean | ratio | Rust, worst | C, worst |\n|---|---|---|---|---|---|\n",
    );
    let mut faults = String::new();
    for [name, rust, rust_worst, c, c_worst] in counted("firmware")? {
        let number = |field: &str| {
            field
                .parse::<f64>()
                .map_err(|_| format!("{name}: {field} is no number"))
        };
        let ratio = number(&c)? / number(&rust)?;
        let _ = writeln!(
            text,
            "| {name} | {rust} | {c} | {ratio:.3} | {rust_worst} | {c_worst} |"
        );
        // NaN fails, too.
        if !(ratio <= EDGE) {
            let _ = writeln!(
                faults,
                "{name}: {ratio:.3} times the instructions of Rust, at most {EDGE}"
            );
        }
    }
    if faults.is_empty() {
        Ok(text)
    } else {
        Err(format!("{text}{faults}"))
    }
}

/// Stack of a call below its caller, from the painted stack of one run of each image.
fn stack() -> Result<String, String> {
    let mut text = String::from("| call | -O3 [B] | -Os [B] |\n|---|---|---|\n");
    let [fast, small] = [counted("firmware")?, counted("firmware-size")?];
    for ([name, fast], [other, small]) in fast.iter().zip(&small) {
        if name != other {
            return Err(format!("{name} and {other} are not the same call"));
        }
        let _ = writeln!(text, "| {name} | {fast} | {small} |");
    }
    Ok(text)
}
