//! Explanations that are taken off the list.

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::explanation::{Change, Explanation};
use crate::diagnosis::record::wave::Wave;
use crate::diagnosis::result::value::Value;
use crate::model::kind::Kind;
use crate::model::motion;

impl AxisState {
    /// Takes the explanations of a kind off the list; whether there were any. What follows from the list is
    /// brought up to date by [`Self::refresh`].
    pub fn withdraw(&mut self, kind: Kind) -> bool {
        self.withdraw_where(|one| one.kind() == kind)
    }

    /// The same for all explanations of which `is_gone` is true.
    pub fn withdraw_where(&mut self, is_gone: impl Fn(&Explanation) -> bool) -> bool {
        let gone: Vec<Kind> = self
            .explanations
            .iter()
            .filter(|one| is_gone(one))
            .map(Explanation::kind)
            .collect();
        self.explanations.retain(|one| !is_gone(one));
        gone.iter().for_each(|kind| self.forget(*kind));
        !gone.is_empty()
    }

    /// Takes what is known of a kind out of what the others were measured beside.
    fn forget(&mut self, kind: Kind) {
        for one in &mut self.explanations {
            one.with.forget(kind);
            one.without.forget(kind);
        }
    }

    /// Takes the explanation of that `place` off the list, and no other of its kind.
    pub fn withdraw_one(&mut self, place: usize) {
        let kind = self.explanations.remove(place).kind();
        // Where others of its kind stay, what was measured beside them and it was so.
        if !self.has(kind) {
            self.forget(kind);
        }
    }

    /// Takes the explanation off the list whose law has this number; its place among the explanations.
    pub fn withdraw_law(&mut self, number: usize) -> Option<usize> {
        let places = self.explanations.iter().enumerate();
        let mut laws = places.filter(|(_, one)| one.law().is_some());
        let (place, _) = laws.nth(number)?;
        self.explanations.remove(place);
        Some(place)
    }

    /// Takes the explanations off the list whose laws have these `numbers`.
    pub fn withdraw_laws(&mut self, numbers: &[usize]) {
        let mut number = 0;
        self.explanations.retain(|one| {
            let is_law = one.law().is_some();
            number += usize::from(is_law);
            !(is_law && numbers.contains(&(number - 1)))
        });
    }

    /// Takes the levels back that stretches of motion leave; they stay what they are otherwise.
    pub fn withdraw_levels(&mut self) {
        let motions = self.explanations.iter_mut();
        for one in motions.filter(|one| one.kind() == motion::KIND) {
            if let Change::Happened { waves, .. } = &mut one.change {
                waves.retain(|one| !matches!(one, Wave::Steps(_)));
                for wave in waves {
                    if let Wave::Meanwhile(levels) = wave {
                        levels.iter_mut().for_each(|one| one.step = 0.0);
                    }
                }
            }
            for row in one.effect.values.chunks_mut(motion::ROW) {
                row[motion::STEP] = Some(Value::exact(0.0));
            }
        }
    }

    /// Leaves out of an explanation's waveforms those of which `is_gone` is true, and the explanation with its last
    /// one; whether there were any.
    pub fn withdraw_waves(&mut self, is_gone: impl Fn(&Wave) -> bool) -> bool {
        let mut any = false;
        for one in &mut self.explanations {
            if let Change::Waves(waves) = &mut one.change {
                let before = waves.len();
                waves.retain(|wave| !is_gone(wave));
                any |= waves.len() < before;
            }
        }
        let is_empty =
            |one: &Explanation| matches!(&one.change, Change::Waves(waves) if waves.is_empty());
        self.explanations.retain(|one| !is_empty(one));
        any
    }

    /// Takes the tone of a number among the tones off the list; its number among the explanations.
    pub fn withdraw_tone(&mut self, number: usize) -> Option<usize> {
        let place = *self.tones().get(number)?;
        self.explanations.remove(place);
        Some(place)
    }
}
