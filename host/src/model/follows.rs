//! What follows a series that is not in the model: a column of the same record, or other axes.
//!
//! The law of an axis does not hold it, since the leader's law is not known. A follower makes it,
//! or takes it out again, where there is the leader's record.

/// A leader, and how an axis follows it: `gain` times a first-order lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follows {
    /// The series that is followed.
    pub leader: Leader,
    /// Signal per unit of the leader.
    pub gain: f64,
    /// Time constant of the lag, seconds; zero for none.
    pub lag_s: f64,
}

/// What an axis can follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Leader {
    /// The temperature recorded with the axes, kelvin or degrees Celsius.
    Temperature,
    /// What all axes have in common, as large as it is in the first axis. It is part of each
    /// axis' own noise: its law is in the axis' terms already.
    Shared,
}

impl Leader {
    /// What it is, for messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Temperature => "the temperature",
            Self::Shared => "what the axes share",
        }
    }
}

impl Follows {
    /// Follows the temperature, with these parameters in the catalogue's order.
    pub fn of_temperature(values: &[f64]) -> Self {
        Self {
            leader: Leader::Temperature,
            gain: values[0],
            lag_s: values[1],
        }
    }

    /// Follows a leader at `rate_hz` samples a second. `reference` is the leader's value at which
    /// nothing is added; before the first sample it has been the same as there for long.
    pub fn follower(&self, rate_hz: f64, reference: f64) -> Follower {
        let step = if self.lag_s > 0.0 {
            -(-1.0 / (self.lag_s * rate_hz)).exp_m1()
        } else {
            1.0
        };
        Follower {
            gain: self.gain,
            step,
            reference,
            lagged: None,
        }
    }
}

/// Makes one axis follow a leader, block after block.
pub struct Follower {
    gain: f64,
    /// Part of the distance that is made up in a sample.
    step: f64,
    reference: f64,
    lagged: Option<f64>,
}

impl Follower {
    /// Adds to the next `samples` what follows the next samples of the `leader`, as many.
    pub fn add_to(&mut self, leader: &[f64], samples: &mut [f64]) {
        for (sample, &leader) in samples.iter_mut().zip(leader) {
            let before = self.lagged.unwrap_or(leader);
            let lagged = before + self.step * (leader - before);
            self.lagged = Some(lagged);
            *sample += self.gain * (lagged - self.reference);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_followed_exponentially() {
        let follows = Follows {
            leader: Leader::Temperature,
            gain: -2.0,
            lag_s: 0.5,
        };
        let mut follower = follows.follower(100.0, 20.0);
        let leader: Vec<f64> = (0..300)
            .map(|k| if k < 100 { 20.0 } else { 23.0 })
            .collect();
        let mut samples = vec![1.0; 300];
        for (leader, samples) in leader.chunks(37).zip(samples.chunks_mut(37)) {
            follower.add_to(leader, samples);
        }
        for (index, sample) in samples.iter().enumerate() {
            let since_s = (index as f64 - 99.0).max(0.0) / 100.0;
            let expected = 1.0 - 6.0 * -(-since_s / 0.5_f64).exp_m1();
            assert!((sample - expected).abs() < 1e-12, "{index}: {sample}");
        }
    }

    #[test]
    fn without_a_lag_it_follows_at_once() {
        let follows = Follows {
            leader: Leader::Shared,
            gain: 0.5,
            lag_s: 0.0,
        };
        let mut samples = vec![0.0; 3];
        follows
            .follower(1.0, 1.0)
            .add_to(&[1.0, 3.0, -1.0], &mut samples);
        assert_eq!(samples, [0.0, 1.0, -1.0]);
    }
}
