//! The shock that explains an event best: when, how high, at which frequency, how long.

#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};
use realfft::num_complex::Complex64;

use super::about::About;
use crate::fft;
use crate::model::shock::Shock;
use crate::numeric::product::dot;
use crate::numeric::simplex::climbed;

/// Decays and lengths that are tried first, each so many times the one before: a choice. The simplex goes on from
/// there.
const NEXT: f64 = 1.6;

/// Peaks of the spectrum that ringing is sought at: a choice.
const PEAKS: usize = 3;

/// Twice the gain that one more number must bring: as by the information criterion of G. Schwarz, Ann. Stat. 6 (1978), for
/// some thousand samples.
pub const ONE_MORE: f64 = 7.0;

/// Twice a gain that decides nothing.
const CLOSE: f64 = 0.1;

/// A shock as fitted to an event, its times in samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The shock; one that rings has no end.
    pub shock: Shock,
    /// Standard deviations of time, peak and, relative, of frequency and decay, or of the duration.
    pub sd: Vec<f64>,
    /// Twice its gain in log-likelihood.
    pub score: f64,
}

/// What a shock may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A sine that dies away.
    Ringing,
    /// Half a sine.
    Bump,
}

impl Form {
    /// The shock of height 1 with these numbers: time, then logarithms.
    fn shock(self, at: &[f64]) -> Shock {
        let plain = Shock {
            time_s: at[0],
            peak: 1.0,
            duration_s: f64::INFINITY,
            f_hz: 0.0,
            decay_s: 0.0,
        };
        match self {
            Self::Ringing => Shock {
                f_hz: at[1].exp(),
                decay_s: at[2].exp(),
                ..plain
            },
            Self::Bump => Shock {
                duration_s: at[1].exp(),
                ..plain
            },
        }
    }
}

/// The shock that explains an event best, of those that ring and those that do not.
pub fn fit(about: &About) -> Option<Fitted> {
    let all = first_ringing(about).into_iter();
    let all = all.filter_map(|first| settle(about, Form::Ringing, &first));
    let ringing = all.max_by(|a, b| a.score.total_cmp(&b.score));
    let ringing = ringing.map(|best| on_its_turn(about, best));
    let bump = first_bump(about).and_then(|first| settle(about, Form::Bump, &first));
    let worth = |one: &Option<Fitted>, less: f64| one.as_ref().map_or(0.0, |one| one.score - less);
    if worth(&ringing, ONE_MORE) > worth(&bump, 0.0) {
        ringing
    } else {
        bump
    }
}

/// Ringing where it begins: half a turn earlier or later it is another of the other sign, nearly as good, and between the two
/// none is.
fn on_its_turn(about: &About, mut best: Fitted) -> Fitted {
    loop {
        let half = 0.5 / best.shock.f_hz;
        let beside = [-half, half].map(|aside| {
            let shock = &best.shock;
            let at = [shock.time_s + aside, shock.f_hz.ln(), shock.decay_s.ln()];
            settle(about, Form::Ringing, &at)
        });
        let beside = beside.into_iter().flatten();
        match beside.max_by(|a, b| a.score.total_cmp(&b.score)) {
            Some(better) if better.score > best.score + CLOSE => best = better,
            _ => return best,
        }
    }
}

fn score(about: &About, form: Form, at: &[f64]) -> f64 {
    let len = (about.errors().len() * about.factor()) as f64;
    let from = about.from() as f64;
    let within = (from - 2.0..from + len).contains(&at[0]);
    let sound = match form {
        Form::Ringing => {
            // What is damped more than critically does not ring: a quality `pi f decay` of a half.
            let rings = at[1] + at[2] > (0.5 / std::f64::consts::PI).ln();
            rings && at[1] < 0.5_f64.ln() && at[2] < (4.0 * len).ln() && at[2] > -1.0
        }
        Form::Bump => at[1] < len.ln() && at[1] > 0.0,
    };
    if !(within && sound) {
        return f64::NEG_INFINITY;
    }
    about.explained(&about.of_shock(&form.shock(at))).score
}

/// Where ringing is sought: at each of the highest peaks of the errors' spectrum, at all moments and some decays.
fn first_ringing(about: &About) -> Vec<Vec<f64>> {
    let peaks = peaks(about.errors());
    peaks
        .into_iter()
        .map(|one| ringing_at(about, one))
        .collect()
}

/// The best moment and decay of ringing of so many cycles a mean, as the logarithms are sought by.
fn ringing_at(about: &About, cycles: f64) -> Vec<f64> {
    let errors = about.errors();
    let factor = about.factor() as f64;
    let mut best = (0.0, about.from() as f64, 1.0);
    let mut decay = 1.0;
    while decay < errors.len() as f64 {
        let keep = Complex64::from_polar((-1.0 / decay).exp(), -std::f64::consts::TAU * cycles);
        let square = 0.5 / (1.0 - keep.norm_sqr());
        let mut sum = Complex64::ZERO;
        for (n, error) in errors.iter().enumerate().rev() {
            sum = sum * keep + error;
            let score = sum.norm_sqr() / square;
            if score > best.0 {
                best = (score, about.from() as f64 + n as f64 * factor, decay);
            }
        }
        decay *= NEXT;
    }
    let (_, begins, decay) = best;
    let logs = [(cycles / factor).ln(), (decay * factor).ln()];
    // Its phase is that of a sine from its beginning: which of some beginnings, the score says.
    let shifted = (-8..=8).map(|step| {
        let turns = f64::from(step) / 8.0;
        let at = [begins + turns * factor / cycles, logs[0], logs[1]];
        (score(about, Form::Ringing, &at), at)
    });
    let best = shifted.max_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or_else(Vec::new, |(_, at)| at.to_vec())
}

