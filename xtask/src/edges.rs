//! Edges on the C interface that run in other programs: GNU Octave, and units of FMI in FMPy.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::capi::Archive;
use crate::process::{Done, cargo, root, run, target_directory, works};
use crate::setup;

/// Runs the test of the MEX function in Octave against Rust.
pub(crate) fn octave() -> Done {
    let missing: Vec<_> = [("octave-cli", "octave"), ("mkoctfile", "octave-dev")]
        .into_iter()
        .filter(|(program, _)| !works(program, &["--version"]))
        .map(|(_, package)| package)
        .collect();
    setup::apt(&missing)?;
    Archive::HOST_FAST.build()?;
    let place = fresh("octave")?;
    let source = root().join("octave");
    let mut command = Command::new("mkoctfile");
    command
        .current_dir(&place)
        .args(["--mex", "-Wall", "-Wextra"])
        .arg(include())
        .arg(source.join("trendid_mex.c"))
        .arg(Archive::HOST_FAST.path()?)
        .args(["-Wl,--gc-sections", "-o", "trendid_mex.mex"]);
    run(command)?;
    let mut command = Command::new("octave-cli");
    command
        .args(["--norc", "--quiet", "--path"])
        .arg(&source)
        .arg("--path")
        .arg(&place)
        .arg("--eval")
        .arg(format!("test_trendid('{}')", record().display()));
    same("Octave", &reference("octave")?, &lines(&mut command)?)
}

/// Builds the units, has them validated and simulated by FMPy, and compares with Rust.
pub(crate) fn fmu() -> Done {
    setup::apt(if works("gcc", &["--version"]) {
        &[]
    } else {
        &["gcc", "libc6-dev"]
    })?;
    let python = fmpy()?;
    Archive::HOST_FAST.build()?;
    let place = fresh("fmu")?;
    let mut units = Vec::new();
    for model in ["identifier", "loop"] {
        units.push(unit(&place, model)?);
    }
    let mut command = Command::new(&python);
    // Zip files of the standard library: no program of the system is needed.
    for (unit, directory) in &units {
        let mut pack = Command::new(&python);
        pack.args(["-c", "import shutil, sys; shutil.move(shutil.make_archive(sys.argv[1], 'zip', sys.argv[2]), sys.argv[1])"]);
        pack.arg(unit).arg(directory);
        run(pack)?;
    }
    command
        .arg(root().join("fmu/test_fmu.py"))
        .args(units.iter().map(|(unit, _)| unit))
        .arg(record());
    same("FMPy", &reference("fmu")?, &lines(&mut command)?)?;
    for (unit, _) in &units {
        let bytes = fs::metadata(unit).map_err(|error| error.to_string())?.len();
        println!("{}: {} kB", unit.display(), bytes / 1000);
    }
    Ok(())
}

/// Compiles one unit; gives its path and the directory to be packed.
fn unit(place: &Path, model: &str) -> Result<(PathBuf, PathBuf), String> {
    let directory = place.join(model);
    let binaries = directory.join("binaries/linux64");
    fs::create_dir_all(&binaries).map_err(|error| error.to_string())?;
    let source = root().join("fmu");
    fs::copy(
        source.join(format!("{model}.xml")),
        directory.join("modelDescription.xml"),
    )
    .map_err(|error| format!("{model}.xml: {error}"))?;
    let mut command = Command::new("gcc");
    command
        .args([
            "-std=c11",
            "-O2",
            "-shared",
            "-fPIC",
            "-fvisibility=hidden",
            "-Wall",
            "-Wextra",
            "-Wconversion",
        ])
        .args(["-pedantic", "-Werror"])
        .arg(include())
        .arg("-I")
        .arg(&source)
        .args([source.join("fmi2.c"), source.join(format!("{model}.c"))])
        .arg(Archive::HOST_FAST.path()?)
        .args([
            "-Wl,--gc-sections",
            "-Wl,--exclude-libs,ALL",
            "-s",
            "-lm",
            "-o",
        ])
        .arg(binaries.join(format!("trendid_{model}.so")));
    run(command)?;
    Ok((place.join(format!("trendid_{model}.fmu")), directory))
}

/// A Python that has FMPy, in an environment of its own.
fn fmpy() -> Result<PathBuf, String> {
    let environment = target_directory()?.join("tools/fmpy");
    let python = environment.join("bin/python");
    let path = python.to_string_lossy().into_owned();
    if works(&path, &["-c", "import fmpy"]) {
        return Ok(python);
    }
    if !works("python3", &["-m", "venv", "--help"]) {
        setup::apt(&["python3", "python3-venv"])?;
    }
    let mut create = Command::new("python3");
    create.args(["-m", "venv"]).arg(&environment);
    run(create)?;
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "fmpy==0.3.32"]);
    run(install)?;
    Ok(python)
}

/// An empty directory for what is built.
fn fresh(name: &str) -> Result<PathBuf, String> {
    let place = target_directory()?.join("edges").join(name);
    let _ = fs::remove_dir_all(&place);
    fs::create_dir_all(&place).map_err(|error| format!("{}: {error}", place.display()))?;
    Ok(place)
}

fn include() -> String {
    format!("-I{}", root().join("capi/include").display())
}

fn record() -> PathBuf {
    root().join("examples/data/servo.csv")
}

/// The lines of the same runs in Rust.
fn reference(name: &str) -> Result<Vec<String>, String> {
    lines(&mut cargo(&[
        "run",
        "-q",
        "--release",
        "-p",
        "trendid-capi",
        "--example",
        "c-reference",
        "--",
        name,
    ]))
}

/// What a program prints; an error when it fails.
fn lines(command: &mut Command) -> Result<Vec<String>, String> {
    let output = command
        .output()
        .map_err(|error| format!("{:?}: {error}", command.get_program()))?;
    let text = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        let errors = String::from_utf8_lossy(&output.stderr);
        return Err(format!(
            "{:?} ended with {}:\n{text}{errors}",
            command.get_program(),
            output.status
        ));
    }
    Ok(text.lines().map(str::to_owned).collect())
}

/// Line by line the same; long lines are cut in the message.
fn same(what: &str, expected: &[String], found: &[String]) -> Done {
    if expected == found && !expected.is_empty() {
        println!("{what}: {} lines of numbers, those of Rust", found.len());
        return Ok(());
    }
    let cut = |lines: &[String]| {
        lines
            .iter()
            .map(|line| format!("  {line:.80}\n"))
            .collect::<String>()
    };
    Err(format!(
        "{what}: Rust has\n{}and there is\n{}",
        cut(expected),
        cut(found)
    ))
}
