//! `SAFETY.md` names tests that exist, and every fault that the tests know; so do the tuned
//! constants of the loop.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use trendid_host_tests::servo::faults::fault::Fault;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The rows of the tables, as header and cells.
fn rows(page: &str) -> Vec<(Vec<String>, Vec<String>)> {
    let cells = |line: &str| -> Vec<String> {
        let inner = line.trim().trim_start_matches('|').trim_end_matches('|');
        inner
            .split('|')
            .map(|cell| cell.trim().to_owned())
            .collect()
    };
    let (mut header, mut rows) = (None, Vec::new());
    for line in page.lines() {
        if !line.starts_with('|') {
            header = None;
            continue;
        }
        match &header {
            None => header = Some(cells(line)),
            Some(_) if line.starts_with("|---") => {}
            Some(header) => rows.push((header.clone(), cells(line))),
        }
    }
    rows
}

/// What stands between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Whether `name` is a test function of the source, by its attribute or in `proptest!`; macros that
/// name tests count.
fn is_test(source: &str, name: &str) -> bool {
    let lines: Vec<_> = source.lines().collect();
    let function = format!("fn {name}(");
    let by_name = lines.iter().enumerate().any(|(at, line)| {
        let before = &lines[at.saturating_sub(3)..at];
        line.contains(&function) && before.iter().any(|line| line.contains("#[test]"))
    });
    let words = |line: &str| -> Vec<String> {
        let parts = line.split(|c: char| !c.is_alphanumeric() && c != '_');
        parts.map(str::to_owned).collect()
    };
    let listed = source
        .lines()
        .filter(|line| line.starts_with(char::is_alphabetic) && line.contains("!("))
        .any(|line| words(line).iter().any(|word| word == name));
    by_name || (listed && source.contains("#[test]"))
}

/// The tasks of xtask, by the variants of its commands.
fn tasks() -> BTreeSet<String> {
    let mut tasks = BTreeSet::new();
    for file in ["xtask/src/main.rs", "xtask/src/printed.rs"] {
        let text = read(file);
        let commands = text.split("enum Task {").nth(1).expect("the tasks");
        let commands = commands.split("\n}").next().unwrap_or_default();
        for line in commands.lines().map(str::trim) {
            let name = line.split(['(', ',']).next().unwrap_or_default();
            if name.chars().next().is_some_and(char::is_uppercase) {
                tasks.insert(name.to_lowercase());
            }
        }
    }
    tasks
}

/// What is wrong with one row of the page.
fn fault_of(header: &[String], row: &[String], tasks: &BTreeSet<String>) -> Option<String> {
    if header.len() != row.len() {
        return Some("another number of cells than the header".into());
    }
    let cell = |name: &str| {
        let at = header.iter().position(|title| title == name)?;
        Some(row[at].as_str())
    };
    let Some(test) = cell("test") else {
        return Some("no column of tests".into());
    };
    if test == "none" {
        let remains = cell("what remains").unwrap_or_default();
        let said = !(remains.is_empty() || remains == "-");
        return (!said).then(|| "no test, and nothing that remains".into());
    }
    let mut named = 0;
    for reference in quoted(test) {
        if let Some(task) = reference.strip_prefix("cargo xtask ") {
            named += 1;
            if !tasks.contains(task) {
                return Some(format!("no task {task}"));
            }
        } else if let Some((file, name)) = reference.split_once("::") {
            named += 1;
            let Ok(source) = std::fs::read_to_string(root().join(file)) else {
                return Some(format!("no file {file}"));
            };
            if !is_test(&source, name) {
                return Some(format!("no test {name} in {file}"));
            }
        }
    }
    (named == 0).then(|| "no test is named".into())
}

#[test]
fn every_row_names_a_test_that_exists_or_says_what_remains() {
    let tasks = tasks();
    assert!(
        tasks.contains("firmware") && tasks.contains("fuzz"),
        "{tasks:?}"
    );
    let page = read("SAFETY.md");
    let rows = rows(&page);
    assert!(rows.len() > 40, "{} rows", rows.len());
    let faults: Vec<_> = rows
        .iter()
        .filter_map(|(header, row)| Some(format!("{}: {}", row[0], fault_of(header, row, &tasks)?)))
        .collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn every_fault_of_the_tests_has_a_row() {
    let page = read("SAFETY.md");
    let keys: BTreeSet<_> = rows(&page)
        .into_iter()
        .filter(|(header, _)| header.get(1).is_some_and(|title| title == "key"))
        .flat_map(|(_, row)| quoted(&row[1]).map(str::to_owned).collect::<Vec<_>>())
        .collect();
    let known: BTreeSet<_> = Fault::ALL
        .iter()
        .map(|fault| fault.name().to_owned())
        .collect();
    assert_eq!(keys, known);
}

/// The texts of all sources below a folder.
fn texts(folder: &Path, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            texts(&path, found);
        } else if path.extension().is_some_and(|x| x == "rs") {
            found.push(std::fs::read_to_string(&path).expect("a source"));
        }
    }
}

#[test]
fn every_constant_of_the_loop_is_held_by_tests_that_exist() {
    // A list goes on over lines of its comment, to the full stop.
    let page = read("src/servo/design/constants.rs").replace(",\n// ", ", ");
    let held = page
        .lines()
        .filter_map(|line| line.split_once("Held by: "))
        .flat_map(|(_, names)| names.trim_end_matches('.').split(", "))
        .map(|name| name.split(" (").next().unwrap_or_default());
    let held: BTreeSet<_> = held.collect();
    assert!(held.len() > 8, "{held:?}");
    let mut sources = Vec::new();
    for folder in ["src", "host-tests/tests"] {
        texts(&root().join(folder), &mut sources);
    }
    let missing: Vec<_> = held
        .into_iter()
        .filter(|name| !sources.iter().any(|source| is_test(source, name)))
        .collect();
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn a_name_that_is_wrong_is_found() {
    let header = ["requirement", "mechanism", "test", "what remains"].map(str::to_owned);
    let fault = |test: &str, remains: &str| {
        let row = ["x", "y", test, remains].map(str::to_owned);
        fault_of(&header, &row, &tasks())
    };
    assert_eq!(
        fault(
            "`host-tests/tests/safety.rs::a_name_that_is_wrong_is_found`",
            "-"
        ),
        None
    );
    assert!(fault("`host-tests/tests/safety.rs::no_such_test`", "-").is_some());
    assert!(fault("`host-tests/tests/nowhere.rs::x`", "-").is_some());
    // A function that is no test.
    assert!(fault("`host-tests/tests/safety.rs::fault_of`", "-").is_some());
    assert!(fault("`cargo xtask dance`", "-").is_some());
    assert!(fault("some test", "-").is_some());
    assert!(fault("none", "-").is_some());
    assert_eq!(fault("none", "guards"), None);
}
