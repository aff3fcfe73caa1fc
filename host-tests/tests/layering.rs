//! The arrows run one way: a room uses only the rooms left of it, and no two files import each other.
//!
//! Read from the sources: the `use` lines and the full paths in the code, without tests. A name that a module passes on
//! (`pub use`) counts for the file that defines it.

use std::collections::BTreeMap;
use std::path::Path;

use proc_macro2::Ident;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, ItemMod, ItemUse, Macro, Token, UseTree, Visibility};

/// The rooms of a package, each using only those before it; the crate root may use all.
const ORDERS: [(&str, &[&str]); 2] = [
    (
        "src",
        &[
            "math",
            "error",
            "hardware",
            "trends",
            "estimation",
            "model",
            "readout",
            "identifier",
            "servo",
        ],
    ),
    (
        "host-tests/src",
        &[
            "plants",
            "signals",
            "oracles",
            "paper",
            "servo",
            "endurance",
        ],
    ),
];

/// Rooms that only these may use, beside the crate root.
const RESERVED: [(&str, &str, &[&str]); 1] = [("src", "hardware", &["servo"])];

/// Packages and programs; in those that contain others, each folder with a `main.rs` or `lib.rs` is one.
const PACKAGES: [&str; 9] = [
    "src",
    "identify/src",
    "cli/src",
    "host-tests/src",
    "link/src",
    "xtask/src",
    "xtask/log/src",
    "host-tests/tests",
    "examples",
];

/// Path of a module, and name of what it holds at the end.
type Names = Vec<String>;

/// What a `use` brings into a file.
struct Import {
    path: Names,
    /// Name in the file; empty for `*`.
    local: String,
    line: usize,
    /// `pub use`: the file passes it on and need not use it.
    passed_on: bool,
}

/// One file: its path, and what is read from it.
struct Source {
    file: String,
    /// Modules declared with `mod name;`.
    children: Names,
    imports: Vec<Import>,
    /// Paths in the code, with their line.
    paths: Vec<(Names, usize)>,
}

impl Source {
    fn read(file: &str, text: &str) -> Self {
        let mut source = Self {
            file: file.into(),
            children: Names::new(),
            imports: Vec::new(),
            paths: Vec::new(),
        };
        let parsed = syn::parse_file(text).unwrap_or_else(|e| panic!("{file}: {e}"));
        source.visit_file(&parsed);
        source
    }

    fn import(&mut self, tree: &UseTree, mut path: Names, passed_on: bool) {
        let (name, local, at) = match tree {
            UseTree::Path(one) => {
                path.push(one.ident.to_string());
                return self.import(&one.tree, path, passed_on);
            }
            UseTree::Group(all) => {
                let each = all.items.iter();
                return each.for_each(|tree| self.import(tree, path.clone(), passed_on));
            }
            UseTree::Name(one) => (
                one.ident.to_string(),
                one.ident.to_string(),
                one.ident.span(),
            ),
            UseTree::Rename(one) => (
                one.ident.to_string(),
                one.rename.to_string(),
                one.ident.span(),
            ),
            UseTree::Glob(one) => (String::new(), String::new(), one.star_token.spans[0]),
        };
        if !["self", ""].contains(&name.as_str()) || path.is_empty() {
            path.push(name);
        }
        let same = local == "self";
        self.imports.push(Import {
            local: if same {
                path[path.len() - 1].clone()
            } else {
                local
            },
            path,
            line: at.start().line,
            passed_on,
        });
    }
}

impl Visit<'_> for Source {
    fn visit_item_mod(&mut self, item: &ItemMod) {
        let test = |a: &Attribute| {
            a.path().is_ident("cfg") && a.parse_args::<Ident>().is_ok_and(|i| i == "test")
        };
        if item.attrs.iter().any(test) {
            return;
        }
        if item.content.is_none() {
            self.children.push(item.ident.to_string());
        }
        visit::visit_item_mod(self, item);
    }

    fn visit_item_use(&mut self, item: &ItemUse) {
        self.import(
            &item.tree,
            Names::new(),
            !matches!(item.vis, Visibility::Inherited),
        );
    }

    /// `pub(in crate::room)` uses nothing.
    fn visit_visibility(&mut self, _: &Visibility) {}

    fn visit_path(&mut self, path: &syn::Path) {
        let names = path.segments.iter().map(|s| s.ident.to_string()).collect();
        self.paths
            .push((names, path.segments[0].ident.span().start().line));
        visit::visit_path(self, path);
    }

    /// Arguments such as those of `format!`; the tokens of other macros are not read.
    fn visit_macro(&mut self, item: &Macro) {
        let arguments = item.parse_body_with(Punctuated::<Expr, Token![,]>::parse_terminated);
        arguments.iter().flatten().for_each(|e| self.visit_expr(e));
    }
}

