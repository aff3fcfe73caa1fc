//! Mutants that stand beside the original in one text, each behind a switch.
//!
//! `a + b` becomes `(if crate::switched::is(7) { a - b } else { a + b })`: one build serves all
//! mutants (Untch, Offutt and Harrold, Mutation analysis using mutant schemata, 1993). The operator
//! of the expression is replaced, not its letter in the text: `*` of `a + b * c` gives `a + (b +
//! c)`.

use std::collections::BTreeMap;
use std::ops::Range;

use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use crate::list::Mutant;

/// A text with switches.
#[derive(Debug, Default)]
pub(crate) struct Switched {
    /// The source.
    pub text: String,
    /// Where the text of a mutant stands in it.
    pub places: Vec<(u32, Range<usize>)>,
    /// Mutants that have no place in this text.
    pub left: Vec<u32>,
}

/// What a node of the syntax becomes.
#[derive(Clone, Debug)]
enum Kind {
    /// The whole has alternatives.
    Choice,
    /// A text in front of the rest: a value that is returned at once, an arm that does not apply.
    Insert,
}

/// A place with its mutants and the text of each.
#[derive(Clone, Debug)]
struct Node {
    range: Range<usize>,
    kind: Kind,
    mutants: Vec<(u32, String)>,
}

/// Puts switches for `mutants`, all of one file, into its text.
pub(crate) fn switch(source: &str, mutants: &[(u32, &Mutant)]) -> Result<Switched, String> {
    let file = syn::parse_file(source).map_err(|error| error.to_string())?;
    let mut finder = Finder {
        source,
        mutants,
        nodes: BTreeMap::new(),
        innermost: BTreeMap::new(),
    };
    finder.visit_file(&file);
    let Finder {
        mut nodes,
        innermost,
        ..
    } = finder;
    for (number, place) in innermost {
        let value = mutants
            .iter()
            .find(|(other, _)| *other == number)
            .map_or("", |(_, mutant)| mutant.replacement.as_str());
        let text = format!(" if crate::switched::is({number}) {{ return {value}; }}");
        add(&mut nodes, place..place, Kind::Insert, number, text);
    }
    let mut nodes: Vec<Node> = nodes.into_values().collect();
    nodes.sort_by_key(|node| (node.range.start, usize::MAX - node.range.end));
    let mut switched = Switched::default();
    render(source, &nodes, 0..source.len(), &mut switched);
    let placed = |number: u32| switched.places.iter().any(|(other, _)| *other == number);
    switched.left = mutants
        .iter()
        .map(|(number, _)| *number)
        .filter(|number| !placed(*number))
        .collect();
    Ok(switched)
}

/// Writes a part of the source; `nodes` are those that may stand in it, in their order.
fn render(source: &str, nodes: &[Node], range: Range<usize>, out: &mut Switched) {
    let mut at = range.start;
    for (k, node) in nodes.iter().enumerate() {
        if node.range.start < at || node.range.end > range.end {
            continue;
        }
        out.text += &source[at..node.range.start];
        at = node.range.end;
        match node.kind {
            Kind::Insert => {
                for (number, text) in &node.mutants {
                    place(out, *number, text);
                }
            }
            Kind::Choice => {
                out.text.push('(');
                for (number, text) in &node.mutants {
                    out.text += &format!("if crate::switched::is({number}) {{ ");
                    place(out, *number, text);
                    out.text += " } else ";
                }
                out.text += "{ ";
                // The original, with the mutants of its parts.
                render(source, &nodes[k + 1..], node.range.clone(), out);
                out.text += " })";
            }
        }
    }
    out.text += &source[at..range.end];
}

fn place(out: &mut Switched, number: u32, text: &str) {
    let begin = out.text.len();
    out.text += text;
    out.places.push((number, begin..out.text.len()));
}

type Nodes = BTreeMap<(usize, usize), Node>;

fn add(nodes: &mut Nodes, range: Range<usize>, kind: Kind, number: u32, text: String) {
    let node = nodes.entry((range.start, range.end)).or_insert(Node {
        range,
        kind,
        mutants: Vec::new(),
    });
    node.mutants.push((number, text));
}

/// Looks for the node of each mutant.
struct Finder<'a> {
    source: &'a str,
    mutants: &'a [(u32, &'a Mutant)],
    nodes: Nodes,
    /// For bodies of functions: behind the brace of the innermost function so far.
    innermost: BTreeMap<u32, usize>,
}

