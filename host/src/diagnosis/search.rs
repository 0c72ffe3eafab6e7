//! The search for explanations: look, explain, fit again, look again, until nothing significant is
//! left.
//!
//! Within a round the detectors of [`detect::ROUND`] look in turn, from the most local to the most general:
//! single values, lines, level, variance, shape of the spectrum. The first that changes the model ends
//! the round, and the next one begins with everything fitted anew, so that what one effect hid from
//! another shows. Detectors only look; what they propose is done here.

use crate::diagnosis::axis::{AxisState, Excluded, NoFit};
use crate::diagnosis::detect;
use crate::diagnosis::detect::values::ValueFindings;
use crate::diagnosis::explanation::{Candidate, Explanation};
use crate::model::kind::Kind;

/// Rounds, at most: far more than effects that one record can tell apart.
const ROUNDS: usize = 24;

/// What a search is given.
pub struct Context<'a> {
    /// Level of one test.
    pub level: f64,
    /// A covariate, one value a sample.
    pub covariate: Option<&'a [f64]>,
    /// What the values themselves say.
    pub values: &'a ValueFindings,
    /// Kinds that are not proposed any more: they gained nothing on held-out data.
    pub refused: &'a [Kind],
    /// Is told each effect that is taken in.
    pub found: &'a (dyn Fn(Kind) + Sync),
}

/// What was learnt of an axis that explains nothing, yet decides what may be an explanation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Character {
    /// Its level switches to and fro, or jumps more often than jumps can be told one by one: single steps are
    /// none of it.
    pub level_switches: bool,
    /// Its large samples come in groups, or as the level switches: none of them is an outlier.
    pub large_samples_in_groups: bool,
    /// The strength of its noise moves all the time: single stretches are no bursts.
    pub strength_moves: bool,
    /// Explanations there were when outliers were last sought among them.
    pub outliers_sought_among: usize,
    /// Frequencies of lines that were seen to lose no samples, hertz.
    pub lines_without_loss: Vec<f64>,
}

/// What a detector sees.
pub struct Look<'a> {
    /// The axis as it is.
    pub axis: &'a AxisState,
    /// What the search was given.
    pub context: &'a Context<'a>,
    /// What was learnt so far.
    pub character: &'a Character,
}

impl Look<'_> {
    /// Level of one test.
    pub const fn level(&self) -> f64 {
        self.context.level
    }

    /// Whether a kind may still be proposed.
    pub fn is_open(&self, kind: Kind) -> bool {
        !self.context.refused.contains(&kind)
    }

    /// Number of the explanation of a kind.
    pub fn place_of(&self, kind: Kind) -> Option<usize> {
        let mut kinds = self.axis.explanations().iter().map(Explanation::kind);
        kinds.position(|one| one == kind)
    }

    /// Length of the record, seconds.
    pub fn duration_s(&self) -> f64 {
        self.axis.filled.len() as f64 / self.axis.rate_hz
    }
}

/// What is to be done about what a detector saw.
#[derive(Debug)]
pub enum Proposal {
    /// Explain something.
    Explain(Box<Candidate>),
    /// Exclude a band that no steady law speaks for, and take all laws back, and these kinds: they may have been
    /// found for it.
    Exclude(Excluded, Vec<Kind>),
    /// Exclude a line that does not keep its frequency; nothing is taken back.
    ExcludeLine(Excluded),
    /// Take these kinds back.
    Withdraw(Vec<Kind>),
    /// Remember something.
    Learn(Lesson),
}

/// What there is to remember; see [`Character`].
#[derive(Debug, Clone, PartialEq)]
pub enum Lesson {
    /// [`Character::level_switches`].
    LevelSwitches,
    /// [`Character::large_samples_in_groups`].
    LargeSamplesInGroups,
    /// [`Character::strength_moves`].
    StrengthMoves,
    /// [`Character::outliers_sought_among`].
    OutliersSoughtAmong(usize),
    /// [`Character::lines_without_loss`].
    LinesWithoutLoss(Vec<f64>),
}

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
    let mut search = Search {
        axis,
        context,
        character: Character::default(),
        latest: None,
    };
    let done = search.run();
    let Search {
        character, latest, ..
    } = search;
    done.map(|()| (character, latest))
        .map_err(|NoFit| Spoilt { latest })
}

struct Search<'a> {
    axis: &'a mut AxisState,
    context: &'a Context<'a>,
    character: Character,
    latest: Option<Kind>,
}

impl Search<'_> {
    fn run(&mut self) -> Result<(), NoFit> {
        for detector in detect::BEFORE_ROUNDS {
            while self.ask(detector)? {}
        }
        for _ in 0..ROUNDS {
            if !self.round()? {
                break;
            }
        }
        Ok(())
    }

    /// Whether any detector changed the model.
    fn round(&mut self) -> Result<bool, NoFit> {
        self.axis.prepare(self.context.level);
        for detector in detect::ROUND {
            if self.ask(detector)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Lets a detector look and does what it proposes; whether that changed the model.
    fn ask(&mut self, detector: &detect::Detector) -> Result<bool, NoFit> {
        let look = Look {
            axis: self.axis,
            context: self.context,
            character: &self.character,
        };
        let mut changed = false;
        for proposal in (detector.look)(&look)? {
            changed |= self.follow(proposal)?;
        }
        Ok(changed)
    }

    fn follow(&mut self, proposal: Proposal) -> Result<bool, NoFit> {
        match proposal {
            Proposal::Explain(candidate) => return self.explain(*candidate),
            Proposal::Exclude(band, kinds) => {
                self.axis.exclude(band);
                self.axis
                    .withdraw_where(|one| one.law().is_some() || kinds.contains(&one.kind()));
                self.character.level_switches = false;
                self.axis.refresh()?;
            }
            Proposal::ExcludeLine(line) => {
                self.axis.exclude_line(line);
                self.axis.refresh()?;
            }
            Proposal::Withdraw(kinds) => {
                let any = self.axis.withdraw_where(|one| kinds.contains(&one.kind()));
                if !any {
                    return Ok(false);
                }
                self.axis.refresh()?;
            }
            Proposal::Learn(lesson) => {
                self.character.learn(lesson);
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Takes a candidate in, unless it is refused.
    fn explain(&mut self, candidate: Candidate) -> Result<bool, NoFit> {
        let kind = candidate.effect.kind;
        if self.context.refused.contains(&kind) {
            return Ok(false);
        }
        if candidate.amends.is_none() {
            (self.context.found)(kind);
            self.latest = Some(kind);
        }
        self.axis.accept(candidate)?;
        Ok(true)
    }
}

impl Character {
    fn learn(&mut self, lesson: Lesson) {
        match lesson {
            Lesson::LevelSwitches => self.level_switches = true,
            Lesson::LargeSamplesInGroups => self.large_samples_in_groups = true,
            Lesson::StrengthMoves => self.strength_moves = true,
            Lesson::OutliersSoughtAmong(count) => self.outliers_sought_among = count,
            Lesson::LinesWithoutLoss(lines_hz) => self.lines_without_loss = lines_hz,
        }
    }
}
