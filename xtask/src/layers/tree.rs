//! The modules of a crate and what they import from each other, read from the text.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result};

use super::lexer::{tokens, without_tests};

/// Re-exports followed one after the other; more would be a circle of them.
const DEPTH: usize = 8;

/// A name as a path of words.
type Name<'t> = Vec<&'t str>;

/// Modules by their full names, such as `host::model::law`, and who imports whom.
#[derive(Debug, Default)]
pub struct Tree {
    pub modules: BTreeSet<String>,
    pub imports: BTreeSet<(String, String)>,
}

/// Whether `module` is `ancestor` or in it.
pub fn is_in(module: &str, ancestor: &str) -> bool {
    module
        .strip_prefix(ancestor)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
}

/// What a file says of other modules: every path in it, and which of them come from a `use`.
#[derive(Default)]
struct File<'t> {
    paths: Vec<Name<'t>>,
    uses: Vec<Name<'t>>,
}

impl Tree {
    /// Reads the sources of the crate `name` in a folder.
    ///
    /// # Errors
    /// Something there cannot be read.
    pub fn read(name: &str, folder: &Path) -> Result<Self> {
        let files = sources(folder)?;
        let files: Vec<(&str, &str)> = files
            .iter()
            .map(|(path, text)| (path.as_str(), text.as_str()))
            .collect();
        Ok(Self::of(name, &files))
    }

    /// The crate `name` of files, by path and text. A module that is there for tests alone is none.
    pub fn of(name: &str, files: &[(&str, &str)]) -> Self {
        let mut read = BTreeMap::new();
        let mut tests = BTreeSet::new();
        for (path, text) in files {
            let module = module(name, path);
            let tokens = tokens(text);
            let (tokens, test_files) = without_tests(&tokens);
            tests.extend(test_files.iter().map(|file| format!("{module}::{file}")));
            let file: &mut File<'_> = read.entry(module).or_default();
            file.take(&tokens);
        }
        read.retain(|module, _| !tests.iter().any(|test| is_in(module, test)));
        let mut imports = BTreeSet::new();
        for (from, file) in &read {
            for path in file.paths.iter().chain(&file.uses) {
                if let Some(to) = resolve(&read, name, from, path, DEPTH) {
                    imports.insert((from.clone(), to));
                }
            }
        }
        imports.retain(|(from, to)| from != to);
        Self {
            modules: read.into_keys().collect(),
            imports,
        }
    }
}

/// The source files in a folder: their texts, by path.
///
/// # Errors
/// Something there cannot be read.
pub fn sources(folder: &Path) -> Result<BTreeMap<String, String>> {
    let mut files = BTreeMap::new();
    collect(folder, "", &mut files)?;
    Ok(files)
}

fn collect(folder: &Path, prefix: &str, files: &mut BTreeMap<String, String>) -> Result<()> {
    let place = || format!("{}: cannot be read", folder.display());
    for entry in std::fs::read_dir(folder).with_context(place)? {
        let path = entry.with_context(place)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() {
            collect(&path, &format!("{prefix}{name}/"), files)?;
        } else if name.ends_with(".rs") {
            let text = std::fs::read_to_string(&path).with_context(place)?;
            files.insert(format!("{prefix}{name}"), text);
        }
    }
    Ok(())
}

/// Full name of the module in a file.
pub fn module(name: &str, path: &str) -> String {
    let path = path.trim_end_matches(".rs");
    let path = path.strip_suffix("/mod").unwrap_or(path);
    match path {
        "lib" | "main" => name.to_owned(),
        path => format!("{name}::{}", path.replace('/', "::")),
    }
}

impl<'t> File<'t> {
    fn take(&mut self, tokens: &[&'t str]) {
        let mut before = "";
        for (at, &token) in tokens.iter().enumerate() {
            let begins = matches!(token, "crate" | "super" | "self")
                && tokens.get(at + 1) == Some(&"::")
                && before != "::";
            if before == "use" {
                leaves(&tokens[at..], &mut Vec::new(), &mut self.uses);
            } else if begins {
                leaves(&tokens[at..], &mut Vec::new(), &mut self.paths);
            }
            before = token;
        }
    }
}

/// Appends the paths that `tokens` begin with, braces taken apart; how many tokens they take.
fn leaves<'t>(tokens: &[&'t str], prefix: &mut Name<'t>, found: &mut Vec<Name<'t>>) -> usize {
    let depth = prefix.len();
    let mut at = 0;
    loop {
        match tokens.get(at) {
            Some(&"{") => {
                at += 1;
                while let Some(&token) = tokens.get(at).filter(|&&token| token != "}") {
                    // A comma, and what is behind `as`, is no path.
                    at += match token {
                        "," => 1,
                        "as" => 2,
                        _ => leaves(&tokens[at..], prefix, found),
                    };
                }
                at += 1;
                break;
            }
            Some(&word) if is_word(word) => prefix.push(word),
            // A star, or the types of a function.
            _ => {
                found.push(prefix.clone());
                at += 1;
                break;
            }
        }
        at += 1;
        if tokens.get(at) != Some(&"::") {
            found.push(prefix.clone());
            break;
        }
        at += 1;
    }
    prefix.truncate(depth);
    at
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphanumeric() || c == '_')
}

/// The module that `path`, as it stands in the module `from`, leads to: where the name is made, if
/// that is inside the module that it is taken from. `None` outside the crate.
fn resolve(
    files: &BTreeMap<String, File<'_>>,
    root: &str,
    from: &str,
    path: &[&str],
    depth: usize,
) -> Option<String> {
    let parent = |module: &str| {
        module
            .rsplit_once("::")
            .map(|(parent, _)| parent.to_owned())
    };
    let (mut module, mut words) = match path {
        ["crate", words @ ..] => (root.to_owned(), words),
        ["self", words @ ..] => (from.to_owned(), words),
        ["super", words @ ..] => (parent(from)?, words),
        [child, ..] if files.contains_key(&format!("{from}::{child}")) => (from.to_owned(), path),
        _ => return None,
    };
    while let ["super", rest @ ..] = words {
        (module, words) = (parent(&module)?, rest);
    }
    while let [word, rest @ ..] = words {
        let child = format!("{module}::{word}");
        if !files.contains_key(&child) {
            break;
        }
        (module, words) = (child, rest);
    }
    let handed_on = words.first().filter(|_| depth > 0).and_then(|word| {
        let uses = &files.get(&module)?.uses;
        let origin = uses.iter().find(|path| path.last() == Some(word))?;
        resolve(files, root, &module, origin, depth - 1).filter(|origin| is_in(origin, &module))
    });
    Some(handed_on.unwrap_or(module))
}
