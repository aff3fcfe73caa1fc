//! The mutants there are, as cargo-mutants names them, and a draw of them.

use std::ops::Range;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// One change of the source.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mutant {
    /// File, line, column and what is replaced, as cargo-mutants says it.
    pub name: String,
    /// The source file below the root of the workspace.
    pub file: String,
    /// The kind of change.
    pub genre: String,
    /// What is replaced, in bytes of the file.
    pub range: Range<usize>,
    /// What stands there instead.
    pub replacement: String,
}

impl Mutant {
    /// The change without line and column, which move with every edit.
    pub(crate) fn change(&self) -> &str {
        self.name.splitn(4, ':').nth(3).unwrap_or_default().trim()
    }
}

/// All mutants in the files below `room`.
pub(crate) fn all(root: &Path, room: &str) -> Result<Vec<Mutant>, String> {
    let output = Command::new("cargo")
        .args(["mutants", "--list", "--json", "-p", "trendid", "-f"])
        .arg(format!("{room}**/*.rs"))
        .current_dir(root)
        .output()
        .map_err(|error| format!("cargo mutants: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let list: Value =
        serde_json::from_slice(&output.stdout).map_err(|error| format!("its list: {error}"))?;
    let list = list.as_array().ok_or("its list is none")?;
    list.iter().map(|value| mutant(root, value)).collect()
}

fn mutant(root: &Path, value: &Value) -> Result<Mutant, String> {
    let text = |key: &str| {
        value[key]
            .as_str()
            .map(str::to_owned)
            .ok_or_else(|| format!("a mutant without {key}: {value}"))
    };
    let file = text("file")?;
    let source = std::fs::read_to_string(root.join(&file)).map_err(|e| format!("{file}: {e}"))?;
    let place = |end: &str| {
        let number = |key: &str| value["span"][end][key].as_u64().map(|n| n as usize);
        let at = number("line").zip(number("column"));
        at.and_then(|(line, column)| offset(&source, line, column))
            .ok_or_else(|| format!("a mutant without a place: {value}"))
    };
    Ok(Mutant {
        name: text("name")?,
        genre: text("genre")?,
        range: place("start")?..place("end")?,
        replacement: text("replacement")?,
        file,
    })
}

/// The byte of a line and a column, both from one, the column in characters.
fn offset(source: &str, line: usize, column: usize) -> Option<usize> {
    let begin = if line == 1 {
        0
    } else {
        source.match_indices('\n').nth(line - 2)?.0 + 1
    };
    let rest = &source[begin..];
    let mut places = rest.char_indices().map(|(at, _)| at).chain([rest.len()]);
    Some(begin + places.nth(column - 1)?)
}

/// `count` of them, in an order by chance; every one without a count.
pub(crate) fn draw(mut mutants: Vec<Mutant>, count: Option<usize>, seed: u64) -> Vec<Mutant> {
    if let Some(count) = count {
        // The order of a hash of name and seed is one by chance.
        mutants.sort_by_key(|mutant| hash(seed, &mutant.name));
        mutants.truncate(count);
    }
    mutants
}

/// FNV-1a with a seed, mixed so that neighbours differ.
fn hash(seed: u64, name: &str) -> u64 {
    let start = 0xCBF2_9CE4_8422_2325 ^ seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let hash = name.bytes().fold(start, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3)
    });
    (hash ^ (hash >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_counted_in_characters_and_given_in_bytes() {
        let source = "ab\nöö+c\n";
        assert_eq!(offset(source, 1, 1), Some(0));
        assert_eq!(offset(source, 2, 3), Some(7));
        assert_eq!(offset(source, 2, 5), Some(9));
        assert_eq!(offset(source, 9, 1), None);
    }

    #[test]
    fn a_draw_is_the_same_each_time_and_another_one_with_another_seed() {
        let mutants: Vec<Mutant> = (0..100)
            .map(|k| Mutant {
                name: format!("src/a.rs:{k}:1: replace + with -"),
                file: "src/a.rs".into(),
                genre: "BinaryOperator".into(),
                range: k..k + 1,
                replacement: "-".into(),
            })
            .collect();
        let first = draw(mutants.clone(), Some(10), 3);
        assert_eq!(first.len(), 10);
        assert_eq!(first, draw(mutants.clone(), Some(10), 3));
        assert_ne!(first, draw(mutants.clone(), Some(10), 4));
        assert_ne!(first, mutants[..10]);
        assert_eq!(first[0].change(), "replace + with -");
    }
}
