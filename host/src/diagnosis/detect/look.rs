//! What detectors see, and what they may propose.

use crate::diagnosis::axis::{AxisState, Excluded};
use crate::diagnosis::decision::Decision;
use crate::diagnosis::explanation::{Candidate, Explanation};
use crate::diagnosis::loser::Loser;
use crate::diagnosis::record::reading::Reading;
use crate::diagnosis::result::rival::Rival;
use crate::diagnosis::values::ValueFindings;
use crate::model::kind::Kind;
use crate::spectrum::Line;

/// What a search is given.
pub struct Context<'a> {
    /// Level of one test.
    pub level: f64,
    /// A covariate.
    pub covariate: Option<&'a Reading>,
    /// What the values themselves say.
    pub values: &'a ValueFindings,
    /// What is not proposed any more.
    pub refused: &'a [Loser],
    /// Called with each decision.
    pub decided: &'a (dyn Fn(Decision) + Sync),
}

/// What was learnt of an axis that explains nothing, yet decides what may be an explanation.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Character {
    /// Its level switches to and fro, or jumps more often than jumps can be resolved one by one: single steps are
    /// none of it.
    pub level_switches: bool,
    /// Its large samples come in groups, or as the level switches, with so much taken out of it: none of them is an
    /// outlier as long as no more is.
    pub large_samples_in_groups: Option<usize>,
    /// The strength of its noise moves all the time: single stretches are no bursts.
    pub strength_moves: bool,
    /// Explanations there were when outliers were last sought among them.
    pub outliers_sought_among: usize,
    /// Lines that were seen to lose no samples, the strongest first.
    pub lines_without_loss: Vec<Line>,
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
        let mut refused = self.context.refused.iter();
        !refused.any(|one| one.is_all_of(kind))
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
    /// Take a candidate in as an explanation.
    Explain(Box<Candidate>),
    /// Exclude a band that no steady law speaks for, and take all laws back, and these kinds: they may have been
    /// found for it.
    Exclude(Excluded, Vec<Kind>),
    /// Exclude a line that does not keep its frequency; nothing is taken back.
    ExcludeLine(Excluded),
    /// Take explanations of these kinds back.
    Withdraw(Vec<Kind>),
    /// Takes the law of this number back.
    WithdrawLaw(usize),
    /// Remember what else explains the same as the law of this number, beside all others.
    Compare(usize, Vec<Rival>),
    /// Remember what explains nothing but decides what may.
    Learn(Lesson),
}

impl Proposal {
    /// The kind that it would explain something by.
    pub fn explained(&self) -> Option<Kind> {
        match self {
            Self::Explain(candidate) => Some(candidate.effect.kind),
            _ => None,
        }
    }
}

/// What there is to remember; see [`Character`].
#[derive(Debug, Clone, PartialEq)]
pub enum Lesson {
    /// [`Character::level_switches`].
    LevelSwitches,
    /// [`Character::large_samples_in_groups`].
    LargeSamplesInGroups(usize),
    /// [`Character::strength_moves`].
    StrengthMoves,
    /// [`Character::outliers_sought_among`].
    OutliersSoughtAmong(usize),
    /// [`Character::lines_without_loss`].
    LinesWithoutLoss(Vec<Line>),
}

impl Character {
    /// Remembers a lesson.
    pub fn learn(&mut self, lesson: Lesson) {
        match lesson {
            Lesson::LevelSwitches => self.level_switches = true,
            Lesson::LargeSamplesInGroups(among) => self.large_samples_in_groups = Some(among),
            Lesson::StrengthMoves => self.strength_moves = true,
            Lesson::OutliersSoughtAmong(count) => self.outliers_sought_among = count,
            Lesson::LinesWithoutLoss(lines) => self.lines_without_loss = lines,
        }
    }
}
