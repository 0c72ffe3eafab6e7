//! Sizes of many components at once.

use crate::fit::likelihood::scoring::{Range, greatest_beside};
use crate::fit::likelihood::{Data, log_likelihood};
use crate::numeric::mixture::add_mixture;
use crate::numeric::product::dot;

/// How often sizes are multiplied towards the data before they are scored: enough to come within a tenth.
const MULTIPLIED: usize = 30;

/// Rounds of both, at most, and the gain that is worth another, nats: choices. One is usual.
const ROUNDS: usize = 6;
const WORTH: f64 = 1.0;

/// The likeliest squares of `components`, from a start, and their log-likelihood. Scoring may fail to get anywhere from a
/// start that is far off: then the sizes are first multiplied towards the data, which never loses, and both as often as that gains.
pub fn likeliest(
    data: &Data,
    components: &[Vec<f64>],
    squared: Vec<f64>,
) -> Option<(Vec<f64>, f64)> {
    let nothing = vec![0.0; data.len()];
    let scored = |start: &[f64]| {
        greatest_beside(data, components, &nothing, Some(start), Range::NonNegative)
    };
    let first = scored(&squared);
    let mut best: Option<(Vec<f64>, f64)> = first;
    let mut start = squared;
    for _ in 0..ROUNDS {
        let multiplied = multiplied(data, components, start);
        let second = scored(&multiplied.0);
        let before = best.as_ref().map_or(f64::NEG_INFINITY, |one| one.1);
        let all = [best, second, Some(multiplied)].into_iter().flatten();
        let (sizes, nats) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
        start = sizes.clone();
        best = Some((sizes, nats));
        if nats < before + WORTH {
            break;
        }
    }
    best
}

/// Sizes [multiplied](MULTIPLIED) towards the data, and their log-likelihood (C. Fevotte, N. Bertin and J.-L. Durrieu, Neural
/// Computation 21, 2009, eq. 4.1 with the square root that makes it monotonic).
fn multiplied(data: &Data, components: &[Vec<f64>], mut squared: Vec<f64>) -> (Vec<f64>, f64) {
    for _ in 0..MULTIPLIED {
        let mut expected = vec![0.0; data.len()];
        add_mixture(&mut expected, components, &squared);
        let bins = data.dof.iter().zip(&data.psd).zip(&expected);
        let (up, down): (Vec<f64>, Vec<f64>) = bins
            .map(|((dof, psd), e)| (dof / e * psd / e, dof / e))
            .unzip();
        for (squared, component) in squared.iter_mut().zip(components) {
            let (up, down) = (dot(component, &up), dot(component, &down));
            *squared *= if down > 0.0 { (up / down).sqrt() } else { 1.0 };
        }
    }
    let mut expected = vec![0.0; data.len()];
    add_mixture(&mut expected, components, &squared);
    let nats = log_likelihood(data, &expected);
    (squared, nats)
}
