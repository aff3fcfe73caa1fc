//! A copy of the work tree whose core carries switches, and its test programs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::blame::blame;
use crate::list::Mutant;
use crate::switch::{Switched, switch};

/// The switch that every mutant asks: off where the compiler evaluates, by the environment where
/// the program runs. `TRENDID_MUTANT` names the one that is on; `TRENDID_REACHED` a file that takes
/// the numbers of those that are asked.
const SWITCHES: &str = r#"
/// Which mutant is on.
#[allow(missing_docs, clippy::all)]
#[doc(hidden)]
pub mod switched {
    extern crate std;
    use self::std::io::Write;
    use self::std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
    const UNKNOWN: u32 = u32::MAX;
    const RECORD: u32 = u32::MAX - 1;
    const NONE: u32 = u32::MAX - 2;
    static ON: AtomicU32 = AtomicU32::new(UNKNOWN);
    static ASKED: [AtomicU64; 512] = [const { AtomicU64::new(0) }; 512];
    #[inline(always)]
    pub const fn is(number: u32) -> bool {
        core::intrinsics::const_eval_select((number,), at_compile_time, at_run_time)
    }
    #[inline(always)]
    const fn at_compile_time(_: u32) -> bool {
        false
    }
    #[inline(always)]
    fn at_run_time(number: u32) -> bool {
        let on = ON.load(Relaxed);
        if on >= RECORD { rarely(on, number) } else { on == number }
    }
    #[cold]
    #[inline(never)]
    fn rarely(mut on: u32, number: u32) -> bool {
        if on == UNKNOWN {
            let named = self::std::env::var("TRENDID_MUTANT").ok().and_then(|n| n.parse().ok());
            let record = self::std::env::var_os("TRENDID_REACHED").is_some();
            on = if record { RECORD } else { named.unwrap_or(NONE) };
            ON.store(on, Relaxed);
        }
        if on != RECORD {
            return on == number;
        }
        let (bit, word) = (1 << (number % 64), &ASKED[(number / 64) as usize]);
        if word.load(Relaxed) & bit == 0 && word.fetch_or(bit, Relaxed) & bit == 0 {
            let path = self::std::env::var_os("TRENDID_REACHED").unwrap();
            let mut file = self::std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
            file.write_all(self::std::format!("{number}\n").as_bytes()).unwrap();
        }
        false
    }
}
"#;

/// Mutants that fit into one build.
pub(crate) const MOST: usize = 512 * 64;

/// The copy.
#[derive(Debug)]
pub(crate) struct Tree {
    root: PathBuf,
    copy: PathBuf,
    target: PathBuf,
}

/// A program of tests.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    /// Where it is.
    pub path: PathBuf,
    /// The directory in which cargo would run it.
    pub directory: PathBuf,
}

impl Tree {
    /// Brings the copy up to date: whatever git knows or does not ignore.
    pub(crate) fn new(root: &Path, place: &Path) -> Result<Self, String> {
        let tree = Self {
            root: root.to_owned(),
            copy: place.join("tree"),
            target: place.join("target"),
        };
        let output = Command::new("git")
            .args([
                "ls-files",
                "-z",
                "--cached",
                "--others",
                "--exclude-standard",
            ])
            .current_dir(root)
            .output()
            .map_err(|error| format!("git: {error}"))?;
        let names = String::from_utf8_lossy(&output.stdout).into_owned();
        let names: BTreeSet<&str> = names.split('\0').filter(|name| !name.is_empty()).collect();
        for name in &names {
            // What git knows may be deleted in the work tree.
            if let Ok(bytes) = std::fs::read(root.join(name)) {
                write(&tree.copy.join(name), &bytes)?;
            }
        }
        tree.forget(&tree.copy, &names)?;
        Ok(tree)
    }

