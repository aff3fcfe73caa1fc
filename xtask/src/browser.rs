//! Both pages in a headless browser, used as their users would, and the firmware in the emulator
//! behind one of them; pictures go to `target/browser`.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::process::{self, Done, M4F, cargo, root, target_directory, works};
use crate::{setup, web};

/// Seed of the simulated axis.
const SEED: &str = "200017";

/// Names under which systems have the browser.
const BROWSERS: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// Installs what is missing, builds both pages and drives them.
pub(crate) fn run() -> Done {
    let chromium = chromium()?;
    let out = target_directory()?.join("browser");
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let scripts = scripts(&out)?;
    process::run(cargo(&[
        "build",
        "-q",
        "-p",
        "trendid-monitor",
        "-p",
        "trendid-cli",
    ]))?;
    setup::run()?;
    let image = M4F.build("servo", "firmware")?;
    let page = web::build()?;
    let target = target_directory()?;
    let bin = target.join("debug");
    for script in ["monitor.mjs", "valve.mjs", "emulator.mjs", "playground.mjs"] {
        let mut command = Command::new("node");
        command
            .arg(scripts.join(script))
            .env("CHROMIUM", &chromium)
            .env("OUT", &out)
            .env("AXE", scripts.join("node_modules/axe-core/axe.min.js"))
            .env("MONITOR", bin.join("trendid-monitor"))
            .env("TRENDID", bin.join("trendid"))
            .env("SEED", SEED)
            .env("IMAGE", &image)
            .env("WEB", &page)
            .env("CORE", web::module(&target, "trendid_web"))
            .env("RECORD", root().join("examples/data/servo.csv"));
        process::run(command)?;
    }
    println!("pictures: {}", out.display());
    Ok(())
}

/// The scripts beside the packages that they need.
pub(crate) fn scripts(out: &std::path::Path) -> Result<PathBuf, String> {
    let place = out.join("node");
    fs::create_dir_all(&place).map_err(|error| format!("{}: {error}", place.display()))?;
    let from = root().join("xtask/browser");
    for name in [
        "package.json",
        "common.mjs",
        "session.mjs",
        "monitor.mjs",
        "emulator.mjs",
        "playground.mjs",
        "valve.mjs",
        "watch.mjs",
    ] {
        let (from, to) = (from.join(name), place.join(name));
        fs::copy(&from, &to).map_err(|error| format!("{}: {error}", from.display()))?;
    }
    if !works("node", &["--version"]) {
        return Err("node is missing: install Node.js 20 or newer".into());
    }
    if !place.join("node_modules/axe-core/axe.min.js").exists()
        || !place.join("node_modules/puppeteer-core").exists()
    {
        let mut command = Command::new("npm");
        command.current_dir(&place).args([
            "install",
            "--no-audit",
            "--no-fund",
            "--no-package-lock",
            "--loglevel=error",
        ]);
        process::run(command)?;
    }
    Ok(place)
}

/// The browser; installed where that is possible.
pub(crate) fn chromium() -> Result<PathBuf, String> {
    let find = || {
        let paths = std::env::var_os("PATH")?;
        BROWSERS.iter().find_map(|name| {
            std::env::split_paths(&paths)
                .map(|folder| folder.join(name))
                .find(|path| path.is_file())
        })
    };
    if let Some(path) = find() {
        return Ok(path);
    }
    setup::apt(&["chromium"])?;
    find().ok_or_else(|| "no Chromium is installed, and apt cannot install it".into())
}
