//! The likeliest swing of some powers: starts at several frequencies, and Fisher scoring from the best.

use nalgebra::{Matrix4, Vector4};

use super::Swing;
use crate::diagnosis::record::powers::{BLOCK, Powers};

/// Largest depth that is tried: beyond, the likelihood has no top.
const DEEPEST: f64 = 0.999;

impl Swing {
    /// The likeliest cosine of about this `period`, samples, of a `share` of the power.
    pub fn new(powers: &Powers, period: f64, share: f64) -> Option<Self> {
        /// Steps between ordinates at which the frequency is tried.
        const STEPS: i32 = 8;
        let at = BLOCK as f64 / period;
        let spacing = (powers.powers.len() as f64).recip();
        let tried = (-STEPS..=STEPS).map(|step| {
            let frequency = at + f64::from(step) / f64::from(STEPS) * spacing;
            let steady = Self::steady(powers);
            let begin = Self {
                frequency,
                share,
                ..steady
            };
            begin.begun(powers)
        });
        let plainest = |a: &Self, b: &Self| a.depth().total_cmp(&b.depth());
        let begin = tried.max_by(plainest)?;
        begin.climbed(powers)
    }

    /// With the parts that the powers' own cosine has, which is right for a shallow one.
    fn begun(mut self, powers: &Powers) -> Self {
        let (mut sums, mut count) = ([0.0; 2], 0.0);
        let pairs = powers.powers.iter().zip(&powers.counts);
        for (block, (power, n)) in pairs.enumerate() {
            let (sine, cosine) = self.angle(block).sin_cos();
            sums[0] += n * power * cosine;
            sums[1] -= n * power * sine;
            count += n;
        }
        // The power that swings does by twice the depth.
        self.parts = sums.map(|sum| sum / (self.share * count * self.log_power.exp()));
        self.shallowed()
    }

    /// Within the depths that there are.
    fn shallowed(mut self) -> Self {
        let over = (self.depth() / DEEPEST).max(1.0);
        self.parts = self.parts.map(|part| part / over);
        self
    }

    /// From here to the top of the likelihood by Fisher scoring, each step halved until it gains.
    fn climbed(mut self, powers: &Powers) -> Option<Self> {
        /// Steps, at most; some five are enough.
        const STEPS: usize = 50;
        /// Gain that is none, nats.
        const NOTHING: f64 = 1e-6;
        let mut score = self.score(powers);
        for _ in 0..STEPS {
            let (slope, information) = self.slope(powers);
            self.covariance = information.try_inverse()?;
            let step = self.covariance * slope;
            let halved = (0..20).map(|halvings| step / f64::from(1 << halvings));
            let tried = halved.map(|step| self.moved(&step));
            let better = tried.map(|one| (one.score(powers), one));
            let better = better.into_iter().find(|(better, _)| *better > score);
            let Some((higher, moved)) = better else {
                break;
            };
            let gain = higher - score;
            (self, score) = (moved, higher);
            if gain < NOTHING {
                break;
            }
        }
        Some(self)
    }

    fn moved(&self, step: &Vector4<f64>) -> Self {
        let moved = Self {
            log_power: self.log_power + step[0],
            parts: [self.parts[0] + step[1], self.parts[1] + step[2]],
            frequency: self.frequency + step[3],
            ..self.clone()
        };
        moved.shallowed()
    }

    /// Derivatives of the log-likelihood, and their information.
    fn slope(&self, powers: &Powers) -> (Vector4<f64>, Matrix4<f64>) {
        let (mut slope, mut information) = (Vector4::zeros(), Matrix4::zeros());
        let pairs = powers.powers.iter().zip(&powers.counts).enumerate();
        for (block, (power, n)) in pairs.filter(|(_, (_, n))| **n > 0.0) {
            let (expected, by) = self.expected(block);
            slope += by * (0.5 * n * (power / expected - 1.0));
            information += by * by.transpose() * (0.5 * n);
        }
        (slope, information)
    }
}
