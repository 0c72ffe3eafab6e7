//! How much louder the noise of a stretch is than that of others as long in which nothing happens, and which part of it.

use std::ops::Range;

use super::bands::{data, groups, mean, periodogram};
use super::course::deflection;
use crate::diagnosis::laws::gain::Local;
use crate::fit::likelihood::Data;

/// Samples that bands are taken from, at least: a choice. Of fewer hardly a frequency can be told.
pub const LEAST: usize = 48;

/// A record about an event.
pub struct Beside<'a> {
    /// The samples.
    pub values: &'a [f64],
    /// Runs in which nothing happens, ascending.
    pub quiet: &'a [Range<usize>],
    /// The run of samples about the event in which nothing else happens.
    pub own: &'a Range<usize>,
}

/// Share of what is measured that is nothing: a choice. What a filter shuts out is told by no taper, nor what stands for
/// noise that is not known.
const NOTHING: f64 = 1e-6;

/// The spectrum of a stretch, and of others as long in which nothing happens.
pub struct Inside {
    /// What it is over the line between the levels beside it, and over its mean.
    pub values: Vec<f64>,
    /// Ordinates that are taken together.
    pub groups: Vec<Range<usize>>,
    /// Their powers.
    pub data: Data,
    /// What is expected of noise alone; hardly anything where that is not known.
    pub noise: Vec<f64>,
    /// Whether it is known.
    pub is_known: bool,
}

/// How much louder the noise of a stretch is.
#[derive(Debug, Clone, Copy)]
pub struct Louder {
    /// Factor on its deviation.
    pub factor: f64,
    /// Standard deviation of the logarithm of that.
    pub log_factor_sd: f64,
    /// Frequency above which it is louder, cycles a sample; `None` where all of it is.
    pub above: Option<f64>,
    /// Gain in log-likelihood over noise as it is elsewhere, nats.
    pub gain_nats: f64,
}

impl Inside {
    /// Of the `samples` of a record, without their mean where that is given; `None` where they are too few, or nothing is in
    /// them.
    pub fn new(beside: &Beside<'_>, samples: &Range<usize>, mean: Option<f64>) -> Option<Self> {
        if samples.len() < LEAST {
            return None;
        }
        // Of an even number ordinates lie alike.
        let even = samples.start..samples.end - samples.len() % 2;
        let mut inside = deflection(beside.values, &even, beside.own);
        let mut groups = groups(even.len() / 2);
        if let Some(mean) = mean {
            inside.iter_mut().for_each(|value| *value -= mean);
            // The sum of all samples says nothing any more.
            groups.remove(0);
        }
        let data = data(&periodogram(&inside), &groups)?;
        let (noise, is_known) = beside.noise(&even, &groups, &data);
        Some(Self {
            values: inside,
            groups,
            data,
            noise,
            is_known,
        })
    }

    /// Mean square of what is expected of noise alone.
    pub fn noise_power(&self) -> f64 {
        let groups = self.groups.iter().zip(&self.noise);
        let powers = groups.map(|(group, density)| group.len() as f64 * density);
        powers.sum::<f64>() / (self.values.len() / 2) as f64
    }

    /// How much louder it is, if the noise is of which [a part](own_shapes) is.
    pub fn louder(&self) -> Option<Louder> {
        if !self.is_known {
            return None;
        }
        let (data, noise) = (&self.data, &self.noise);
        let all = own_shapes(noise, &data.f_hz)
            .into_iter()
            .map(|(above, expected)| {
                let most = f64::INFINITY;
                let own = Local {
                    first: 0,
                    expected,
                    most,
                };
                let (squared, gain_nats) = own.best(data, noise);
                let share = |bin: usize| {
                    let louder = squared * own.expected[bin];
                    louder / (noise[bin] + louder)
                };
                // Fisher's information on the logarithm of what is added.
                let known = (0..noise.len()).map(|bin| 0.5 * data.dof[bin] * share(bin).powi(2));
                let added_sd = known.sum::<f64>().powf(-0.5);
                // The noise holds that share of what is louder.
                let ratio = (1.0 + squared) / (1.0 - NOTHING * (1.0 + squared)).max(NOTHING);
                Louder {
                    factor: ratio.sqrt(),
                    above,
                    log_factor_sd: 0.5 * added_sd * squared / (1.0 + squared),
                    gain_nats,
                }
            });
        all.max_by(|a, b| a.gain_nats.total_cmp(&b.gain_nats))
    }
}

