//! The sample at which a loss came: with strong lines it is known to one, whatever the noise is.
//!
//! The lines ahead of the loss and behind it are taken out of a short stretch about it, one up to a moment and the other
//! from there on; what is left is noise, of which neighbours foretell each sample. The moment is the one at which the
//! errors of these predictions are likeliest. The noise is cut with the lines, so that nothing ahead of the loss foretells
//! what is behind it: or a moment beside the true one is likelier where the lines' jump there is that of the noise.

use std::slice::SliceIndex;

use rustfft::num_complex::Complex64;

use super::line::{Line, Turned};
use super::moment::{Posterior, posterior};
use crate::diagnosis::steady::prediction::{ORDER, Prediction};
use crate::fft::phasor::Phasor;

/// Samples on either side of the moment that are tried, half the width of what was known before at most: a choice. Where more is
/// left open the lines are so weak that no single sample says anything.
const TRIED: usize = 48;

/// Samples on either side that the predictions rest on: sixty-four for each coefficient.
const RESTS_ON: usize = 64 * ORDER;

/// The moment of a loss of `samples` samples about `known`, in `values` whose lines are those `turned` by it; `None` where it is
/// not known nearly enough, or not all about it was measured.
pub(super) fn moment(
    values: &[f64],
    block: usize,
    lines: &[Line],
    turned: &[Turned],
    known: Posterior,
) -> Option<Posterior> {
    let middle = known.middle.round() as usize;
    let tried = middle.checked_sub(TRIED)?..middle + TRIED;
    if known.hi - known.lo > TRIED as f64 {
        return None;
    }
    let from = tried.start.checked_sub(RESTS_ON)?;
    let to = tried.end + RESTS_ON;
    let about = values.get(from..to)?;
    if about.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let samples = turned.first()?.samples;
    let mut ahead = about.to_vec();
    let mut behind = about.to_vec();
    for (line, turned) in lines.iter().zip(turned) {
        let phasor = Phasor::new(line.cycles(turned.offset, block));
        let out = |value: &mut f64, line: Complex64| *value -= line.re;
        phasor.zip(from, &mut ahead, turned.amplitude, out);
        phasor.zip(from + samples, &mut behind, turned.amplitude, out);
    }
    about_mean(&mut ahead, ..RESTS_ON);
    about_mean(&mut behind, about.len() - RESTS_ON..);
    let noise = [
        ahead[..RESTS_ON].to_vec(),
        behind[about.len() - RESTS_ON..].to_vec(),
    ];
    let prediction = Prediction::new(&noise)?;
    let (from, to) = (RESTS_ON - ORDER, RESTS_ON + 2 * TRIED + ORDER);
    let sum = |errors: &[f64]| errors.iter().map(|one| one * one).sum::<f64>();
    let ahead = prediction.errors(&ahead[from..to]);
    let gains = (0..=tried.len()).map(|number| {
        let cut = RESTS_ON + number;
        let behind = prediction.errors(&behind[cut..to]);
        -0.5 * (sum(&ahead[ORDER..cut - from]) + sum(&behind))
    });
    let gains: Vec<f64> = gains.collect();
    let found = posterior(&gains.iter().copied());
    let first = tried.start as f64;
    Some(Posterior {
        middle: first + found.middle,
        lo: first + found.lo,
        hi: first + found.hi,
        sd: found.sd.max(12f64.sqrt().recip()),
    })
}

/// What is left of a stretch without the mean of some of it.
fn about_mean(values: &mut [f64], of: impl SliceIndex<[f64], Output = [f64]>) {
    let of = &values[of];
    let mean = of.iter().sum::<f64>() / of.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
}
