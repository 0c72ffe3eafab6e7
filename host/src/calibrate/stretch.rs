//! One position: the means of short blocks, whether they are of sensors at rest, and what they come to.

use super::Position;

/// Length of a block, seconds: a person's hand moves in many, and the sensors' own filter is long over.
pub const BLOCK_S: f64 = 0.1;

/// Fewest blocks that tell their own noise.
const FEWEST_BLOCKS: usize = 10;

/// Difference of the halves in its standard deviations above which they differ: of three axes and
/// thirty positions that differ by chance one is beyond it in a million sessions.
const DIFFERS: f64 = 7.0;

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
    #[error("{blocks} blocks of 0.1 s arrived, and {FEWEST_BLOCKS} are needed")]
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
        let half = self.blocks.len() / 2;
        let [first, second] = [&self.blocks[..half], &self.blocks[half..]].map(mean);
        let moved = [0, 1, 2].map(|axis| (second[axis] - first[axis]).abs());
        let chance = scatter.map(|scatter| DIFFERS * scatter * (2.0 / half as f64).sqrt());
        let beyond = [0, 1, 2].map(|axis| {
            let beyond = moved[axis] > chance[axis].max(HARMLESS_M_S2);
            if beyond { moved[axis] } else { 0.0 }
        });
        let (axis, moved_m_s2) = largest(beyond);
        if moved_m_s2 > 0.0 {
            return Err(Unsteady::Moved { axis, moved_m_s2 });
        }
        let number = self.blocks.len() as f64;
        Ok(Position {
            mean_m_s2: mean(&self.blocks),
            variance: scatter.map(|scatter| scatter * scatter / number),
            time_s: self.time_s,
        })
    }

    /// Standard deviation of a block, m/s^2: from what neighbours differ by, to which slow wander adds
    /// next to nothing.
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

fn mean(blocks: &[[f64; 3]]) -> [f64; 3] {
    let number = blocks.len().max(1) as f64;
    [0, 1, 2].map(|axis| blocks.iter().map(|block| block[axis]).sum::<f64>() / number)
}
