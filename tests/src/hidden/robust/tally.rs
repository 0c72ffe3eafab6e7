//! The table of a study of random records: what came of them, failures by class.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::check::Outcome;

/// Seeds shown of each class.
const SHOWN: usize = 6;

/// How many ended how; then each class of failure with the seeds that show it.
pub fn table(outcomes: &[(u64, Outcome)]) -> String {
    let mut ends: BTreeMap<&str, Vec<u64>> = BTreeMap::new();
    let mut failures: BTreeMap<&str, Vec<u64>> = BTreeMap::new();
    for (seed, outcome) in outcomes {
        ends.entry(&outcome.end).or_default().push(*seed);
        for failure in &outcome.failures {
            failures.entry(failure).or_default().push(*seed);
        }
    }
    let bad = outcomes.iter().filter(|(_, one)| !one.failures.is_empty());
    let mut text = format!(
        "{} records, {} fail\n\nended\n",
        outcomes.len(),
        bad.count()
    );
    text.push_str(&rows(ends));
    text.push_str("\nfailures, by class\n");
    text.push_str(&rows(failures));
    text
}

fn rows(classes: BTreeMap<&str, Vec<u64>>) -> String {
    let mut classes: Vec<_> = classes.into_iter().collect();
    classes.sort_by_key(|(_, seeds)| std::cmp::Reverse(seeds.len()));
    let mut text = String::new();
    for (class, seeds) in classes {
        let shown: Vec<String> = seeds.iter().take(SHOWN).map(u64::to_string).collect();
        let _ = writeln!(
            text,
            "{:>6}  {class}  (seeds {})",
            seeds.len(),
            shown.join(" ")
        );
    }
    text
}