/// The module that a file below the root of its package is.
fn module(file: &str) -> Names {
    let names = file.trim_end_matches(".rs").split('/');
    let mut names: Names = names.map(str::to_owned).collect();
    names.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
    names
}

/// The module in which `path`, named in `from`, ends; nothing for what lies outside of the package.
fn target(
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
fn arrows(modules: &BTreeMap<Names, Source>) -> BTreeMap<(&Names, Names), usize> {
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

/// Whether a file of the room `from` may not use one of the room `to`; the crate root is no room, and no file uses it.
fn denied(package: &str, from: &str, to: &str) -> bool {
    let order = ORDERS
        .iter()
        .find(|o| o.0 == package)
        .map_or(&[][..], |o| o.1);
    let place = |room: &str| order.iter().position(|r| *r == room);
    let reserved = RESERVED.iter().find(|r| (r.0, r.1) == (package, to));
    let kept = reserved.is_some_and(|r| from != to && !r.2.contains(&from));
    !order.is_empty() && (kept || place(to).is_none() || place(from) < place(to))
}

/// What is wrong in the files (path below the package, text) of a package; each with file and line.
fn violations(package: &str, files: &[(String, String)]) -> Vec<String> {
    let modules: BTreeMap<Names, Source> = files
        .iter()
        .map(|(file, text)| (module(file), Source::read(file, text)))
        .collect();
    let arrows = arrows(&modules);
    let mut wrong = Vec::new();
    for ((from, to), line) in &arrows {
        let place = format!("{package}/{}:{line}", modules[*from].file);
        let used = &modules[to].file;
        let room = |module: &Names| module.first().cloned().unwrap_or_default();
        if !from.is_empty() && denied(package, &room(from), &room(to)) {
            wrong.push(format!("{place} uses {used}, which {} may not", room(from)));
        }
        let back = modules
            .get_key_value(to)
            .and_then(|(to, _)| arrows.get(&(to, (*from).clone())));
        if let Some(back) = back.filter(|_| *from < to) {
            wrong.push(format!(
                "{place} uses {used}, and {package}/{used}:{back} uses it"
            ));
        }
    }
    wrong
}

/// The sources below a folder, by their path from it.
fn sources(folder: &Path) -> Vec<(String, String)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        let entries =
            std::fs::read_dir(&next).unwrap_or_else(|e| panic!("{}: {e}", next.display()));
        for path in entries.map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|x| x == "rs") {
                let text = std::fs::read_to_string(&path).expect("a source");
                let name = path.strip_prefix(folder).expect("below").to_string_lossy();
                files.push((name.replace('\\', "/"), text));
            }
        }
    }
    files
}

/// Each package and program in the folders of [`PACKAGES`].
fn packages() -> Vec<(String, Vec<(String, String)>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = Vec::new();
    for package in PACKAGES {
        let files = sources(&root.join(package));
        let programs = files.iter().filter_map(|(file, _)| {
            file.strip_suffix("/main.rs")
                .or(file.strip_suffix("/lib.rs"))
        });
        for program in programs {
            let own = files.iter().filter_map(|(file, text)| {
                let file = file.strip_prefix(program)?.strip_prefix('/')?;
                Some((file.to_owned(), text.clone()))
            });
            found.push((format!("{package}/{program}"), own.collect()));
        }
        let is_root = |(file, _): &(String, String)| ["lib.rs", "main.rs"].contains(&file.as_str());
        if files.iter().any(is_root) {
            found.push((package.to_owned(), files));
        }
    }
    found
}

