//! The wide draw, random records and everyday disturbances: what they promise.

use inm_tests::hidden::case::{Case, Plan};
use inm_tests::hidden::effect;
use inm_tests::hidden::everyday::record::Record as Desk;
use inm_tests::hidden::everyday::score::score;
use inm_tests::hidden::everyday::table::EVERYDAY;
use inm_tests::hidden::judge::answer::{Answer, Interval};
use inm_tests::hidden::robust::bounds::{Room, broken};
use inm_tests::hidden::robust::record::Record;
use inm_tests::hidden::strength::Strength;
use inm_tests::hidden::wide::form::{Form, Missing};
use inm_tests::hidden::wide::limits::LIMITS;
use inm_tests::hidden::wide::scene::SHORTEST;
use inm_tests::hidden::wide::tally::wilson;

const LONGEST: usize = 1 << 15;

fn any(kind: &'static effect::Kind) -> Plan {
    Plan {
        kinds: vec![kind],
        strength: Strength::Any,
        samples: LONGEST,
    }
}

/// Bits, since what is missing is not equal to itself.
fn bits(columns: &[Vec<f64>]) -> Vec<u64> {
    columns
        .iter()
        .flatten()
        .map(|value| value.to_bits())
        .collect()
}

#[test]
fn every_kind_has_its_row_of_limits_and_only_one() {
    let mut named: Vec<&str> = LIMITS.iter().map(|limit| limit.kind).collect();
    let mut kinds: Vec<&str> = effect::KINDS.iter().map(|kind| kind.name).collect();
    named.sort_unstable();
    kinds.sort_unstable();
    assert_eq!(named, kinds);
}

#[test]
fn every_kind_is_drawn_within_its_limits_and_the_same_again() {
    for kind in effect::KINDS {
        for seed in 1..=4 {
            let case = Case::draw(&any(kind), seed);
            let (name, scene) = (kind.name, &case.scene);
            let strength = case.strength.expect("something is hidden");
            assert!(
                (1.0..=1000.0).contains(&strength),
                "{name} {seed}: {strength}"
            );
            assert!((1.0..=4000.0).contains(&scene.rate_hz), "{name} {seed}");
            let limit = LIMITS
                .iter()
                .find(|limit| limit.kind == name)
                .expect("a row");
            assert!(scene.rate_hz >= limit.rate_hz && scene.samples >= limit.samples);
            let share = case
                .truths
                .iter()
                .find_map(|truth| truth.parameter("share"));
            assert!(
                share.is_none_or(|share| share <= 0.5 + 1e-9),
                "{name} {seed}: {share:?}"
            );
            let again = Case::draw(&any(kind), seed);
            assert_eq!(bits(&case.columns), bits(&again.columns), "{name} {seed}");
        }
    }
}

#[test]
fn what_is_missing_leaves_enough_for_a_diagnosis() {
    for missing in [Missing::Single, Missing::Stretches, Missing::Third] {
        for seed in 1..40 {
            let samples = SHORTEST + [0, 1, 150, 3000, 9000][seed as usize % 5];
            let form = Form {
                missing,
                ..Form::default()
            };
            let mut columns = vec![vec![1.0; samples]; 2];
            form.settle(&mut columns, &[], seed);
            for column in &columns {
                let counting = column.iter().filter(|value| value.is_finite()).count();
                let said = format!("{missing:?}, seed {seed}: {counting} of {samples}");
                assert!(counting >= SHORTEST, "{said}");
                assert!(samples < SHORTEST + 3000 || counting < samples, "{said}");
            }
        }
    }
}

#[test]
fn of_what_happened_no_stretch_that_is_missing_takes_more_than_half() {
    let form = Form {
        missing: Missing::Stretches,
        ..Form::default()
    };
    let samples = SHORTEST + 20_000;
    let lost_of = |happened: &[std::ops::Range<usize>], seed| {
        let mut columns = vec![vec![1.0; samples]];
        form.settle(&mut columns, happened, seed);
        let lost = columns[0][10_000..10_040].iter();
        lost.filter(|value| value.is_nan()).count()
    };
    let happened = 10_000..10_040;
    let seeds = 1..300;
    let most = seeds.clone().map(|seed| lost_of(&[], seed)).max();
    assert_eq!(most, Some(40), "the seeds try it");
    for seed in seeds {
        let lost = lost_of(std::slice::from_ref(&happened), seed);
        // Two stretches may take a half each from either side.
        assert!(lost < 40, "seed {seed}: {lost}");
    }
}

#[test]
fn random_records_come_again_and_go_into_files() {
    let folder = tempfile::tempdir().expect("a folder");
    for seed in 1..=60 {
        let record = Record::draw(seed, 1 << 12);
        let again = Record::draw(seed, 1 << 12);
        assert_eq!(bits(&record.columns), bits(&again.columns), "seed {seed}");
        let length = record.columns[0].len();
        assert!(length <= 1 << 12, "seed {seed}: {length}");
        assert!(record.columns.iter().all(|column| column.len() == length));
        record.write(folder.path()).expect("a file");
    }
}

