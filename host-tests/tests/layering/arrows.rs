//! Which module of a package uses which.

use std::collections::BTreeMap;

use super::source::{Names, Source};

/// The module that a file below the root of its package is.
pub(crate) fn module(file: &str) -> Names {
    let names = file.trim_end_matches(".rs").split('/');
    let mut names: Names = names.map(str::to_owned).collect();
    names.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
    names
}

/// The module in which `path`, named in `from`, ends; nothing for what lies outside of the package.
pub(crate) fn target(
    modules: &BTreeMap<Names, Source>,
    from: &Names,
    path: &[String],
    depth: u32,
) -> Option<Names> {
    let source = &modules[from];
    let mut at = from.clone();
    let mut rest = path;
    match path[0].as_str() {
        "crate" => (at, rest) = (Names::new(), &path[1..]),
        "self" => rest = &path[1..],
        "super" => {
            while let [first, more @ ..] = rest
                && first == "super"
            {
                at.pop();
                rest = more;
            }
        }
        child if source.children.iter().any(|c| c == child) => {}
        local => {
            let import = source
                .imports
                .iter()
                .find(|i| i.local == local && i.path != path)?;
            let path: Names = import.path.iter().chain(&path[1..]).cloned().collect();
            return target(modules, from, &path, depth.checked_sub(1)?);
        }
    }
    while let [name, more @ ..] = rest {
        let below: Names = at.iter().chain([name]).cloned().collect();
        if modules.contains_key(&below) {
            (at, rest) = (below, more);
            continue;
        }
        let Some(import) = modules
            .get(&at)
            .and_then(|m| m.imports.iter().find(|i| i.local == *name))
        else {
            return Some(at);
        };
        let path: Names = import.path.iter().chain(more).cloned().collect();
        return target(modules, &at, &path, depth.checked_sub(1)?);
    }
    Some(at)
}

/// Which file uses which, with the first line that does.
pub(crate) fn arrows(modules: &BTreeMap<Names, Source>) -> BTreeMap<(&Names, Names), usize> {
    let mut arrows = BTreeMap::new();
    for (from, source) in modules {
        let imports = source.imports.iter().filter(|i| !i.passed_on);
        let imports = imports.map(|i| (&i.path, i.line));
        let paths = source.paths.iter().map(|(path, line)| (path, *line));
        for (path, line) in imports.chain(paths) {
            if let Some(to) = target(modules, from, path, 8)
                && to != *from
                && modules.contains_key(&to)
            {
                arrows.entry((from, to)).or_insert(line);
            }
        }
    }
    arrows
}
