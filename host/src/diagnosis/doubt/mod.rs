//! What speaks against a name, and what has none.
//!
//! Names that detectors gave are heard once more when nothing new is found: the effect explains some of
//! what it was named for, but what is there may not behave as the effect does. What a doubt takes back it
//! remarks on.

mod cancelled;
pub mod colour;
pub mod grouped_samples;
pub mod law;
pub mod left_over;
pub mod lopsided;
pub mod tops;
pub mod unbounded;
mod undated;

use crate::diagnosis::axis::{AxisState, NoFit};
use crate::diagnosis::decision::Decision;
use crate::diagnosis::detect::look::{Character, Context};
use crate::diagnosis::loser::Loser;
use crate::diagnosis::result::finding::Remark;
use crate::model::kind::Kind;

/// Speaks against names of one sort.
pub struct Doubt {
    /// Tests that it makes: its share of the family's level.
    pub tests: u32,
    /// What speaks against a name that it takes back.
    pub why: &'static str,
    /// Takes names back and remarks on them.
    pub hear: fn(&mut Hearing<'_>) -> Result<(), NoFit>,
}

/// All doubts, in the order in which they are heard.
pub static DOUBTS: &[&Doubt] = &[
    &cancelled::DOUBT,
    &undated::DOUBT,
    &tops::DOUBT,
    &lopsided::DOUBT,
    &law::DOUBT,
    &unbounded::DOUBT,
    &grouped_samples::DOUBT,
    &colour::OF_TERMS,
    &left_over::DOUBT,
];

/// An axis whose names are heard.
pub struct Hearing<'a> {
    /// The axis as it is; a doubt may take explanations back.
    pub axis: &'a mut AxisState,
    /// Level of one test.
    pub level: f64,
    /// Whether the strength of its noise moves all the time.
    pub strength_moves: bool,
    /// Whether large samples of it were seen to come in groups.
    pub large_samples_in_groups: bool,
    /// What there is to say.
    pub remarks: Vec<Remark>,
    /// What was named as a course first of all that are none.
    pub no_course: Option<Loser>,
}

impl Hearing<'_> {
    /// Takes a course back that is none. What else was found may be there because of the first of them.
    ///
    /// # Errors
    /// [`NoFit`] where what is left cannot be fitted.
    fn take_course_back(&mut self, kind: Kind) -> Result<(), NoFit> {
        self.axis.withdraw(kind);
        self.axis.refresh()?;
        self.no_course.get_or_insert_with(|| Loser::course(kind));
        Ok(())
    }
}

/// What came of a hearing.
pub struct Heard {
    /// What is unexplained.
    pub remarks: Vec<Remark>,
    /// The course that was taken back first, if any was: others may have been hidden by it or found for it.
    pub no_course: Option<Loser>,
}

impl From<Hearing<'_>> for Heard {
    fn from(hearing: Hearing<'_>) -> Self {
        Self {
            remarks: hearing.remarks,
            no_course: hearing.no_course,
        }
    }
}

/// Hears all doubts about an axis; what is unexplained of it.
///
/// # Errors
/// [`NoFit`] where what is left without a name cannot be fitted.
pub fn hear(
    axis: &mut AxisState,
    context: &Context<'_>,
    character: &Character,
) -> Result<Heard, NoFit> {
    let excluded = axis.excluded().iter().map(|one| one.remark.clone());
    let mut hearing = Hearing {
        remarks: excluded.collect(),
        axis,
        level: context.level,
        strength_moves: character.strength_moves,
        large_samples_in_groups: character.large_samples_in_groups.is_some(),
        no_course: None,
    };
    for doubt in DOUBTS {
        let before = hearing.axis.kinds();
        (doubt.hear)(&mut hearing)?;
        let left = hearing.axis.explanations();
        if let Some(withdrawn) = Decision::withdrawn(&before, left, doubt.why) {
            (context.decided)(withdrawn);
        }
    }
    Ok(hearing.into())
}
