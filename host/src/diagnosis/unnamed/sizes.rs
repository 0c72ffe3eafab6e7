//! Sizes of many components at once.

use crate::fit::likelihood::scoring::{Range, greatest_beside};
use crate::fit::likelihood::{Data, log_likelihood};
use crate::numeric::bisect::bisect;
use crate::numeric::mixture::add_mixture;
use crate::numeric::product::dot;
use crate::spectrum::pool;

/// How often sizes are multiplied towards the data before they are scored: enough to come within a tenth.
const MULTIPLIED: usize = 30;

/// Rounds of both, at most, and the gain that is worth another, nats: choices. One is usual.
const ROUNDS: usize = 6;
const WORTH: f64 = 1.0;

/// Probability that a bin is as quiet as that beside what it is expected to be: hundreds of bins are looked at for each of
/// hundreds of components.
const HARDLY: f64 = 1e-6;

/// Share of the room for it that a size starts at which was zero: multiplied, zero stays what it is. A choice: it
/// hardly shows where it is not needed.
const HARDLY_THERE: f64 = 1e-6;

/// Degrees of freedom of a mean that is hardly a tenth of what is expected: one of 8 is, by chance, once in thirteen hundred
/// (SciPy's `chi2.cdf(0.8, 8)`).
const KNOWN: f64 = 8.0;

/// Halvings of the logarithm of what a bin hardly falls short of: to a thousandth of it where that is 300 orders of magnitude.
const HALVINGS: u32 = 20;

/// The sizes that components may have beside a spectrum. The likelihood hardly minds what is far too large: a bin that
/// is expected to be a thousand times as loud as it is costs seven nats for every two degrees of freedom, one that is
/// as quiet costs a thousand. So a band whose skirt suits one end of the spectrum is taken in where it stands out by
/// orders of magnitude at the other, while nothing better is there. No component is larger than all of what is measured.
pub struct Sizes<'a> {
    /// The spectrum.
    pub data: &'a Data,
    /// Densities that are measured about each bin.
    pub measured: Vec<f64>,
    /// The most that each bin may be expected to be.
    most: Vec<f64>,
    /// What each is expected to be beside all components.
    pub fixed: Vec<f64>,
}

impl<'a> Sizes<'a> {
    /// Beside this spectrum, of which a part is `fixed`.
    pub fn beside(data: &'a Data, fixed: Vec<f64>) -> Self {
        let bins = data.dof.iter().zip(&data.psd);
        let most = bins.map(|(&dof, psd)| psd / least_share(dof));
        Self {
            data,
            measured: measured(data),
            most: most.collect(),
            fixed,
        }
    }

    /// The largest square of a component that leaves room in each of its bins.
    pub fn most(&self, component: &[f64]) -> f64 {
        let bins = self.most.iter().zip(component);
        let room = bins.filter(|(_, own)| **own > 0.0);
        room.map(|(most, own)| most / own)
            .fold(f64::INFINITY, f64::min)
    }

    /// Squares of `components` to start from that leave room; those at zero are raised to [`HARDLY_THERE`] of it.
    pub fn start(&self, components: &[Vec<f64>], squared: Vec<f64>) -> Vec<f64> {
        let pairs = squared.into_iter().zip(components);
        let within = pairs.map(|(own, component)| {
            let most = self.most(component);
            if most.is_finite() {
                own.clamp(HARDLY_THERE * most, most)
            } else {
                own
            }
        });
        within.collect()
    }

