//! The loop: look, name, extend, fit again, look again, until nothing significant is left.
//!
//! Within a round the views are taken from the most local to the most general: single values, lines,
//! level, variance, shape of the spectrum. The first that finds something extends the model, and
//! the next round begins with everything fitted anew, so that what one effect hid from another
//! shows. An effect that turns out to gain nothing on held-out data is refused from the outset.
//!
//! One file a view; each extends `Rounds`.

mod colour;
mod doubt;
mod left_over;
mod level;
mod lines;
mod lost;
mod of_band;
mod of_switching;
mod shape;
mod steady;
mod values;
mod variance;

use std::collections::BTreeMap;

use crate::diagnosis::axis::AxisState;
use crate::diagnosis::detect::values::CodeFindings;
use crate::diagnosis::laws::Law;
use crate::diagnosis::laws::departure;
use crate::diagnosis::record::residual::Wave;
use crate::diagnosis::result::finding::{Remark, Rival, Value};
use crate::diagnosis::statistic::profile::Noise;
use crate::fit::likelihood::Fit;
use crate::model::catalogue;

/// Tests that share the family's level evenly: of the values (repeats, both extremes, grid) 3, single
/// samples, lost ones, lines, the level 3 twice, steadiness, bursts, power over time 2, its colour, laws 4, what is left of
/// the spectrum, amplitudes, axes in common, the clock.
const TESTS: f64 = 25.0;

/// Rounds, at most: far more than effects that one record can tell apart.
const ROUNDS: usize = 24;

/// What the diagnosis is told.
#[derive(Debug, Clone)]
pub struct Options {
    /// Probability at most of any finding or remark where nothing is hidden.
    pub family_level: f64,
    /// A covariate, such as the temperature, one value a sample.
    pub covariate: Option<Vec<f64>>,
    /// Whether views are wanted, with a simulated record of the last model beside the measured one: text
    /// needs none.
    pub views: bool,
}

impl Options {
    /// Level of one test.
    pub fn level(&self) -> f64 {
        self.family_level / TESTS
    }
}

/// An effect that was accepted.
#[derive(Debug, Clone)]
pub struct Accepted {
    /// Its name.
    pub effect: &'static str,
    /// Its parameters.
    pub parameters: BTreeMap<String, Value>,
    /// Probability of as much without it.
    pub p_value: f64,
    /// Other names.
    pub rivals: Vec<Rival>,
    /// Number of its law, where it is one of the axis's.
    pub law: Option<usize>,
    /// Numbers that were fitted to all of the record for it.
    pub freedom: f64,
    /// Fit without it.
    pub before: Fit,
    /// Fit with it, as it was found.
    pub after: Fit,
    /// Gain in log-likelihood on held-out data, where it was measured as the effect was found.
    pub nats: Option<f64>,
    /// What the record and the model were with it.
    pub with: Snapshot,
    /// And without.
    pub without: Snapshot,
}

impl Accepted {
    /// Whether a likelihood of the noise does not see it.
    pub fn changes_nothing(&self) -> bool {
        self.with.waves == self.without.waves && self.with.laws == self.without.laws
    }
}

/// State of record and model at some moment.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// What is taken out.
    pub waves: Vec<Wave>,
    /// Laws beside the five terms, by their place in the catalogue.
    pub laws: Vec<(&'static str, Vec<f64>)>,
}

impl Snapshot {
    /// Of an axis as it is.
    pub fn of(axis: &AxisState) -> Self {
        Self {
            waves: axis.mended.waves.clone(),
            laws: axis
                .laws
                .iter()
                .map(|law| (law.effect.name(), law.values.clone()))
                .collect(),
        }
    }
}

/// The outcome for one axis.
pub struct Outcome {
    /// Effects, in the order in which they were found.
    pub accepted: Vec<Accepted>,
    /// What is left.
    pub unexplained: Vec<Remark>,
    /// What the five terms alone get wrong.
    pub discrepancies: Vec<Remark>,
    /// Standard deviations of the squares of the base components.
    pub squares_sd: Vec<f64>,
}

