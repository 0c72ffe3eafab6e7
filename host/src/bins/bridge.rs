//! Block means of one axis, for averaging times at which gaps leave no whole difference.
//!
//! They run together with the exact bins and are shown only where those have nothing. What they are and
//! how they are biased stands at [`BlockMeans`].

use inm_allan::fixed_point::FixedPoint;
use inm_allan::{BlockEstimate, BlockMeans};

/// Octaves of block lengths: up to 2^40 samples.
const OCTAVES: usize = 35;

/// How much further than the first run a grid reaches; leaves steps of 2^-25 of that run's range.
const HEADROOM: f64 = 65_536.0;

/// Floating-point samples converted at a time.
const CHUNK: usize = 1024;

/// Block means of one axis.
#[derive(Debug, Clone, Default)]
pub struct Bridge {
    /// One for the codes, or one for each grid that floating-point samples needed.
    parts: Vec<Part>,
}

#[derive(Debug, Clone)]
struct Part {
    /// Of floating-point samples; `None` for codes.
    grid: Option<FixedPoint>,
    means: BlockMeans<OCTAVES>,
}

impl Bridge {
    /// Passes over a known number of missing samples.
    pub fn skip(&mut self, missing: u64) {
        if let Some(part) = self.parts.last_mut() {
            part.means.skip(missing);
        }
    }

    /// Passes over a number of missing samples that nobody knows.
    pub fn restart(&mut self) {
        if let Some(part) = self.parts.last_mut() {
            part.means.restart();
        }
    }

    /// Adds integer samples.
    pub fn push_codes(&mut self, run: &[i32]) {
        if self.parts.last().is_none_or(|part| part.grid.is_some()) {
            self.begin(None);
        }
        if let Some(part) = self.parts.last_mut() {
            part.means.push_slice(run);
        }
    }

    /// Adds floating-point samples, all of them finite.
    pub fn push_floats(&mut self, mut run: &[f64]) {
        let mut codes = Vec::with_capacity(CHUNK.min(run.len()));
        while !run.is_empty() {
            if let Some(Part {
                grid: Some(grid),
                means,
            }) = self.parts.last_mut()
            {
                codes.clear();
                codes.extend(
                    run.iter()
                        .take(CHUNK)
                        .map_while(|&sample| grid.code(sample)),
                );
                means.push_wide(&codes);
                run = &run[codes.len()..];
                if !codes.is_empty() {
                    continue;
                }
            }
            // The new grid covers all that is left, so this happens once a run.
            self.begin(Some(FixedPoint::covering(run.iter().copied(), HEADROOM)));
        }
    }

    fn begin(&mut self, grid: Option<FixedPoint>) {
        self.parts.push(Part {
            grid,
            means: BlockMeans::starting_at(0),
        });
    }

    /// The estimates at every averaging time that has one, ascending, in squared counts.
    pub fn estimates(&self) -> Vec<BlockEstimate> {
        let mut pooled: Vec<BlockEstimate> = Vec::new();
        for Part { grid, means } in &self.parts {
            for mut point in means.points() {
                if let Some(grid) = grid {
                    point.estimate.variance = grid.scale_variance(point.estimate.variance);
                }
                match pooled.binary_search_by_key(&point.estimate.m, |one| one.estimate.m) {
                    Ok(at) => pool(&mut pooled[at], &point),
                    Err(at) => pooled.insert(at, point),
                }
            }
        }
        pooled
    }
}

/// Averages two estimates at one averaging time by their terms.
fn pool(one: &mut BlockEstimate, other: &BlockEstimate) {
    let (a, b) = (one.estimate.terms as f64, other.estimate.terms as f64);
    let mean = |x: f64, y: f64| (x * a + y * b) / (a + b);
    one.estimate.variance = mean(one.estimate.variance, other.estimate.variance);
    one.white_bias = mean(one.white_bias, other.white_bias);
    one.estimate.terms += other.estimate.terms;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_floats_agree() {
        let codes: Vec<i32> = (0..1000_i32).map(|k| k * k % 611 - 300).collect();
        let floats: Vec<f64> = codes.iter().map(|&code| f64::from(code)).collect();
        let (mut whole, mut float) = (Bridge::default(), Bridge::default());
        for part in [0..300, 310..1000] {
            whole.push_codes(&codes[part.clone()]);
            float.push_floats(&floats[part.clone()]);
            if part.end < 1000 {
                whole.skip(10);
                float.skip(10);
            }
        }
        let (whole, float) = (whole.estimates(), float.estimates());
        assert_eq!(whole.len(), 3);
        for (one, other) in whole.iter().zip(&float) {
            assert_eq!(one.estimate.terms, other.estimate.terms);
            assert_eq!(one.white_bias, other.white_bias);
            assert!((one.estimate.variance / other.estimate.variance - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_sample_off_the_grid_begins_a_new_part() {
        let mut bridge = Bridge::default();
        bridge.push_floats(&[1.0; 128]);
        bridge.push_floats(&[[0.0; 64], [1e9; 64]].concat());
        // Blocks of 64: 1, 1, 0, and then a grid of its own, with nothing between.
        let one = bridge.estimates()[0].estimate;
        assert_eq!(one.terms, 2);
        assert!((one.variance - 0.25).abs() < 1e-9, "{one:?}");
    }
}