    /// Removes files that are no longer in the work tree.
    fn forget(&self, directory: &Path, names: &BTreeSet<&str>) -> Result<(), String> {
        let failed = |error: std::io::Error| format!("{}: {error}", directory.display());
        for entry in std::fs::read_dir(directory).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let name = path.strip_prefix(&self.copy).unwrap_or(&path);
            let name = name.to_string_lossy().into_owned();
            if path.is_dir() {
                self.forget(&path, names)?;
            } else if !names.contains(name.as_str()) || !self.root.join(&name).exists() {
                std::fs::remove_file(&path).map_err(failed)?;
            }
        }
        Ok(())
    }

    /// Puts the mutants into the core and takes those out that do not compile, with the reason.
    pub(crate) fn plant(&self, mutants: &[Mutant]) -> Result<BTreeMap<u32, String>, String> {
        let mut unviable: BTreeMap<u32, String> = BTreeMap::new();
        loop {
            let texts = self.switched(mutants, &mut unviable)?;
            let wrong = self.check(&texts)?;
            if wrong.is_empty() {
                return Ok(unviable);
            }
            eprintln!("{} mutants do not compile", wrong.len());
            unviable.extend(wrong);
        }
    }

    /// Writes the sources of the core.
    fn switched(
        &self,
        mutants: &[Mutant],
        unviable: &mut BTreeMap<u32, String>,
    ) -> Result<BTreeMap<String, Switched>, String> {
        let mut files: BTreeMap<&str, Vec<(u32, &Mutant)>> = BTreeMap::new();
        for (number, mutant) in (0..).zip(mutants) {
            if !unviable.contains_key(&number) {
                files
                    .entry(&mutant.file)
                    .or_default()
                    .push((number, mutant));
            }
        }
        let mut texts = BTreeMap::new();
        for (name, mutants) in &files {
            let source = read(&self.root.join(name))?;
            let switched = switch(&source, mutants).map_err(|error| format!("{name}: {error}"))?;
            for number in &switched.left {
                unviable.insert(*number, "no place for a switch".into());
            }
            write(&self.copy.join(name), switched.text.as_bytes())?;
            texts.insert((*name).to_owned(), switched);
        }
        // Files whose mutants are all gone are the original again.
        for mutant in mutants {
            if !texts.contains_key(&mutant.file) {
                let source = read(&self.root.join(&mutant.file))?;
                write(&self.copy.join(&mutant.file), source.as_bytes())?;
            }
        }
        let library = texts.get("src/lib.rs").map(|file| file.text.clone());
        let library = library.map_or_else(|| read(&self.root.join("src/lib.rs")), Ok)?;
        let library = library.replace(
            "#![forbid(unsafe_code)]",
            "#![feature(core_intrinsics, const_eval_select)]\n#![allow(internal_features)]",
        );
        write(
            &self.copy.join("src/lib.rs"),
            (library + SWITCHES).as_bytes(),
        )?;
        Ok(texts)
    }

    fn cargo(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new("cargo");
        command
            .args(arguments)
            .current_dir(&self.copy)
            .env("CARGO_TARGET_DIR", &self.target)
            // A function that asks at run time only is not stable.
            .env("RUSTC_BOOTSTRAP", "trendid")
            // A mutant may leave something unused, or divide by what is plainly zero.
            .env("CARGO_ENCODED_RUSTFLAGS", "--cap-lints=warn")
            .env_remove("RUSTFLAGS");
        command
    }

    /// Errors of the compiler, each for the mutants in whose text it stands.
    fn check(&self, texts: &BTreeMap<String, Switched>) -> Result<BTreeMap<u32, String>, String> {
        let output = self
            .cargo(&[
                "check",
                "-q",
                "-p",
                "trendid",
                "--lib",
                "--message-format=json",
            ])
            .output()
            .map_err(|error| format!("cargo: {error}"))?;
        let mut wrong = BTreeMap::new();
        for line in String::from_utf8_lossy(&output.stdout).lines() {
            let Ok(value) = serde_json::from_str::<Value>(line) else {
                continue;
            };
            let message = &value["message"];
            if message["level"] != "error" {
                continue;
            }
            let blamed = blame(message, texts);
            let text = message["message"].as_str().unwrap_or_default();
            if blamed.is_empty() && message["spans"].as_array().is_some_and(|s| !s.is_empty()) {
                return Err(format!("an error of no mutant: {}", message["rendered"]));
            }
            wrong.extend(blamed.into_iter().map(|number| (number, text.to_owned())));
        }
        if wrong.is_empty() && !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned());
        }
        Ok(wrong)
    }

    /// Builds the test programs; with `unit` only that of the core.
    pub(crate) fn programs(&self, unit: bool) -> Result<Vec<Program>, String> {
        let mut programs = Vec::new();
        let builds: [&[&str]; 2] = [
            &["-p", "trendid", "--lib"],
            &[
                "-p",
                "trendid-host-tests",
                "--features",
                "thorough",
                "--test",
                "core",
                "--test",
                "servo",
            ],
        ];
        for build in builds.into_iter().take(if unit { 1 } else { 2 }) {
            let output = self
                .cargo(&[&["test", "-q", "--no-run", "--message-format=json"], build].concat())
                .stderr(std::process::Stdio::inherit())
                .output()
                .map_err(|error| format!("cargo: {error}"))?;
            if !output.status.success() {
                return Err(format!("the tests {} do not build", build.join(" ")));
            }
            for line in String::from_utf8_lossy(&output.stdout).lines() {
                let value: Value = serde_json::from_str(line).unwrap_or_default();
                let text = |value: &Value| value.as_str().map(str::to_owned);
                if let Some(path) = text(&value["executable"])
                    && let Some(manifest) = text(&value["manifest_path"])
                {
                    programs.push(Program {
                        path: path.into(),
                        directory: Path::new(&manifest).parent().unwrap_or(&self.copy).into(),
                    });
                }
            }
        }
        Ok(programs)
    }
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// Writes what is another content; a file that stays is not compiled again.
fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    if std::fs::read(path).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    let failed = |error: std::io::Error| format!("{}: {error}", path.display());
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(failed)?;
    }
    std::fs::write(path, bytes).map_err(failed)
}