/// Runs the loop on an axis, without the effects `refused`; `values` is what its values themselves
/// say, and `found` is told each effect as it is. `None` where a fit fails.
pub fn run(
    axis: &mut AxisState,
    options: &Options,
    values: &CodeFindings,
    refused: &[&'static str],
    found: &dyn Fn(&'static str),
) -> Option<Outcome> {
    let mut rounds = Rounds {
        axis,
        options,
        refused,
        found,
        accepted: Vec::new(),
        discrepancies: Vec::new(),
        switching: false,
        ringing: false,
        restless: false,
        grid_decides: false,
        sought_beside: 0,
        unsteady: Vec::new(),
        kept: Vec::new(),
    };
    rounds.note_base();
    rounds.take_codes(values)?;
    for _ in 0..ROUNDS {
        // A level that switches all the time looks like bad samples and bursts until its law is
        // there.
        let first = rounds.switching && rounds.axis.laws.is_empty() && rounds.laws()?;
        rounds.axis.prepare(rounds.level());
        let groups = crate::diagnosis::detect::lines::lines(rounds.axis, rounds.level());
        // Where samples are lost the noise is cut: no bad samples, no burst.
        if !(first
            || rounds.lost(&groups)?
            || rounds.outliers()?
            || rounds.lines(groups)?
            || rounds.levels(Noise::Fitted)?
            || rounds.steady()?
            || rounds.bursts()?
            || rounds.strength()?
            || rounds.laws()?
            // What is left may be hidden by the walk that it was taken for.
            || rounds.levels(Noise::Anew)?
            || rounds.wandering_lines()?)
        {
            break;
        }
    }
    let doubts = rounds.doubts()?;
    let squares_sd = rounds.describe_laws();
    let mut unexplained = rounds.left_over();
    unexplained.extend(doubts);
    Some(Outcome {
        accepted: rounds.accepted,
        unexplained,
        discrepancies: rounds.discrepancies,
        squares_sd,
    })
}

struct Rounds<'a> {
    axis: &'a mut AxisState,
    options: &'a Options,
    refused: &'a [&'static str],
    found: &'a dyn Fn(&'static str),
    accepted: Vec<Accepted>,
    discrepancies: Vec<Remark>,
    /// Whether the level switches to and fro: no business of single steps.
    switching: bool,
    /// Whether large samples come in groups, or as a level switches: no business of outliers.
    ringing: bool,
    /// Whether the strength of the noise moves all the time: no business of bursts.
    restless: bool,
    /// Whether the grid of the values decides how strong the noise looks: no business of bursts.
    grid_decides: bool,
    /// Effects there were when outliers were last sought among them.
    sought_beside: usize,
    /// Lines that were seen to lose no samples.
    kept: Vec<f64>,
    /// Bands that no steady law speaks for.
    unsteady: Vec<Remark>,
}

impl Rounds<'_> {
    fn level(&self) -> f64 {
        self.options.level()
    }

    fn duration_s(&self) -> f64 {
        self.axis.filled.len() as f64 / self.axis.rate_hz
    }

    /// Accepts an effect, unless it is refused, and makes its `change` to the record or the laws.
    fn accept(
        &mut self,
        effect: &'static str,
        parameters: BTreeMap<String, Value>,
        p_value: f64,
        freedom: f64,
        nats: Option<f64>,
        change: impl FnOnce(&mut AxisState) -> Option<()>,
    ) -> Option<bool> {
        if self.refused.contains(&effect) {
            return Some(false);
        }
        (self.found)(effect);
        let (before, without) = (self.axis.fit.clone(), Snapshot::of(self.axis));
        change(self.axis)?;
        self.accepted.push(Accepted {
            effect,
            parameters,
            p_value,
            rivals: Vec::new(),
            law: None,
            freedom,
            before,
            after: self.axis.fit.clone(),
            nats,
            with: Snapshot::of(self.axis),
            without,
        });
        Some(true)
    }

    /// Takes an effect back, with what was done to the record for it; whether it was there.
    fn withdraw(&mut self, effect: &str) -> bool {
        let before = self.accepted.len();
        self.accepted.retain(|one| one.effect != effect);
        let kept = |wave: &Wave| match wave {
            Wave::Outliers(_) => effect != "outliers",
            Wave::Steps(_) => effect != "steps",
            Wave::WarmUp { .. } => effect != "warmup",
            Wave::Follows { .. } => effect != "thermal",
            _ => true,
        };
        self.axis.mended.waves.retain(kept);
        for one in &mut self.accepted {
            one.with.waves.retain(kept);
            one.without.waves.retain(kept);
        }
        match effect {
            "burst" => self.axis.mended.masked.clear(),
            "steps" => self.axis.mended.spread.clear(),
            _ => {}
        }
        self.accepted.len() < before
    }

    fn find(&mut self, effect: &str) -> Option<&mut Accepted> {
        self.accepted.iter_mut().find(|one| one.effect == effect)
    }

    fn note_base(&mut self) {
        let level = self.level();
        let departure = departure::departure(&self.axis.data, &self.axis.fit.expected);
        if let Some(departure) = departure.filter(|one| one.p_value < level) {
            self.discrepancies.push(spectrum_remark(&departure));
        }
    }
}

/// The laws of a snapshot.
pub fn laws_of(snapshot: &Snapshot) -> Vec<Law> {
    snapshot
        .laws
        .iter()
        .filter_map(|(name, values)| {
            Some(Law {
                effect: catalogue::find(name)?,
                values: values.clone(),
            })
        })
        .collect()
}

fn named<const N: usize>(values: [(&str, Value); N]) -> BTreeMap<String, Value> {
    values
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

fn spectrum_remark(departure: &departure::Departure) -> Remark {
    Remark {
        test: "spectrum".into(),
        place: (departure.from_hz..departure.to_hz).into(),
        p_value: departure.p_value,
        description: format!(
            "{:.3} times the power that the model expects there",
            departure.ratio
        ),
    }
}
