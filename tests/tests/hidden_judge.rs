//! The judge, with answers made up by the test in place of the program.

use std::collections::BTreeMap;
use std::time::Duration;

use inm_tests::hidden::case::{Case, Files, Plan};
use inm_tests::hidden::effect::{self, find};
use inm_tests::hidden::judge::allan::{ModelError, Sides};
use inm_tests::hidden::judge::allan_table::{Mean, table};
use inm_tests::hidden::judge::answer::{
    Answer, Axis, Finding, Held, Interval, Last, Modelled, Remark, Views,
};
use inm_tests::hidden::judge::place::is_right;
use inm_tests::hidden::judge::program::{Diagnose, Failure, Outcome, Program};
use inm_tests::hidden::judge::score::{Score, score};
use inm_tests::hidden::judge::tally;
use inm_tests::hidden::judge::trial::{Task, Trial, run_all};
use inm_tests::hidden::outside::{self, Place};
use inm_tests::hidden::strength::Strength;
use inm_tests::hidden::truth::Truth;
use serde_json::json;

const SAMPLES: usize = 1 << 16;

fn plan(names: &[&str]) -> Plan {
    Plan {
        kinds: names
            .iter()
            .map(|name| find(name).or(outside::find(name)).expect("a kind"))
            .collect(),
        strength: Strength::At(5.0),
        samples: SAMPLES,
    }
}

/// The finding of one who knows: every value with an interval of 10 % either side.
fn finding(truth: &Truth, axis: usize) -> Finding {
    let mut parameters = BTreeMap::new();
    for (name, value) in &truth.parameters {
        let interval = Interval {
            value: Some(*value),
            lo: Some(value - 0.1 * value.abs()),
            hi: Some(value + 0.1 * value.abs()),
            upper: None,
        };
        match name.strip_prefix("gain_") {
            Some(number) if number.parse() == Ok(axis + 1) => {
                parameters.insert("gain".to_owned(), interval);
            }
            Some(_) => {}
            None => {
                parameters.insert(name.clone(), interval);
            }
        }
    }
    Finding {
        effect: truth.effect.to_owned(),
        parameters,
        ..Finding::default()
    }
}

fn perfect(case: &Case) -> Answer {
    let mut axes = vec![Axis::default(); case.columns.len()];
    for truth in &case.truths {
        for (index, axis) in axes.iter_mut().enumerate() {
            if index == case.scene.target || truth.effect == "common_mode" {
                axis.findings.push(finding(truth, index));
            }
        }
    }
    axes[case.scene.target].last = Some(Last {
        coefficients: BTreeMap::from([(
            "N".to_owned(),
            Interval {
                value: Some(case.scene.axes[case.scene.target].n),
                lo: Some(0.0),
                hi: Some(1.0),
                upper: None,
            },
        )]),
    });
    Answer { axes }
}

#[test]
fn a_perfect_answer_is_right_for_every_kind() {
    for kind in effect::KINDS {
        let case = Case::draw(&plan(&[kind.name]), 1);
        let score = score(&case, &perfect(&case));
        assert!(score.is_right(), "{}: {score:?}", kind.name);
        for parameter in &score.parameters {
            assert_eq!(parameter.inside, Some(true), "{}: {parameter:?}", kind.name);
        }
        // N is in its interval, and nothing is said of K. With a wrong rate neither is judged.
        let judged: Vec<Option<bool>> = score.coefficients.iter().map(|c| c.inside).collect();
        if kind.name == "timebase" {
            assert!(judged.is_empty());
        } else {
            assert_eq!(
                judged,
                [None, None, None, Some(true), None],
                "{}",
                kind.name
            );
        }
    }
}

#[test]
fn silence_and_wrong_names_are_wrong() {
    let case = Case::draw(&plan(&["markov"]), 1);
    let silent = Answer {
        axes: vec![Axis::default()],
    };
    assert!(!score(&case, &silent).is_named());
    let mut wrong = perfect(&case);
    wrong.axes[0].findings[0].effect = "telegraph".to_owned();
    let wrong = score(&case, &wrong);
    assert!(!wrong.is_named());
    assert_eq!(wrong.extra, ["telegraph"]);
    // Named twice is once too often.
    let mut twice = perfect(&case);
    let again = twice.axes[0].findings[0].clone();
    twice.axes[0].findings.push(again);
    assert_eq!(score(&case, &twice).extra, ["markov"]);
    // Named, but with a remark left: named, not right.
    let mut remark = perfect(&case);
    remark.axes[0]
        .unexplained
        .push(Remark(json!({"test": "x"})));
    let remark = score(&case, &remark);
    assert!(remark.is_named() && !remark.is_right());
}

