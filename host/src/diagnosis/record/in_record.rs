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
        let of_courses = |start: &[f64]| {
            let mut left = start.to_vec();
            let courses = waves.iter().filter(is_course);
            courses.for_each(|wave| wave.take_out(&mut left));
            left
        };
        let mut courses = Vec::new();
        if waves.iter().any(|wave| is_course(&wave)) {
            // Taken out of nothing: what is put back, with the other sign.
            courses = of_courses(&vec![0.0; residual.len()]);
            courses.iter_mut().for_each(|value| *value = -*value);
            for (value, measured) in courses.iter_mut().zip(residual.whole()) {
                *value += 0.0 * measured;
            }
        }
        let mut replaced = waves.iter().filter(|wave| !is_course(wave)).peekable();
        let noise = replaced.peek().is_some().then(|| {
            let read = of_courses(residual.whole());
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
