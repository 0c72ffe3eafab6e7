//! `cargo xtask docs`: what the README shows of the demonstration, as the program prints it.

use std::fs;

use anyhow::{Context, Result};

use crate::excerpt;
use crate::run::{cargo, output, root, target};

/// Runs `inm demo` and writes the README's block and picture.
///
/// # Errors
/// The demonstration fails, the README has no markers, or a file cannot be written.
pub fn run() -> Result<()> {
    let folder = target().join("docs-demo");
    eprintln!(
        "inm demo into {}: half a minute, and the build",
        folder.display()
    );
    let printed = output(
        cargo(&["run", "--quiet", "--package", "inm-host", "--bin", "inm"])
            .args(["--", "demo", "--output"])
            .arg(&folder),
    )?;
    let block = excerpt::of_output(&printed)
        .context("`inm demo` prints no diagnosis with what was hidden; expected both")?;
    let readme = root().join("README.md");
    let text = fs::read_to_string(&readme).context("README.md: cannot be read")?;
    let [before, _, after] = excerpt::of_readme(&text)
        .context("README.md: no markers `inm demo`; put back the two of xtask/src/excerpt.rs")?;
    fs::write(&readme, [before, &block, after].concat()).context("README.md: cannot be written")?;
    let picture = root().join("docs/images/demo.png");
    fs::copy(folder.join("hidden.png"), &picture)
        .with_context(|| format!("{}: cannot be written", picture.display()))?;
    eprintln!("written: README.md, docs/images/demo.png");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRINTED: &str = "intro\n\nAxis Y: mean 1\n  table\n\nWhat the five terms get wrong, and \
                           why:\n\nfile: 3 samples\n\nAxis X\n  nothing\n\nAxis Y\n  1. hum\n     \
                           R 0\n\nHidden in axis Y, unknown: hum.\n  f_hz 50\nNothing else.\n\n\
                           file\n";

    #[test]
    fn the_block_is_the_axis_with_the_hidden_effect_and_what_was_hidden() {
        assert_eq!(
            excerpt::of_output(PRINTED).as_deref(),
            Some(
                "```text\nAxis Y\n  1. hum\n     R 0\n\nHidden in axis Y, unknown: hum.\n  f_hz \
                 50\nNothing else.\n```\n"
            )
        );
        assert_eq!(excerpt::of_output("nothing of the kind\n"), None);
    }

    #[test]
    fn the_readme_has_both_markers_and_an_excerpt_between_them() {
        let text = fs::read_to_string(root().join("README.md")).expect("a README");
        let [_, block, _] = excerpt::of_readme(&text).expect("both markers");
        assert!(block.starts_with("```text\nAxis "), "{block}");
        assert!(text.contains("docs/images/demo.png"), "no picture of it");
    }
}