#[test]
fn a_line_elsewhere_is_another_line() {
    let case = Case::draw(&plan(&["sinusoid"]), 1);
    let mut answer = perfect(&case);
    let parameters = &mut answer.axes[0].findings[0].parameters;
    let f_hz = parameters.get_mut("f_hz").expect("its frequency");
    f_hz.value = f_hz.value.map(|f_hz| 1.1 * f_hz);
    assert!(!score(&case, &answer).is_named());
}

#[test]
fn errors_are_counted_in_deviations() {
    let case = Case::draw(&plan(&["sinusoid"]), 1);
    let mut answer = perfect(&case);
    let amplitude = case.truths[0].parameter("amplitude").expect("known");
    let interval = Interval {
        value: Some(amplitude + 3.0),
        lo: Some(amplitude + 3.0 - 1.96),
        hi: Some(amplitude + 3.0 + 1.96),
        upper: None,
    };
    let parameters = &mut answer.axes[0].findings[0].parameters;
    parameters.insert("amplitude".to_owned(), interval);
    let score = score(&case, &answer);
    let said = &score.parameters[1];
    assert_eq!(said.inside, Some(false));
    let deviations = said.deviations.expect("an interval");
    assert!((deviations - 3.0).abs() < 1e-9, "{deviations}");
}

#[test]
fn places_are_read_from_words() {
    let remark = |text: &str| Remark(json!({"test": "lines", "where": text}));
    for (text, place, right) in [
        ("120 to 140 Hz, wanders", Place::Band(125.0, 135.0), true),
        ("near 0.13 kHz", Place::Band(125.0, 135.0), true),
        ("120-140 Hz after 3 s", Place::Band(200.0, 220.0), false),
        ("from 120 s to 140 s", Place::Band(125.0, 135.0), false),
        ("variance over 0.5 s", Place::Variance, true),
        ("skewed", Place::Amplitude, true),
        ("120 Hz", Place::Amplitude, false),
    ] {
        let remark = remark(text);
        assert_eq!(is_right(&[&remark], place), right, "{text}");
    }
    let structured = Remark(json!({"where": {"from_hz": 121.5, "to_hz": 130}}));
    assert!(is_right(&[&structured], Place::Band(125.0, 135.0)));
}

/// What has no name is right when a remark says where, and wrong when it is named.
#[test]
fn outside_the_catalogue_no_name_is_right() {
    let case = Case::draw(&plan(&["beating_tone"]), 1);
    let f_hz = case.truths[0].parameter("f_hz").expect("known");
    let mut answer = Answer {
        axes: vec![Axis::default()],
    };
    assert_eq!(score(&case, &answer).placed, Some(false));
    let words = format!("power near {f_hz:.1} Hz that wanders");
    answer.axes[0].unexplained.push(Remark(json!(words)));
    let good = score(&case, &answer);
    assert_eq!((good.placed, good.is_named()), (Some(true), true));
    let name = Truth::new("resonance", &[]);
    answer.axes[0].findings.push(finding(&name, 0));
    assert_eq!(score(&case, &answer).extra, ["resonance"]);
}

/// A stand-in that reads nothing and says the same of every record.
struct Parrot;

impl Diagnose for Parrot {
    fn diagnose(&self, files: &Files) -> Result<Outcome, Failure> {
        let bytes = std::fs::read(&files.record)?;
        assert_eq!(bytes.len() % 8, 0, "a header of whole words, and float64");
        let answer = json!({"axes": [{"findings": [{"effect": "markov", "parameters": {}}],
                                       "unexplained": []}]});
        Ok(Outcome {
            answer: serde_json::from_value(answer)?,
            time: Duration::from_millis(10),
        })
    }
}

#[test]
fn tables_count_what_was_said() {
    let tasks: Vec<Task> = [plan(&["markov"]), plan(&["rolloff"]), plan(&[])]
        .into_iter()
        .flat_map(|plan| {
            (1..=2).map(move |seed| Task {
                plan: plan.clone(),
                seed,
            })
        })
        .collect();
    let trials = run_all(&tasks, &Parrot, 2, &|_| {});
    let named: Vec<bool> = trials
        .iter()
        .map(|trial| {
            trial
                .result
                .as_ref()
                .is_ok_and(|(score, _)| score.is_right())
        })
        .collect();
    assert_eq!(named, [true, true, false, false, false, false]);
    let table = tally::confusion(&trials);
    assert!(table.contains("rolloff                markov 2"), "{table}");
    assert!(table.contains("clean                  markov 2"), "{table}");
}

