//! `README.md`, `docs/results.md` and `docs/position-loop.md` hold what the commands in them print, and nothing typed by hand.
//!
//! `cargo test --release -p trendid-cli --test results -- --ignored` compares; with `TRENDID_WRITE=1` it writes.
//! `TRENDID_ONLY=TEXT` leaves out the commands that do not contain this text.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn printed(command: &str) -> String {
    let mut words = command.split_whitespace();
    assert_eq!(words.next(), Some("trendid"), "{command}");
    let output = Command::new(env!("CARGO_BIN_EXE_trendid"))
        .args(words)
        .current_dir(root())
        .output()
        .expect("the program runs");
    assert!(
        output.status.success(),
        "{command}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("text")
}

/// The document with the output of every `<!-- run text: .. -->` or `<!-- run markdown: .. -->` put anew.
fn renewed(document: &str) -> String {
    let mut text = String::new();
    let mut lines = document.lines();
    while let Some(line) = lines.next() {
        text += line;
        text.push('\n');
        let Some(run) = line
            .strip_prefix("<!-- run ")
            .and_then(|l| l.strip_suffix(" -->"))
        else {
            continue;
        };
        let (kind, command) = run.split_once(": ").expect("a kind and a command");
        if std::env::var("TRENDID_ONLY").is_ok_and(|only| !command.contains(&only)) {
            continue;
        }
        let output = printed(command);
        text += &match kind {
            "markdown" => format!("\n`{command}`\n\n{}\n", output.trim_end()),
            "text" => format!("\n```text\n$ {command}\n{}\n```\n", output.trim_end()),
            _ => panic!("{kind} is neither text nor markdown"),
        };
        text.push('\n');
        let end = lines.find(|l| *l == "<!-- end -->").expect("an end");
        text += end;
        text.push('\n');
    }
    text
}

#[test]
#[ignore = "runs every table of the documents again, minutes; the README needs the EMPS record"]
fn results_are_what_the_commands_print() {
    for name in ["README.md", "docs/results.md", "docs/position-loop.md"] {
        let path = root().join(name);
        let document = std::fs::read_to_string(&path).expect(name);
        let renewed = renewed(&document);
        if std::env::var_os("TRENDID_WRITE").is_some() {
            std::fs::write(&path, renewed).expect("the document is writable");
            continue;
        }
        for (k, (old, new)) in document.lines().zip(renewed.lines()).enumerate() {
            assert_eq!(old, new, "{name}, line {}", k + 1);
        }
        assert_eq!(document, renewed);
    }
}
