//! Every package with the oldest compiler that is promised; where that cannot be had, what can be
//! said without it.

use crate::process::{self, Done, cargo, works};

/// The version that `Cargo.toml` promises.
const PROMISED: &str = env!("CARGO_PKG_RUST_VERSION");

/// Options of the task.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Without that compiler: no item of the standard library is newer (clippy), and no dependency
    /// in a lock file asks for a newer one. What is newer in the language itself is not seen.
    #[arg(long)]
    by_lint: bool,
}

/// Checks every package with the promised compiler, or by lint.
pub(crate) fn run(options: &Options) -> Done {
    if options.by_lint {
        return by_lint();
    }
    let toolchain = format!("+{PROMISED}");
    if !works("cargo", &[&toolchain, "--version"]) {
        let mut command = std::process::Command::new("rustup");
        command.args(["toolchain", "install", PROMISED, "--profile", "minimal"]);
        process::run(command).map_err(|error| {
            format!("{error}; where Rust {PROMISED} cannot be had, `cargo xtask msrv --by-lint` checks a part")
        })?;
    }
    let mut command = std::process::Command::new("cargo");
    // Without the variables of the compiler that built this task.
    command
        .current_dir(process::root())
        .args([&toolchain, "check", "--workspace", "--target-dir"])
        .arg(process::target_directory()?.join("msrv"))
        .env_remove("RUSTFLAGS")
        .env_remove("RUSTC")
        .env_remove("RUSTUP_TOOLCHAIN");
    process::run(command)
}

/// The second way.
fn by_lint() -> Done {
    process::run(cargo(&[
        "clippy",
        "-q",
        "--workspace",
        "--exclude",
        "trendid-log",
        "--",
        "-D",
        "clippy::incompatible_msrv",
    ]))?;
    let promised = version(PROMISED).ok_or("the promised version is no version")?;
    let mut newer = Vec::new();
    let mut packages = 0;
    for manifest in [
        "Cargo.toml",
        "examples/rtic/Cargo.toml",
        "examples/embassy/Cargo.toml",
        "python/Cargo.toml",
    ] {
        let output = cargo(&[
            "metadata",
            "--format-version",
            "1",
            "--locked",
            "--manifest-path",
        ])
        .arg(manifest)
        .output()
        .map_err(|error| format!("cargo metadata: {error}"))?;
        let metadata: serde_json::Value = serde_json::from_slice(&output.stdout)
            .map_err(|error| format!("cargo metadata of {manifest}: {error}"))?;
        for package in metadata["packages"].as_array().into_iter().flatten() {
            packages += 1;
            let asked = package["rust_version"].as_str().and_then(version);
            if asked.is_some_and(|asked| asked > promised) {
                newer.push(format!(
                    "{manifest}: {} {} asks for Rust {}",
                    package["name"], package["version"], package["rust_version"]
                ));
            }
        }
    }
    println!(
        "{packages} packages in the lock files, {} ask for more than Rust {PROMISED}",
        newer.len()
    );
    if newer.is_empty() {
        Ok(())
    } else {
        Err(newer.join("\n"))
    }
}

/// `1.88` or `1.88.0` as numbers.
fn version(text: &str) -> Option<(u32, u32)> {
    let mut numbers = text.split('.').map_while(|number| number.parse().ok());
    Some((numbers.next()?, numbers.next()?))
}