#[test]
fn every_room_uses_only_the_rooms_before_it() {
    let packages = packages();
    assert!(packages.len() > 8, "{} packages", packages.len());
    let wrong: Vec<String> = packages
        .iter()
        .flat_map(|(package, files)| violations(package, files))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_core_has_its_modules_in_rooms() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src");
    let files = sources(&root);
    let top: Vec<_> = files
        .iter()
        .map(|f| &f.0)
        .filter(|f| !f.contains('/'))
        .collect();
    assert!(top.len() <= 3, "{top:?}");
}

/// Violations in a core that consists of these files.
fn in_core(files: &[(&str, &str)]) -> Vec<String> {
    let files: Vec<_> = files
        .iter()
        .map(|(f, t)| ((*f).to_owned(), (*t).to_owned()))
        .collect();
    violations("src", &files)
}

const LIB: (&str, &str) = (
    "lib.rs",
    "mod math; mod model; mod servo; mod trends;\npub use servo::Loop;",
);

#[test]
fn a_use_against_the_order_is_named_with_file_and_line() {
    let servo = ("servo/mod.rs", "pub struct Loop;");
    let through = [
        "//! A header.\nuse crate::servo::Loop;",
        "\nuse crate::{\n    Loop as Other,\n};",
        "\nuse super::servo::{self, Loop};",
        "\nfn f() -> crate::servo::Loop { todo!() }",
        "\nfn f() { format!(\"{}\", crate::Loop::new()); }",
    ];
    for (text, line) in through.into_iter().zip([2, 3, 2, 2, 2]) {
        let wrong = in_core(&[LIB, servo, ("trends/mod.rs", text)]);
        let expected = format!("src/trends/mod.rs:{line} uses servo/mod.rs, which trends may not");
        assert_eq!(wrong, [expected], "{text}");
    }
    for text in [
        "// use crate::servo::Loop;",
        "const TEXT: &str = \"use crate::servo::Loop;\";",
        "#[cfg(test)]\nmod tests { use crate::servo::Loop; }",
        "use std::servo::Loop;",
    ] {
        assert!(
            in_core(&[LIB, servo, ("trends/mod.rs", text)]).is_empty(),
            "{text}"
        );
    }
}

#[test]
fn two_files_that_import_each_other_are_named() {
    let model = ("model/mod.rs", "mod a; mod b;\npub use a::A;");
    let a = (
        "model/a.rs",
        "use crate::{model::{b::{B, C}}};\npub struct A;",
    );
    let b = ("model/b.rs", "\n\nuse super::A;\npub struct B;");
    let expected = "src/model/a.rs:1 uses model/b.rs, and src/model/b.rs:3 uses it";
    assert_eq!(in_core(&[LIB, model, a, b]), [expected]);
    let child = ("model/a.rs", "use super::M;\npub struct A;");
    for parent in [
        "mod a;\npub struct M;\nfn f() { a::g() }",
        "mod a;\npub use a::A;\npub struct M(A);",
    ] {
        let line = parent.lines().count();
        let expected =
            format!("src/model/mod.rs:{line} uses model/a.rs, and src/model/a.rs:1 uses it");
        assert_eq!(in_core(&[LIB, ("model/mod.rs", parent), child]), [expected]);
    }
    // What is only passed on is not used.
    let parent = ("model/mod.rs", "mod a;\npub use a::A;\npub struct M;");
    assert!(in_core(&[LIB, parent, child]).is_empty());
}

#[test]
fn a_module_without_a_room_and_a_reserved_room_are_named() {
    let math = ("math/mod.rs", "pub fn sqrt() {}");
    let heap = ("heap.rs", "pub fn f() {}");
    let model = ("model/mod.rs", "use crate::heap::f;");
    assert_eq!(
        in_core(&[LIB, math, heap, model]),
        ["src/model/mod.rs:1 uses heap.rs, which model may not"]
    );
    let heap = ("heap.rs", "use crate::math::sqrt;");
    assert_eq!(
        in_core(&[LIB, math, heap]),
        ["src/heap.rs:1 uses math/mod.rs, which heap may not"]
    );
    let hardware = ("hardware/mod.rs", "pub trait Valve {}");
    let model = ("model/mod.rs", "use crate::hardware::Valve;");
    assert_eq!(
        in_core(&[LIB, hardware, model]),
        ["src/model/mod.rs:1 uses hardware/mod.rs, which model may not"]
    );
}
