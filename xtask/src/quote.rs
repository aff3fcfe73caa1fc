//! Marks in a document, and what stands between them.

/// A quotation of a document.
#[derive(Debug, PartialEq)]
pub(crate) struct Mark<'a> {
    /// As it is, instead of a block of program output.
    markdown: bool,
    /// Takes minutes.
    pub long: bool,
    /// Has figures that another compiler changes.
    pub near: bool,
    /// What prints it.
    pub command: &'a str,
}

impl<'a> Mark<'a> {
    /// Reads a line; `None` when it is no mark.
    fn parse(line: &'a str) -> Option<Result<Self, String>> {
        let inner = line.strip_prefix("<!-- run ")?.strip_suffix(" -->")?;
        Some(Self::words(inner).ok_or_else(|| format!("not a mark: {line}")))
    }

    fn words(inner: &'a str) -> Option<Self> {
        let (kind, command) = inner.split_once(": ")?;
        let mut words = kind.split(", ");
        let markdown = match words.next()? {
            "markdown" => true,
            "text" => false,
            _ => return None,
        };
        let (mut long, mut near) = (false, false);
        for word in words {
            match word {
                "long" => long = true,
                "near" => near = true,
                _ => return None,
            }
        }
        Some(Self {
            markdown,
            long,
            near,
            command,
        })
    }

    /// What stands between the marks.
    pub(crate) fn quoted(&self, output: &str) -> String {
        let (command, output) = (self.command, output.trim_end());
        if self.markdown {
            format!("\n`{command}`\n\n{output}\n\n")
        } else {
            format!("\n```text\n$ {command}\n{output}\n```\n\n")
        }
    }
}

/// The document with each quotation replaced by what `renewed` gives for it and its old text, if it
/// gives something.
pub(crate) fn replaced(
    document: &str,
    renewed: &mut impl FnMut(&Mark<'_>, &str) -> Result<Option<String>, String>,
) -> Result<String, String> {
    let mut text = String::new();
    let mut lines = document.split_inclusive('\n');
    while let Some(line) = lines.next() {
        text += line;
        let Some(mark) = Mark::parse(line.trim_end()) else {
            continue;
        };
        let mark = mark?;
        let (mut old, mut end) = (String::new(), None);
        for line in lines.by_ref() {
            if line.trim_end() == "<!-- end -->" {
                end = Some(line);
                break;
            }
            old += line;
        }
        let end = end.ok_or_else(|| format!("no end of: {}", mark.command))?;
        text += &renewed(&mark, &old)?.unwrap_or(old);
        text += end;
    }
    Ok(text)
}

/// The first lines that differ.
pub(crate) fn difference(old: &str, new: &str, near: bool) -> Option<String> {
    let (mut left, mut right) = (old.lines(), new.lines());
    loop {
        let (old, new) = (left.next(), right.next());
        if old.is_none() && new.is_none() {
            return None;
        }
        let (old, new) = (old.unwrap_or_default(), new.unwrap_or_default());
        if old != new && !(near && alike(old, new)) {
            return Some(format!("    quoted:  {old}\n    printed: {new}"));
        }
    }
}

/// Whether two lines have the same words, numbers within two per cent.
fn alike(old: &str, new: &str) -> bool {
    let number = |word: &str| word.parse::<f64>().ok();
    let words = |line: &str| -> Vec<String> { line.split_whitespace().map(String::from).collect() };
    let (old, new) = (words(old), words(new));
    old.len() == new.len()
        && old.iter().zip(&new).all(|(old, new)| {
            old == new
                || number(old)
                    .zip(number(new))
                    .is_some_and(|(old, new)| (new - old).abs() <= 0.02 * old.abs())
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "a\n<!-- run text, long: trendid demo -->\nold\n<!-- end -->\nb\n";

    #[test]
    fn a_block_is_replaced_between_its_marks() {
        let new = replaced(PAGE, &mut |mark, old| {
            assert_eq!(old, "old\n");
            assert!(mark.long && !mark.near && !mark.markdown);
            Ok(Some(mark.quoted("new\n")))
        });
        let expected = "a\n<!-- run text, long: trendid demo -->\n\n```text\n$ trendid demo\nnew\n```\n\n<!-- end -->\nb\n";
        assert_eq!(new.as_deref(), Ok(expected));
        assert_eq!(replaced(PAGE, &mut |_, _| Ok(None)).as_deref(), Ok(PAGE));
    }

    #[test]
    fn a_mark_that_is_not_understood_is_an_error() {
        for page in [
            "<!-- run txt: trendid demo -->\n<!-- end -->\n",
            "<!-- run text, quick: trendid demo -->\n<!-- end -->\n",
            "<!-- run text: trendid demo -->\n",
        ] {
            assert!(replaced(page, &mut |_, _| Ok(None)).is_err(), "{page}");
        }
    }

    #[test]
    fn near_forgives_two_per_cent_of_a_number_and_no_word() {
        assert_eq!(difference("| a | 100 |", "| a | 102 |", true), None);
        assert!(difference("| a | 100 |", "| a | 103 |", true).is_some());
        assert!(difference("| a | 100 |", "| b | 100 |", true).is_some());
        assert!(difference("| a | 100 |", "| a | 102 |", false).is_some());
        assert!(difference("a\nb", "a", true).is_some());
    }
}
