use super::*;

fn mutant(source: &str, genre: &str, what: &str, replacement: &str) -> Mutant {
    let start = source.find(what).expect("what is replaced");
    Mutant {
        name: String::new(),
        file: String::new(),
        genre: genre.to_owned(),
        range: start..start + what.len(),
        replacement: replacement.to_owned(),
    }
}

fn switched(source: &str, mutants: &[Mutant]) -> Switched {
    let numbered: Vec<(u32, &Mutant)> = (1..).zip(mutants).collect();
    let found = switch(source, &numbered).expect("a source");
    syn::parse_file(&found.text).unwrap_or_else(|error| panic!("{error}: {}", found.text));
    found
}

#[test]
fn an_expression_has_its_alternatives_and_those_of_its_parts() {
    let source = "fn f(a: f32) -> f32 { a + 2.0 * a }";
    let mutants = [
        mutant(source, "BinaryOperator", "+", "-"),
        mutant(source, "BinaryOperator", "*", "+"),
        mutant(source, "BinaryOperator", "+", "*"),
    ];
    let found = switched(source, &mutants);
    assert_eq!(
        found.text,
        "fn f(a: f32) -> f32 { (if crate::switched::is(1) { a - 2.0 * a } \
         else if crate::switched::is(3) { a * 2.0 * a } \
         else { a + (if crate::switched::is(2) { 2.0 + a } else { 2.0 * a }) }) }"
    );
    assert!(found.left.is_empty());
    let (number, place) = found.places[2].clone();
    assert_eq!((number, &found.text[place]), (2, "2.0 + a"));
}

#[test]
fn a_body_returns_in_the_innermost_function() {
    let source = "fn f() -> u8 { fn g() -> u8 { 7 } g() }";
    let mut inner = mutant(source, "FnValue", "7", "1");
    let outer = mutant(source, "FnValue", "fn g() -> u8 { 7 } g()", "0");
    let found = switched(source, &[inner.clone(), outer]);
    assert_eq!(
        found.text,
        "fn f() -> u8 { if crate::switched::is(2) { return 0; } \
         fn g() -> u8 { if crate::switched::is(1) { return 1; } 7 } g() }"
    );
    inner.range = 0..0;
    assert_eq!(switched(source, &[inner]).left, [1]);
}

#[test]
fn arms_guards_fields_and_signs() {
    let source = "fn f() -> A { match x { 1 => -a, 2 if c || d => b, _ => A { b: 1, ..c } } }";
    let found = switched(
        source,
        &[
            mutant(source, "MatchArm", "1 => -a,", ""),
            mutant(source, "MatchArm", "2 if c || d => b,", ""),
            mutant(source, "MatchArmGuard", "c || d", "true"),
            mutant(source, "UnaryOperator", "-a", ""),
            mutant(source, "StructField", "b: 1", ""),
        ],
    );
    assert_eq!(
        found.text,
        "fn f() -> A { match x { 1 if !crate::switched::is(1) => \
         (if crate::switched::is(4) { a } else { -a }), \
         2 if (if crate::switched::is(2) { false } else if crate::switched::is(3) { true } \
         else { c || d }) => b, \
         _ => (if crate::switched::is(5) { A { ..c } } else { A { b: 1, ..c } }) } }"
    );
}

#[test]
fn a_condition_with_let_has_no_other_operator() {
    let source = "fn f() { if let Some(a) = b && a > 1 { g() } }";
    let mutants = [
        mutant(source, "BinaryOperator", "&&", "||"),
        mutant(source, "BinaryOperator", ">", "<"),
    ];
    let found = switched(source, &mutants);
    assert_eq!(found.left, [1]);
    assert!(found.text.contains("&& (if crate::switched::is(2)"));
}

#[test]
fn what_the_compiler_evaluates_has_no_switch() {
    let source = "const A: f32 = 1.0 / 2.0; static B: u8 = 1 + 2; \
                  impl T for S { const C: u8 = 3 - 1; } trait T { const C: u8 = 6 ^ 4; } \
                  enum E { F = 1 << 4 } \
                  fn f(a: [u8; 8 >> 1]) -> [u8; 3] { \
                  const D: u8 = 7 % 4; g::<{ 9 & 5 }>(const { 5 == 5 }); [a[0] * D; 2 | 1] }";
    let constant = ["/", "+", "-", "^", "<<", ">>", "%", "&", "==", "|"];
    let mut mutants: Vec<Mutant> = constant
        .map(|operator| mutant(source, "BinaryOperator", operator, "*"))
        .into();
    // `->` of a signature is in front of the subtraction.
    mutants[2].range.start = source.find("- 1").expect("the subtraction");
    mutants.push(mutant(source, "BinaryOperator", "* D", "/"));
    let found = switched(source, &mutants);
    assert_eq!(found.left, (1..=10).collect::<Vec<u32>>());
    let [(number, place)] = &found.places[..] else {
        panic!("{:?}", found.places);
    };
    // The value that an array repeats is one of run time.
    assert_eq!((*number, &found.text[place.clone()]), (11, "a[0] / D"));
}
