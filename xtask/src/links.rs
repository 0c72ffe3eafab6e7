//! Links between pages, and the pages that comments and commands name: each must lead somewhere.
//!
//! `cargo test -p xtask links` checks them. Addresses elsewhere on the net are left alone.
#![cfg(test)]

use std::fs;
use std::path::{Path, PathBuf};

use crate::run::root;

/// Folders that hold nothing written here.
const FOREIGN: [&str; 4] = ["target", ".git", "corpus", "artifacts"];

/// Files below `folder` whose name ends in `extension`.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder that can be read") {
        let path = entry.expect("an entry that can be read").path();
        let name = path.file_name().and_then(|name| name.to_str());
        if path.is_dir() {
            if name.is_some_and(|name| !FOREIGN.contains(&name)) {
                found.extend(files(&path, extension));
            }
        } else if path.extension().is_some_and(|end| end == extension) {
            found.push(path);
        }
    }
    found
}

/// Lines of a page with their numbers from 1, without blocks of code.
fn prose(page: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_code = false;
    page.lines().enumerate().filter_map(move |(index, line)| {
        let fence = line.trim_start().starts_with("```");
        in_code ^= fence;
        (!in_code && !fence).then_some((index + 1, line))
    })
}

/// Targets of the links in a line: what stands in brackets behind `](`, but not within backticks.
fn targets(line: &str) -> Vec<&str> {
    line.match_indices("](")
        .filter(|&(start, _)| line[..start].matches('`').count().is_multiple_of(2))
        .filter_map(|(start, mark)| line[start + mark.len()..].split(')').next())
        .collect()
}

/// The name by which a heading is linked to: lower case, words joined by hyphens.
fn anchor(heading: &str) -> String {
    heading
        .trim_start_matches('#')
        .trim()
        .to_lowercase()
        .chars()
        .filter_map(|letter| match letter {
            ' ' => Some('-'),
            '-' | '_' => Some(letter),
            _ => letter.is_alphanumeric().then_some(letter),
        })
        .collect()
}

/// Whether the page at `path` has a heading that `name` links to.
fn has_anchor(path: &Path, name: &str) -> bool {
    let page = fs::read_to_string(path).unwrap_or_default();
    prose(&page).any(|(_, line)| line.starts_with('#') && anchor(line) == name)
}

/// What is wrong with a link on the page at `from`, if anything.
fn fault(from: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (file, name) = target.split_once('#').unwrap_or((target, ""));
    let to = if file.is_empty() {
        from.to_owned()
    } else {
        from.parent().unwrap_or(from).join(file)
    };
    if !to.exists() {
        return Some(format!("there is no {}", to.display()));
    }
    (!name.is_empty() && !has_anchor(&to, name))
        .then(|| format!("{} has no heading #{name}", to.display()))
}

/// Pages and models of `docs/` that a line names by their path from the root.
fn named_pages(line: &str) -> Vec<&str> {
    line.match_indices("docs/")
        .filter(|&(start, _)| !line[..start].ends_with(|letter: char| letter.is_alphanumeric()))
        .map(|(start, _)| {
            let rest = &line[start..];
            let end = rest
                .find(|letter: char| !letter.is_ascii_alphanumeric() && !"-_./".contains(letter));
            rest[..end.unwrap_or(rest.len())].trim_end_matches('.')
        })
        .filter(|page| page.ends_with(".md") || page.ends_with(".json"))
        .collect()
}

#[test]
fn every_relative_link_leads_to_a_file_and_a_heading() {
    let mut links = 0;
    let mut faults = Vec::new();
    for path in files(&root(), "md") {
        let page = fs::read_to_string(&path).expect("a page of text");
        for (number, line) in prose(&page) {
            for target in targets(line) {
                links += 1;
                if let Some(fault) = fault(&path, target) {
                    faults.push(format!("{}:{number}: {fault}", path.display()));
                }
            }
        }
    }
    assert!(
        links > 0,
        "no link found at all: is {} the root?",
        root().display()
    );
    assert!(
        faults.is_empty(),
        "repair these links:\n{}",
        faults.join("\n")
    );
}

#[test]
fn every_page_that_source_or_page_names_exists() {
    let mut pages = 0;
    let mut faults = Vec::new();
    for path in files(&root(), "rs").into_iter().chain(files(&root(), "md")) {
        // The examples of what is looked for, below.
        if path.ends_with("xtask/src/links.rs") {
            continue;
        }
        let text = fs::read_to_string(&path).expect("a file of text");
        for (index, line) in text.lines().enumerate() {
            for page in named_pages(line) {
                pages += 1;
                if !root().join(page).exists() {
                    faults.push(format!(
                        "{}:{}: there is no {page}",
                        path.display(),
                        index + 1
                    ));
                }
            }
        }
    }
    assert!(
        pages > 0,
        "no page named at all: is {} the root?",
        root().display()
    );
    assert!(
        faults.is_empty(),
        "repair these names:\n{}",
        faults.join("\n")
    );
}

#[test]
fn broken_links_are_seen() {
    let readme = root().join("README.md");
    assert_eq!(fault(&readme, "https://example.org/nothing#here"), None);
    assert_eq!(fault(&readme, "LICENSE-MIT"), None);
    assert!(fault(&readme, "LICENSE-NONE").is_some_and(|fault| fault.contains("LICENSE-NONE")));
    assert!(fault(&readme, "README.md#no-such-heading").is_some());
    assert_eq!(
        targets("[a](b.md#c), ![d](e.png) and `[f](g)`"),
        ["b.md#c", "e.png"]
    );
    assert_eq!(
        anchor("## The models' Allan deviation, 2^20"),
        "the-models-allan-deviation-220"
    );
    assert_eq!(
        named_pages("/// file (docs/reference/model-file.md)."),
        ["docs/reference/model-file.md"]
    );
    assert!(named_pages("https://docs.rs/x").is_empty());
}
