//! What an effect is called is said once, in the catalogue: whoever knows effects compares their kinds.
//!
//! A name written out where effects are looked for or shown is a rule that nobody finds when an effect
//! is added or renamed.

use std::collections::{BTreeMap, BTreeSet};

use crate::layers::lexer::{content, tokens_with_strings, without_tests};
use crate::layers::tree::{is_in, module};

/// Modules that know effects by their kinds alone.
const BY_KIND: [&str; 2] = ["host::diagnosis", "host::report"];

/// Where the effects are listed.
const CATALOGUE: &str = "host::model::catalogue";

/// A name that may be written out in a module.
struct Allowed {
    module: &'static str,
    name: &'static str,
    /// Why, in a clause.
    why: &'static str,
}

/// Empty is the aim.
const ALLOWED: [Allowed; 0] = [];

/// The tokens of every module of a crate, string literals among them, tests left out.
struct Sources<'t>(BTreeMap<String, Vec<&'t str>>);

impl<'t> Sources<'t> {
    /// Of the files of the crate `name`, by path and text.
    fn of(name: &str, files: impl IntoIterator<Item = (&'t str, &'t str)>) -> Self {
        let (mut read, mut tests) = (BTreeMap::new(), BTreeSet::new());
        for (path, text) in files {
            let module = module(name, path);
            let (tokens, test_files) = without_tests(&tokens_with_strings(text));
            tests.extend(test_files.iter().map(|file| format!("{module}::{file}")));
            read.insert(module, tokens);
        }
        read.retain(|module, _| !tests.iter().any(|test| is_in(module, test)));
        Self(read)
    }

    /// The names of all effects that the catalogue lists, or the first that has none.
    fn names(&self) -> Result<BTreeSet<&'t str>, String> {
        let listed = self.0.get(CATALOGUE).ok_or("no catalogue")?;
        let entries = listed
            .windows(3)
            .filter(|three| three[1..] == ["::", "KIND"]);
        let name = |entry: &[&str]| {
            let file = format!("host::model::{}", entry[0]);
            let tokens = self.0.get(&file);
            let said = tokens.and_then(|tokens| said_name(tokens));
            said.ok_or_else(|| format!("{file} does not say its effect's name"))
        };
        entries.map(name).collect()
    }

    /// Every one of `names` that a module which knows kinds alone writes out, a line each, and entries of
    /// the list that speak of nothing.
    fn complaints(&self, names: &BTreeSet<&str>, allowed: &[Allowed]) -> Vec<String> {
        let mut used = vec![false; allowed.len()];
        let mut lines = Vec::new();
        let by_kind = self
            .0
            .iter()
            .filter(|(module, _)| BY_KIND.iter().any(|room| is_in(module, room)));
        for (module, tokens) in by_kind {
            let strings = tokens.iter().filter_map(|token| content(token));
            for name in strings.filter(|string| names.contains(string)) {
                let entry = allowed
                    .iter()
                    .position(|one| one.module == module && one.name == name);
                match entry {
                    Some(entry) => used[entry] = true,
                    None => lines.push(format!(
                        "{module} writes out \"{name}\": compare with the KIND of its file in host/src/model"
                    )),
                }
            }
        }
        let idle = allowed.iter().zip(used).filter(|(_, used)| !used);
        lines.extend(idle.map(|(one, _)| {
            format!(
                "{} does not write out \"{}\" any longer ({}): take it out of ALLOWED",
                one.module, one.name, one.why
            )
        }));
        lines
    }
}