#[test]
fn detection_stands_beside_the_ideal() {
    let trial = |row: &str, strength: f64, ideal: f64, named: Option<bool>| Trial {
        row: row.to_owned(),
        seed: 1,
        strength: Some(strength),
        ideal_power: Some(ideal),
        facts: Vec::new(),
        redrawn: 0,
        result: match named {
            Some(named) => Ok((
                Score {
                    named: vec![("hum", true), ("steps", named)],
                    // Another name beside it does not make it less seen.
                    extra: vec!["burst".to_owned()],
                    ..Score::default()
                },
                Duration::ZERO,
            )),
            None => Err(Failure::Status("2".to_owned(), String::new())),
        },
    };
    let trials = [
        trial("steps", 1.5, 1.0, Some(true)),
        trial("steps", 0.3, 0.2, Some(false)),
        trial("steps", 0.3, 0.4, Some(true)),
        trial("burst", 0.3, 0.0, Some(false)),
        trial("burst", 0.3, 0.1, None),
    ];
    let text = tally::detection(&trials);
    let rows: Vec<String> = text
        .lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    let expected = [
        "named % (ideal %)",
        "strength 0.30 1.50",
        "steps 50 (30) 100 (100)",
        "burst 0 (5) -",
        "all 25 (18) 100 (100)",
    ];
    assert_eq!(rows, expected, "{text}");
}

/// Models whose deviations are 1.5 and 1.02 times the truth, on a part where 0.9 of it was measured.
fn off(case: &Case) -> Views {
    let ms = [1, 8, 64];
    let truth = case.allan_variances(&ms).expect("a law");
    let mut views = Views::default();
    for (m, variance) in ms.into_iter().zip(truth) {
        let models = |factor: f64| Modelled {
            m,
            before: 1.5 * factor * variance.sqrt(),
            after: 1.02 * factor * variance.sqrt(),
        };
        views.allan.push(models(1.0));
        views.held_out.push(Held {
            tau_s: m as f64 / 2000.0,
            adev: 0.9 * variance.sqrt(),
            edf: if m < 64 { 1000.0 } else { 999.0 },
            models: models(0.9),
        });
    }
    views
}

#[test]
fn models_are_held_against_the_truth_and_what_was_held_out() {
    for kind in ["markov", "steps", "burst", "rolloff", "outliers"] {
        let case = Case::draw(&plan(&[kind]), 1);
        let mut answer = perfect(&case);
        answer.axes[case.scene.target].views = off(&case);
        let errors = score(&case, &answer).allan;
        let ms: Vec<u64> = errors.iter().map(|one| one.m).collect();
        assert_eq!(ms, [1, 8], "{kind}: 999 degrees of freedom are too few");
        for one in errors {
            let truth = one.truth.expect("a law");
            for (sides, what) in [(truth, "truth"), (one.held_out, "held out")] {
                assert!(
                    (sides.before - 50.0).abs() < 1e-9,
                    "{kind}, {what}: {sides:?}"
                );
                assert!(
                    (sides.after - 2.0).abs() < 1e-9,
                    "{kind}, {what}: {sides:?}"
                );
            }
        }
        // What is named wrong has another fault than this.
        answer.axes[case.scene.target].findings[0].effect = "powerlaw".to_owned();
        assert!(score(&case, &answer).allan.is_empty(), "{kind}");
    }
}

#[test]
fn means_have_their_standard_error() {
    let mean = Mean::of(&[-1.0, 3.0, 4.0]).expect("three");
    // Squares about the mean add up to 14; over 2 and over 3.
    let error = (14.0_f64 / 6.0).sqrt();
    assert_eq!((mean.count, mean.mean), (3, 2.0));
    assert!((mean.error - error).abs() < 1e-12, "{mean:?}");
    assert!((mean.size - 8.0 / 3.0).abs() < 1e-12, "{mean:?}");
    assert!((mean.beyond() - (1.0 - error)).abs() < 1e-12, "{mean:?}");
    assert!(Mean::of(&[]).is_none());
    assert!(
        Mean::of(&[50.0]).expect("one").beyond() < 0.0,
        "one says nothing"
    );
}

