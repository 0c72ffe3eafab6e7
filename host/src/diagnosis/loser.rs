//! What gained too little on data that it was not fitted to, or turned out to be no course, and is not proposed any more.

use std::fmt;

use crate::diagnosis::explanation::{Change, Explanation};
use crate::diagnosis::held_out::ENOUGH_NATS;
use crate::diagnosis::result::estimate::Estimate;
use crate::model::kind::Kind;
use crate::model::marks::Mark;
use crate::model::steps;
use crate::numeric::written::plain;

/// Share of a frequency by which what is found in its place may differ, at most: a choice. The next line or peak of a
/// record is farther off, and what is found again is nearer.
const SAME: f64 = 0.01;

/// An effect that is not proposed any more.
#[derive(Debug, Clone, PartialEq)]
pub struct Loser {
    kind: Kind,
    which: Which,
}

/// Which of a kind are not proposed any more.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Which {
    /// All of them.
    All,
    /// Those about this frequency, hertz, where others of its kind stand.
    AtHz(f64),
    /// Jumps that are not [strong](crate::diagnosis::record::wave::Jump::is_strong).
    Weak,
}

impl fmt::Display for Loser {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.which {
            Which::All => write!(f, "{}", self.kind),
            Which::AtHz(at_hz) => write!(f, "{} at {} Hz", self.kind, plain(at_hz)),
            Which::Weak => write!(f, "weak {}", self.kind),
        }
    }
}

impl Loser {
    /// All of a kind.
    pub const fn all(kind: Kind) -> Self {
        let which = Which::All;
        Self { kind, which }
    }

    /// A course that turned out to be none: of jumps those that are not strong, and all of any other kind.
    pub fn course(kind: Kind) -> Self {
        let which = if kind == steps::KIND {
            Which::Weak
        } else {
            Which::All
        };
        Self { kind, which }
    }

    /// All of its kind, where it was `refused` already and came again.
    pub fn beyond(self, refused: &[Self]) -> Self {
        if refused.contains(&self) {
            Self::all(self.kind)
        } else {
            self
        }
    }

    /// Those of some explanations that gained too little, as `held_out_nats` say. A line or a peak among others that gained
    /// is refused by itself: they are there whatever it is.
    pub fn among(explanations: &[Explanation], held_out_nats: &[Option<f64>]) -> Vec<Self> {
        let pairs = || explanations.iter().zip(held_out_nats);
        let gained = |kind| {
            let mut of_kind = pairs().filter(|(one, _)| one.kind() == kind);
            of_kind.any(|(one, nats)| nats.is_some_and(|nats| nats > needed_nats(&one.change)))
        };
        let losers =
            pairs().filter(|(one, nats)| nats.is_some_and(|nats| nats <= needed_nats(&one.change)));
        let losers = losers.map(|(one, _)| Self {
            kind: one.kind(),
            which: frequency(&one.effect, &one.change)
                .filter(|_| gained(one.kind()))
                .map_or(Which::All, Which::AtHz),
        });
        losers.collect()
    }

    /// Whether a kind is out altogether.
    pub fn is_all_of(&self, kind: Kind) -> bool {
        self.kind == kind && self.which == Which::All
    }

    /// Whether jumps of a kind are out that are not strong.
    pub fn is_weak(&self, kind: Kind) -> bool {
        self.kind == kind && self.which == Which::Weak
    }

    /// Whether an effect is what is not proposed any more.
    pub fn is(&self, effect: &Estimate, change: &Change) -> bool {
        self.kind == effect.kind
            && match self.which {
                Which::All => true,
                Which::AtHz(at_hz) => {
                    frequency(effect, change).is_some_and(|f_hz| (f_hz / at_hz - 1.0).abs() < SAME)
                }
                // Who looks for jumps leaves these out.
                Which::Weak => false,
            }
    }
}

/// Gain on held-out data that something needs. A waveform may fill two or three ordinates, of which those that are held out say
/// little: any gain is enough.
const fn needed_nats(change: &Change) -> f64 {
    match change {
        Change::Law(_) | Change::Strength(_) => ENOUGH_NATS,
        _ => 0.0,
    }
}

