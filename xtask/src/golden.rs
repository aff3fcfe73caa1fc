//! Reference files: renewed by their name only (`cargo xtask docs --write NAME`), because others
//! are measured against them.

use std::fs;

use crate::process::{Done, cargo, root};
use crate::{icount, record};

/// What a reference file holds.
type Content = fn() -> Result<Vec<u8>, String>;

const FILES: [(&str, Content); 3] = [
    ("examples/data/servo.bin", || Ok(record::bytes())),
    ("examples/data/selftest.txt", selftest),
    (icount::BASELINE, || Ok(icount::baseline()?.into_bytes())),
];

/// Writes the file that ends with `name`; says whether there is one.
pub(crate) fn write(name: &str) -> Result<bool, String> {
    let Some((path, content)) = FILES.iter().find(|(path, _)| path.ends_with(name)) else {
        return Ok(false);
    };
    fs::write(root().join(path), content()?).map_err(|error| format!("{path}: {error}"))?;
    println!("{path}: written");
    Ok(true)
}

/// The record is what its generator gives; the other files are compared by the self-test and by
/// `icount`.
pub(crate) fn check() -> Done {
    let (path, content) = FILES[0];
    let kept = fs::read(root().join(path)).map_err(|error| format!("{path}: {error}"))?;
    if kept == content()? {
        Ok(())
    } else {
        Err(format!("{path} is not what its generator gives"))
    }
}

/// The lines of the self-test on this machine.
fn selftest() -> Result<Vec<u8>, String> {
    let output = cargo(&["run", "-q", "--release", "--example", "selftest"])
        .output()
        .map_err(|error| error.to_string())?;
    let text = String::from_utf8_lossy(&output.stdout).replace(" DIFFERS", "");
    if text.is_empty() {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    } else {
        Ok(text.into_bytes())
    }
}
