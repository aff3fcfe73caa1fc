//! The arrows run one way: a room uses only the rooms left of it, and no two files import each
//! other. Files are short, comments narrow, and no struct has many fields.
//!
//! Read from the sources: the `use` lines and the full paths in the code, without tests. A name
//! that a module passes on (`pub use`) counts for the file that defines it.

use std::collections::BTreeMap;
use std::path::Path;

use layering::arrows::{arrows, module};
use layering::packages::{packages, sources};
use layering::shape::{COLUMNS, FIELDS, LINES, crowded, is_long, wide_comments};
use layering::source::{Names, Source};

/// In the folder beside this file.
mod layering {
    pub(crate) mod arrows;
    pub(crate) mod packages;
    pub(crate) mod shape;
    pub(crate) mod source;
}

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
            "batches",
            "instruments",
            "servo",
        ],
    ),
    (
        "host-tests/src",
        &[
            "random",
            "plants",
            "signals",
            "oracles",
            "paper",
            "servo",
            "endurance",
            "users",
        ],
    ),
];

/// Rooms that only these may use, beside the crate root.
const RESERVED: [(&str, &str, &[&str]); 1] = [("src", "hardware", &["servo"])];

/// Whether a file of the room `from` may not use one of the room `to`; the crate root is no room,
/// and no file uses it.
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

/// Structs that are a data sheet: a number per field, none of which belongs to another.
const SHEETS: [&str; 1] = ["AxisParameters"];

#[test]
fn files_are_short_and_comments_narrow_and_structs_have_few_fields() {
    let mut wrong = Vec::new();
    for (package, files) in packages() {
        for (file, text) in files {
            let place = format!("{package}/{file}");
            if is_long(&text) {
                wrong.push(format!("{place} has more than {LINES} lines"));
            }
            for line in wide_comments(&text) {
                wrong.push(format!("{place}:{line} is wider than {COLUMNS}"));
            }
            let many = crowded(&text).into_iter();
            for (line, name) in many.filter(|(_, name)| !SHEETS.contains(&name.as_str())) {
                wrong.push(format!(
                    "{place}:{line} {name} has more than {FIELDS} fields"
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_crowded_struct_is_seen() {
    let fields = |count: usize| -> String {
        let field =
            |k| format!("    /// Not: a field.\n    #[a(b)]\n    pub(crate) x{k}: [f32; 2],\n");
        (0..count).map(field).collect()
    };
    let of = |count| format!("struct A;\npub struct Many<T> {{\n{}}}\n", fields(count));
    assert!(crowded(&of(FIELDS)).is_empty());
    assert_eq!(crowded(&of(FIELDS + 1)), [(2, "Many".to_owned())]);
}

#[test]
fn a_long_file_and_a_wide_comment_are_seen() {
    let (lines, columns) = ("a\n".repeat(LINES), "a".repeat(COLUMNS - 3));
    assert!(!is_long(&lines) && is_long(&format!("{lines}a\n")));
    let text = format!(
        "// {columns}\nlet a = 0;\n/// {columns}\n    // a{columns}\n//! | {columns} |\n\
         /// ```\n/// {columns}\n/// ```\n/// {columns}"
    );
    assert_eq!(wide_comments(&text), [3, 4, 9]);
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
