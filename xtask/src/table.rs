//! Tables that tests print beside what they hold.

use crate::process::cargo;

/// Options of the task.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// A part of the name of the test.
    #[arg(value_name = "TEST")]
    test: String,
}

/// Runs the test; gives the rows of its table.
pub(crate) fn run(options: &Options) -> Result<String, String> {
    let program = [
        "test",
        "-p",
        "trendid-host-tests",
        "--features",
        "thorough",
        "--test",
        "servo",
    ];
    let output = cargo(&program)
        .args([
            options.test.as_str(),
            "--",
            "--nocapture",
            "--test-threads",
            "1",
        ])
        .output()
        .map_err(|error| error.to_string())?;
    let text = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(format!("{text}{}", String::from_utf8_lossy(&output.stderr)));
    }
    let rows = rows(&text);
    if rows.is_empty() {
        Err(format!("no test `{}` prints a table", options.test))
    } else {
        Ok(rows)
    }
}

/// The rows in the output of a test program, which begins with the name of the test.
fn rows(text: &str) -> String {
    let rows = text.lines().filter_map(|line| line.split_once('|'));
    rows.map(|(_, row)| format!("|{row}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_what_begins_with_a_bar() {
        let text = "running 1 test\ntest a::b ... | x | y |\n|---|---|\n| 1 | 2 |\nok\n";
        assert_eq!(rows(text), "| x | y |\n|---|---|\n| 1 | 2 |\n");
    }
}
