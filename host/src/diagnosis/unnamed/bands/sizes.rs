//! Sizes of many components at once.

use crate::fit::likelihood::scoring::{Range, greatest_beside};
use crate::fit::likelihood::{Data, log_likelihood};
use crate::numeric::mixture::add_mixture;
use crate::numeric::product::dot;

/// How often sizes are multiplied towards the data before they are scored: enough to come within a tenth.
const MULTIPLIED: usize = 30;

/// The likeliest squares of `components`, from a start, and their log-likelihood. Scoring may fail to get anywhere from a
/// start that is far off: then the sizes are first multiplied towards the data, which never loses (C. Fevotte,
/// N. Bertin and J.-L. Durrieu, Neural Computation 21, 2009, eq. 4.1 with the square root that makes it monotonic).
pub fn likeliest(
    data: &Data,
    components: &[Vec<f64>],
    mut squared: Vec<f64>,
) -> Option<(Vec<f64>, f64)> {
    let nothing = vec![0.0; data.len()];
    let scored = |start: &[f64]| {
        greatest_beside(data, components, &nothing, Some(start), Range::NonNegative)
    };
    let first = scored(&squared);
    for _ in 0..MULTIPLIED {
        let mut expected = nothing.clone();
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
    let second = scored(&squared);
    let mut expected = nothing.clone();
    add_mixture(&mut expected, components, &squared);
    let multiplied = Some((squared, log_likelihood(data, &expected)));
    let fits = [first, second, multiplied].into_iter().flatten();
    fits.max_by(|a, b| a.1.total_cmp(&b.1))
}
