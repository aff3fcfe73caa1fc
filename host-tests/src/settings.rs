//! The names of the settings in a configuration, for tests that no setting is dead.

use std::collections::BTreeSet;
use std::fmt::Debug;

/// The names of all fields, as `Debug` prints them; a field of a field is `outer.inner`.
pub fn names(config: &impl Debug) -> BTreeSet<String> {
    let text = format!("{config:?}");
    let (mut path, mut word, mut names) = (Vec::new(), String::new(), BTreeSet::new());
    let mut listed = 0;
    for c in text.chars() {
        match c {
            '[' | '(' => listed += 1,
            ']' | ')' => listed -= 1,
            // The entries of a list have no names.
            _ if listed > 0 => {}
            // A group of settings is no setting itself.
            '{' => {
                names.remove(&path.join("."));
            }
            '}' => {
                path.pop();
            }
            ':' => {
                path.push(word.clone());
                names.insert(path.join("."));
            }
            ',' => {
                path.pop();
            }
            _ => {}
        }
        if c.is_alphanumeric() || c == '_' {
            word.push(c);
        } else {
            word.clear();
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug)]
    #[allow(dead_code, reason = "printed only")]
    struct Outer {
        a: [f32; 2],
        b: Inner,
        c: Option<[Inner; 1]>,
    }

    #[derive(Debug)]
    #[allow(dead_code, reason = "printed only")]
    struct Inner {
        x: f32,
        y: Option<f32>,
    }

    #[test]
    fn fields_and_the_fields_of_fields_have_names() {
        let inner = || Inner { x: 1.0, y: None };
        let outer = Outer {
            a: [1.0, 2.0],
            b: inner(),
            c: Some([inner()]),
        };
        let found: Vec<String> = names(&outer).into_iter().collect();
        assert_eq!(found, ["a", "b.x", "b.y", "c"]);
    }
}
