//! What the program says without a page: exit codes and sentences.

use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

fn command(words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_trendid-monitor"));
    command.args(words.split(' ')).args(["--http", "0"]);
    command
}

/// Runs for a second at most.
fn run(words: &str) -> Output {
    command(words).args(["--seconds", "0.5"]).output().unwrap()
}

/// The last sentence of a run that ends with an error.
fn refused(words: &str) -> String {
    let out = run(words);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{words}: {said}");
    let last = said.lines().last().unwrap_or_default();
    let last = last.strip_prefix("error: ");
    last.unwrap_or_else(|| panic!("{words}: {said}")).to_owned()
}

fn scratch(name: &str, text: Option<&str>) -> PathBuf {
    let path = std::env::temp_dir().join(format!("{}-{name}", std::process::id()));
    if let Some(text) = text {
        std::fs::write(&path, text).unwrap();
    }
    path
}

#[test]
fn a_record_that_cannot_be_written_is_said_before_anything_is_served() {
    let there = scratch("there.csv", Some("kept"));
    let name = there.display();
    let said = refused(&format!("--axis 7 --csv {name}"));
    assert_eq!(
        said,
        format!("{name}: it is there already, and is not overwritten")
    );
    assert_eq!(std::fs::read_to_string(&there).unwrap(), "kept");
    let below = format!("--axis 7 --csv {name}/x.csv");
    assert!(refused(&below).starts_with(&format!("{name}/x.csv: ")));
    std::fs::remove_file(there).unwrap();
}

#[test]
fn a_record_that_is_none_is_not_replayed() {
    assert!(refused("--replay no/such.csv").starts_with("no/such.csv: "));
    let other = scratch("other.csv", Some("t,u,y\n0,1,2\n"));
    let said = refused(&format!("--replay {}", other.display()));
    assert!(said.contains("line 1: `t,u,y` is not the header"), "{said}");
    std::fs::remove_file(other).unwrap();
    let said = refused("--emulator --image no/image");
    assert_eq!(said, "no/image: no such file");
}

#[test]
fn a_session_without_a_sample_is_an_error_and_leaves_no_record() {
    let record = scratch("none.csv", None);
    let said = refused("--port /dev/nope");
    assert!(
        said.starts_with("no sample in 0.5 s: /dev/nope: "),
        "{said}"
    );
    let said = refused(&format!("--tcp nohost --csv {}", record.display()));
    assert_eq!(said, format!("{}: nothing was recorded", record.display()));
    assert!(!record.exists());
}

#[test]
fn a_session_that_records_ends_well() {
    let record = scratch("well.csv", None);
    let out = run(&format!("--axis 7 --csv {}", record.display()));
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(out.status.success() && said.is_empty(), "{said}");
    let rows = std::fs::read_to_string(&record).unwrap();
    assert!(rows.lines().count() > 50);
    std::fs::remove_file(record).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_goes_nowhere_is_no_panic() {
    let full = std::fs::File::create("/dev/full").unwrap();
    let mut command = command("--axis 7 --seconds 0.5");
    let out = command
        .stdout(full)
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2));
    assert!(
        said.starts_with("error: cannot write to standard output: "),
        "{said}"
    );
    // A reader that has gone away has what it wanted.
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut gone = command.spawn().unwrap();
    drop(gone.stdout.take());
    let out = gone.wait_with_output().unwrap();
    assert!(out.status.success() && out.stderr.is_empty());
}
