//! Whether a file can be read at a glance: how long it is, and how wide its comments are.

/// Lines of a file of the core.
pub(crate) const LINES: usize = 300;

/// Columns of a comment; a row of a table and what is quoted as text keep their lines.
pub(crate) const COLUMNS: usize = 100;

/// Whether a file has too many lines.
pub(crate) fn is_long(text: &str) -> bool {
    text.lines().count() > LINES
}

/// Lines with a comment that is too wide, counted from 1. (rustfmt does not wrap comments.)
pub(crate) fn wide_comments(text: &str) -> Vec<usize> {
    let mut quoted = false;
    let mut wide = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let Some(comment) = line.trim_start().strip_prefix("//") else {
            quoted = false;
            continue;
        };
        let comment = comment.trim_start_matches(['/', '!']).trim_start();
        quoted ^= comment.starts_with("```");
        if !quoted && !comment.starts_with('|') && line.chars().count() > COLUMNS {
            wide.push(at + 1);
        }
    }
    wide
}
