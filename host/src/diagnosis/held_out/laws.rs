//! What the laws of an axis are worth, each in a model that has all others, by ordinates.

use nalgebra::{DMatrix, DVector};

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::held_out::SEEN_COST;
use crate::diagnosis::laws::{self, Law};
use crate::diagnosis::statistic::matched_filter::Half;
use crate::fit::likelihood::scoring::{Range, greatest_beside};
use crate::fit::likelihood::{Data, log_likelihood};
use crate::model::effect::Part;
use crate::numeric::mixture::add_mixture;

/// Bins an octave, as those of the fit.
const BINS_PER_OCTAVE: f64 = 16.0;

/// Power of the chain below which ordinates do not count: what falls more steeply than that from bin
/// to bin no mean over points can follow.
const PASSED: f64 = 0.1;

/// Frequencies in a bin at which a law is asked for its density, at most: a choice. A bin of a sixteenth of an octave holds two
/// lobes of a running mean at most, of which eight frequencies see the zero too.
const ASKED: usize = 16;

/// The ordinates of a residual in two halves.
pub struct Ordinates<'a> {
    axis: &'a AxisState,
    fitted: Binned,
    held: Binned,
}

/// Means of a periodogram.
struct Binned {
    data: Data,
    /// Frequencies all over each bin, hertz.
    asked_hz: Vec<Vec<f64>>,
}

impl<'a> Ordinates<'a> {
    /// Of an axis; `None` where it has none that count.
    pub fn new(axis: &'a AxisState) -> Option<Self> {
        Some(Self {
            axis,
            fitted: bins(axis, Half::Even)?,
            held: bins(axis, Half::Odd)?,
        })
    }

    /// Gain in log-likelihood of the held half from law number `which`, nats.
    pub fn nats(&self, which: usize) -> Option<f64> {
        let all = &self.axis.laws;
        let mut without = all.clone();
        let law = without.remove(which);
        let shapes = law.shape().count() as f64;
        Some(self.score(all)? - self.score(&without)? - SEEN_COST * shapes)
    }

    /// Log-likelihood of the held half with the sizes that fit the other best.
    fn score(&self, laws: &[Law]) -> Option<f64> {
        let floor = laws::floor(&self.axis.bins, laws);
        let components = self.components(laws, &self.fitted);
        let (squared, _) = greatest_beside(
            &self.fitted.data,
            &components,
            &vec![floor; self.fitted.data.len()],
            None,
            Range::NonNegative,
        )?;
        let mut expected = vec![floor; self.held.data.len()];
        add_mixture(&mut expected, &self.components(laws, &self.held), &squared);
        Some(log_likelihood(&self.held.data, &expected))
    }

    /// Densities of the base components and the laws, in the mean over each bin.
    fn components(&self, laws: &[Law], binned: &Binned) -> Vec<Vec<f64>> {
        let bins = &self.axis.bins;
        let parts: Vec<Part> = laws
            .iter()
            .map(|law| law.effect.part(&law.values))
            .collect();
        let power = |f_hz: f64| -> f64 {
            let powers = parts.iter().map(|part| match part {
                Part::Distortion(filter) => filter.shown(f_hz, bins.rate_hz()),
                Part::Term(_) | Part::Clock(_) | Part::Hold(_) | Part::Follows(_) => 1.0,
            });
            powers.product()
        };
        let at = |density: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let mean = |all: &Vec<f64>| {
                let sum: f64 = all.iter().map(|&f_hz| density(f_hz)).sum();
                sum / all.len() as f64
            };
            binned.asked_hz.iter().map(mean).collect()
        };
        let mut all: Vec<Vec<f64>> = (0..bins.units().len())
            .map(|unit| at(&|f_hz| bins.unit_density(unit, f_hz, power(f_hz))))
            .collect();
        for part in &parts {
            if let Part::Term(term) = part {
                all.push(at(&|f_hz| {
                    bins.term_density(&**term, f_hz) * bins.chain_power(f_hz) * power(f_hz)
                }));
            }
        }
        all
    }
}