/// The name that the file of an effect gives it.
fn said_name<'t>(tokens: &[&'t str]) -> Option<&'t str> {
    const BEFORE: [&str; 12] = [
        "fn", "name", "(", "&", "self", ")", "-", ">", "&", "static", "str", "{",
    ];
    let at = tokens
        .windows(BEFORE.len())
        .position(|some| some == BEFORE)?;
    let [said, "}", ..] = tokens[at + BEFORE.len()..] else {
        return None;
    };
    content(said)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layers::tree::sources;
    use crate::run::root;

    #[test]
    fn no_effect_is_told_by_its_name_where_kinds_are_compared() {
        let files = sources(&root().join("host").join("src")).expect("readable sources");
        let files = files
            .iter()
            .map(|(path, text)| (path.as_str(), text.as_str()));
        let sources = Sources::of("host", files);
        for room in BY_KIND {
            assert!(sources.0.contains_key(room), "no {room}");
        }
        let names = sources
            .names()
            .unwrap_or_else(|missing| panic!("{missing}"));
        let lines = sources.complaints(&names, &ALLOWED);
        assert!(lines.is_empty(), "\n{}\n", lines.join("\n"));
    }

    /// What is said of a crate of one effect, `hiss`, whose diagnosis has this text.
    fn said(text: &str, allowed: &[Allowed]) -> Vec<String> {
        let files = [
            (
                "model/catalogue.rs",
                "pub static CATALOGUE: &[Kind] = &[hiss::KIND];",
            ),
            (
                "model/hiss.rs",
                "impl Effect for Hiss { fn name(&self) -> &'static str { \"hiss\" } }",
            ),
            (
                "diagnosis/mod.rs",
                "pub mod search; #[cfg(test)] mod trial;",
            ),
            ("diagnosis/search.rs", text),
            ("diagnosis/trial.rs", "const HISS: &str = \"hiss\";"),
            ("simulate.rs", "const HISS: &str = \"hiss\";"),
        ];
        let sources = Sources::of("host", files);
        let names = sources.names().expect("a name");
        assert_eq!(names, BTreeSet::from(["hiss"]));
        sources.complaints(&names, allowed)
    }

    #[test]
    fn a_name_that_is_written_out_is_found_however_it_is_written() {
        for text in [
            "fn f(kind: Kind) -> bool { kind.name() == \"hiss\" }",
            "const A: &[&str] = &[\"other\", r\"hiss\"];",
            "fn f(name: &str) -> bool { matches!(name, r#\"hiss\"#) }",
        ] {
            let lines = said(text, &[]);
            assert_eq!(lines.len(), 1, "{text}: {lines:?}");
            assert!(
                lines[0].starts_with("host::diagnosis::search writes out \"hiss\""),
                "{lines:?}"
            );
        }
    }

    #[test]
    fn comments_tests_and_other_words_name_no_effect() {
        for text in [
            "// \"hiss\"\n/* \"hiss\" */ fn hiss() {}",
            "#[cfg(test)] mod tests { const A: &str = \"hiss\"; }",
            "#[cfg(test)] const A: &str = \"hiss\";",
            // Tests that remarks come of, and words of a sentence.
            "const A: [&str; 3] = [\"lines\", \"steadiness\", \"a hiss\"];",
            "const A: &str = hiss::KIND.name(); const B: char = '\"'; fn hiss() {}",
        ] {
            assert_eq!(said(text, &[]), [""; 0], "{text}");
        }
    }

    #[test]
    fn a_place_that_is_allowed_is_passed_over_and_missed_once_it_is_gone() {
        let allowed = [Allowed {
            module: "host::diagnosis::search",
            name: "hiss",
            why: "for now",
        }];
        assert_eq!(said("const A: &str = \"hiss\";", &allowed), [""; 0]);
        assert_eq!(
            said("", &allowed),
            [
                "host::diagnosis::search does not write out \"hiss\" any longer (for now): take it out of ALLOWED"
            ]
        );
    }

    #[test]
    fn an_effect_that_does_not_say_its_name_is_missed() {
        let files = [
            (
                "model/catalogue.rs",
                "static CATALOGUE: &[Kind] = &[hiss::KIND];",
            ),
            ("model/hiss.rs", "const NAME: &str = \"hiss\";"),
        ];
        assert_eq!(
            Sources::of("host", files).names(),
            Err("host::model::hiss does not say its effect's name".to_owned())
        );
    }
}
