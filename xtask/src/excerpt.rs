//! The part of `inm demo`'s output that the README shows, and its place there. Also compiled into
//! host/tests/readme.rs, which compares the two.

/// Markers around the block in the README.
const BEGIN: &str = "<!-- inm demo: written by `cargo xtask docs` -->\n";
const END: &str = "<!-- end of inm demo -->\n";

/// The diagnosis of the axis that something was hidden in, and what was hidden: a block between
/// fences. `None` if the output is not that of a demonstration.
pub fn of_output(output: &str) -> Option<String> {
    let (_, diagnosis) = output.split_once("\nWhat the five terms get wrong")?;
    let (diagnosis, reveal) = diagnosis.split_once("\nHidden in axis ")?;
    let (name, _) = reveal.split_once(',')?;
    let (_, axis) = diagnosis.split_once(&format!("\nAxis {name}\n"))?;
    let (axis, _) = axis.split_once("\n\n").unwrap_or((axis.trim_end(), ""));
    let (reveal, _) = reveal.split_once("\n\n")?;
    Some(format!(
        "```text\nAxis {name}\n{axis}\n\nHidden in axis {reveal}\n```\n"
    ))
}

/// Text before, between and after the markers; `None` where one is missing.
pub fn of_readme(readme: &str) -> Option<[&str; 3]> {
    let begin = readme.find(BEGIN)? + BEGIN.len();
    let end = begin + readme[begin..].find(END)?;
    Some([&readme[..begin], &readme[begin..end], &readme[end..]])
}
