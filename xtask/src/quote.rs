//! Results in the documents that quote them: what a task printed stands between two marks and is never typed.

use std::path::Path;

use crate::process::Done;
use crate::process::root;

/// Documents that may have marks.
const DOCUMENTS: [&str; 2] = ["README.md", "docs/firmware.md"];

/// Puts `text` between `<!-- name: begin -->` and `<!-- name: end -->` in every document that has them.
pub fn quote(name: &str, text: &str) -> Done {
    for document in DOCUMENTS {
        let path = root().join(document);
        // A document that is not there quotes nothing.
        let Ok(old) = std::fs::read_to_string(&path) else {
            continue;
        };
        match quoted(&old, name, text) {
            Some(new) if new != old => write(&path, &new)?,
            _ => {}
        }
    }
    Ok(())
}

/// Writes a file and, if need be, its directory.
pub fn write(path: &Path, text: &str) -> Done {
    let named = |error: std::io::Error| format!("{}: {error}", path.display());
    path.parent()
        .map_or(Ok(()), std::fs::create_dir_all)
        .map_err(named)?;
    std::fs::write(path, text).map_err(named)
}

fn quoted(document: &str, name: &str, text: &str) -> Option<String> {
    let (begin, end) = (
        format!("<!-- {name}: begin -->\n"),
        format!("<!-- {name}: end -->"),
    );
    let (before, rest) = document.split_once(&begin)?;
    let (_, after) = rest.split_once(&end)?;
    Some([before, &begin, text, &end, after].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_replaced_between_its_marks() {
        let old = "a\n<!-- x: begin -->\nold\n<!-- x: end -->\nb";
        let new = "a\n<!-- x: begin -->\nnew\n<!-- x: end -->\nb";
        assert_eq!(quoted(old, "x", "new\n"), Some(new.to_owned()));
        assert_eq!(quoted(old, "y", "new\n"), None);
    }
}
