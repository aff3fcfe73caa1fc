//! What a file imports and names, as far as the arrows between modules need it.

use proc_macro2::Ident;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, ItemMod, ItemUse, Macro, Token, UseTree, Visibility};

/// Path of a module, and name of what it holds at the end.
pub(crate) type Names = Vec<String>;

/// What a `use` brings into a file.
pub(crate) struct Import {
    pub(crate) path: Names,
    /// Name in the file; empty for `*`.
    pub(crate) local: String,
    pub(crate) line: usize,
    /// `pub use`: the file passes it on and need not use it.
    pub(crate) passed_on: bool,
}

/// One file: its path, and what is read from it.
pub(crate) struct Source {
    pub(crate) file: String,
    /// Modules declared with `mod name;`.
    pub(crate) children: Names,
    pub(crate) imports: Vec<Import>,
    /// Paths in the code, with their line.
    pub(crate) paths: Vec<(Names, usize)>,
}

impl Source {
    pub(crate) fn read(file: &str, text: &str) -> Self {
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
