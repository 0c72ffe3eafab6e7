//! What the model of an axis holds beyond the five terms: its explanations, and what each does.
//!
//! A detector proposes a [`Candidate`]; taken in, it is an [`Explanation`]. What is left of the record,
//! the stretches that no fit looks at and the laws of the noise all follow from the list of
//! explanations, so that taking one back is taking it off the list.

use std::ops::Range;

use crate::diagnosis::laws::Law;
use crate::diagnosis::record::envelope::Envelope;
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::finding::Rival;
use crate::fit::likelihood::Fit;
use crate::model::kind::Kind;

/// What an explanation does to the record or to the model of its noise.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Waveforms that are taken out of the record.
    Waves(Vec<Wave>),
    /// Stretches of another noise: no fit looks at them.
    Mask(Vec<Range<usize>>),
    /// Stretches in which something happened: no fit looks at them, and waveforms stand for them in the model.
    Happened {
        /// The stretches.
        masked: Vec<Range<usize>>,
        /// What stands for them.
        waves: Vec<Wave>,
    },
    /// A moment at which samples were lost: the noise itself is cut there.
    Cut(Range<usize>),
    /// A law of the noise; its size is 1, its square a component of the fit.
    Law(Law),
    /// A tone that neither a waveform nor a density describes: no fit and no test looks at these bands, hertz, and it is
    /// in the model as it was measured.
    Tone(Vec<Range<f64>>),
    /// The strength of the noise over time: the record stays as it is, and what looks at strengths looks
    /// at them over this.
    Strength(Envelope),
    /// Nothing: the values themselves lie on a grid. Where the noise spans few steps of it, how strong it looks
    /// depends on where the level lies between two of them.
    Grid {
        /// Whether the level decides how strong the noise looks.
        decides: bool,
    },
}

/// An effect that a detector proposes to take into the model.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The effect with its parameters.
    pub effect: Estimate,
    /// Probability of as much without it, the search included.
    pub p_value: f64,
    /// Other names for it.
    pub rivals: Vec<Rival>,
    /// Numbers that were fitted to all of the record for it.
    pub freedom: f64,
    /// Gain in log-likelihood on data that it was not fitted to, where its detector measures it.
    pub held_out_nats: Option<f64>,
    /// What it does to the record or to the model of its noise.
    pub change: Change,
    /// The explanation that it takes the place of, by its number.
    pub amends: Option<usize>,
    /// Kinds that are taken back as it comes in: what they were found for is explained by it.
    pub supersedes: Vec<Kind>,
    /// Kinds that are taken back once it is in and looked for again: they may have been found for it.
    pub reopens: Vec<Kind>,
    /// Whether bands that were excluded count again once it is in: it may have made their noise unsteady.
    pub readmits_bands: bool,
}

impl Candidate {
    /// A candidate that leaves all others as they are.
    pub fn new(effect: Estimate, p_value: f64, freedom: f64, change: Change) -> Self {
        Self {
            effect,
            p_value,
            rivals: Vec::new(),
            freedom,
            held_out_nats: None,
            change,
            amends: None,
            supersedes: Vec::new(),
            reopens: Vec::new(),
            readmits_bands: false,
        }
    }
}

/// An effect that is in the model.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// The effect with its parameters.
    pub effect: Estimate,
    /// Probability of as much without it, the search included.
    pub p_value: f64,
    /// Other names for it.
    pub rivals: Vec<Rival>,
    /// Numbers that were fitted to all of the record for it.
    pub freedom: f64,
    /// Gain in log-likelihood on held-out data, where its detector measured it.
    pub held_out_nats: Option<f64>,
    /// What it does to the record or to the model of its noise.
    pub change: Change,
    /// Fit of the model without it.
    pub before: Fit,
    /// Fit with it, as it was found.
    pub after: Fit,
    /// Waveforms and laws of the model with it.
    pub with: Snapshot,
    /// Waveforms and laws of the model without it.
    pub without: Snapshot,
}

impl Explanation {
    /// Kind of its effect.
    pub const fn kind(&self) -> Kind {
        self.effect.kind
    }

    /// Its law, where it is one.
    pub const fn law(&self) -> Option<&Law> {
        match &self.change {
            Change::Law(law) => Some(law),
            _ => None,
        }
    }

    /// What it takes out of the record.
    pub fn waves(&self) -> &[Wave] {
        match &self.change {
            Change::Waves(waves) | Change::Happened { waves, .. } => waves,
            _ => &[],
        }
    }

    /// Whether it happened once, in stretches that no fit looks at.
    pub const fn happened(&self) -> bool {
        matches!(self.change, Change::Happened { .. })
    }

    /// Whether it is a tone that no fit looks at.
    pub const fn is_tone(&self) -> bool {
        matches!(self.change, Change::Tone(_))
    }

    /// The bands that it fills, hertz, where it is a tone that no fit looks at.
    pub fn bands_hz(&self) -> &[Range<f64>] {
        match &self.change {
            Change::Tone(bands_hz) => bands_hz,
            _ => &[],
        }
    }

    /// The frequency below which it takes the noise out with it, hertz, where it does: nothing is said of that noise.
    pub fn absorbs_hz(&self) -> Option<f64> {
        self.waves().iter().find_map(Wave::absorbs_hz)
    }

    /// The strength of the noise over time that it says, where it says any.
    pub const fn envelope(&self) -> Option<&Envelope> {
        match &self.change {
            Change::Strength(envelope) => Some(envelope),
            _ => None,
        }
    }

    /// Whether a likelihood of the noise does not see it: it changes nothing there, or says of samples that they are no
    /// measurement, in place of which any that the noise may have stand.
    pub fn is_beside_noise(&self) -> bool {
        let waves = self.waves();
        let replaces = !waves.is_empty() && waves.iter().all(|wave| wave.replaced().is_some());
        replaces || self.with == self.without
    }
}

/// Waveforms and laws of a model at some moment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Snapshot {
    waves: Vec<(Kind, Wave)>,
    /// Laws beyond the five terms.
    pub laws: Vec<Law>,
    /// Tones that are in the model as they were measured.
    pub tones: Vec<Estimate>,
}

impl Snapshot {
    /// What a list of explanations takes out of a record, and its laws.
    pub fn of(explanations: &[Explanation]) -> Self {
        let waves = explanations.iter().flat_map(|one| {
            let waves = one.waves().iter();
            waves.map(|wave| (one.kind(), wave.clone()))
        });
        Self {
            waves: waves.collect(),
            laws: explanations
                .iter()
                .filter_map(Explanation::law)
                .cloned()
                .collect(),
            tones: explanations
                .iter()
                .filter(|one| one.is_tone())
                .map(|one| one.effect.clone())
                .collect(),
        }
    }

    /// The waveforms, of all kinds.
    pub fn waves(&self) -> impl Iterator<Item = &Wave> {
        self.waves.iter().map(|(_, wave)| wave)
    }

    /// Takes the waveforms and the tones of a kind out of it.
    pub fn forget(&mut self, kind: Kind) {
        self.waves.retain(|(other, _)| *other != kind);
        self.tones.retain(|other| other.kind != kind);
    }
}
