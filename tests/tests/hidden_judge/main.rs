//! The judge, with answers made up by the test in place of the program.

mod answers;
mod counts;
mod models;
mod process;

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
use std::collections::BTreeMap;
use std::time::Duration;

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
