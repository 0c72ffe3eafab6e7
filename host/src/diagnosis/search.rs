//! The search for explanations: look, explain, fit again, look again, until nothing significant is
//! left.
//!
//! Within a round the detectors of [`detect::ROUND`] look in turn, from the most local to the most general:
//! single values, lines, level, variance, shape of the spectrum. The first that changes the model ends
//! the round, and the next one begins with everything fitted anew, so that what one effect hid from
//! another shows. A law hides other laws rather than anything local, so who found one looks for more
//! of them first. Detectors only look; what they propose is done here.

use crate::diagnosis::axis::{AxisState, Excluded, NoFit};
use crate::diagnosis::decision::{Decision, Declined};
use crate::diagnosis::detect::look::{Character, Context, Look, Proposal};
use crate::diagnosis::detect::{self, Detector};
use crate::diagnosis::explanation::{Candidate, Change, Explanation};
use crate::diagnosis::loser::Loser;
use crate::diagnosis::room;
use crate::model::kind::Kind;

/// Rounds, at most: far more than effects that one record can resolve.
const ROUNDS: usize = 24;

/// Why something is taken back where something else is taken in.
const HAS_ITS_PLACE: &str = "what was found since has its place";

/// A search that ended before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spoilt {
    /// The effect that was taken in last; `None` where there is none.
    pub latest: Option<Kind>,
}

/// Searches an axis for explanations and takes them in; what was learnt on the way, and the last of them.
///
/// # Errors
/// [`Spoilt`] where what is left of the record cannot be fitted any more.
pub fn search(
    axis: &mut AxisState,
    context: &Context<'_>,
) -> Result<(Character, Option<Kind>), Spoilt> {
    let plan = Plan {
        before_rounds: detect::BEFORE_ROUNDS,
        round: detect::ROUND,
        again: detect::OF_KINDS_IN_NOISE,
    };
    Search::new(axis, context).follow_plan(&plan)
}

/// Takes what happened out of an axis, and single samples that do not belong, and looks for nothing else.
///
/// # Errors
/// [`NoFit`] where what is left of the record cannot be fitted.
pub fn take_events_out(axis: &mut AxisState, context: &Context<'_>) -> Result<(), NoFit> {
    let mut search = Search::new(axis, context);
    search.ask(&detect::stale::DETECTOR)?;
    search.ask(&detect::telegraph::path::DETECTOR)?;
    search.ask(&detect::plain::DETECTOR)?;
    search.ask(&detect::warmup::plain::DETECTOR)?;
    while search.ask(&detect::shock::DETECTOR)? != Changed::Nothing {}
    // Noise that they had raised hides further ones.
    for _ in 0..ROUNDS {
        if search.ask(&detect::outliers::DETECTOR)? == Changed::Nothing {
            break;
        }
    }
    Ok(())
}

/// What a proposal changed of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Changed {
    /// Nothing.
    Nothing,
    /// Its laws, by one more.
    Laws,
    /// What is taken out of the record or left out of it.
    Record,
}

/// Who looks, and in which order.
struct Plan<'a> {
    before_rounds: &'a [&'a Detector],
    round: &'a [&'a Detector],
    /// Who is asked once more at the end.
    again: &'a [&'a Detector],
}

struct Search<'a> {
    axis: &'a mut AxisState,
    context: &'a Context<'a>,
    character: Character,
    latest: Option<Kind>,
}

impl<'a> Search<'a> {
    fn new(axis: &'a mut AxisState, context: &'a Context<'a>) -> Self {
        Self {
            axis,
            context,
            character: Character::default(),
            latest: None,
        }
    }

    fn follow_plan(mut self, plan: &Plan<'_>) -> Result<(Character, Option<Kind>), Spoilt> {
        let done = self.run(plan).and_then(|()| self.ask_again(plan.again));
        let latest = self.latest;
        done.map(|()| (self.character, latest))
            .map_err(|NoFit| Spoilt { latest })
    }

    fn run(&mut self, plan: &Plan<'_>) -> Result<(), NoFit> {
        for detector in plan.before_rounds {
            while self.ask(detector)? != Changed::Nothing {}
        }
        for _ in 0..ROUNDS {
            if !self.round(plan.round)? {
                break;
            }
        }
        Ok(())
    }

    /// Takes back what is not found again beside all that was found since: what hid it, or looked like it, has its place by then.
    /// Only what one test found is asked for, not what is plainer than two in a row.
    fn ask_again(&mut self, detectors: &[&Detector]) -> Result<(), NoFit> {
        let plain = self.context.level.powi(2);
        let mut place = 0;
        while let Some(one) = self.axis.explanations().get(place) {
            let kind = one.kind();
            place += 1;
            if one.p_value < plain || !detect::IN_NOISE.contains(&kind) {
                continue;
            }
            let mut without = self.axis.clone();
            without.withdraw_one(place - 1);
            let is_fitted = without.refresh().is_ok();
            if is_fitted && !self.is_found(&without, kind, detectors)? {
                let before = self.axis.kinds();
                *self.axis = without;
                self.say_withdrawn(&before, "it is not found again beside what was found since");
                place -= 1;
            }
        }
        Ok(())
    }

