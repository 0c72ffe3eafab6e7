//! What is kept of an answer.

use std::fs;
use std::io;
use std::path::Path;

use serde_json::Value;

/// Records whose views are kept: a line, gaps and steps, three axes. Those of all would be ten
/// times as large as the rest, and every view is made of every record in the same way.
const WITH_VIEWS: [&str; 3] = ["hum-1", "steps-5-gaps", "axes-clean-markov-hum"];

/// Points of a view that are kept; more of a smooth curve show nothing else.
const POINTS: usize = 16;

/// The answer in a file, as far as it is frozen.
///
/// # Errors
/// If the file cannot be read or is no JSON.
pub fn read(name: &str, path: &Path) -> io::Result<Value> {
    let say =
        |error: &dyn std::fmt::Display| io::Error::other(format!("{}: {error}", path.display()));
    let text = fs::read_to_string(path).map_err(|error| say(&error))?;
    let mut answer: Value = serde_json::from_str(&text).map_err(|error| say(&error))?;
    let axes = answer["axes"].as_array_mut().into_iter().flatten();
    for axis in axes.filter_map(Value::as_object_mut) {
        if !WITH_VIEWS.contains(&name) {
            axis.remove("views");
        } else if let Some(views) = axis.get_mut("views").and_then(Value::as_object_mut) {
            views.values_mut().for_each(thin);
        }
    }
    Ok(answer)
}

/// Every so many of the points of a list, the first among them.
fn thin(view: &mut Value) {
    if let Some(points) = view.as_array_mut() {
        let every = points.len().div_ceil(POINTS).max(1);
        let thinned = points.iter().step_by(every).cloned().collect();
        *points = thinned;
    }
}
