//! What an axis comes to, in a few sentences: may one simulate with the model, what happened when, what has no name.

use crate::chain::Chain;
use crate::diagnosis::result::finding::{AxisDiagnosis, Finding, Unnamed, UnnamedBand};
use crate::diagnosis::result::verdict::Verdict;
use crate::model::marks::Mark;
use crate::model::rolloff;
use crate::numeric::written::{grouped, significant};

/// Moments and stretches that are listed, at most; the findings have all.
const MOST_EVENTS: usize = 6;

/// Bands without a name that are listed, at most; JSON has all.
const MOST_BANDS: usize = 3;

/// Error that is not worth a digit, percent.
const LEAST_PERCENT: f64 = 0.1;

/// The sentences about an axis, the most important first.
pub fn summary(axis: &AxisDiagnosis) -> Vec<String> {
    let mut sentences = vec![verdict(&axis.verdict)];
    sentences.extend(
        axis.recognised_chain
            .as_ref()
            .map(|chain| recognised(axis, chain)),
    );
    sentences.extend(filled(axis));
    sentences.extend(events(axis));
    sentences.extend(axis.unnamed.as_ref().map(without_name));
    sentences
}

fn verdict(verdict: &Verdict) -> String {
    let (Some(error), Some(five)) = (verdict.error_percent, verdict.five_terms_error_percent)
    else {
        return "Too short to say whether one may simulate with its model.".into();
    };
    let Some([from_s, to_s]) = verdict.good_s else {
        return format!(
            "Do not simulate with it: the model's Allan deviation is off by {} at all averaging times.",
            percent(error)
        );
    };
    let compared = format!(
        "over all averaging times it is off by {}, the five terms alone by {}",
        percent(error),
        percent(five)
    );
    let range = format!("{} to {} s", significant(from_s, 3), significant(to_s, 3));
    match verdict.worst() {
        None => format!(
            "Simulate with it: its Allan deviation is that of the record from {range}; {compared}."
        ),
        Some(worst) => format!(
            "Simulate with it only from {range}: at {} s its Allan deviation is {} % too {}; {compared}.",
            significant(worst.tau_s, 3),
            significant(worst.model_percent.abs(), 2),
            if worst.model_percent > 0.0 {
                "large"
            } else {
                "small"
            },
        ),
    }
}

/// What stands in the place of missing samples.
fn filled(axis: &AxisDiagnosis) -> Option<String> {
    (axis.filled_samples > 0).then(|| {
        format!(
            "In short gaps {} samples that were not measured were drawn as the noise of the rest has them.",
            grouped(axis.filled_samples as u64)
        )
    })
}

/// What a chain that was recognised asks for.
fn recognised(axis: &AxisDiagnosis, chain: &Chain) -> String {
    // A chain is declared with single poles.
    let is_pole = |one: &&Finding| one.effect == rolloff::KIND && one.estimate.values.len() == 1;
    let poles = axis.findings.iter().filter(is_pole);
    let poles = poles.flat_map(Finding::marks);
    let poles = poles.filter_map(|mark| match mark {
        Mark::Corner(f_hz) => Some(f_hz),
        _ => None,
    });
    let declared = poles.fold(chain.to_string(), |chain, f_hz| {
        format!("{chain}+{}hz", significant(f_hz, 3))
    });
    format!(
        "Its spectrum ends as behind an ADS1281's digital filter, which is not declared and is taken as if it were: \
         --chain {declared}."
    )
}

/// What happened when.
fn events(axis: &AxisDiagnosis) -> Option<String> {
    let mut events: Vec<(f64, String)> = Vec::new();
    for one in &axis.findings {
        for mark in one.marks() {
            match mark {
                Mark::Moment(s) => events.push((s, format!("{} at {} s", one.effect, time(s)))),
                Mark::Stretch(from_s, to_s) => {
                    let words = format!("{} from {} to {} s", one.effect, time(from_s), time(to_s));
                    events.push((from_s, words));
                }
                Mark::Line { .. } | Mark::Corner(_) | Mark::Band(..) | Mark::AveragingTime(_) => {}
            }
        }
    }
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    let more = events.len().saturating_sub(MOST_EVENTS);
    let mut words: Vec<String> = events
        .into_iter()
        .take(MOST_EVENTS)
        .map(|one| one.1)
        .collect();
    if more > 0 {
        words.push(format!("{more} more"));
    }
    (!words.is_empty()).then(|| format!("Events: {}.", words.join(", ")))
}

fn time(s: f64) -> String {
    format!("{s:.1}")
}

fn without_name(unnamed: &Unnamed) -> String {
    let band = |one: &UnnamedBand| {
        if one.f_hz < one.width_hz {
            format!("below {} Hz", significant(one.f_hz + 0.5 * one.width_hz, 2))
        } else {
            format!("about {} Hz", significant(one.f_hz, 3))
        }
    };
    let mut bands: Vec<String> = unnamed.bands.iter().take(MOST_BANDS).map(band).collect();
    bands.dedup();
    let more = unnamed.bands.len().saturating_sub(MOST_BANDS);
    if more > 0 {
        bands.push(format!("in {more} more bands"));
    }
    format!(
        "Without a name: noise {}; it is in the model, and without it the Allan deviation would be up to {} lower.",
        bands.join(", "),
        percent(lower(unnamed.allan_change_percent))
    )
}

/// By how much less a deviation is that is `change` percent more with something; all of it where nothing else is there.
fn lower(change: f64) -> f64 {
    100.0 * (1.0 - (1.0 + 0.01 * change).recip())
}

fn percent(error: f64) -> String {
    if error < LEAST_PERCENT {
        format!("less than {LEAST_PERCENT} %")
    } else {
        format!("{} %", significant(error, 2))
    }
}

#[cfg(test)]
mod tests {
    use super::lower;

    #[test]
    fn what_is_nothing_without_a_part_is_all_lower() {
        assert!((lower(25.0) - 20.0).abs() < 1e-12);
        assert!((lower(f64::INFINITY) - 100.0).abs() < 1e-12);
    }
}
