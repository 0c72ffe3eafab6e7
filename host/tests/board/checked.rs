//! `inm board selftest`.

use inm_host::internals::virtual_board::VirtualConnect;
use serde_json::Value;

use super::pty::PtyBoard;
use super::{inm, json, steady, text};

/// Names and axes of the checks with this verdict.
fn with_verdict(tested: &Value, verdict: &str) -> Vec<String> {
    let checks = tested["checks"].as_array().expect("a list").iter();
    let named = checks.filter(|check| check["verdict"] == verdict);
    named
        .map(|check| {
            let axis = check["axis"].as_str().unwrap_or("");
            format!("{} {axis}", check["name"].as_str().expect("a name"))
        })
        .collect()
}

fn value(tested: &Value, name: &str, axis: &str) -> f64 {
    let mut checks = tested["checks"].as_array().expect("a list").iter();
    let check = checks.find(|check| check["name"] == name && check["axis"] == axis);
    check.expect("it is checked")["value"]
        .as_f64()
        .expect("it was measured")
}

/// Farthest that noise moves a step, g: six deviations of the difference of two means of 64 words at
/// 2000/s, `sqrt(2) N / sqrt(0.032 s)` with the noise density N that was measured in the same run.
fn six_deviations_g(tested: &Value, axis: &str) -> f64 {
    6.0 * (2.0_f64 / 0.032).sqrt() * value(tested, "noise", axis) / 9.806_65
}

/// The virtual board keeps its own time, so that all but the last digits is the same anywhere.
#[test]
fn a_sound_board_passes() {
    let output = inm(&["board", "selftest", "--port", "virtual"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert!(told.ends_with("\npassed\n"), "{told}");
    let tested = json(&["board", "selftest", "--port", "virtual"], 0);
    assert_eq!(tested["passed"], true);
    for (axis, step_g) in [("X", 0.1), ("Y", 0.1), ("Z", 1.0)] {
        let found = value(&tested, "step", axis);
        let noise_g = six_deviations_g(&tested, axis);
        assert!((found - step_g).abs() < noise_g, "{axis}: {found} g");
    }
    steady().bind(|| insta::assert_snapshot!("selftest_as_text", told));
    let mut shape = tested;
    for check in shape["checks"].as_array_mut().expect("a list") {
        check["value"] = Value::from(check["value"].is_number());
    }
    steady().bind(|| {
        insta::assert_snapshot!(
            "selftest_as_json",
            serde_json::to_string_pretty(&shape).expect("JSON")
        );
    });
}

#[test]
fn an_axis_whose_step_is_missing_fails_and_is_named() {
    let board = PtyBoard::start(VirtualConnect {
        self_test_g: [-0.1, 0.0, 1.0],
        ..VirtualConnect::published(1, 1.0)
    });
    let arguments = ["board", "selftest", "--port", &board.port, "--watch", "3"];
    let output = inm(&arguments);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert!(told.ends_with("\nFAILED: step Y\n"), "{told}");
    let tested = json(&arguments, 1);
    assert_eq!(tested["passed"], false);
    assert_eq!(with_verdict(&tested, "failed"), ["step Y"]);
    let found = value(&tested, "step", "Y");
    assert!(found.abs() < six_deviations_g(&tested, "Y"), "{found} g");
}

#[test]
fn an_axis_that_answers_the_wrong_way_fails() {
    let board = PtyBoard::start(VirtualConnect {
        self_test_g: [-0.1, 1.0, -1.0],
        ..VirtualConnect::published(1, 1.0)
    });
    let arguments = ["board", "selftest", "--port", &board.port, "--watch", "3"];
    let tested = json(&arguments, 1);
    assert_eq!(with_verdict(&tested, "failed"), ["step Y", "step Z"]);
}

/// Its clock goes half as fast again, far beyond what a busy machine can feign.
#[test]
fn a_clock_that_goes_wrong_fails() {
    let board = PtyBoard::start(VirtualConnect::published(1, 1.5));
    let arguments = ["board", "selftest", "--port", &board.port, "--watch", "6"];
    let tested = json(&arguments, 1);
    assert_eq!(with_verdict(&tested, "failed"), ["clock "]);
}

/// The crystal of this board is off by what is drawn, and no crystal is off by more.
#[test]
fn the_clock_is_checked_by_a_pulse_a_second_where_there_is_one() {
    let plan = VirtualConnect::published(1, 1.0).with_pulses(1);
    let crystal_ppm = plan.off.crystal_ppm;
    let board = PtyBoard::start(plan);
    let arguments = ["board", "selftest", "--port", &board.port, "--watch", "8"];
    let tested = json(&arguments, 0);
    let mut checks = tested["checks"].as_array().expect("a list").iter();
    let clock = checks.find(|check| check["name"] == "clock");
    let found = clock.expect("it is checked")["value"].as_f64();
    let found = found.expect("it was measured");
    // Eight pulses in seven seconds of 20 us each at most: 3.5 ppm, and eight times that.
    assert!(
        (found - crystal_ppm).abs() < 30.0,
        "{found} ppm of {crystal_ppm}"
    );
    let told = tested.to_string();
    assert!(told.contains("by a pulse a second"), "{told}");
}
