//! Searches of one axis, each without what lost in those before it.

use std::cell::OnceCell;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::held_out::Halves;
use crate::diagnosis::held_out::laws::Ordinates;
use crate::diagnosis::loser::Loser;
use crate::diagnosis::refused::Refused;
use crate::diagnosis::search::Spoilt;

/// Times that something is refused before the rest is taken as it is: a choice. Each costs another search of the axis.
const MOST_REFUSALS: usize = 5;

/// What came of one search.
pub struct Attempt<T> {
    /// What it ended with.
    pub done: T,
    /// What it named and took back, so that others may have been hidden by it or found for it.
    pub loser: Option<Loser>,
}

/// Explains the axis called `name` by an `attempt` that is told what is refused, and does so anew from its
/// beginning without what gained too little, what was taken back, and what left nothing to fit. The axis, what came of the
/// last attempt, and the gain of each explanation on held-out data.
///
/// # Errors
/// [`Refused`] where the axis cannot be begun, or nothing that was tried can be fitted.
pub fn without_losers<T>(
    name: &str,
    first: AxisState,
    begin: impl Fn() -> Result<AxisState, Refused>,
    attempt: impl Fn(&mut AxisState, &[Loser]) -> Result<Attempt<T>, Spoilt>,
) -> Result<(AxisState, T, Vec<Option<f64>>), Refused> {
    let mut refused: Vec<Loser> = Vec::new();
    let mut axis = first;
    for further in (0..=MOST_REFUSALS).rev() {
        match attempt(&mut axis, &refused) {
            Ok(Attempt { done, loser }) => {
                let held_out_nats = held_out(&axis);
                let mut new = Loser::among(axis.explanations(), &held_out_nats);
                new.extend(loser.map(|one| one.beyond(&refused)));
                if new.is_empty() || further == 0 {
                    return Ok((axis, done, held_out_nats));
                }
                refused.extend(new);
            }
            // What was taken in last left nothing that can be fitted: the rest is explained without it.
            Err(Spoilt { latest }) => {
                let Some(latest) = latest.filter(|_| further > 0) else {
                    break;
                };
                refused.push(Loser::all(latest));
            }
        }
        axis = begin()?;
    }
    Err(Refused::Unfitted {
        axis: name.to_owned(),
    })
}

/// Gain of each explanation on data that it was not fitted to. The halves are made where they are needed.
fn held_out(axis: &AxisState) -> Vec<Option<f64>> {
    let halves = OnceCell::new();
    let ordinates = OnceCell::new();
    let nats = axis.explanations().iter().map(|one| {
        if one.held_out_nats.is_some() || one.is_beside_noise() {
            return one.held_out_nats;
        }
        match axis.law_number(one) {
            Some(law) => {
                let ordinates = ordinates.get_or_init(|| Ordinates::new(axis));
                ordinates.as_ref()?.nats(law)
            }
            None => {
                if let Some(halves) = Halves::of_hidden(axis, one) {
                    return halves.nats(one);
                }
                let halves = halves.get_or_init(|| Halves::new(axis));
                halves.as_ref()?.nats(one)
            }
        }
    });
    nats.collect()
}

#[cfg(test)]
mod tests;
