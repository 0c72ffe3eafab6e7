//! A converter whose filter a record shows, where no signal chain is declared.
//!
//! The digital filter of an ADS1281 passes all up to 0.41 of the data rate and next to nothing from 0.5 of it on: a wall that
//! noise of no sensor has by itself, and that every law of the catalogue would be tried on in vain. So it is looked for
//! before anything else: the upper end of the spectrum is fitted as noise behind a pole, a mean over some samples, both or
//! neither, with the filter and without.

use inm_protocol::Phase;

use crate::chain::Chain;
use crate::diagnosis::axis::AxisState;
use crate::diagnosis::laws;
use crate::diagnosis::laws::search::{self, Fitted, Starts};
use crate::diagnosis::record::bins::SpectralBins;
use crate::fit::likelihood::{Data, Fit};
use crate::model::kind::Kind;
use crate::model::{averaging, resonance, rolloff};

/// Share of the data rate from which the spectrum is looked at: half an octave below the wall shows the pole that may be
/// ahead of it, and little of what moves slowly.
const FROM: f64 = 0.25;

/// Share of the data rate where the wall begins: the filter's corner, at -3 dB, is 0.413 (ADS1281 data sheet, SBAS378, digital
/// filter).
const WALL: f64 = 0.41;

/// Least fall in power from the mean below the wall to the end of the spectrum without which no filter is tried: to half of it. Coarse
/// rounding behind the filter hides all but the beginning of its wall; of less nothing would be seen that a pole does not do.
const LEAST_FALL: f64 = 2.0;

/// The same where samples are missing: what was drawn behind the filter has its wall, be there one or not, and a third of
/// a record makes a fall to less than a half of it.
const LEAST_FALL_OF_DRAWN: f64 = 10.0;

/// How far off a bin of the wall may be, as a share, beside what chance makes of it: a choice, less than half of what
/// the filter of the other phase is off by at its end (39 % at 0.489 of the rate).
const TOLERANCE: f64 = 0.15;

/// Deviations of a bin that chance may make of it: passed once in 16 000 by a bin, of which there are five.
const BY_CHANCE: f64 = 4.0;

/// By how much likelier the record has to be with the filter, nats: twenty are one in 5e8, for two filters that are tried.
const LEAST_NATS: f64 = 20.0;

/// What may be ahead of the filter: both let less through at the upper end, in lobes or not, where no wall is.
const AHEAD: [Kind; 2] = [rolloff::KIND, averaging::KIND];

/// What may be there without a filter: what rings below the wall falls towards half of the rate too.
const IN_ITS_PLACE: [Kind; 3] = [resonance::KIND, rolloff::KIND, averaging::KIND];

/// By how much likelier one of them has to make the record, nats: what the best of some 150 starts gains by chance, once in
/// a hundred.
const AHEAD_NATS: f64 = 10.0;

/// The chain with which the upper end of an axis's spectrum agrees, where none is declared; its poles are found as
/// [`rolloff`]. What was filled in the place of missing samples is that of an axis `behind` the chain in question.
pub fn chain(axis: &AxisState, behind: impl Fn(&Chain) -> Option<AxisState>) -> Option<Chain> {
    let is_filled = axis.filled_samples() > 0;
    if axis.chain.is_some() || !(is_filled || falls(&axis.data, axis.rate_hz, LEAST_FALL)) {
        return None;
    }
    let phases = [Phase::Linear, Phase::Minimum];
    let fits = phases.into_iter().filter_map(|phase| {
        let chain = Chain {
            converter: Some(phase),
            poles_hz: Vec::new(),
        };
        let seen = is_filled.then(|| behind(&chain));
        let axis = seen.as_ref().map_or(Some(axis), Option::as_ref)?;
        let data = &axis.data;
        if is_filled && !falls(data, axis.rate_hz, LEAST_FALL_OF_DRAWN) {
            return None;
        }
        let bins = |chain| {
            let mut bins = SpectralBins::new(&axis.residual.values(), axis.rate_hz, chain)?;
            bins.know_less(axis.filled_share());
            bins.leave_out(&axis.excluded_hz());
            bins.know_floor(axis.bins.floor());
            Some(bins)
        };
        let (bins, unfiltered) = (bins(Some(&chain))?, bins(None)?);
        let (fit, ahead) = fitted(&bins, data, &AHEAD)?;
        let (without, _) = fitted(&unfiltered, data, &IN_ITS_PLACE)?;
        let gain = fit.log_likelihood - without.log_likelihood;
        let is_it = gain > LEAST_NATS && agrees(data, &fit, axis.rate_hz);
        is_it.then_some((chain, ahead, gain))
    });
    simplest(fits)
}

