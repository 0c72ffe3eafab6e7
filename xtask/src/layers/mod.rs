//! Which module may import which: the order of the layers, held by a test.
//!
//! ```text
//!   lexer   source as words and signs      tree   who imports whom
//!   rules   what must never be             mod    whether it is so
//! ```

pub mod lexer;
mod rules;
pub mod tree;

use std::collections::{BTreeMap, BTreeSet};

use rules::{Import, Never};
use tree::{Tree, is_in};

/// Crates of which the modules are looked at.
const CRATES: [&str; 6] = [
    "protocol", "allan", "ads1281", "firmware", "emulator", "host",
];

/// What is wrong with a crate, a line each, `known` imports aside: imports that must never be,
/// circles, and entries of the lists that speak of nothing.
fn complaints(tree: &Tree, never: &[Never], known: &[Import]) -> Vec<String> {
    let entries: Vec<&Import> = known.iter().collect();
    let mut lines = wrong(tree, never, &entries);
    let count = lines.len();
    for name in never.iter().flat_map(|one| one.from.iter().chain(one.to)) {
        if !tree.modules.contains(*name) {
            lines.push(format!(
                "no module {name}: put its new name in xtask/src/layers/rules.rs"
            ));
        }
    }
    for (at, entry) in known.iter().enumerate() {
        let mut others = entries.clone();
        others.remove(at);
        if wrong(tree, never, &others).len() == count {
            lines.push(format!(
                "{} -> {} harms no longer ({}): take it out of KNOWN",
                entry.from, entry.to, entry.why
            ));
        }
    }
    lines
}

/// Imports that must never be, and circles.
fn wrong(tree: &Tree, never: &[Never], known: &[&Import]) -> Vec<String> {
    let imports: Vec<&(String, String)> = tree
        .imports
        .iter()
        .filter(|(from, to)| {
            !known
                .iter()
                .any(|entry| is_in(from, entry.from) && is_in(to, entry.to))
        })
        .collect();
    let mut lines = circles(&imports);
    for (from, to) in &imports {
        for rule in never {
            let [is_from, is_to] = [(from, rule.from), (to, rule.to)]
                .map(|(module, names)| names.iter().any(|name| is_in(module, name)));
            if is_from && is_to {
                lines.push(format!("{from} imports {to}: {}", rule.why));
            }
        }
    }
    lines
}

/// The imports that close a circle among the children of one module, each child with all that is in
/// it taken as one.
fn circles(imports: &[&(String, String)]) -> Vec<String> {
    // From sibling to sibling, with an import as an example.
    let mut siblings: BTreeMap<(String, String), &(String, String)> = BTreeMap::new();
    for import in imports {
        if let Some(pair) = apart(&import.0, &import.1) {
            siblings.entry(pair).or_insert(import);
        }
    }
    let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (from, to) in siblings.keys() {
        next.entry(from).or_default().insert(to);
    }
    let reaches = |from: &str, goal: &str| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(module) = open.pop() {
            let new = next.get(module).into_iter().flatten();
            open.extend(new.copied().filter(|&one| seen.insert(one)));
        }
        seen.contains(goal)
    };
    let closing = siblings.iter().filter(|((from, to), _)| reaches(to, from));
    closing
        .map(|((from, to), (example, imported))| {
            format!("circle: {from} -> {to} ({example} imports {imported})")
        })
        .collect()
}