impl Finder<'_> {
    /// The mutants of a kind at a place, with what they put there.
    fn at(&self, genre: &str, range: &Range<usize>) -> Vec<(u32, String)> {
        self.mutants
            .iter()
            .filter(|(_, mutant)| mutant.genre == genre && mutant.range.start == range.start)
            .map(|(number, mutant)| (*number, mutant.replacement.clone()))
            .collect()
    }

    fn choose(&mut self, whole: Range<usize>, number: u32, text: String) {
        add(&mut self.nodes, whole, Kind::Choice, number, text);
    }

    /// A body: what is visited last of those around a mutant is the innermost.
    fn body(&mut self, block: &syn::Block) {
        let range = bytes(block);
        for (number, mutant) in self.mutants {
            let within = range.start <= mutant.range.start && mutant.range.end <= range.end;
            if mutant.genre == "FnValue" && within {
                self.innermost.insert(*number, range.start + 1);
            }
        }
    }
}

/// Whether a condition is a `let`, or has one among its parts.
fn has_let(condition: &syn::Expr) -> bool {
    match condition {
        syn::Expr::Let(_) => true,
        syn::Expr::Binary(node) => {
            matches!(node.op, syn::BinOp::And(_)) && (has_let(&node.left) || has_let(&node.right))
        }
        _ => false,
    }
}

/// The bytes of a node.
fn bytes(node: &impl Spanned) -> Range<usize> {
    let span = node.span();
    let begin = span.byte_range();
    begin.start..begin.end
}

impl<'ast> Visit<'ast> for Finder<'_> {
    // What the compiler evaluates asks no switch at run time: a mutant there could never be on.
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}

    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}

    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}

    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}

    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}

    fn visit_variant(&mut self, _: &'ast syn::Variant) {}

    /// Lengths of arrays and arguments of types.
    fn visit_type(&mut self, _: &'ast syn::Type) {}

    fn visit_angle_bracketed_generic_arguments(
        &mut self,
        _: &'ast syn::AngleBracketedGenericArguments,
    ) {
    }

    fn visit_expr_repeat(&mut self, node: &'ast syn::ExprRepeat) {
        self.visit_expr(&node.expr);
    }

    fn visit_expr_binary(&mut self, node: &'ast syn::ExprBinary) {
        let (whole, left, right) = (bytes(node), bytes(&*node.left), bytes(&*node.right));
        // `||` beside a `let` of a condition is no expression of the language.
        let chain = has_let(&node.left) || has_let(&node.right);
        for (number, operator) in self.at("BinaryOperator", &bytes(&node.op)) {
            if chain {
                continue;
            }
            let [left, right] = [&self.source[left.clone()], &self.source[right.clone()]];
            self.choose(whole.clone(), number, format!("{left} {operator} {right}"));
        }
        visit::visit_expr_binary(self, node);
    }

    fn visit_expr_unary(&mut self, node: &'ast syn::ExprUnary) {
        let (whole, operand) = (bytes(node), bytes(&*node.expr));
        for (number, operator) in self.at("UnaryOperator", &bytes(&node.op)) {
            let operand = &self.source[operand.clone()];
            self.choose(whole.clone(), number, format!("{operator}{operand}"));
        }
        visit::visit_expr_unary(self, node);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        let guard = arm.guard.as_ref().map(|(_, guard)| bytes(&**guard));
        for (number, _) in self.at("MatchArm", &bytes(arm)) {
            if let Some(range) = guard.clone() {
                self.choose(range, number, "false".to_owned());
                continue;
            }
            let place = bytes(&arm.fat_arrow_token).start;
            let text = format!("if !crate::switched::is({number}) ");
            add(&mut self.nodes, place..place, Kind::Insert, number, text);
        }
        if let Some(range) = guard {
            for (number, value) in self.at("MatchArmGuard", &range) {
                self.choose(range.clone(), number, value);
            }
        }
        visit::visit_arm(self, arm);
    }

    fn visit_expr_struct(&mut self, node: &'ast syn::ExprStruct) {
        let whole = bytes(node);
        for (k, field) in node.fields.iter().enumerate() {
            let range = bytes(field);
            let behind = node.fields.iter().nth(k + 1).map(|next| bytes(next).start);
            let behind = behind.or(node.dot2_token.as_ref().map(|dots| bytes(dots).start));
            for (number, _) in self.at("StructField", &range) {
                let behind = behind.unwrap_or(range.end);
                let [before, after] = [
                    &self.source[whole.start..range.start],
                    &self.source[behind..whole.end],
                ];
                self.choose(whole.clone(), number, format!("{before}{after}"));
            }
        }
        visit::visit_expr_struct(self, node);
    }

    fn visit_item_fn(&mut self, node: &'ast syn::ItemFn) {
        self.body(&node.block);
        visit::visit_item_fn(self, node);
    }

    fn visit_impl_item_fn(&mut self, node: &'ast syn::ImplItemFn) {
        self.body(&node.block);
        visit::visit_impl_item_fn(self, node);
    }

    fn visit_trait_item_fn(&mut self, node: &'ast syn::TraitItemFn) {
        if let Some(block) = &node.default {
            self.body(block);
        }
        visit::visit_trait_item_fn(self, node);
    }
}

#[cfg(test)]
mod tests;