    /// Whether one of some detectors finds a kind in an axis.
    fn is_found(
        &self,
        axis: &AxisState,
        kind: Kind,
        detectors: &[&Detector],
    ) -> Result<bool, NoFit> {
        axis.prepare(self.context.level);
        let look = Look {
            axis,
            context: self.context,
            character: &self.character,
        };
        for detector in detectors {
            let proposals = (detector.look)(&look)?;
            let mut explained = proposals.iter().filter_map(Proposal::explained);
            if explained.any(|one| one == kind) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Whether any detector changed the model.
    fn round(&mut self, detectors: &[&Detector]) -> Result<bool, NoFit> {
        self.axis.prepare(self.context.level);
        for detector in detectors {
            if self.ask_while_laws(detector)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Lets a detector look until it finds no further law; whether it changed the model.
    fn ask_while_laws(&mut self, detector: &Detector) -> Result<bool, NoFit> {
        for laws in 0..=ROUNDS {
            let changed = self.ask(detector)?;
            if changed != Changed::Laws {
                return Ok(laws > 0 || changed != Changed::Nothing);
            }
        }
        Ok(true)
    }

    /// Lets a detector look and does what it proposes; what that changed of the model.
    fn ask(&mut self, detector: &Detector) -> Result<Changed, NoFit> {
        let look = Look {
            axis: self.axis,
            context: self.context,
            character: &self.character,
        };
        let mut changed = Changed::Nothing;
        for proposal in (detector.look)(&look)? {
            changed = changed.max(self.follow(proposal)?);
        }
        Ok(changed)
    }

    fn follow(&mut self, proposal: Proposal) -> Result<Changed, NoFit> {
        match proposal {
            Proposal::Explain(candidate) => return self.explain(*candidate),
            Proposal::Exclude(band, kinds) => {
                self.say_excluded(&band);
                self.axis.exclude(band);
                self.withdraw_where(|one| one.law().is_some() || kinds.contains(&one.kind()));
                self.character.level_switches = false;
                self.axis.refresh()?;
            }
            Proposal::ExcludeLine(line) => {
                self.say_excluded(&line);
                self.axis.exclude_line(line);
                self.axis.refresh()?;
            }
            Proposal::Withdraw(kinds) => {
                if !self.withdraw_where(|one| kinds.contains(&one.kind())) {
                    return Ok(Changed::Nothing);
                }
                self.axis.refresh()?;
            }
            Proposal::WithdrawLaw(number) => {
                let before = self.axis.kinds();
                self.axis.withdraw_law(number);
                self.say_withdrawn(&before, HAS_ITS_PLACE);
                self.axis.refresh()?;
            }
            Proposal::Compare(number, rivals) => {
                self.axis.set_rivals(number, rivals);
                return Ok(Changed::Nothing);
            }
            Proposal::Learn(lesson) => {
                self.character.learn(lesson);
                return Ok(Changed::Nothing);
            }
        }
        Ok(Changed::Record)
    }

    /// Takes a candidate in, unless it is refused.
    fn explain(&mut self, candidate: Candidate) -> Result<Changed, NoFit> {
        let kind = candidate.effect.kind;
        let p_value = candidate.p_value;
        let is_refused = |loser: &Loser| loser.is(&candidate.effect, &candidate.change);
        let declined = match () {
            () if self.context.refused.iter().any(is_refused) => Some(Declined::Lost),
            () if !room::holds(self.axis, &candidate) => Some(Declined::NoRoom),
            () => None,
        };
        if let Some(why) = declined {
            self.say(Decision::Declined { kind, p_value, why });
            return Ok(Changed::Nothing);
        }
        let is_only_law = matches!(candidate.change, Change::Law(_))
            && candidate.supersedes.is_empty()
            && candidate.reopens.is_empty();
        if candidate.amends.is_none() {
            self.say(Decision::taken(&candidate));
            self.latest = Some(kind);
        }
        let before = self.axis.kinds();
        self.axis.accept(candidate)?;
        // What it replaces, and what is sought anew beside it.
        self.say_withdrawn(&before, HAS_ITS_PLACE);
        Ok(if is_only_law {
            Changed::Laws
        } else {
            Changed::Record
        })
    }

    /// Takes explanations back; whether there were any.
    fn withdraw_where(&mut self, is_out: impl Fn(&Explanation) -> bool) -> bool {
        let before = self.axis.kinds();
        let any = self.axis.withdraw_where(is_out);
        self.say_withdrawn(&before, HAS_ITS_PLACE);
        any
    }

    fn say(&self, decision: Decision) {
        (self.context.decided)(decision);
    }

    fn say_excluded(&self, excluded: &Excluded) {
        let (from_hz, to_hz) = (excluded.band_hz.start, excluded.band_hz.end);
        self.say(Decision::Excluded { from_hz, to_hz });
    }

    fn say_withdrawn(&self, before: &[Kind], why: &'static str) {
        let left = self.axis.explanations();
        if let Some(withdrawn) = Decision::withdrawn(before, left, why) {
            self.say(withdrawn);
        }
    }
}

#[cfg(test)]
mod tests;
