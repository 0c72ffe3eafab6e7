//! What a diagnosis is asked for.

use crate::model::kind::Kind;

/// What a diagnosis is asked for.
#[derive(Debug, Clone)]
pub struct Options {
    /// Probability at most of any finding or remark where nothing is hidden.
    pub family_level: f64,
    /// A covariate, such as the temperature, one value a sample.
    pub covariate: Option<Vec<f64>>,
    /// Kinds that are suspected: of those that are not found it is told how near they come to a name, and how large
    /// they may be.
    pub suspects: Vec<Kind>,
    /// Whether views are wanted, with a simulated record of the last model next to the measured one: text
    /// needs none.
    pub views: bool,
}