/// Means of the periodogram over bins of a `half` of the ordinates.
fn bins(axis: &AxisState, half: Half) -> Option<Binned> {
    let seen = axis.whitened();
    let (mut f_hz, mut psd, mut variance) = (Vec::new(), Vec::new(), Vec::new());
    let mut asked_hz = Vec::new();
    let mut first = 1;
    let shut = (1..seen.top).find(|&k| axis.bins.chain_power(seen.transform.frequency(k)) < PASSED);
    let top = shut.unwrap_or(seen.top);
    while first < top {
        let next = (first as f64 * (1.0 / BINS_PER_OCTAVE).exp2()) as usize;
        let next = next.max(first + 2).min(top);
        let counted = (first..next).filter(|&k| half.has(k) && seen.density[k].is_finite());
        let counted: Vec<usize> = counted.collect();
        let (mut count, mut sum, mut log) = (0.0, 0.0, 0.0);
        for &k in &counted {
            count += 1.0;
            sum += seen.transform.ordinates()[k].norm_sqr() / seen.transform.power();
            log += seen.transform.frequency(k).ln();
        }
        if count > 0.0 {
            f_hz.push(f64::exp(log / count));
            psd.push(sum / count);
            variance.push(1.0 / count);
            let some = counted.iter().step_by(counted.len().div_ceil(ASKED));
            let some = some.map(|&k| seen.transform.frequency(k));
            asked_hz.push(some.collect());
        }
        first = next;
    }
    let covariance = DMatrix::from_diagonal(&DVector::from_vec(variance));
    let data = Data::from_parts(f_hz, psd, covariance)?;
    Some(Binned { data, asked_hz })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::Chain;
    use crate::diagnosis::trial::{self, RATE_HZ, axis, short};
    use crate::model::{Coefficient, Seed, averaging};

    #[test]
    fn no_ordinate_is_in_both_halves_and_none_is_left_out() {
        let axis = axis(1, short(1), |_, noise| noise);
        let halves = Ordinates::new(&axis).expect("ordinates");
        let count = |data: &Data| data.dof.iter().sum::<f64>();
        let (fitted, held) = (count(&halves.fitted.data), count(&halves.held.data));
        // Two degrees of freedom each, from the first ordinate to the last.
        let all = 2.0 * (axis.whitened().top - 1) as f64;
        assert!((fitted + held - all).abs() < 1e-6 * all, "{fitted} {held}");
        let [fitted, held] = [&halves.fitted, &halves.held].map(|one| &one.data.psd);
        let mut both = fitted.iter().zip(held);
        assert!(both.all(|(fitted, held)| fitted != held), "seed 1");
    }

    #[test]
    fn what_a_filter_shuts_out_says_nothing_of_a_law() {
        let chain: Chain = "ads1281:linear".parse().expect("a chain");
        let plain = axis(2, short(2), |_, noise| noise);
        let values = Arc::clone(&plain.filled);
        let axis = AxisState::new(values, RATE_HZ, Some(&chain)).expect("a spectrum");
        let halves = Ordinates::new(&axis).expect("ordinates");
        for data in [&halves.fitted.data, &halves.held.data] {
            let passed = data.f_hz.iter().map(|f_hz| chain.power(*f_hz, RATE_HZ));
            let least = passed.fold(f64::INFINITY, f64::min);
            assert!(least >= PASSED, "seed 2: {least}");
        }
    }

    #[test]
    fn zeros_between_lobes_are_means_over_their_bins() {
        for seed in 3..6 {
            // Flicker alone: in the middle of a zero there is a thousandth of what the bin about it holds.
            let mut raw = vec![0.0; short(seed)];
            let random = Seed { seed, stream: 3 };
            let flicker = Coefficient::B.term(1.0);
            flicker.generator(RATE_HZ, random).add_to(&mut raw);
            let mean = |n: usize| {
                let window = &raw[n.saturating_sub(14)..=n];
                window.iter().sum::<f64>() / window.len() as f64
            };
            let mut axis = axis(seed, raw.len(), |n, _| mean(n));
            let law = trial::law(averaging::KIND, &[15.0 / RATE_HZ]);
            axis.accept(trial::made_up(averaging::KIND, law))
                .expect("a fit");
            let halves = Ordinates::new(&axis).expect("ordinates");
            let nats = halves.nats(0).expect("a law");
            assert!(nats > 1000.0, "seed {seed}: {nats}");
        }
    }
}
