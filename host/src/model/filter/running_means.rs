//! Running means over samples, of which the oldest may count in part.

use super::mirror::Mirror;
use crate::model::effect::Distorter;

/// Running means one after the other.
pub struct RunningMeans(Vec<RunningMean>);

impl RunningMeans {
    /// So many, each over this number of samples.
    pub fn new(times: u8, samples: f64) -> Self {
        Self((0..times).map(|_| RunningMean::new(samples)).collect())
    }
}

impl Distorter for RunningMeans {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        self.0.iter_mut().for_each(|mean| mean.apply(samples));
    }
}

/// Samples that a mean is over at most, as they are held: 8 MB. Longer ones are over as many.
const MOST: f64 = (1 << 20) as f64;

struct RunningMean {
    /// How many samples count as a whole.
    whole: usize,
    /// What the one before them counts.
    rest: f64,
    mirror: Mirror,
    /// The latest samples, as many as a mean needs but for the next.
    past: Vec<f64>,
    /// Sum of the samples that count as a whole, up to the latest.
    sum: f64,
    /// Outputs until it is summed up anew.
    until_anew: usize,
}

impl RunningMean {
    fn new(samples: f64) -> Self {
        let samples = samples.min(MOST);
        Self {
            whole: samples as usize,
            rest: samples.fract(),
            mirror: Mirror::new(samples as usize),
            past: Vec::new(),
            sum: 0.0,
            until_anew: 0,
        }
    }

    /// The mean over a window, the oldest sample of which counts by what is left. A sample costs two additions: the sum goes
    /// on from the last one and is made anew after as many as it holds, so that no error adds up.
    fn mean(&mut self, window: &[f64]) -> f64 {
        let (oldest, newest) = (window[0], window[self.whole]);
        if self.until_anew == 0 {
            self.sum = window[1..].iter().sum();
            self.until_anew = self.whole;
        } else {
            self.sum += newest - oldest;
        }
        self.until_anew -= 1;
        (self.sum + self.rest * oldest) / (self.whole as f64 + self.rest)
    }
}

impl Distorter for RunningMean {
    fn apply(&mut self, samples: &mut Vec<f64>) {
        let before = self.whole;
        let Some(came) = self.mirror.before(std::mem::take(samples)) else {
            return;
        };
        self.past.extend(came);
        let past = std::mem::take(&mut self.past);
        samples.extend(past.windows(before + 1).map(|window| self.mean(window)));
        self.past = past;
        let gone = self.past.len() - before;
        self.past.drain(..gone);
    }
}
