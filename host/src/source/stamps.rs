//! Time stamps of a file: they give the data period where no rate is stated, and the gaps.

use super::SourceError;

/// A step within this fraction of the period of one period counts as regular.
const TOLERANCE: f64 = 0.5;

/// Share of irregular steps from which stamps do not describe a sampling rate.
const MOST_IRREGULAR: f64 = 0.1;

/// Places rows on the grid of data periods by their stamps.
#[derive(Debug, Clone)]
pub struct Stamps {
    period_s: f64,
    last_s: Option<f64>,
    next_index: u64,
}

impl Stamps {
    /// Stamps on a known period, seconds.
    pub fn new(period_s: f64) -> Self {
        Self {
            period_s,
            last_s: None,
            next_index: 0,
        }
    }

    /// Index of the row with stamp `time_s`: the number of whole periods since the first.
    ///
    /// Steps are rounded one by one, so that an error in the period does not add up. A step
    /// of less than one and a half periods is one period.
    ///
    /// # Errors
    /// If time stands still, runs backwards, or is no number.
    pub fn place(&mut self, time_s: f64) -> Result<u64, StampError> {
        let index = match self.last_s {
            None if time_s.is_finite() => 0,
            Some(last_s) if time_s > last_s && time_s.is_finite() => {
                let steps = ((time_s - last_s) / self.period_s).round().max(1.0);
                self.next_index.saturating_add(steps as u64 - 1)
            }
            last_s => return Err(StampError { time_s, last_s }),
        };
        self.last_s = Some(time_s);
        self.next_index = index + 1;
        Ok(index)
    }
}

/// A stamp that does not follow the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StampError {
    time_s: f64,
    last_s: Option<f64>,
}

impl StampError {
    /// The error with the place of the row.
    pub fn at(self, place: String) -> SourceError {
        let Self { time_s, last_s } = self;
        SourceError {
            place,
            message: match last_s {
                Some(last_s) if time_s.is_finite() => {
                    format!("time {time_s} s does not lie after {last_s} s in the row before")
                }
                _ => format!("time stamp {time_s}; expected seconds"),
            },
            remedy: "sort or repair the rows, or leave --time out and give --rate".into(),
        }
    }
}

/// The data period that a run of stamps was taken with, seconds: the mean of the steps that
/// lie within half a period of the median step.
///
/// # Errors
/// In words, if fewer than two stamps are there or more than a tenth of the steps are
/// irregular, as the arrival times at a computer are.
pub fn period_s(times_s: &[f64]) -> Result<f64, String> {
    let mut steps: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() {
        return Err("one row gives no sampling rate".into());
    }
    steps.sort_by(f64::total_cmp);
    let median = steps[steps.len() / 2];
    let regular = |step: &&f64| (**step - median).abs() <= TOLERANCE * median;
    let count = steps.iter().filter(regular).count();
    let irregular = 1.0 - count as f64 / steps.len() as f64;
    if median.is_nan() || median <= 0.0 || irregular > MOST_IRREGULAR {
        return Err(format!(
            "the time stamps give no sampling rate: {:.0} % of the steps differ by more than \
             half from the median step of {median} s",
            100.0 * irregular
        ));
    }
    Ok(steps.iter().filter(regular).sum::<f64>() / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_counted_and_jitter_is_not() {
        let mut stamps = Stamps::new(0.01);
        let places: Vec<u64> = [5.0, 5.0104, 5.0195, 5.0501, 5.06]
            .into_iter()
            .map(|time| stamps.place(time).expect("ascending"))
            .collect();
        assert_eq!(places, [0, 1, 2, 5, 6]);
        assert!(stamps.place(5.06).is_err());
        assert!(stamps.place(f64::NAN).is_err());
    }

    #[test]
    fn period_from_the_stamps() {
        let with_gap: Vec<f64> = (0..1000)
            .map(|k| f64::from(k) * 0.01 + if k > 500 { 3.0 } else { 0.0 })
            .collect();
        let period = period_s(&with_gap).expect("regular");
        assert!((period - 0.01).abs() < 1e-12, "{period}");
        let bursts: Vec<f64> = (0..1000)
            .map(|k| f64::from(k / 5) * 0.1 + f64::from(k % 5) * 1e-3)
            .collect();
        assert!(period_s(&bursts).is_err());
        assert!(period_s(&[1.0]).is_err());
    }
}
