//! `cargo xtask pictures`: `inm live` as the documentation shows it, page and terminal, from the program.
//!
//! The tests of the page know how to drive a browser and a terminal: two of them, which are ignored
//! otherwise, write what they see.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use crate::run::{cargo, root, run, target};

/// The page that shows the terminal.
const PAGE: &str = "docs/how-to/with-the-board.md";

/// Pictures of the page, in docs/images.
const PICTURES: [&str; 3] = ["live-light.png", "live-dark.png", "live-phone.png"];

/// Sizes of the terminal, between markers of their name in [`PAGE`].
const TERMINALS: [&str; 2] = ["live-80x24", "live-120x40"];

/// Has them written, and puts them where they are shown.
///
/// # Errors
/// There is no browser, a picture is not drawn, the page has no markers, or a file cannot be written.
pub fn pictures() -> Result<()> {
    let folder = target().join("docs-pictures");
    fs::create_dir_all(&folder)
        .with_context(|| format!("{}: cannot be created", folder.display()))?;
    run(cargo(&["test", "--package", "inm-host", "--test", "live"])
        .args(["--", "--ignored", "as_the_documentation_shows_it"])
        .env("INM_PICTURES", &folder))?;
    for name in PICTURES {
        let picture = root().join("docs/images").join(name);
        fs::copy(folder.join(name), &picture)
            .with_context(|| format!("{}: cannot be written", picture.display()))?;
    }
    let page = root().join(PAGE);
    let mut text = fs::read_to_string(&page).with_context(|| format!("{PAGE}: cannot be read"))?;
    for name in TERMINALS {
        let shown = read(&folder.join(name).with_extension("txt"))?;
        let [before, _, after] = block(&text, name)
            .with_context(|| format!("{PAGE}: no markers `{name}`; put them back"))?;
        text = format!("{before}```text\n{shown}```\n{after}");
    }
    fs::write(&page, text).with_context(|| format!("{PAGE}: cannot be written"))?;
    eprintln!("written: {PAGE}, docs/images: look at all of them");
    Ok(())
}

fn read(file: &Path) -> Result<String> {
    fs::read_to_string(file).with_context(|| format!("{}: cannot be read", file.display()))
}

/// Text before, between and after the markers of `name`; `None` where one is missing.
fn block<'a>(text: &'a str, name: &str) -> Option<[&'a str; 3]> {
    let begin = format!("<!-- {name}: written by `cargo xtask pictures` -->\n");
    let begin = text.find(&begin)? + begin.len();
    let end = begin + text[begin..].find(&format!("<!-- end of {name} -->\n"))?;
    Some([&text[..begin], &text[begin..end], &text[end..]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_a_place_for_each_terminal_and_the_documentation_each_picture() {
        let text = fs::read_to_string(root().join(PAGE)).expect("the page");
        for name in TERMINALS {
            let [_, shown, _] = block(&text, name).expect(name);
            assert!(
                shown.starts_with("```text\nvirtual -> run1.inmcap"),
                "{shown}"
            );
        }
        assert_eq!(block(&text, "live-1x1"), None);
        for name in PICTURES {
            assert!(text.contains(name), "{name} is shown nowhere");
        }
    }
}
