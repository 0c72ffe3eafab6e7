//! The list of an axis's explanations, and how residual, spectrum and fit follow from it.

use std::ops::Range;
use std::sync::OnceLock;

use crate::diagnosis::axis::{AxisState, NoFit, fill};
use crate::diagnosis::explanation::{Candidate, Change, Explanation, Snapshot};
use crate::diagnosis::laws::{Law, search};
use crate::diagnosis::record::bins::SpectralBins;
use crate::diagnosis::record::residual::TakenOut;
use crate::diagnosis::result::estimate::Estimate;
use crate::diagnosis::result::rival::Rival;
use crate::fit::likelihood::{Data, Fit};
use crate::model::averaging::{self, Averaging};
use crate::model::kind::Kind;
use crate::model::telegraph;
use crate::numeric::mixture::add_mixture;

/// Samples over which a converter's filter spreads a jump, on either side: those of the ADS1281
/// settle within 63 conversions.
pub const SPREAD: usize = 64;

impl AxisState {
    /// What its model holds beyond the five terms, in the order in which it was found.
    pub fn explanations(&self) -> &[Explanation] {
        &self.explanations
    }

    /// The kinds of its explanations, in their order.
    pub fn kinds(&self) -> Vec<Kind> {
        self.explanations.iter().map(Explanation::kind).collect()
    }

    /// The first explanation of a kind.
    pub fn explanation(&self, kind: Kind) -> Option<&Explanation> {
        self.explanations.iter().find(|one| one.kind() == kind)
    }

    /// Whether it has an explanation of a kind.
    pub fn has(&self, kind: Kind) -> bool {
        self.explanation(kind).is_some()
    }

    /// Number of an explanation's law among the laws; `None` for one that is no law.
    pub fn law_number(&self, explanation: &Explanation) -> Option<usize> {
        let mut laws = self.explanations.iter().filter(|one| one.law().is_some());
        laws.position(|one| std::ptr::eq(one, explanation))
    }

    /// Number of an explanation among the effects of the noise's model: laws, then tones. `None` for one that is
    /// neither.
    pub fn effect_number(&self, explanation: &Explanation) -> Option<usize> {
        let mut tones = self.explanations.iter().filter(|one| one.is_tone());
        let mut tone = || tones.position(|one| std::ptr::eq(one, explanation));
        self.law_number(explanation)
            .or_else(|| Some(self.laws.len() + tone()?))
    }

    /// Takes a candidate in and brings everything up to date.
    ///
    /// # Errors
    /// [`NoFit`] where what is left cannot be fitted any more.
    pub fn accept(&mut self, candidate: Candidate) -> Result<(), NoFit> {
        let is_superseded = |one: &Explanation| candidate.supersedes.contains(&one.kind());
        // What is amended moves up as others before it go.
        let amends = candidate.amends.map(|place| {
            let gone = self.explanations[..place]
                .iter()
                .filter(|one| is_superseded(one));
            place - gone.count()
        });
        let makes_room = self.withdraw_where(is_superseded);
        let Candidate {
            effect,
            p_value,
            rivals,
            freedom,
            held_out_nats,
            change,
            reopens,
            readmits_bands,
            ..
        } = candidate;
        if readmits_bands {
            self.readmit_all();
        }
        let place = if let Some(place) = amends {
            let one = &mut self.explanations[place];
            (one.effect, one.freedom, one.change) = (effect, freedom, change);
            one.held_out_nats = held_out_nats;
            place
        } else {
            let now = Snapshot::of(&self.explanations);
            self.explanations.push(Explanation {
                effect,
                p_value,
                rivals,
                freedom,
                held_out_nats,
                change,
                before: self.fit.clone(),
                after: self.fit.clone(),
                with: Snapshot::default(),
                without: now,
            });
            self.explanations.len() - 1
        };
        match self.explanations[place].change {
            // What went for it changes them all the same.
            _ if makes_room => self.refresh()?,
            // A statement about values leaves record and noise as they are.
            Change::Grid { .. } => {}
            // So does one about strength, but for what is measured against it and what was drawn without it.
            Change::Strength(_) if self.short_gaps.is_none() => self.powers = OnceLock::new(),
            _ => self.refresh()?,
        }
        let now = Snapshot::of(&self.explanations);
        let one = &mut self.explanations[place];
        (one.after, one.with) = (self.fit.clone(), now);
        let withdrawn = reopens.iter().filter(|kind| self.withdraw(**kind)).count();
        if withdrawn > 0 {
            self.refresh()?;
        }
        Ok(())
    }

    /// Takes over what else explains the same as the law of this number. What it was told from by more than its spectrum stays.
    pub fn set_rivals(&mut self, number: usize, rivals: Vec<Rival>) {
        let mut laws = self
            .explanations
            .iter_mut()
            .filter(|one| one.law().is_some());
        if let Some(one) = laws.nth(number) {
            one.rivals.retain(|rival| rival.effect == telegraph::KIND);
            one.rivals.extend(rivals);
            one.rivals.sort_by(|a, b| a.log_odds.total_cmp(&b.log_odds));
        }
    }

