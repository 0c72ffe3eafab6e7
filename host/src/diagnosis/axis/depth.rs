//! How deep the spectrum of a record is looked into.
//!
//! What a script filtered in double precision has a stop band a millionth of a millionth of what it lets through: nothing that an
//! Allan deviation shows, and for a likelihood, which weighs ratios, as much as all the rest. Such a record gets white noise
//! that is known, as one that is rounded has it.

use super::AxisState;
use crate::diagnosis::statistic::spread::middle_spread;
use crate::model::Seed;
use crate::model::random::Gaussian;

/// Standard deviation of the noise over that of one sample's, by the middle half of its increments: a choice. At one sample the
/// Allan deviation is then larger by no more than a millionth.
const DEEPEST: f64 = 1e-3;

/// Part of the rate from which on a spectrum is asked how deep it is: a choice. Below, what falls toward zero, as quantisation
/// noise does, is no stop band.
const FROM: f64 = 0.05;

/// A record with noise that hides what is deeper.
pub struct Shallow {
    /// Its samples.
    pub measured: Vec<f64>,
    /// Two-sided density of the noise, white.
    pub floor: f64,
}

/// What was `measured` of an axis with noise that hides what is deeper; `None` where nothing is, or where a converter is
/// declared, whose stop band is its own.
pub fn shallow(measured: &[f64], axis: &AxisState) -> Option<Shallow> {
    let chain = axis.chain.as_ref();
    if chain.is_some_and(|chain| chain.converter.is_some()) {
        return None;
    }
    let increments = measured.windows(2).map(|pair| pair[1] - pair[0]);
    let increments: Vec<f64> = increments.filter(|step| step.is_finite()).collect();
    let deviation = DEEPEST * middle_spread(&increments) / std::f64::consts::SQRT_2;
    let floor = deviation * deviation / axis.rate_hz;
    let mut bins = axis.data.f_hz.iter().zip(&axis.data.psd);
    let is_deep = bins.any(|(f_hz, psd)| *f_hz > FROM * axis.rate_hz && *psd < floor);
    is_deep.then(|| {
        // The same for the same record, and another for each axis: what axes share has a name.
        let seed = measured.iter().find(|value| value.is_finite());
        let seed = seed.map_or(0, |value| value.to_bits());
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, deviation);
        let measured = measured.iter().map(|value| value + noise.draw()).collect();
        Shallow { measured, floor }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::detect::trial::{RATE_HZ, noise};
    use crate::model::effect::Distortion;
    use crate::model::rolloff::RollOff;

    fn axis(values: &[f64]) -> AxisState {
        AxisState::new(values.to_vec().into(), RATE_HZ, None).expect("long enough")
    }

    fn of(values: &[f64]) -> Option<Shallow> {
        shallow(values, &axis(values))
    }

    /// Noise behind eight poles above a tenth of the rate, where the middle of the band is, twice.
    fn filtered() -> Vec<f64> {
        let mut filtered = noise(3);
        let seed = Seed { seed: 3, stream: 9 };
        let filter = RollOff::of(&[0.15 * RATE_HZ, 8.0, 1.0]);
        // One alone is made to 60 dB.
        for _ in 0..2 {
            filter.distorter(RATE_HZ, seed).apply(&mut filtered);
        }
        filtered
    }

    #[test]
    fn nothing_is_whitened_in_a_stop_band() {
        let all = axis(&noise(3)).whitened();
        assert_eq!(all.top, all.density.len(), "white noise");
        let seen = axis(&filtered()).whitened();
        let top_hz = seen.transform.frequency(seen.top);
        // Eight poles, twice, are 50 dB down at one and a half times their corner.
        let corners = top_hz / (0.15 * RATE_HZ);
        assert!((1.0..3.0).contains(&corners), "{corners} corners");
    }

    #[test]
    fn only_what_is_deeper_than_any_sensor_is_hidden() {
        assert!(of(&noise(3)).is_none(), "white noise");
        let filtered = filtered();
        let shallow = of(&filtered).expect("a stop band");
        let added = filtered.iter().zip(&shallow.measured);
        let squares: f64 = added.map(|(a, b)| (a - b).powi(2)).sum();
        let density = squares / filtered.len() as f64 / RATE_HZ;
        // The variance of so many samples to five standard deviations.
        let off = 5.0 * (2.0 / filtered.len() as f64).sqrt();
        assert!((density / shallow.floor - 1.0).abs() < off);
    }
}
