//! One position: the means of short blocks, whether they are of sensors at rest, and what they come to.
//!
//! The mean is tapered: what converter and sensor add as differenced noise (Q of the noise table) stands at
//! the ends of a plain mean and outweighs all else in one of seconds; without ends it averages out.

use super::Position;

/// Length of a block, seconds: many to a stretch, so that the taper is smooth.
pub const BLOCK_S: f64 = 0.01;

/// Parts of a stretch that tell the variance of its mean: longer parts would be few, in shorter ones the
/// differenced noise shows again.
const PARTS: usize = 4;

/// Parts that tell whether the sensors moved.
const STILL_PARTS: usize = 8;

/// Fewest blocks: a taper of a dozen a part.
const FEWEST_BLOCKS: usize = 100;

/// Difference of the halves in its deviations above which they differ. As many, because the deviation is
/// told by the median of seven squares, which a move does not enlarge and which by chance is small: of
/// axes at rest one in some hundred thousand differs.
const DIFFERS: f64 = 20.0;

/// Median of the square of a normal number of variance one.
const MEDIAN_SQUARE: f64 = 0.454_936_423_119_572_8;

/// What a reading may wander within a stretch, m/s^2: 0.2 mg, or a tilt by 0.7 arc minutes, which changes the
/// magnitude by some 0.2 ug.
const HARMLESS_M_S2: f64 = 2e-3;

/// Scatter of blocks over that of a quiet stretch above which something shakes.
const SHAKEN: f64 = 4.0;

/// Means of the readings over blocks of [`BLOCK_S`].
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// By the nominal scale, m/s^2, in order.
    pub blocks: Vec<[f64; 3]>,
    /// Middle of the stretch, seconds since the session began.
    pub time_s: f64,
}

/// Why a stretch is none of sensors at rest.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Unsteady {
    /// Hardly anything arrived.
    #[error("{blocks} blocks of 10 ms arrived, and {FEWEST_BLOCKS} are needed")]
    Short {
        /// Whole blocks.
        blocks: usize,
    },
    /// The first half is not where the second is.
    #[error("{axis} moved by {moved_m_s2:.1e} m/s^2 from the first half to the second")]
    Moved {
        /// The axis that moved most.
        axis: char,
        /// By how much, m/s^2.
        moved_m_s2: f64,
    },
    /// It shakes more than when it was quiet.
    #[error("{axis} shakes {times:.0} times as much as it did at rest")]
    Shaken {
        /// The axis that shakes most.
        axis: char,
        /// Over the scatter of the quiet stretch.
        times: f64,
    },
}

impl Stretch {
    /// Its mean and that mean's variance; `quiet` is the scatter of blocks of a sound stretch, m/s^2, if one
    /// is known.
    ///
    /// # Errors
    /// [`Unsteady`] if the sensors were not at rest.
    pub fn position(&self, quiet: Option<[f64; 3]>) -> Result<Position, Unsteady> {
        if self.blocks.len() < FEWEST_BLOCKS {
            return Err(Unsteady::Short {
                blocks: self.blocks.len(),
            });
        }
        let scatter = self.scatter();
        if let Some(quiet) = quiet {
            let times = [0, 1, 2].map(|axis| scatter[axis] / quiet[axis].max(f64::MIN_POSITIVE));
            let (axis, times) = largest(times);
            if times > SHAKEN {
                return Err(Unsteady::Shaken { axis, times });
            }
        }
        if let Some((axis, moved_m_s2)) = self.moved() {
            return Err(Unsteady::Moved { axis, moved_m_s2 });
        }
        let parts = self.parts::<PARTS>();
        Ok(Position {
            mean_m_s2: tapered(&self.blocks),
            variance: [0, 1, 2].map(|axis| {
                let pairs = parts.windows(2);
                let squares = pairs.map(|pair| (pair[1][axis] - pair[0][axis]).powi(2));
                0.5 * squares.sum::<f64>() / ((PARTS - 1) * PARTS) as f64
            }),
            time_s: self.time_s,
        })
    }

    /// The axis that moved most from the first half to the second, and by how much, if any did.
    fn moved(&self) -> Option<(char, f64)> {
        const HALF: usize = STILL_PARTS / 2;
        let parts = self.parts::<STILL_PARTS>();
        let beyond = [0, 1, 2].map(|axis| {
            let halves = [&parts[..HALF], &parts[HALF..]];
            let means =
                halves.map(|half| half.iter().map(|part| part[axis]).sum::<f64>() / HALF as f64);
            let pairs = parts.windows(2);
            let mut squares: Vec<f64> = pairs
                .map(|pair| (pair[1][axis] - pair[0][axis]).powi(2))
                .collect();
            squares.sort_by(f64::total_cmp);
            let variance = 0.5 * squares[squares.len() / 2] / MEDIAN_SQUARE;
            let chance = DIFFERS * (2.0 * variance / HALF as f64).sqrt();
            let moved = (means[1] - means[0]).abs();
            if moved > chance.max(HARMLESS_M_S2) {
                moved
            } else {
                0.0
            }
        });
        Some(largest(beyond)).filter(|(_, moved)| *moved > 0.0)
    }

    /// Tapered means of equal parts.
    fn parts<const N: usize>(&self) -> [[f64; 3]; N] {
        let length = self.blocks.len() / N;
        std::array::from_fn(|part| tapered(&self.blocks[part * length..(part + 1) * length]))
    }

    /// Scatter of a block, m/s^2, from what neighbours differ by: a measure of what shakes.
    pub fn scatter(&self) -> [f64; 3] {
        let pairs = self.blocks.windows(2);
        let number = pairs.len().max(1) as f64;
        let mut sums = [0.0; 3];
        for pair in pairs {
            for (axis, sum) in sums.iter_mut().enumerate() {
                *sum += (pair[1][axis] - pair[0][axis]).powi(2);
            }
        }
        sums.map(|sum| (0.5 * sum / number).sqrt())
    }
}

/// The axis with the largest of three, and that.
fn largest(values: [f64; 3]) -> (char, f64) {
    let named = ['X', 'Y', 'Z'].into_iter().zip(values);
    named.fold(
        ('X', 0.0),
        |most, one| if one.1 > most.1 { one } else { most },
    )
}

/// Mean by Welch's taper, a parabola that is zero at both ends.
fn tapered(blocks: &[[f64; 3]]) -> [f64; 3] {
    let number = blocks.len() as f64;
    let (mut sums, mut whole) = ([0.0; 3], 0.0);
    for (at, block) in blocks.iter().enumerate() {
        let share = (at as f64 + 0.5) / number;
        let weight = share * (1.0 - share);
        whole += weight;
        for (sum, value) in sums.iter_mut().zip(block) {
            *sum += weight * value;
        }
    }
    sums.map(|sum| sum / whole)
}