/// Two kinds: one is off by 2 % at one averaging time, the other has no law there.
#[test]
fn the_table_marks_what_is_off() {
    let sides = |after: f64| Sides { before: 7.0, after };
    let trial = |row: &str, errors: &[(u64, Option<f64>)]| Trial {
        row: row.to_owned(),
        seed: 1,
        strength: None,
        ideal_power: None,
        facts: Vec::new(),
        redrawn: 0,
        result: Ok((
            Score {
                allan: errors
                    .iter()
                    .map(|&(m, truth)| ModelError {
                        m,
                        tau_s: m as f64,
                        truth: truth.map(sides),
                        held_out: sides(if m == 1 { 0.6 } else { 0.5 }),
                    })
                    .collect(),
                ..Score::default()
            },
            Duration::ZERO,
        )),
    };
    let trials = [
        trial("markov", &[(1, Some(0.9)), (2, Some(-2.0))]),
        trial("markov", &[(1, Some(1.0)), (2, Some(-2.2))]),
        trial("quantisation", &[(2, None)]),
    ];
    let text = table(&trials);
    let rows: Vec<Vec<&str>> = text
        .lines()
        .map(|line| line.split_whitespace().collect())
        .collect();
    let row = |name: &str| {
        let found = rows.iter().find(|row| row.first() == Some(&name));
        found
            .unwrap_or_else(|| panic!("no row {name} in\n{text}"))
            .join(" ")
    };
    assert_eq!(
        row("1.0000"),
        "1.0000 2 7.00 0.95 0.05 0.95 2 7.00 0.60 0.00 worst over the held-out part"
    );
    assert_eq!(
        row("2.0000"),
        "2.0000 2 7.00 -2.10 0.10 2.10 3 7.00 0.50 0.00 beyond 1 % worst over the truth"
    );
    assert_eq!(
        row("markov"),
        "markov 2.0000 2 7.00 -2.10 0.10 2.10 beyond 1 %"
    );
    assert_eq!(row("quantisation"), "quantisation -");
}

/// Nothing in the files tells: same name, same header, whatever is hidden.
#[test]
fn the_files_do_not_tell() {
    let write = |names: &[&str]| {
        let folder = tempfile::tempdir().expect("a folder");
        let case = Case::draw(&plan(names), 3);
        let files = case.write(folder.path()).expect("it writes");
        let bytes = std::fs::read(&files.record).expect("it is there");
        let name = files.record.file_name().map(ToOwned::to_owned);
        (bytes, name, case)
    };
    let (markov, name, case) = write(&["markov"]);
    let (clean, clean_name, _) = write(&[]);
    assert_eq!(name, clean_name);
    let header = usize::from(u16::from_le_bytes([clean[8], clean[9]])) + 10;
    assert_eq!(header % 64, 0);
    assert_eq!(clean.len(), header + 8 * SAMPLES);
    assert_eq!(markov[..header], clean[..header]);
    assert_ne!(markov[header..], clean[header..]);
    let first = f64::from_le_bytes(markov[header..header + 8].try_into().expect("eight bytes"));
    assert_eq!(first.to_bits(), case.columns[0][0].to_bits());
    let (again, ..) = write(&["markov"]);
    assert!(markov == again, "the same seed gives the same bytes");
}

/// The program is told of everything, its answer is read, and its failure is none of its own.
#[cfg(unix)]
#[test]
fn the_program_is_run_as_a_process() {
    use std::os::unix::fs::PermissionsExt as _;

    let folder = tempfile::tempdir().expect("a folder");
    let script = folder.path().join("inm");
    let answer = r#"{"schema":1,"axes":[{"findings":[{"effect":"thermal","parameters":
        {"gain":{"value":1.0,"lo":0.5,"hi":null}}}],"unexplained":[],"final":null}]}"#;
    let text = format!(
        "#!/bin/sh\necho \"$@\" > {0}/said\nwhile [ $# -gt 1 ]; do shift; done\n\
         cat > \"$1\" <<'END'\n{answer}\nEND\nexit $(cat {0}/status)\n",
        folder.path().display()
    );
    std::fs::write(&script, text).expect("it writes");
    std::fs::set_permissions(&script, std::fs::Permissions::from_mode(0o755)).expect("its mode");
    let status = |status: &str| std::fs::write(folder.path().join("status"), status);
    let case = Case::draw(&plan(&["thermal"]), 1);
    let files = case.write(folder.path()).expect("it writes");
    let program = Program(script.clone());

    status("1").expect("it writes");
    let outcome = program.diagnose(&files).expect("status 1 is an answer");
    assert!(score(&case, &outcome.answer).is_right());
    let said = std::fs::read_to_string(folder.path().join("said")).expect("it was run");
    assert!(said.starts_with("diagnose "), "{said}");
    assert!(
        said.contains("record.npy --rate 2000 --unit m/s^2 "),
        "{said}"
    );
    assert!(said.contains("--columns 0 --temperature 1"), "{said}");

    status("2").expect("it writes");
    let failure = program.diagnose(&files).expect_err("status 2 is a failure");
    assert!(failure.to_string().contains("exit status: 2"), "{failure}");
}
