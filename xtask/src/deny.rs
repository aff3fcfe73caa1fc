//! What the dependencies are: licences, sources, duplicates, advisories; and which of them nobody
//! uses.

use crate::process::{self, Done, cargo};
use crate::tool::Tool;

/// Options of the task.
#[derive(Default, clap::Args)]
pub(crate) struct Options {
    /// Leaves the advisories out, where their database cannot be fetched.
    #[arg(long)]
    without_advisories: bool,
}

/// Holds the dependencies against `deny.toml`.
pub(crate) fn deny(options: &Options) -> Done {
    Tool::named("deny", "cargo-deny").install()?;
    let mut command = cargo(&["deny", "--workspace", "--all-features", "check"]);
    command.args(["bans", "licenses", "sources"]);
    if !options.without_advisories {
        command.arg("advisories");
    }
    process::run(command)
}

/// Dependencies that are named and not used.
pub(crate) fn machete() -> Done {
    Tool::named("machete", "cargo-machete").install()?;
    let mut command = cargo(&["machete"]);
    // `cargo run` names the package of this task to its children; with that name cargo-machete
    // takes its own first argument for a directory.
    command.env_remove("CARGO_PKG_NAME");
    process::run(command)
}

/// Whether a published package breaks its users; there is nothing to compare with before the first
/// release.
pub(crate) fn semver(published: &[&str]) -> Done {
    Tool::named("semver-checks", "cargo-semver-checks").install()?;
    let mut command = cargo(&["semver-checks"]);
    command.args(published.iter().flat_map(|name| ["-p", name]));
    process::run(command)
}
