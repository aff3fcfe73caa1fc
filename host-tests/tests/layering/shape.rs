//! Whether a file can be read at a glance: how long it is, how wide its comments are, and how many
//! fields a struct has.

/// Lines of a file.
pub(crate) const LINES: usize = 300;

/// Columns of a comment; a row of a table and what is quoted as text keep their lines.
pub(crate) const COLUMNS: usize = 100;

/// Fields of a struct; what has more has parts.
pub(crate) const FIELDS: usize = 20;

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

/// Structs with too many fields: line, counted from 1, and name.
pub(crate) fn crowded(text: &str) -> Vec<(usize, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let indent = line.len() - line.trim_start().len();
        let words: Vec<&str> = line.split_whitespace().collect();
        let Some(place) = words.iter().position(|word| *word == "struct") else {
            continue;
        };
        let (Some(name), true) = (words.get(place + 1), line.ends_with('{')) else {
            continue;
        };
        // As rustfmt leaves it: a line per field, the brace in the column of the struct.
        let end = format!("{}}}", &line[..indent]);
        let body = lines[at + 1..].iter().take_while(|line| **line != end);
        let fields = body.filter(|line| is_field(line, indent + 4)).count();
        if fields > FIELDS {
            let name = name.split(['<', '{']).next().unwrap_or(name);
            found.push((at + 1, name.to_owned()));
        }
    }
    found
}

/// Whether a line begins a field in this column.
fn is_field(line: &str, column: usize) -> bool {
    let text = line.trim_start();
    let name = text.split(':').next().unwrap_or_default();
    let name = name.rsplit(' ').next().unwrap_or_default();
    let is_word = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_');
    line.len() - text.len() == column && is_word && text.contains(": ") && !text.starts_with("//")
}