/// Of filters with how many laws are ahead of them and with their gains, nats: the one that needs fewest laws, and the likeliest
/// of these. The filter of one phase behind a pole or a mean looks like that of the other by itself.
fn simplest(fits: impl Iterator<Item = (Chain, usize, f64)>) -> Option<Chain> {
    let simplest = fits.min_by(|a, b| a.1.cmp(&b.1).then(b.2.total_cmp(&a.2)));
    simplest.map(|(chain, ..)| chain)
}

/// Whether the spectrum falls at its end, to less than one `least` of what it was below.
fn falls(data: &Data, rate_hz: f64, least: f64) -> bool {
    let below = |from: f64, to: f64| {
        let band = from * rate_hz..to * rate_hz;
        let bins = data.f_hz.iter().zip(&data.psd);
        let inside = bins.filter(|(f_hz, _)| band.contains(f_hz));
        inside.fold((0.0, 0.0), |(sum, count), (_, psd)| {
            (sum + psd, count + 1.0)
        })
    };
    let ((level, count), end) = (below(FROM, WALL), data.psd.last());
    end.is_some_and(|end| count > 0.0 && level > least * count * end)
}

/// The likeliest fit of the upper end of a spectrum with laws of these kinds, two at most, and how many of them there are.
fn fitted(bins: &SpectralBins, data: &Data, kinds: &[Kind]) -> Option<(Fit, usize)> {
    let starts = Starts::new(bins)?;
    let counts = |(f_hz, dof): (&f64, &f64)| *f_hz >= WALL * bins.rate_hz() && *dof >= 1.0;
    let shows_wall = data.f_hz.iter().zip(&data.dof).any(counts);
    let below = 0.0..FROM * bins.rate_hz();
    let data = Data {
        dof: bins.dof_beside(std::slice::from_ref(&below)),
        ..data.clone()
    };
    // Where its wall does not count, nothing says that what a mean makes of it is not there.
    let may_be = |kind: &Kind| shows_wall || *kind != averaging::KIND;
    let kinds: Vec<Kind> = kinds.iter().copied().filter(may_be).collect();
    let (mut laws, mut fit) = (Vec::new(), laws::fit(bins, &data, &[])?);
    for _ in 0..kinds.len().min(AHEAD.len()) {
        let present = Fitted {
            bins,
            data: &data,
            laws: &laws,
            fit: &fit,
        };
        let found = kinds.iter();
        let found = found.filter_map(|&kind| search::best(present, &starts, kind));
        let best = found.max_by(|a, b| a.nats.total_cmp(&b.nats));
        let Some(best) = best.filter(|best| best.nats > AHEAD_NATS) else {
            break;
        };
        laws.push(best.law);
        fit = best.fit;
    }
    Some((fit, laws.len()))
}

/// Whether every bin of the wall is what a fit expects there.
fn agrees(data: &Data, fit: &Fit, rate_hz: f64) -> bool {
    let bins = data.f_hz.iter().zip(&data.psd).zip(&data.dof);
    let mut wall = bins
        .zip(&fit.expected)
        .filter(|(((f_hz, _), _), _)| **f_hz >= WALL * rate_hz);
    wall.all(|(((_, psd), dof), expected)| {
        let deviation = (2.0 / dof).sqrt();
        (psd / expected - 1.0).abs() <= TOLERANCE + BY_CHANCE * deviation
    })
}

#[cfg(test)]
mod tests;
