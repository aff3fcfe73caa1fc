//! Programs that the task needs, installed where they are missing.

use std::path::PathBuf;
use std::process::Command;

use crate::process::{Done, run, target_directory, works};
use crate::setup;

/// What makes the header; its version decides the text.
pub(crate) const CBINDGEN: &str = "cbindgen";
const CBINDGEN_VERSION: &str = "0.29.0";

/// Programs of other packages, and the package of Debian that has each.
const PACKAGES: [(&str, &[&str]); 5] = [
    ("cmake", &["cmake"]),
    ("make", &["make"]),
    ("gcc", &["gcc", "libc6-dev"]),
    ("g++", &["g++"]),
    (
        "arm-none-eabi-gcc",
        &["gcc-arm-none-eabi", "libnewlib-arm-none-eabi"],
    ),
];

/// Everything.
pub(crate) fn all() -> Done {
    setup::run()?;
    let mut missing: Vec<_> = PACKAGES
        .iter()
        .filter(|(program, _)| !works(program, &["--version"]))
        .flat_map(|(_, packages)| packages.iter().copied())
        .collect();
    // Headers of C++: the compiler for ARM comes without.
    let with_headers = [
        "-x",
        "c++",
        "-fsyntax-only",
        "-include",
        "array",
        "/dev/null",
    ];
    if !works("arm-none-eabi-g++", &with_headers) {
        missing.push("libstdc++-arm-none-eabi-dev");
    }
    setup::apt(&missing)?;
    cbindgen()
}

/// The program, where [`cbindgen`] has put it.
pub(crate) fn command(program: &str) -> Result<Command, String> {
    Ok(Command::new(place()?.join("bin").join(program)))
}

fn place() -> Result<PathBuf, String> {
    Ok(target_directory()?.join("tools"))
}

/// The maker of the header, in this version; half a minute to build where it is missing.
pub(crate) fn cbindgen() -> Done {
    let current = command(CBINDGEN)?
        .arg("--version")
        .output()
        .is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains(CBINDGEN_VERSION));
    if current {
        return Ok(());
    }
    let mut command =
        crate::process::cargo(&["install", "--quiet", "--locked", "--debug", CBINDGEN]);
    command
        .args(["--version", CBINDGEN_VERSION, "--root"])
        .arg(place()?);
    run(command)
}
