//! The Python package: a wheel, tests of it in a fresh environment, types, and the page that is
//! executed.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::process::{self, Done, cargo, root, target_directory, works};

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Write what the blocks of docs/python.md print and draw now, instead of comparing.
    #[arg(long)]
    write: bool,
}

/// An environment of Python.
struct Environment(PathBuf);

impl Environment {
    /// A new one in place of an old one.
    fn fresh(directory: PathBuf) -> Result<Self, String> {
        if directory.exists() {
            fs::remove_dir_all(&directory).map_err(|error| error.to_string())?;
        }
        let mut command = Command::new("python3");
        command.args(["-m", "venv"]).arg(&directory);
        process::run(command)?;
        Ok(Self(directory))
    }

    /// A program of it.
    fn command(&self, program: &str) -> Command {
        let folder = if cfg!(windows) { "Scripts" } else { "bin" };
        Command::new(self.0.join(folder).join(program))
    }

    /// Installs packages.
    fn install(&self, packages: &[impl AsRef<OsStr>]) -> Done {
        let mut command = self.command("python");
        command.args(["-m", "pip", "install", "-q", "--disable-pip-version-check"]);
        process::run({
            command.args(packages);
            command
        })
    }
}

/// Builds, installs, tests.
pub(crate) fn run(options: &Options) -> Done {
    interpreter()?;
    let package = root().join("python");
    let place = target_directory()?.join("python");
    lint(&package, &place)?;
    let wheel = wheel(&package, &place)?;
    let size = fs::metadata(&wheel)
        .map_err(|error| error.to_string())?
        .len();
    println!("{}: {size} B", wheel.display());

    let environment = Environment::fresh(place.join("environment"))?;
    environment.install(&[format!("{}[test]", wheel.display())])?;
    process::run(cargo(&["build", "-q", "--release", "-p", "trendid-cli"]))?;
    // Away from the sources: what is imported is what was installed.
    let mut tests = environment.command("python");
    tests
        .args(["-m", "pytest", "-q", "-s", "-p", "no:cacheprovider"])
        .arg(package.join("tests"))
        .env("TRENDID", target_directory()?.join("release/trendid"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .current_dir(&place);
    process::run(tests)?;
    let mut types = environment.command("python");
    types
        .args([
            "-m",
            "mypy",
            "--strict",
            "--ignore-missing-imports",
            "-p",
            "trendid",
        ])
        .current_dir(&place);
    process::run(types)?;
    let mut page = environment.command("python");
    page.arg(package.join("tests/page.py"))
        .arg(root().join("docs/python.md"))
        .current_dir(&place);
    if options.write {
        page.arg("--write");
    } else {
        page.arg("--pictures").arg(place.join("pictures"));
    }
    process::run(page)
}

/// An interpreter that can make environments.
fn interpreter() -> Done {
    if works("python3", &["-c", "import venv, ensurepip"]) {
        return Ok(());
    }
    if works("apt-get", &["--version"]) {
        let packages = [
            "install",
            "-y",
            "--no-install-recommends",
            "python3-venv",
            "python3-pip",
        ];
        for arguments in [&["update"][..], &packages] {
            let mut command = Command::new("apt-get");
            command
                .args(arguments)
                .env("DEBIAN_FRONTEND", "noninteractive");
            process::run(command)?;
        }
        return Ok(());
    }
    Err(
        "python3 (3.9 or newer) with venv is missing: install it from https://www.python.org"
            .into(),
    )
}

/// Formatting and lints of the native part. Its lock file may grow by what the packages of the
/// workspace need: not `--locked`.
fn lint(package: &Path, place: &Path) -> Done {
    for arguments in [
        &["fmt", "--check"][..],
        &["clippy", "-q", "--release", "--", "-D", "warnings"],
    ] {
        let mut command = cargo(arguments);
        command.current_dir(package).env("CARGO_TARGET_DIR", place);
        process::run(command)?;
    }
    Ok(())
}

/// Builds the wheel, by maturin in an environment of its own that is kept.
fn wheel(package: &Path, place: &Path) -> Result<PathBuf, String> {
    let tools = Environment(place.join("tools"));
    let works = tools.command("maturin").arg("--version").output().is_ok();
    if !works {
        Environment::fresh(place.join("tools"))?.install(&["maturin>=1.9,<2"])?;
    }
    let wheels = place.join("wheels");
    if wheels.exists() {
        fs::remove_dir_all(&wheels).map_err(|error| error.to_string())?;
    }
    let mut command = tools.command("maturin");
    command
        .args(["build", "-q", "--release", "-o"])
        .arg(&wheels)
        .current_dir(package)
        .env("CARGO_TARGET_DIR", place)
        .env_remove("RUSTFLAGS");
    process::run(command)?;
    let found = fs::read_dir(&wheels).map_err(|error| error.to_string())?;
    let mut wheels = found.filter_map(|entry| Some(entry.ok()?.path()));
    let wheel = wheels.find(|path| path.extension().is_some_and(|end| end == "whl"));
    wheel.ok_or_else(|| "maturin built no wheel".into())
}