    /// The likeliest squares of `components`, from a start, and their log-likelihood. The start leaves room. Scoring may fail to get
    /// anywhere from one that is far off: then the sizes are first multiplied towards the data, which never loses, and both as often as that gains.
    pub fn likeliest(&self, components: &[Vec<f64>], squared: &[f64]) -> Option<(Vec<f64>, f64)> {
        let most: Vec<f64> = components.iter().map(|one| self.most(one)).collect();
        let scored = |start: &[f64]| {
            let range = Range::NonNegative;
            let sizes = greatest_beside(self.data, components, &self.fixed, Some(start), range)?;
            let mut pairs = sizes.0.iter().zip(&most);
            pairs.all(|(own, most)| own <= most).then_some(sizes)
        };
        let mut start = squared.to_vec();
        let mut best: Option<(Vec<f64>, f64)> = scored(&start);
        for _ in 0..ROUNDS {
            let multiplied = self.multiplied(components, &most, start);
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

    /// Sizes [multiplied](MULTIPLIED) towards the data, each up to its `most`, and their log-likelihood (C. Fevotte, N. Bertin
    /// and J.-L. Durrieu, Neural Computation 21, 2009, eq. 4.1 with the square root that makes it monotonic).
    fn multiplied(
        &self,
        components: &[Vec<f64>],
        most: &[f64],
        mut squared: Vec<f64>,
    ) -> (Vec<f64>, f64) {
        let data = self.data;
        for _ in 0..MULTIPLIED {
            let mut expected = self.fixed.clone();
            add_mixture(&mut expected, components, &squared);
            let bins = data.dof.iter().zip(&data.psd).zip(&expected);
            let (up, down): (Vec<f64>, Vec<f64>) = bins
                .map(|((dof, psd), e)| (dof / e * psd / e, dof / e))
                .unzip();
            for ((squared, component), most) in squared.iter_mut().zip(components).zip(most) {
                let (up, down) = (dot(component, &up), dot(component, &down));
                *squared *= if down > 0.0 { (up / down).sqrt() } else { 1.0 };
                *squared = squared.min(*most);
            }
        }
        let mut expected = self.fixed.clone();
        add_mixture(&mut expected, components, &squared);
        let nats = log_likelihood(data, &expected);
        (squared, nats)
    }
}

/// Densities of bins, those of few values as the mean with their neighbours: one of two values may be nearly nothing by chance.
fn measured(data: &Data) -> Vec<f64> {
    let mut measured = data.psd.clone();
    for (run, dof) in pool::runs(data.dof.iter().copied(), KNOWN) {
        let mean = dot(&data.dof[run.clone()], &data.psd[run.clone()]) / dof;
        if dof > 0.0 {
            measured[run].fill(mean);
        }
    }
    measured
}

/// The share of what is expected that a bin of so many degrees of freedom hardly falls short of: one has less than a share
/// `x` with a probability of at most `(x e^(1 - x))^(dof / 2)` (H. Chernoff, Ann. Math. Stat. 23, 1952).
fn least_share(dof: f64) -> f64 {
    let power = HARDLY.ln() / (0.5 * dof);
    // The rest of the exponent is between 0 and 1.
    let least = (power - 1.0).max(f64::MIN_POSITIVE.ln());
    bisect(least, 0.0, HALVINGS, |ln| ln + 1.0 - ln.exp() < power).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use statrs::distribution::{ChiSquared, ContinuousCDF};

    #[test]
    fn a_bin_hardly_falls_short_of_its_least_share() {
        for dof in [1.0, 2.0, 7.5, 18.5, 37.0, 300.0, 5e3] {
            let law = ChiSquared::new(dof).expect("positive");
            let share = least_share(dof);
            let probability = law.cdf(dof * share);
            assert!(probability <= HARDLY, "{dof}: {share}, {probability}");
            // The bound is Chernoff's: a few times too small a probability, not orders of magnitude.
            assert!(probability > 1e-3 * HARDLY, "{dof}: {share}, {probability}");
        }
        assert!(least_share(1e-9) < 1e-300);
    }

    #[test]
    fn a_peak_is_no_larger_than_its_middle_has_room_for() {
        // A skirt falls into bins that are known a thousand times as well as the middle of its peak, where hardly anything is.
        let (middle, skirt) = (10, 100);
        let dof = [vec![37.0; middle], vec![3e4; skirt]].concat();
        let peak = [vec![1.0; middle], vec![1e-5; skirt]].concat();
        // Another component makes all of it but the last bin.
        let mut floor = vec![1e-3; middle + skirt];
        floor[middle + skirt - 1] = 0.0;
        let psd = [vec![3.0; middle], vec![2.0; skirt]].concat();
        let variances = DVector::from_iterator(dof.len(), dof.iter().map(|dof| 2.0 / dof));
        let data = Data::from_parts(
            vec![1.0; psd.len()],
            psd,
            DMatrix::from_diagonal(&variances),
        );
        let data = data.expect("positive densities");
        let sizes = Sizes::beside(&data, vec![0.0; data.len()]);
        let components = [peak, floor];
        let start = sizes.start(&components, vec![1e5, 1e3]);
        assert!(start[0] <= sizes.most(&components[0]), "{start:?}");
        let most = sizes.most(&components[0]);
        assert!(most < 30.0, "{most}");
        let nothing = vec![0.0; data.len()];
        let far = [1e5, 1e3];
        let free = greatest_beside(&data, &components, &nothing, Some(&far), Range::NonNegative);
        let free = free.expect("sizes").0;
        assert!(
            free[0] > 1e4,
            "{free:?}: the likeliest near there is far above"
        );
        let (squared, _) = sizes.likeliest(&components, &start).expect("sizes");
        assert!(squared[0] <= most, "{squared:?}");
        assert!((1e-3 * squared[1] - 2.0).abs() < 0.1, "{squared:?}");
    }
}
