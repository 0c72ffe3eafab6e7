//! A model with bands for what it lacked.

use crate::diagnosis::laws::Law;
use crate::diagnosis::unnamed::dictionary::Band;
use crate::fit::likelihood::Fit;

/// Factor on the power of a tone beside all else from which its law is not that of what is there: 3 dB are a choice. Tones
/// that were named right come to 0.9 to 1.15 in measured records. A law of which bands have as much has lost its name to them.
pub const ANOTHER: f64 = 2.0;

/// A model that lacks nothing.
pub struct WithBands {
    /// Its laws, those without a name behind those that have one.
    pub laws: Vec<Law>,
    /// Its fit to the whole spectrum; the tones are not in its expectation.
    pub fit: Fit,
    /// Power of each tone over that with which it was named.
    pub tones: Vec<f64>,
    /// What a law costs, nats.
    pub cost_nats: f64,
}

impl WithBands {
    /// Log-likelihood of the spectrum, all laws paid for; only differences on the same spectrum have a meaning.
    pub fn worth_nats(&self) -> f64 {
        self.fit.log_likelihood - self.cost_nats * self.laws.len() as f64
    }

    /// Whether the spectrum is likelier than by a model with one more name, bands that take its place paid for as it is. By half of
    /// what a law costs, that is: a name that explains nothing gains all of it by going, one that a band replaces none.
    pub fn is_better_than(&self, named: &Self) -> bool {
        self.worth_nats() - named.worth_nats() > 0.5 * named.cost_nats
    }

    /// Those of its laws that are bands.
    pub fn bands(&self) -> Vec<Band> {
        self.laws.iter().filter_map(Band::of_law).collect()
    }

    /// Number of the tone that has to change most, if that is by as much as makes it another.
    pub fn another(&self) -> Option<usize> {
        let powers = self.tones.iter();
        let changes = powers.map(|power| power.max(power.recip()));
        let most = changes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        (most.1 > ANOTHER).then_some(most.0)
    }
}
