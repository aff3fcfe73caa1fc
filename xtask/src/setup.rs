//! What a fresh machine lacks.

use std::path::Path;
use std::process::Command;

use crate::process::{self, Done, M0, M3, M4F, works};

/// Adds what is missing, or says what to install.
pub(crate) fn run() -> Done {
    targets()?;
    emulator()
}

/// Compilation targets and the components that the lints need.
fn targets() -> Done {
    let wanted = [M4F, M3, M0].map(|machine| machine.target);
    add_targets(&wanted)?;
    for (component, program) in [("rustfmt", "cargo-fmt"), ("clippy", "cargo-clippy")] {
        if !works(program, &["--version"]) {
            let mut command = Command::new("rustup");
            command.args(["component", "add", component]);
            process::run(command)?;
        }
    }
    eprintln!("targets: {}", wanted.join(" "));
    Ok(())
}

/// The libraries of these targets, where they are missing.
pub(crate) fn add_targets(wanted: &[&str]) -> Done {
    let Some(sysroot) = output("rustc", &["--print", "sysroot"]) else {
        return Err("rustc is missing: install Rust from https://rustup.rs".into());
    };
    let library = Path::new(sysroot.trim()).join("lib/rustlib");
    let missing: Vec<&str> = wanted
        .iter()
        .copied()
        .filter(|target| !library.join(target).join("lib").exists())
        .collect();
    if !missing.is_empty() {
        if !works("rustup", &["--version"]) {
            return Err(format!(
                "rustup is missing; install the libraries of these targets: {}",
                missing.join(" ")
            ));
        }
        let mut command = Command::new("rustup");
        command.args(["target", "add"]).args(&missing);
        process::run(command)?;
    }
    Ok(())
}

/// The emulator; 7.2 is what the figures were counted with.
fn emulator() -> Done {
    if !works("qemu-system-arm", &["--version"]) {
        if !can_apt() {
            let apt = works("apt-get", &["--version"]);
            return Err(format!(
                "qemu-system-arm (7.2 or later) is missing; install it with\n    {}\nand run this again",
                if apt {
                    "sudo apt-get update && sudo apt-get install -y qemu-system-arm"
                } else if cfg!(target_os = "macos") {
                    "brew install qemu"
                } else {
                    "the package manager of this system, package qemu-system-arm, or from https://www.qemu.org/download"
                }
            ));
        }
        apt(&["qemu-system-arm"])?;
    }
    let version =
        output("qemu-system-arm", &["--version"]).ok_or("qemu-system-arm does not start")?;
    eprintln!("{}", version.lines().next().unwrap_or_default());
    Ok(())
}

/// Whether packages can be installed without a password.
fn can_apt() -> bool {
    let root = output("id", &["-u"]).is_some_and(|id| id.trim() == "0");
    root && works("apt-get", &["--version"])
}

/// Installs packages of Debian, or says which.
pub(crate) fn apt(packages: &[&str]) -> Done {
    if packages.is_empty() {
        return Ok(());
    }
    if !can_apt() {
        let names = packages.join(" ");
        return Err(format!(
            "these packages are missing (names of Debian): {names}; install them, e.g. with\n    sudo apt-get install -y {names}\nand run this again"
        ));
    }
    let install = [&["install", "-y", "--no-install-recommends"][..], packages].concat();
    for arguments in [&["update"][..], &install] {
        let mut command = Command::new("apt-get");
        command
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive");
        process::run(command)?;
    }
    Ok(())
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}