/// The two siblings that two modules are in; `None` where one is inside the other.
fn apart(from: &str, to: &str) -> Option<(String, String)> {
    let [from, to] = [from, to].map(|name| name.split("::").collect::<Vec<_>>());
    let at = from.iter().zip(&to).position(|(from, to)| from != to)?;
    Some((from[..=at].join("::"), to[..=at].join("::")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::root;

    #[test]
    fn no_crate_imports_against_the_order_of_its_layers() {
        let mut all = Tree::default();
        for name in CRATES {
            let tree = Tree::read(name, &root().join(name).join("src")).expect("readable sources");
            assert!(!tree.imports.is_empty(), "{name} imports nothing");
            all.modules.extend(tree.modules);
            all.imports.extend(tree.imports);
        }
        let lines = complaints(&all, &rules::NEVER, &rules::KNOWN);
        assert!(lines.is_empty(), "\n{}\n", lines.join("\n"));
    }

    #[test]
    fn a_crate_depends_on_no_other_than_it_may() {
        for (name, allowed) in rules::DEPENDENCIES {
            let path = root().join(name).join("Cargo.toml");
            let text = std::fs::read_to_string(&path).expect("a manifest");
            let (_, text) = text.split_once("\n[dependencies]").expect("dependencies");
            let text = text.split("\n[").next().unwrap_or_default();
            let ours = |line: &&str| line.contains("inm-") || line.starts_with("ads1281");
            let found: Vec<&str> = text.lines().filter(ours).collect();
            assert_eq!(found, allowed, "{}", path.display());
        }
    }

    const RULE: [Never; 1] = [Never {
        from: &["c::low"],
        to: &["c::high"],
        why: "low is below high",
    }];

    /// What is said of a crate whose module `low` has this text.
    fn said(low: &str, known: &[Import]) -> Vec<String> {
        let files = [
            ("lib.rs", "mod low; mod high; mod other;"),
            ("low/mod.rs", low),
            ("low/inner.rs", "pub struct Inner;"),
            ("high.rs", "pub use crate::other::Thing; pub fn f() {}"),
            ("other.rs", "pub struct Thing;"),
        ];
        complaints(&Tree::of("c", &files), &RULE, known)
    }

    #[test]
    fn a_forbidden_import_is_found_however_it_is_written() {
        for text in [
            "use crate::high::f;",
            "use crate::{other::Thing, high::{self, f}};",
            "use crate::{other::*, high::*};",
            "pub(crate) use super::high;",
            "fn g() { crate::high::f::<u8>('\"', \"}\") }",
            "use crate::high as other;",
        ] {
            let lines = said(text, &[]);
            assert_eq!(
                lines,
                ["c::low imports c::high: low is below high"],
                "{text}"
            );
        }
    }

    #[test]
    fn comments_literals_tests_and_other_crates_import_nothing() {
        for text in [
            "// use crate::high::f;",
            "/* crate::high */ const A: &str = \"crate::high\"; const B: &str = r#\"\"crate::high\"#;",
            "#[cfg(test)] mod tests { use crate::high::f; fn g() { if true {} } } const A: u8 = 0;",
            "#[cfg(test)] use crate::high::f;",
            "use high::f; use serde::high;",
            "use self::inner::Inner; use crate::other::Thing;",
        ] {
            assert_eq!(said(text, &[]), [""; 0], "{text}");
        }
    }

    #[test]
    fn a_circle_is_found_over_modules_of_several_files() {
        let files = [
            ("lib.rs", "mod a; mod b; mod c; pub use a::inner::Inner;"),
            ("a/mod.rs", "mod inner; use crate::b::B;"),
            ("a/inner.rs", "use super::Outer;"),
            ("b.rs", "use crate::c::C;"),
            ("c.rs", "use crate::Inner;"),
        ];
        let lines = complaints(&Tree::of("k", &files), &[], &[]);
        assert_eq!(
            lines,
            [
                "circle: k::a -> k::b (k::a imports k::b)",
                "circle: k::b -> k::c (k::b imports k::c)",
                "circle: k::c -> k::a (k::c imports k::a::inner)",
            ]
        );
    }

    #[test]
    fn an_entry_that_speaks_of_nothing_is_found() {
        let known = |to| Import {
            from: "c::low",
            to,
            why: "for now",
        };
        assert_eq!(said("use super::high::f;", &[known("c::high")]), [""; 0]);
        assert_eq!(
            said("", &[known("c::high")]),
            ["c::low -> c::high harms no longer (for now): take it out of KNOWN"]
        );
        let lines = complaints(&Tree::of("c", &[("low.rs", "")]), &RULE, &[]);
        assert_eq!(
            lines,
            ["no module c::high: put its new name in xtask/src/layers/rules.rs"]
        );
    }
}
