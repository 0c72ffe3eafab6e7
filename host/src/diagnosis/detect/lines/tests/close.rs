//! Lines that stand close, also to their own mirror image, and how far one stands out.

use super::*;

/// A line and others so many cycles a record beside it, each of this share of its power, in noise.
fn beside(seed: u64, away: &[f64], share: f64) -> (Trial, Vec<Line>) {
    const AMPLITUDE: f64 = 3.0;
    let mut values = noise(seed);
    let step_hz = trial::RATE_HZ / values.len() as f64;
    let all = std::iter::once((0.0, 1.0)).chain(away.iter().map(|away| (*away, share)));
    let all = all.map(|(away, share)| (7.3 + away * step_hz, AMPLITUDE * f64::sqrt(share)));
    let lines = all.map(|(frequency_hz, amplitude)| {
        trial::add(&mut values, &trial::line(frequency_hz, amplitude));
        Line {
            frequency_hz,
            frequency_sd_hz: 0.0,
            amplitude,
            ratio: 0.0,
            false_alarm: 0.0,
        }
    });
    let lines = lines.collect();
    (Trial::new(values), lines)
}

#[test]
fn what_is_left_beside_a_line_counts_together() {
    for seed in 40..43 {
        let is_held = |away: &[f64], share: f64| {
            let (trial, lines) = beside(seed, away, share);
            let top = measure::measure(&trial.axis, &lines[0]);
            measure::holds(&trial.axis, &top, &lines)
        };
        // A hundredth of its power may be missing, in one or in many.
        assert!(is_held(&[5.0], 6e-3), "seed {seed}: one");
        assert!(!is_held(&[5.0, -7.0], 8e-3), "seed {seed}: two");
    }
}

#[test]
fn a_line_that_is_measured_anew_stands_out_as_far() {
    for seed in 43..46 {
        let (trial, lines) = beside(seed, &[], 1.0);
        let near = measure::measure_near(&trial.axis, lines[0].frequency_hz, 1e-9);
        let (axis, samples) = (&trial.axis, measure::weights(&trial.axis));
        // Power over that of noise, `A^2 n / (4 S rate)`, in the density that the line is in.
        let noise = 4.0 * axis.density(lines[0].frequency_hz) * axis.rate_hz / samples;
        let off = near.line.ratio / (lines[0].amplitude.powi(2) / noise);
        // The amplitude is known to a four-hundredth: five deviations of its square.
        assert!((off - 1.0).abs() < 0.025, "seed {seed}: {off}");
    }
}

#[test]
fn at_half_the_rate_a_line_is_measured_beside_its_mirror_image() {
    for seed in 46..49 {
        let mut values = noise(seed);
        let alternating = (0..values.len()).map(|n| if n % 2 == 0 { 0.5 } else { -0.5 });
        values
            .iter_mut()
            .zip(alternating)
            .for_each(|(value, own)| *value += own);
        let one = trial::candidate(Trial::new(values).ask(&DETECTOR));
        let one = one.expect("a line").effect;
        assert_eq!(one.kind, sinusoid::KIND, "seed {seed}");
        let value = |place: usize| one.values[place].as_ref().map(|value| value.value);
        let [f_hz, amplitude] = [0, 1].map(|place| value(place).expect("a number"));
        assert!(
            (f_hz - 0.5 * trial::RATE_HZ).abs() < 1e-9,
            "seed {seed}: {f_hz} Hz"
        );
        // Of deviation sqrt(S rate / n), 0.007 of the shortest record; five of them.
        assert!((amplitude - 0.5).abs() < 0.035, "seed {seed}: {amplitude}");
    }
}
