//! Programs of the Rust ecosystem that a task needs, installed when they are missing.

use std::process::Command;

use crate::process::{self, Done, works};

/// A subcommand of cargo: its name, and the package it comes from.
pub(crate) struct Tool {
    /// The word after `cargo`.
    pub subcommand: &'static str,
    /// The package on crates.io.
    pub package: &'static str,
}

impl Tool {
    /// A subcommand whose package is called `cargo-..`.
    pub(crate) const fn named(subcommand: &'static str, package: &'static str) -> Self {
        Self {
            subcommand,
            package,
        }
    }

    /// Installs it where it is missing; minutes of building.
    pub(crate) fn install(&self) -> Done {
        if works(&format!("cargo-{}", self.subcommand), &["--version"])
            || works("cargo", &[self.subcommand, "--version"])
        {
            return Ok(());
        }
        let mut command = Command::new("cargo");
        // Without the toolchain of this task: programs are built with the default one, in their own
        // directory.
        command
            .args(["install", "--locked", "--quiet", self.package])
            .env_remove("RUSTFLAGS")
            .env_remove("CARGO_TARGET_DIR");
        process::run(command)
    }
}

/// Adds components of rustup to a toolchain, where they are missing.
pub(crate) fn components(toolchain: Option<&str>, names: &[&str]) -> Done {
    let mut command = Command::new("rustup");
    command.args(["component", "add"]);
    if let Some(toolchain) = toolchain {
        command.args(["--toolchain", toolchain]);
    }
    command.args(names);
    process::run(command)
}
