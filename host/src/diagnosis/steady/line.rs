//! Whether a line keeps its size and phase from one part of the record to the next.
//!
//! In each of eight parts the line's phasor is measured under a Hann window, `c_i`, each with the
//! variance `2 S rate sum w^2 / (sum w)^2` of both its real and imaginary part for noise of two-sided
//! density `S`. For a steady line the squared distances from their mean, over that variance, are
//! chi-squared with 2 (8 - 1) - 1 degrees of freedom once a turn of the phase in proportion to time is
//! taken out, which is the frequency's own error.

use realfft::num_complex::Complex64;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::statistic::p_value;
use crate::fft::phasor::Phasor;
use crate::numeric::taper::hann;

/// Parts of the record: a choice. More see quicker changes and each has less of the line.
const PARTS: usize = 8;

/// Cycles that a part must have for what wanders below not to pass the window.
const LEAST_CYCLES: f64 = 8.0;

/// Share of a tone's energy that one steady line may miss: of a strong one the least imperfection shows, and is no
/// wandering. A hundredth is a choice; the part of a line that gaps spread beside it is less, of noise that rings it is
/// a half.
pub const IMPERFECT: f64 = 0.01;

/// Probability that a steady line of `cycles` a sample in the residual differs as much between
/// parts; 1 where the record is too short for a test.
pub fn p_steady(axis: &AxisState, cycles: f64) -> f64 {
    let length = axis.filled.len() / PARTS;
    if cycles * (length as f64) < LEAST_CYCLES {
        return 1.0;
    }
    let density = axis.density(cycles * axis.rate_hz) * axis.rate_hz;
    let window = |offset: usize| hann(offset as f64 + 0.5, length as f64);
    let window: Vec<f64> = (0..length).map(window).collect();
    let mut parts: Vec<Part> = (0..PARTS)
        .filter_map(|number| {
            let (phasor, gain) = phasor(axis, cycles, number * length, &window)?;
            Some(Part {
                phasor,
                weight: (2.0 * density * gain).recip(),
                number: number as f64,
            })
        })
        .collect();
    if parts.len() < 3 {
        return 1.0;
    }
    tolerate(&mut parts);
    let weight: f64 = parts.iter().map(|part| part.weight).sum();
    let mean = parts
        .iter()
        .map(|part| part.phasor * part.weight)
        .sum::<Complex64>()
        / weight;
    let middle = parts
        .iter()
        .map(|part| part.number * part.weight)
        .sum::<f64>()
        / weight;
    let (mut chi, mut turn, mut certainty) = (0.0, 0.0, 0.0);
    for part in &parts {
        let off = part.phasor - mean;
        // What a small turn does to the mean, part by part.
        let turned = Complex64::I * mean * (part.number - middle);
        chi += part.weight * off.norm_sqr();
        turn += part.weight * (off * turned.conj()).re;
        certainty += part.weight * turned.norm_sqr();
    }
    chi -= turn * turn / certainty;
    p_value::chi_squared(chi, 2.0 * (parts.len() - 1) as f64 - 1.0)
}

/// The line in a part of the record.
struct Part {
    phasor: Complex64,
    /// One over the variance of its real part.
    weight: f64,
    /// Number of the part, from 0.
    number: f64,
}

/// Adds what a line may miss of its own energy to the variance of each part.
fn tolerate(parts: &mut [Part]) {
    let of_parts = |of: &dyn Fn(&Part) -> f64| parts.iter().map(of).sum::<f64>();
    let energy =
        of_parts(&|part| part.weight * part.phasor.norm_sqr()) / of_parts(&|part| part.weight);
    for part in parts {
        part.weight = (part.weight.recip() + 0.5 * IMPERFECT * energy).recip();
    }
}

/// Phasor of the line in the part of the record that begins at `from`, under a `window`, and `sum w^2 / (sum w)^2`; `None`
/// where hardly any of the part counts.
fn phasor(axis: &AxisState, cycles: f64, from: usize, window: &[f64]) -> Option<(Complex64, f64)> {
    let (mut sum, mut weights, mut squares) = (Complex64::ZERO, 0.0, 0.0);
    let mut counted = 0;
    let values = (from..).zip(axis.filled[from..].iter().zip(window));
    Phasor::new(-cycles).zip(
        from,
        values,
        2.0.into(),
        |(index, (value, window)), phasor| {
            if !axis.usable(index) {
                return;
            }
            sum += window * value * phasor;
            weights += window;
            squares += window * window;
            counted += 1;
        },
    );
    (4 * counted > window.len()).then(|| (sum / weights, squares / (weights * weights)))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::sync::Arc;

    use super::*;
    use crate::diagnosis::explanation::Change;
    use crate::diagnosis::trial;
    use crate::model::burst;
    use crate::model::random::Gaussian;
    use crate::model::random::Seed;

    fn axis(seed: u64, line: impl Fn(f64) -> f64) -> AxisState {
        let mut noise = Gaussian::new(Seed { seed, stream: 0 }, 1.0);
        let values = (0..1 << 16)
            .map(|n| noise.draw() + line(f64::from(n)))
            .collect();
        AxisState::new(Arc::new(values), 1000.0, None).expect("long enough")
    }

    const CYCLES: f64 = 0.1234;

    #[test]
    fn a_steady_line_is_steady() {
        // Of 60 records, 0.6 below 1 % are expected: 5 or more have a probability of 4e-4.
        let low = (0..60).filter(|&seed| {
            let steady = axis(seed, |n| 0.1 * (TAU * CYCLES * n + 1.0).cos());
            p_steady(&steady, CYCLES) < 0.01
        });
        let low: Vec<u64> = low.collect();
        assert!(low.len() < 5, "seeds {low:?}");
    }

    #[test]
    fn a_line_that_stops_or_turns_is_not() {
        for seed in 100..110 {
            let stops = axis(seed, |n| {
                if n < 30_000.0 {
                    (TAU * CYCLES * n).cos()
                } else {
                    0.0
                }
            });
            let turns = axis(seed, |n| {
                let turned = if n < 30_000.0 { 0.0 } else { 1.0 };
                (TAU * CYCLES * n + turned).cos()
            });
            for axis in [stops, turns] {
                let p = p_steady(&axis, CYCLES);
                // Of a turn by one a line that turns evenly leaves a quarter, beside a hundredth that it may.
                assert!(p < 1e-5, "seed {seed}: {p:e}");
            }
        }
    }

    #[test]
    fn of_less_than_eight_cycles_a_part_nothing_is_said() {
        // Parts of 8192 samples.
        for (cycles, is_said) in [(7.0 / 8192.0, false), (9.0 / 8192.0, true)] {
            let stops = axis(120, |n| {
                let size = if n < 30_000.0 { 5.0 } else { 0.0 };
                size * (TAU * cycles * n).cos()
            });
            assert_eq!(p_steady(&stops, cycles) < 1e-5, is_said, "seed 120");
        }
    }

    #[test]
    fn of_two_parts_nothing_is_said() {
        for (parts, is_said) in [(2, false), (3, true)] {
            // Its size falls to a half behind the first part.
            let size = |n: f64| if n < 8192.0 { 1.0 } else { 0.5 };
            let mut axis = axis(130, |n| size(n) * (TAU * CYCLES * n).cos());
            let rest = Change::Mask(vec![8192 * parts..axis.residual.len()]);
            trial::take_in(&mut axis, burst::KIND, rest);
            assert_eq!(p_steady(&axis, CYCLES) < 1e-5, is_said, "seed 130");
        }
    }
}
