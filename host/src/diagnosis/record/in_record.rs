//! What a model has of this very record beyond the law of its noise.

use crate::diagnosis::record::residual::Residual;
use crate::diagnosis::record::wave::Wave;

/// The deterministic part of a model, and samples that were no measurement: the measured record holds them too.
pub struct InRecord {
    /// Courses, as they are in the record; missing samples are NaN, and none are there where there is no course.
    courses: Vec<f64>,
    /// The record without the courses: as it was read, and with what stands in the place of samples that are no
    /// measurement.
    noise: Option<[Vec<f64>; 2]>,
}

impl InRecord {
    /// Of some waves that are taken out of a record.
    pub fn of(residual: &Residual, waves: &[Wave]) -> Self {
        let is_course = |wave: &&Wave| wave.replaced().is_none();
        let of_courses = |mut left: Vec<f64>| {
            let courses = waves.iter().filter(is_course);
            courses.for_each(|wave| wave.take_out(&mut left));
            left
        };
        let mut courses = Vec::new();
        if waves.iter().any(|wave| is_course(&wave)) {
            // Taken out of nothing: what is put back, with the other sign.
            courses = of_courses(vec![0.0; residual.len()]);
            for (value, measured) in courses.iter_mut().zip(residual.whole()) {
                *value = 0.0 * measured - *value;
            }
        }
        let mut replaced = waves.iter().filter(|wave| !is_course(wave)).peekable();
        let noise = replaced.peek().is_some().then(|| {
            let read = of_courses(residual.whole().to_vec());
            let mut drawn = read.clone();
            replaced.for_each(|wave| wave.take_out(&mut drawn));
            [read, drawn]
        });
        Self { courses, noise }
    }

    /// The courses, to be changed as they are simulated.
    pub fn courses_mut(&mut self) -> &mut [f64] {
        &mut self.courses
    }

    /// What it adds to some mean squares of a record, which `statistic` takes of any series. A course and the noise know
    /// nothing of each other. A sample that repeats the one before is made of the noise, so that what it adds is what the
    /// record has with it less what it has without, below zero where it takes away.
    pub fn adds(&self, statistic: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
        let of_courses = || (!self.courses.is_empty()).then(|| statistic(&self.courses));
        let of_noise = || {
            let [read, drawn] = self.noise.as_ref()?;
            let pairs = statistic(read).into_iter().zip(statistic(drawn));
            Some(pairs.map(|(read, drawn)| read - drawn).collect())
        };
        match (of_courses(), of_noise()) {
            (None, None) => Vec::new(),
            (Some(one), None) | (None, Some(one)) => one,
            (Some(one), Some(other)) => one.into_iter().zip(other).map(|(a, b)| a + b).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::diagnosis::record::wave::{Outlier, Replaced, Side};
    use crate::model::Seed;
    use crate::model::random::Gaussian;

    /// Mean square of a record's increments.
    fn increments(values: &[f64]) -> Vec<f64> {
        let squares = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
        vec![squares.sum::<f64>() / (values.len() - 1) as f64]
    }

    #[test]
    fn a_repeat_takes_from_the_noise_and_a_course_adds_to_it() {
        let mut normal = Gaussian::new(Seed { seed: 4, stream: 0 }, 1.0);
        let truth: Vec<f64> = (0..30_000).map(|_| normal.draw()).collect();
        let mut read = truth.clone();
        let places: Vec<usize> = (10..29_000).step_by(3).collect();
        places
            .iter()
            .for_each(|&place| read[place] = read[place - 1]);
        let sizes = places.iter().map(|&index| Outlier {
            index,
            size: read[index] - truth[index],
            size_sd: 1.0,
        });
        let line = Wave::Line {
            cycles: 0.25,
            cosine: 1.0,
            sine: 0.0,
            lost: None,
        };
        let replaced = Wave::Replaced(Replaced {
            all: Arc::new(sizes.collect()),
            side: Side::Any,
        });
        let mut course = vec![0.0; read.len()];
        line.take_out(&mut course);
        let whole: Vec<f64> = read.iter().zip(&course).map(|(a, b)| a - b).collect();
        let whole = Arc::new(whole);
        let residual = Residual::new(Arc::clone(&whole), whole);
        let added = InRecord::of(&residual, &[line, replaced]).adds(increments)[0];
        // A third of the increments, of mean square 2 each, is gone; those of cos(pi n / 2) have the mean square 1.
        let expected = increments(&read)[0] - increments(&truth)[0] + 1.0;
        assert!(
            (added - expected).abs() < 1e-3,
            "{added} for {expected}, seed 4"
        );
        assert!(
            (expected - (1.0 - 2.0 / 3.0)).abs() < 0.05,
            "{expected}, seed 4"
        );
        assert!(InRecord::of(&residual, &[]).adds(increments).is_empty());
    }
}