/// Where the line or peak of an effect is, hertz.
fn frequency(effect: &Estimate, change: &Change) -> Option<f64> {
    let marks = match change {
        Change::Law(law) => effect.kind.marks(&law.values),
        _ => effect.kind.marks(&effect.plain()),
    };
    marks.into_iter().find_map(|mark| match mark {
        Mark::Line { f_hz, multiple: 1 } => Some(f_hz),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::explanation::Candidate;
    use crate::diagnosis::trial::{NOTHING, axis, law, line, made_up, short};
    use crate::model::{resonance, sinusoid, warmup};

    /// Candidates with their gains, taken into an axis of white noise; what loses of them.
    fn among(all: Vec<(Candidate, f64)>) -> Vec<Loser> {
        let mut axis = axis(1, short(1), |_, noise| noise);
        let nats: Vec<Option<f64>> = all.iter().map(|(_, nats)| Some(*nats)).collect();
        for (candidate, _) in all {
            axis.accept(candidate).expect("a fit");
        }
        Loser::among(axis.explanations(), &nats)
    }

    fn sinusoid_at(f_hz: f64) -> Candidate {
        let mut one = made_up(sinusoid::KIND, line(f_hz, 0.3).into());
        one.effect = Estimate::new(
            sinusoid::KIND,
            [f_hz, 0.3].map(crate::diagnosis::result::value::Value::told),
        );
        one
    }

    #[test]
    fn a_line_that_loses_leaves_those_that_gain() {
        let losers = among(vec![
            (sinusoid_at(50.0), 600.0),
            (sinusoid_at(80.0), -1.0),
            (made_up(steps::KIND, NOTHING), -1.0),
        ]);
        let is_out = |one: Candidate| {
            losers
                .iter()
                .any(|loser| loser.is(&one.effect, &one.change))
        };
        assert!(!is_out(sinusoid_at(50.0)));
        assert!(is_out(sinusoid_at(80.1)));
        assert!(is_out(made_up(steps::KIND, NOTHING)));
        let is_all = |kind| losers.iter().any(|loser| loser.is_all_of(kind));
        assert!(is_all(steps::KIND) && !is_all(sinusoid::KIND));
    }

    #[test]
    fn of_jumps_that_turned_out_to_be_none_the_weak_ones_are_out_and_at_last_all() {
        let weak = Loser::course(steps::KIND);
        assert!(weak.is_weak(steps::KIND) && !weak.is_all_of(steps::KIND));
        let again = made_up(steps::KIND, NOTHING);
        assert!(
            !weak.is(&again.effect, &again.change),
            "a strong one may be"
        );
        assert_eq!(weak.to_string(), "weak steps");
        assert_eq!(weak.clone().beyond(&[]), weak);
        let all = Loser::all(steps::KIND);
        assert_eq!(weak.clone().beyond(&[weak]), all);
        let settling = Loser::course(warmup::KIND);
        assert!(settling.is_all_of(warmup::KIND) && !settling.is_weak(warmup::KIND));
    }

    #[test]
    fn what_hardly_gains_loses() {
        let losers = |nats: f64| {
            let peak = law(resonance::KIND, &[100.0, 2.0, 1.0]);
            let two = [
                made_up(steps::KIND, NOTHING),
                made_up(resonance::KIND, peak),
            ];
            among(two.map(|one| (one, nats)).into())
        };
        assert_eq!(losers(0.0).len(), 2);
        assert_eq!(losers(0.9 * ENOUGH_NATS), [Loser::all(resonance::KIND)]);
        assert_eq!(losers(1.1 * ENOUGH_NATS), []);
    }

    #[test]
    fn a_line_that_loses_alone_takes_its_kind_with_it() {
        let losers = among(vec![(sinusoid_at(80.0), -1.0)]);
        assert_eq!(losers, [Loser::all(sinusoid::KIND)]);
    }

    #[test]
    fn a_peak_is_where_its_law_is() {
        let peak = |f_hz: f64| {
            let law = law(resonance::KIND, &[f_hz, 2.0, 1.0]);
            (Estimate::of_law(resonance::KIND), law)
        };
        let at_hz = |f_hz: f64| {
            let (effect, law) = peak(f_hz);
            frequency(&effect, &law)
        };
        assert_eq!((at_hz(100.0), at_hz(200.0)), (Some(100.0), Some(200.0)));
        let loser = Loser {
            kind: resonance::KIND,
            which: Which::AtHz(at_hz(200.0).expect("a peak")),
        };
        let is_out = |(effect, law): (Estimate, Change)| loser.is(&effect, &law);
        assert!(!is_out(peak(100.0)) && is_out(peak(200.5)) && !is_out(peak(203.0)));
    }
}
