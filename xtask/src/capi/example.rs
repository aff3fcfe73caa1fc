//! The example in C and C++: strict, under sanitizers, on the host and in the emulator, and its
//! lines against those of Rust.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::capi::archive::Archive;
use crate::capi::release;
use crate::process::{Done, M4F, cargo, root, run, target_directory};

/// Builds and runs all of it; gives what it found.
pub(crate) fn run_all() -> Result<String, String> {
    let expected = reference()?;
    let place = target_directory()?.join("capi-example");
    // By `find_package` on a tree as a release has it.
    Archive::HOST_FAST.build()?;
    let tree = place.join("package");
    release::stage(&tree, &[Archive::HOST_FAST])?;
    let package = format!("-Dtrendid_DIR={}", tree.join("lib/cmake/trendid").display());
    let from_package = ["-DTRENDID_FROM=package", &package];
    let host = built(&place.join("host"), &from_package)?;
    same("host, C", &expected, &lines(&host.join("example"))?)?;
    let of_wrapper: Vec<_> = ["servo3", "loop"]
        .iter()
        .filter_map(|name| line(&expected, name))
        .collect();
    same("host, C++", &of_wrapper, &lines(&host.join("example-cpp"))?)?;
    let sanitized = built(
        &place.join("sanitized"),
        &[&from_package[..], &["-DSANITIZE=ON"]].concat(),
    )?;
    same(
        "host, C, sanitizers",
        &expected,
        &lines(&sanitized.join("example"))?,
    )?;
    same(
        "host, C++, sanitizers",
        &of_wrapper,
        &lines(&sanitized.join("example-cpp"))?,
    )?;
    // By `add_subdirectory`, which calls cargo; in the directory where the archive is already
    // built.
    let toolchain = root().join("examples/c/cmake/stm32f405.cmake");
    let target = built(
        &place.join("stm32f405"),
        &[
            &format!("-DCMAKE_TOOLCHAIN_FILE={}", toolchain.display()),
            &format!(
                "-DTRENDID_CARGO_TARGET_DIR={}",
                target_directory()?.display()
            ),
        ],
    )?;
    // An archive for a microcontroller is without `trendid_any`.
    let on_target: Vec<_> = expected
        .iter()
        .filter(|line| !line.starts_with("any"))
        .cloned()
        .collect();
    same(
        "STM32F405 in the emulator, C",
        &on_target,
        &M4F.lines(&target.join("example"), Duration::from_secs(300))?,
    )?;
    same(
        "STM32F405 in the emulator, C++",
        &of_wrapper,
        &M4F.lines(&target.join("example-cpp"), Duration::from_secs(300))?,
    )?;
    from_release(&place, &toolchain, &on_target)?;
    by_make(&place, &expected, &on_target)?;
    Ok(format!(
        "{} lines of numbers, in C and C++, by CMake and make, on the host, under sanitizers and in the emulator: those of Rust\n",
        expected.len()
    ))
}

/// For the target by `find_package`, from a tree as a release has it.
fn from_release(place: &Path, toolchain: &Path, expected: &[String]) -> Done {
    let tree = place.join("package");
    release::stage(&tree, &[Archive::HOST_FAST, Archive::M4F_FAST])?;
    let program = built(
        &place.join("stm32f405-package"),
        &[
            &format!("-DCMAKE_TOOLCHAIN_FILE={}", toolchain.display()),
            "-DTRENDID_FROM=package",
            // As in a project that has the archive beside its sources: `PATHS`.
            &format!("-DCMAKE_PREFIX_PATH={}", tree.display()),
        ],
    )?;
    let found = M4F.lines(&program.join("example"), Duration::from_secs(300))?;
    same("STM32F405 in the emulator, package", expected, &found)
}

/// By make, with one line for the linker, from a tree as a release has it.
fn by_make(place: &Path, expected: &[String], on_target: &[String]) -> Done {
    let (tree, place) = (place.join("package"), place.join("make"));
    let program = made(&place, &tree, Archive::HOST_FAST.target)?;
    same("host, make", expected, &lines(&program)?)?;
    let program = made(&place, &tree, M4F.target)?;
    let found = M4F.lines(&program, Duration::from_secs(300))?;
    same("STM32F405 in the emulator, make", on_target, &found)
}

/// Builds a copy of the example by its Makefile from a release tree; gives the program.
fn made(place: &Path, tree: &Path, target: &str) -> Result<PathBuf, String> {
    let place = place.join(target);
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(place.join("data")).map_err(|error| error.to_string())?;
    let examples = root().join("examples");
    let mut command = Command::new("cp");
    command.arg("-r").arg(examples.join("c")).arg(&place);
    run(command)?;
    std::fs::copy(
        examples.join("data/servo.bin"),
        place.join("data/servo.bin"),
    )
    .map_err(|error| format!("servo.bin: {error}"))?;
    let mut command = Command::new("make");
    command
        .arg("-C")
        .arg(place.join("c"))
        .arg(format!("TRENDID={}", tree.display()))
        .arg(format!("TARGET={target}"));
    run(command)?;
    Ok(place.join("c/example"))
}

/// The lines of the same runs in Rust.
fn reference() -> Result<Vec<String>, String> {
    let run = ["run", "-q", "--release", "-p", "trendid-capi"];
    let mut command = cargo(&[&run[..], &["--example", "c-reference"]].concat());
    collected(&mut command)
}

/// The line that begins with this name.
fn line(lines: &[String], name: &str) -> Option<String> {
    lines
        .iter()
        .find(|line| line.split(' ').next() == Some(name))
        .cloned()
}

/// Configures and builds the example in a directory of its own.
fn built(place: &Path, settings: &[&str]) -> Result<PathBuf, String> {
    let mut command = Command::new("cmake");
    command
        .arg("-S")
        .arg(root().join("examples/c"))
        .arg("-B")
        .arg(place)
        .args(["-DCMAKE_BUILD_TYPE=Release"])
        .args(settings);
    run(command)?;
    let mut command = Command::new("cmake");
    command.arg("--build").arg(place);
    run(command)?;
    Ok(place.to_owned())
}

fn lines(program: &Path) -> Result<Vec<String>, String> {
    collected(&mut Command::new(program))
}

/// What a program prints; an error when it fails.
fn collected(command: &mut Command) -> Result<Vec<String>, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command
        .output()
        .map_err(|error| format!("{name}: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        Ok(text.lines().map(str::to_owned).collect())
    } else {
        let errors = String::from_utf8_lossy(&output.stderr);
        Err(format!(
            "{name} ended with {}:\n{text}{errors}",
            output.status
        ))
    }
}

/// The same lines in any order: each run has a name.
fn same(what: &str, expected: &[String], found: &[String]) -> Done {
    let sorted = |lines: &[String]| {
        let mut lines = lines.to_vec();
        lines.sort();
        lines
    };
    let (expected, found) = (sorted(expected), sorted(found));
    if expected == found && !expected.is_empty() {
        return Ok(());
    }
    let missing: Vec<_> = expected
        .iter()
        .filter(|line| !found.contains(line))
        .map(String::as_str)
        .collect();
    let others: Vec<_> = found
        .iter()
        .filter(|line| !expected.contains(line))
        .map(String::as_str)
        .collect();
    Err(format!(
        "{what}: Rust has\n  {}\nand not\n  {}",
        missing.join("\n  "),
        others.join("\n  ")
    ))
}
