//! What was hidden in a virtual board, next to what was found.

use std::fmt::Write;

use crate::diagnosis::result::finding::{Diagnosis, Finding};
use crate::numeric::written::{estimated, significant};
use crate::virtual_board::Hidden;

/// What was hidden and what was found, with a newline at the end.
pub fn render(hidden: &Hidden, diagnosis: &Diagnosis) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_text(&mut text, hidden, diagnosis);
    text
}

/// The diagnosis of the axis alone that something was hidden in.
pub fn axis(hidden: &Hidden, diagnosis: &Diagnosis) -> Diagnosis {
    let axes = diagnosis.axes.get(hidden.axis).cloned();
    Diagnosis {
        axes: axes.into_iter().collect(),
        correlation: None,
        ..diagnosis.clone()
    }
}

fn write_text(text: &mut String, hidden: &Hidden, diagnosis: &Diagnosis) -> std::fmt::Result {
    let name = hidden.effect.kind();
    let axis = diagnosis.axes.get(hidden.axis);
    let found = axis.and_then(|axis| axis.findings.iter().find(|one| one.effect == name));
    writeln!(
        text,
        "Hidden in axis {}, unknown to the diagnosis: {name}.",
        axis.map_or("", |axis| axis.name.as_str())
    )?;
    match found {
        Some(found) => parameters(text, hidden, found)?,
        None => writeln!(text, "Not found.")?,
    }
    let others: Vec<String> = diagnosis
        .axes
        .iter()
        .enumerate()
        .flat_map(|(number, axis)| axis.findings.iter().map(move |one| (number, axis, one)))
        .filter(|(number, _, one)| *number != hidden.axis || one.effect != name)
        .map(|(_, axis, one)| format!("{} in axis {}", one.effect, axis.name))
        .collect();
    if others.is_empty() {
        writeln!(text, "Nothing else was found.")
    } else {
        writeln!(text, "Found without being there: {}.", others.join(", "))
    }
}

fn parameters(text: &mut String, hidden: &Hidden, found: &Finding) -> std::fmt::Result {
    writeln!(text, "  {:<14} {:>12} {:>12}   95 %", "", "hidden", "found")?;
    let names = hidden.effect.parameters();
    let known = found.estimate.named();
    for (parameter, truth) in names.iter().zip(hidden.effect.values()) {
        let name = parameter.name.as_ref();
        let found = known.get(name);
        let ends = found.and_then(|found| Some((found.value, found.lo?, found.hi?)));
        let (value, interval) = match (found, ends) {
            (_, Some((value, lo, hi))) => {
                let [value, lo, hi] = estimated(value, lo, hi);
                (value, format!("{lo} to {hi}"))
            }
            (Some(found), None) => (significant(found.value, 6), String::new()),
            (None, None) => ("not found".to_owned(), String::new()),
        };
        writeln!(
            text,
            "  {name:<14} {:>12} {value:>12}   {interval}",
            significant(*truth, 8)
        )?;
    }
    Ok(())
}