/// What of some noise may be louder, and above which frequency that is where it is not all of it: all; what is left of it
/// where slow noise does not rise above it, which is white below its least density, or falls with the square of the
/// frequency as that of rounding; or all but a floor that is behind what is loud, as that of rounding behind a filter.
fn own_shapes(noise: &[f64], f_hz: &[f64]) -> [(Option<f64>, Vec<f64>); 4] {
    /// Density over the least one from which noise is slow noise: where that is as strong as what is left.
    const TWICE: f64 = 2.0;
    /// Mean density over the least one from which that is a floor: a choice, what a filter's edge leaves.
    const BEHIND: f64 = 10.0;
    let least = (1..noise.len()).min_by(|&a, &b| noise[a].total_cmp(&noise[b]));
    let least = least.unwrap_or(0);
    let floor = noise[least];
    let below = |power: i32| -> Vec<f64> {
        let shape = noise.iter().zip(f_hz).enumerate();
        let shape = shape.map(|(group, (density, here_hz))| match group < least {
            true => floor * (here_hz / f_hz[least]).powi(power),
            false => *density,
        });
        shape.collect()
    };
    let slow = noise[..least]
        .iter()
        .rposition(|density| *density > TWICE * floor);
    // Where the mean of the stretch alone is slow, at no frequency, it is so up to half of the first one.
    let edge_hz = |group: usize| f_hz[group].max(0.5 * f_hz[1]);
    // What is no more than chance above the floor is no part of the noise.
    let is_behind = mean(noise) > BEHIND * floor;
    let hidden = if is_behind { floor } else { 0.0 };
    let above_floor = noise.iter().map(|density| density - hidden).collect();
    [
        (None, noise.to_vec()),
        (slow.map(edge_hz), below(0)),
        (slow.map(|_| f_hz[least]), below(2)),
        (None, above_floor),
    ]
}

impl Beside<'_> {
    /// What the groups of ordinates are of stretches as long in which nothing happens, and whether there are any; hardly
    /// anything where there are none.
    fn noise(
        &self,
        samples: &Range<usize>,
        groups: &[Range<usize>],
        data: &Data,
    ) -> (Vec<f64>, bool) {
        /// Stretches that are enough: a choice.
        const ENOUGH: usize = 16;
        let len = samples.len();
        let places = |run: &Range<usize>| {
            let (from, to) = (run.start + len, run.end.saturating_sub(2 * len - 1));
            (from..to).step_by(len)
        };
        let mut places: Vec<usize> = self.quiet.iter().flat_map(places).collect();
        places.sort_by_key(|place| place.abs_diff(samples.start));
        places.truncate(ENOUGH);
        let count = places.len() as f64;
        let is_known = !places.is_empty();
        let mut noise: Vec<f64> = data.psd.iter().map(|psd| NOTHING * psd).collect();
        for start in places {
            let place = start..start + len;
            let own = start - len..place.end + len;
            let quiet = periodogram(&deflection(self.values, &place, &own));
            for (noise, group) in noise.iter_mut().zip(groups) {
                *noise += mean(&quiet[group.clone()]) / count;
            }
        }
        (noise, is_known)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_louder_but_for_the_level_is_so_above_a_frequency() {
        // The mean of the stretch, at no frequency, is all that stands above the floor.
        let noise = [10.0, 1.0, 1.1, 1.2];
        let f_hz = [0.0, 0.01, 0.02, 0.04];
        let above = own_shapes(&noise, &f_hz).map(|(above, _)| above);
        assert_eq!(above, [None, Some(0.005), Some(0.01), None]);
    }
}