    /// Takes over what the last fit knows of the laws among the explanations.
    pub fn set_laws(&mut self, estimates: impl Fn(usize, &Explanation) -> Estimate) {
        let mut number = 0;
        for one in &mut self.explanations {
            if one.law().is_some() {
                one.effect = estimates(number, one);
                number += 1;
            }
        }
    }

    /// Numbers of the explanations that are tones which no fit looks at.
    pub(super) fn tones(&self) -> Vec<usize> {
        let places = self.explanations.iter().enumerate();
        let tones = places.filter(|(_, one)| one.is_tone());
        tones.map(|(place, _)| place).collect()
    }

    /// Adds a law whose size `squared` something else than the bins has told, behind all others; the bins are `expected` to be
    /// that of size 1. Nothing is fitted anew, and the fit knows nothing of its scatter.
    pub fn add_law(&mut self, law: Law, squared: f64, expected: Vec<f64>) {
        add_mixture(&mut self.fit.expected, &[expected], &[squared]);
        self.fit.squared.push(squared);
        let components = self.fit.squared.len();
        for matrix in [&mut self.fit.information, &mut self.fit.covariance] {
            matrix.resize_mut(components, components, 0.0);
        }
        self.laws.push(law);
    }

    /// Takes over all laws, those without a name behind those that have one, with their fit to `data`, the whole
    /// spectrum. Nothing is searched for any more. The fit may have counted tones' bins, which `data` leave out: its likelihood is
    /// no other fit's to be held against.
    pub fn complete(&mut self, laws: Vec<Law>, fit: Fit, data: Data) {
        (self.laws, self.fit, self.data) = (laws, fit, data);
    }

    /// Brings residual, spectrum and fit up to date with the explanations.
    ///
    /// # Errors
    /// [`NoFit`] where what is left cannot be fitted any more.
    pub fn refresh(&mut self) -> Result<(), NoFit> {
        self.forget_whitened();
        self.powers = OnceLock::new();
        let spread = self.is_filtered().then_some(SPREAD);
        let replaced = self.residual.replaced();
        self.residual = self.residual.after(self.taken_out(), spread);
        let other_gaps = self.has_other_gaps(&replaced);
        let values = self.residual.values();
        let left_out: Vec<Range<usize>> = self.residual.left_out().cloned().collect();
        if self.left_out == left_out && !other_gaps {
            self.bins.leave_out(&self.excluded_hz());
            self.data = self.bins.measure(&values);
            // A wave that is no number somewhere leaves fewer samples than the bins were made for.
            if self.data.len() != self.bins.dof().len() {
                return Err(NoFit);
            }
        } else {
            self.starts = OnceLock::new();
            let floor = self.bins.floor();
            let bins = SpectralBins::new(&values, self.rate_hz, self.chain.as_ref());
            self.bins = bins.ok_or(NoFit)?;
            self.bins.know_floor(floor);
            self.bins.know_less(self.filled_share());
            self.bins.leave_out(&self.excluded_hz());
            self.data = self.bins.first();
            self.left_out = left_out;
        }
        self.laws = Snapshot::of(&self.explanations).laws;
        let fit = search::polish(&self.bins, &self.data, &mut self.laws, 0, 0.05);
        self.fit = fit.ok_or(NoFit)?;
        self.settle(values);
        self.fill(if other_gaps {
            fill::AT_FIRST
        } else {
            fill::AGAIN
        })?;
        self.keep_replaced();
        let mut polished = self.laws.iter();
        for one in &mut self.explanations {
            if let Change::Law(law) = &mut one.change
                && let Some(polished) = polished.next()
            {
                law.clone_from(polished);
            }
        }
        Ok(())
    }

    /// Samples with which a record begins that are of another law: where each is a mean over so many, the first is one
    /// sample, the next a mean of two. As single ones they are seen in the zeros between lobes, however long the record.
    pub fn begins_with(&self, law: &Law) -> Option<Range<usize>> {
        let mean = (law.effect == averaging::KIND).then(|| Averaging::of(&law.values))?;
        Some(0..mean.begins_with(self.rate_hz)).filter(|some| !some.is_empty())
    }

    /// What the explanations do to the record.
    fn taken_out(&self) -> TakenOut {
        let mut taken = TakenOut::default();
        for one in &self.explanations {
            match &one.change {
                Change::Waves(waves) => taken.waves.extend_from_slice(waves),
                Change::Happened { masked, waves } => {
                    taken.masked.extend_from_slice(masked);
                    taken.waves.extend_from_slice(waves);
                }
                Change::Mask(stretches) => taken.masked.extend_from_slice(stretches),
                Change::Cut(moment) => taken.cut.push(moment.clone()),
                Change::Law(law) => taken.masked.extend(self.begins_with(law)),
                Change::Tone(_) | Change::Strength(_) | Change::Grid { .. } => {}
            }
        }
        taken
    }
}