/// Frequencies of the highest peaks of a spectrum, cycles a value.
fn peaks(errors: &[f64]) -> Vec<f64> {
    let len = (4 * errors.len()).next_power_of_two();
    let fft = fft::real_forward(len);
    let (mut values, mut ordinates) = (fft.make_input_vec(), fft.make_output_vec());
    values[..errors.len()].copy_from_slice(errors);
    if fft.process(&mut values, &mut ordinates).is_err() {
        return Vec::new();
    }
    let powers: Vec<f64> = ordinates.iter().map(Complex64::norm_sqr).collect();
    let mut tops: Vec<usize> = (1..powers.len() - 1)
        .filter(|&k| powers[k] > powers[k - 1] && powers[k] >= powers[k + 1])
        .collect();
    tops.sort_by(|&a, &b| powers[b].total_cmp(&powers[a]));
    tops.truncate(PEAKS);
    tops.into_iter().map(|k| k as f64 / len as f64).collect()
}

/// Where a bump is sought: at all moments, of some lengths.
fn first_bump(about: &About) -> Option<Vec<f64>> {
    let errors = about.errors();
    let len = errors.len();
    let factor = about.factor() as f64;
    let mut best: (f64, Option<Vec<f64>>) = (0.0, None);
    let mut length = 2.0;
    while length < len as f64 {
        let samples = length as usize;
        // Far enough from both ends that it is what it is anywhere.
        let mut means = vec![0.0; 2 * len];
        for (n, mean) in means[len..].iter_mut().take(samples).enumerate() {
            *mean = (std::f64::consts::PI * (n as f64 + 0.5) / length).sin();
        }
        let course = about.unlevelled(&means)[len..].to_vec();
        let square = dot(&course, &course);
        // What lies beyond the bump and the predictor's reach is nothing.
        let course = &course[..(samples + 64).min(len)];
        // The simplex finds what lies between.
        for at in (0..len).step_by((samples / 8).max(1)) {
            let product = dot(&errors[at..], course);
            let score = product * product / square;
            if score > best.0 {
                let time = about.from() as f64 + at as f64 * factor;
                best = (score, Some(vec![time, (length * factor).ln()]));
            }
        }
        length *= NEXT;
    }
    best.1
}

/// The best fit near a `first` one, with its deviations.
pub fn settle(about: &About, form: Form, first: &[f64]) -> Option<Fitted> {
    let shock = form.shock(first);
    let length = if form == Form::Ringing {
        0.25 / shock.f_hz
    } else {
        0.25 * shock.duration_s
    };
    let mut steps = vec![0.4; first.len()];
    steps[0] = length.max(0.25);
    if form == Form::Ringing {
        // Within the width of its peak.
        steps[1] = (0.1 / (shock.f_hz * shock.decay_s)).min(0.3);
    }
    known(
        about,
        form,
        &climbed(first, &steps, |at| score(about, form, at)),
    )
}

/// A shock with these numbers, with its size and deviations.
pub fn known(about: &About, form: Form, at: &[f64]) -> Option<Fitted> {
    let explained = about.explained(&about.of_shock(&form.shock(at)));
    let sd = deviations(about, form, at, explained.size)?;
    Some(Fitted {
        shock: Shock {
            peak: explained.size,
            ..form.shock(at)
        },
        sd,
        score: explained.score,
    })
}

/// Standard deviations of time, size and the logarithms, in noise of deviation 1.
fn deviations(about: &About, form: Form, at: &[f64], size: f64) -> Option<Vec<f64>> {
    let whitened = |at: &[f64]| about.of_shock(&form.shock(at));
    let mut columns = Vec::new();
    for number in 0..at.len() {
        let step = if number == 0 {
            0.05 * about.factor() as f64
        } else {
            1e-3
        };
        let [mut low, mut high] = [at.to_vec(), at.to_vec()];
        low[number] -= step;
        high[number] += step;
        let (low, high) = (whitened(&low), whitened(&high));
        let slope = high
            .iter()
            .zip(&low)
            .map(|(high, low)| size * (high - low) / (2.0 * step));
        columns.push(DVector::from_iterator(low.len(), slope));
        if number == 0 {
            columns.push(DVector::from_vec(whitened(at)));
        }
    }
    let slopes = DMatrix::from_columns(&columns);
    let covariance = (slopes.transpose() * &slopes).try_inverse()?;
    let sd: Vec<f64> = covariance
        .diagonal()
        .iter()
        .map(|one| one.max(0.0).sqrt())
        .collect();
    sd.iter().all(|one| one.is_finite()).then_some(sd)
}
