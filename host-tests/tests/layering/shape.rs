//! Whether a file can be read at a glance: how long it is, and how wide its comments are.

/// Lines of a file of the core.
pub(crate) const LINES: usize = 300;

/// Columns of a comment; a row of a table has to stay on one line.
pub(crate) const COLUMNS: usize = 140;

/// Whether a file has too many lines.
pub(crate) fn is_long(text: &str) -> bool {
    text.lines().count() > LINES
}

/// Lines with a comment that is too wide, counted from 1. (rustfmt does not wrap comments.)
pub(crate) fn wide_comments(text: &str) -> Vec<usize> {
    let wide = |line: &str| {
        let comment = line
            .trim_start()
            .strip_prefix("//")
            .map(|comment| comment.trim_start_matches(['/', '!']).trim_start());
        comment.is_some_and(|comment| !comment.starts_with('|')) && line.chars().count() > COLUMNS
    };
    let lines = text.lines().enumerate();
    lines
        .filter(|(_, line)| wide(line))
        .map(|(at, _)| at + 1)
        .collect()
}