#[test]
fn a_parameter_outside_its_bound_is_seen() {
    let room = Room {
        samples: 1000,
        rate_hz: 10.0,
        least: 8.0,
        most: 10.0,
        chain: false,
    };
    let says = |effect: &str, name: &str, value: f64| {
        let said = Interval {
            value: Some(value),
            ..Interval::default()
        };
        broken(effect, name, &said, &room).is_some()
    };
    let good = [
        ("steps", "time_s_1", 100.0),
        ("steps", "height_1", -2.0),
        ("resonance", "width_hz", 0.01),
        ("clipping", "level", 9.0),
        // No instant but a time constant.
        ("warmup", "time_s", 200.0),
    ];
    let bad = [
        ("steps", "time_s_1", 101.0),
        ("steps", "height_1", -2.2),
        ("resonance", "width_hz", 0.009),
        ("resonance", "f_hz", 5.1),
        ("clipping", "level", 7.9),
        ("stale", "share", 1.1),
        ("burst", "factor", 0.0),
    ];
    for (effect, name, value) in good {
        assert!(!says(effect, name, value), "{effect}.{name} {value}");
    }
    for (effect, name, value) in bad {
        assert!(says(effect, name, value), "{effect}.{name} {value}");
    }
    let outside = Interval {
        value: Some(1.0),
        lo: Some(1.1),
        hi: Some(1.2),
        upper: None,
    };
    assert!(broken("steps", "height_1", &outside, &room).is_some());
}

/// What a perfect program would say is right, at another time wrong, beside another name wrong.
#[test]
fn a_disturbance_is_right_by_kind_and_time() {
    for everyday in EVERYDAY {
        let record = Desk::draw(everyday, 1, 1 << 16);
        let (from_s, to_s) = record.event_s.unwrap_or_default();
        let answer = |later_s: f64, beside: &str| -> Answer {
            let value = |value: f64| serde_json::json!({ "value": value, "lo": null, "hi": null });
            let mut findings = vec![
                serde_json::json!({ "effect": everyday.names[0], "parameters": {
                "from_s": value(from_s + later_s), "to_s": value(to_s + later_s) } }),
            ];
            if !beside.is_empty() {
                findings.push(serde_json::json!({ "effect": beside }));
            }
            let axis = |axis| match axis == record.plainest {
                true => serde_json::json!({ "findings": findings, "unexplained": [] }),
                false => serde_json::json!({ "findings": [], "unexplained": [] }),
            };
            let axes: Vec<_> = (0..3).map(axis).collect();
            serde_json::from_value(serde_json::json!({ "axes": axes })).expect("an answer")
        };
        let name = everyday.name;
        assert!(score(&record, &answer(0.0, "")).is_right(), "{name}");
        assert!(
            !score(&record, &answer(0.0, "telegraph")).is_right(),
            "{name}"
        );
        let late_s = 3.0 * (1.0 + to_s - from_s);
        let is_event = record.event_s.is_some();
        assert_eq!(
            score(&record, &answer(late_s, "")).is_right(),
            !is_event,
            "{name}"
        );
        assert!(!score(&record, &Answer::default()).is_right(), "{name}");
    }
}

/// Nothing is added but what is said, and most of it between the times that are said.
#[test]
fn an_event_is_where_it_is_said_to_be() {
    for everyday in EVERYDAY {
        for seed in 1..=3 {
            let record = Desk::draw(everyday, seed, 1 << 16);
            assert_eq!(record.columns.len(), 3);
            let Some((from_s, to_s)) = record.event_s else {
                continue;
            };
            let column = &record.columns[record.plainest];
            let (from, to) = (from_s * record.room.rate_hz, to_s * record.room.rate_hz);
            let inside = (from as usize)..(to as usize).min(column.len());
            // Over a lag that shows what sways at some tens of hertz.
            let lag = ((0.03 * record.room.rate_hz) as usize).max(1);
            let squares = |range: std::ops::Range<usize>| -> f64 {
                let pairs = column[range.clone()].windows(lag + 1);
                pairs.map(|pair| (pair[lag] - pair[0]).powi(2)).sum::<f64>()
                    / range.len().max(1) as f64
            };
            let quiet = squares(0..inside.start.max(1)).min(squares(inside.end..column.len()));
            let quiet = if quiet > 0.0 {
                quiet
            } else {
                record.room.deviation.powi(2)
            };
            assert!(
                squares(inside) > 1.2 * quiet,
                "{} seed {seed}",
                everyday.name
            );
        }
    }
}

#[test]
fn shares_have_wilsons_interval() {
    // 95 of 100: 88.8 to 97.8 (Newcombe 1998's method 3).
    let (lo, hi) = wilson(95, 100);
    assert!(
        (lo - 88.8).abs() < 0.06 && (hi - 97.8).abs() < 0.06,
        "{lo} {hi}"
    );
    assert!(wilson(0, 20).0.abs() < 1e-9);
}
