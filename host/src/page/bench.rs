//! What the bench does, which settings the board has, and its last self-test, as HTML.

use inm_protocol::{Filter, Phase as Response, Settings};

use super::parts::{Part, text};
use crate::inspect::self_test::{Check, SelfTest, Verdict, number};
use crate::live::{Phase, Scene};

/// What changes with what the bench does.
pub fn parts(scene: &Scene) -> Vec<Part> {
    let tested = scene.tested.as_deref();
    let tested = tested.map(|tested| ("selftest".to_owned(), self_test(tested)));
    let doing = ("doing".to_owned(), doing(scene));
    std::iter::once(doing).chain(tested).collect()
}

/// What it does, in words for people, and in attributes for the buttons.
fn doing(scene: &Scene) -> String {
    let snapshot = &scene.snapshot;
    let file = snapshot.capture.as_ref().map_or_else(
        || "no file: only the statistics are kept".to_owned(),
        |path| path.display().to_string(),
    );
    let tested = match scene.tested.as_deref() {
        None => "",
        Some(SelfTest { passed: true, .. }) => " The last self-test passed.",
        Some(_) => " The last self-test FAILED.",
    };
    let (state, words) = match snapshot.phase {
        Phase::Starting => ("starting", "The board is being started.".to_owned()),
        Phase::Recording => ("recording", format!("Recording into {file}.")),
        Phase::Resting => (
            "resting",
            format!("Stopped: the board rests. Recorded: {file}.{tested}"),
        ),
        Phase::Testing => (
            "testing",
            "The board tests itself, which takes a quarter of a minute.".to_owned(),
        ),
    };
    let settings = snapshot.settings.map_or_else(String::new, attributes);
    let said = match scene.said.as_str() {
        "" => String::new(),
        said => format!("<p class=\"lost\">{}</p>", text(said)),
    };
    format!(
        "<p data-state=\"{state}\" data-recording=\"{}\"{settings}>{}</p>{said}",
        scene.recording,
        text(&words)
    )
}

/// The settings as the form has them.
fn attributes(settings: Settings) -> String {
    let Filter::Fir { phase, high_pass } = settings.filter else {
        return String::new();
    };
    let phase = match phase {
        Response::Linear => "linear",
        Response::Minimum => "minimum",
    };
    let high_pass = high_pass.map_or(String::new(), |word| word.to_string());
    format!(
        " data-rate=\"{}\" data-phase=\"{phase}\" data-high-pass=\"{high_pass}\"",
        settings.rate.hz()
    )
}

/// Each check with its limits.
fn self_test(tested: &SelfTest) -> String {
    let rows: String = tested.checks.iter().map(row).collect();
    let verdict = if tested.passed {
        "<p class=\"well\">passed</p>"
    } else {
        "<p class=\"lost\">FAILED</p>"
    };
    let heads = ["check", "value", "at least", "at most", "unit"];
    let heads = heads.map(|head| format!("<th scope=\"col\">{head}</th>"));
    format!(
        "<h3>Self-test</h3><p class=\"lead\">board {} on {}</p>{verdict}<div class=\"scroll\"><table><tr>{}<th scope=\"col\" class=\"words\">verdict</th></tr>{rows}</table></div>",
        text(&tested.serial),
        text(&tested.port),
        heads.concat()
    )
}

fn row(check: &Check) -> String {
    let (class, verdict) = match check.verdict {
        Verdict::Ok => ("well", "ok"),
        Verdict::Failed => ("negative", "FAILED"),
        Verdict::Open => ("bound", "open"),
    };
    let value = check.value.map_or("-".to_owned(), number);
    let remark = match check.remark.as_str() {
        "" => String::new(),
        remark => format!(": {}", text(remark)),
    };
    format!(
        "<tr><th scope=\"row\">{} {}</th><td>{value}</td><td>{}</td><td>{}</td><td>{}</td>\
         <td class=\"words {class}\">{verdict}{remark}</td></tr>",
        check.name,
        check.axis.unwrap_or_default(),
        number(check.at_least),
        number(check.at_most),
        text(check.unit)
    )
}
