//! `trendid monitor`: the live page is a program of its own, so that a first build stays short.

use std::ffi::OsString;
use std::process::Command;

use clap::Args;

use crate::output::Refusal;

/// A live page of a position loop: runs `trendid-monitor`, which is built apart
#[derive(Debug, Args)]
#[command(disable_help_flag = true)]
pub(crate) struct MonitorArgs {
    /// What it is given, see `trendid monitor --help`
    #[arg(
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "ARGUMENTS"
    )]
    arguments: Vec<OsString>,
}

/// Runs the program that lies beside this one.
///
/// # Errors
///
/// How to build it, where it is not there; how it ended, where it failed.
pub(crate) fn run(args: &MonitorArgs) -> Result<(), Refusal> {
    let own = std::env::current_exe().map_err(|error| error.to_string())?;
    let program = own.with_file_name(format!("trendid-monitor{}", std::env::consts::EXE_SUFFIX));
    if !program.is_file() {
        let how = "the monitor is not built: `cargo run --release -p trendid-monitor -- --axis 7` builds and starts it";
        return Err(Refusal::new(how));
    }
    let ended = Command::new(&program).args(&args.arguments).status();
    match ended {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Refusal::new(format!(
            "{} ended with {status}",
            program.display()
        ))),
        Err(error) => Err(Refusal::new(format!("{}: {error}", program.display()))),
    }
}
