//! What it is that stands out in a stretch of a record.
//!
//! A shock has a duration. What is gone where the record is cut at one moment is a jump, or a loss of samples;
//! what is gone without one sample is an outlier; what is as strong from its beginning to its end is a burst.

use std::ops::Range;

use super::about::{About, Beside};
use super::alone;
use super::course::{self, Course};
use super::ends::beside_ends;
use super::even::{LONG, even};
use super::fit::{self, Fitted};
use super::loud;
use super::moment::{MOMENT, Moment};
use super::moved::{Moved, NotMoved};
use super::quiet::Quiet;
use super::scan::Scan;
use super::singles::Singles;
use super::strength;
use super::stretch::Stretch;
use crate::diagnosis::detect::burst::Burst;

/// Samples that are whitened, at most: a choice between time and place.
const WHITENED: usize = 1 << 20;

/// Means that a course is fitted to, at most: a choice between time and what rings for long at a high frequency.
const FITTED: usize = 1 << 15;

/// What stands out in a stretch.
pub enum What {
    /// A shock.
    Shock(Course),
    /// Something that moved the sensor for a while, in no simple form.
    Motion(Moved),
    /// The noise itself, louder for a while.
    Louder(Burst),
    /// A jump of the level, or whatever else changes at one moment.
    Jump,
    /// Single samples that do not belong, few enough to come together by chance.
    Singles,
    /// Something else.
    Other,
}

/// The record about a stretch.
pub struct Event<'a> {
    scan: &'a Scan<'a>,
    /// The stretch.
    pub stretch: &'a Stretch,
    /// The run of samples about it in which nothing else happens.
    own: Range<usize>,
    /// The same across single gaps.
    whole: Range<usize>,
    /// Where nothing happens.
    quiet: &'a Quiet,
}

impl<'a> Event<'a> {
    /// Of a stretch, of those in which something happens; `quiet` are the runs without them.
    pub fn new(scan: &'a Scan<'a>, stretch: &'a Stretch, quiet: &'a Quiet) -> Self {
        Self {
            own: Quiet::about(&quiet.runs, &stretch.samples),
            whole: Quiet::about(&quiet.whole, &stretch.samples),
            scan,
            stretch,
            quiet,
        }
    }

    const fn samples(&self) -> &'a Range<usize> {
        &self.stretch.samples
    }

    fn values(&self) -> &'a [f64] {
        self.scan.values()
    }

    /// The stretch with up to `more` samples of its own on either side.
    fn with(&self, more: usize) -> Range<usize> {
        let samples = self.samples();
        let from = samples.start.saturating_sub(more).max(self.own.start);
        from..(samples.end + more).min(self.own.end)
    }

    /// What it is.
    pub fn what(&self) -> What {
        let moment = self.moment();
        if moment.as_ref().is_some_and(Moment::is_one_sample) || self.are_single_samples() {
            return What::Singles;
        }
        if moment.as_ref().is_some_and(Moment::is_cut) || self.is_between_levels() {
            return What::Jump;
        }
        let close = self.about(1, self.samples().len() / 2);
        let even = close.as_ref().and_then(|about| even(about, self.samples()));
        drop(close);
        let about = self.about(self.factor(), self.margin());
        let fitted = about.as_ref().and_then(|about| {
            let short = about.errors().len() <= FITTED;
            let fitted = short.then(|| fit::fit(about)).flatten();
            fitted.map(|fitted| (about, fitted))
        });
        let score = fitted
            .as_ref()
            .map_or(self.stretch.z.powi(2), |(_, fitted)| fitted.score);
        if even.is_some_and(|nats| nats > 0.5 * score) {
            return self.louder();
        }
        if score < self.needed() {
            return What::Other;
        }
        let Some((about, fitted)) = fitted else {
            return self.told(None);
        };
        if let Some(other) = self.other(about, &fitted) {
            return other;
        }
        // What settles from the start on has a name of its own.
        let is_first = self.samples().start == 0 && fitted.shock.f_hz == 0.0;
        if is_first && course::is_most(about, &fitted, self.samples()) {
            return What::Other;
        }
        let later = beside_ends(about, &fitted);
        let (rest, best) = later
            .as_ref()
            .map_or((about, &fitted), |(rest, best)| (rest, best));
        let course = course::of_fit(rest, best, self.samples());
        course.map_or_else(|| self.told(Some(about)), What::Shock)
    }

    /// What can be told of an event of no simple form.
    fn told(&self, about: Option<&About>) -> What {
        let (values, samples) = (self.scan.whole(), self.samples());
        match Moved::new(&self.beside(), samples, about) {
            Ok(moved) => What::Motion(moved),
            Err(NotMoved::Short) => What::Shock(course::told(values, samples, &self.whole, about)),
            Err(NotMoved::Louder) => self.louder(),
        }
    }

    fn beside(&self) -> strength::Beside<'_> {
        strength::Beside {
            values: self.scan.whole(),
            quiet: &self.quiet.whole,
            own: &self.whole,
        }
    }

    /// Whether it goes from one level to another; what lasts for longer than a moment, to one further off than a walk goes in
    /// that time.
    fn is_between_levels(&self) -> bool {
        let samples = self.samples();
        course::is_between_levels(self.values(), samples, &self.own)
            && (samples.len() <= MOMENT || self.beside().step(samples).is_some())
    }

    /// Noise that is louder in this stretch, where it is.
    pub fn louder(&self) -> What {
        let found = loud::of(self.scan, self.quiet, self.samples());
        found.map_or(What::Other, What::Louder)
    }

    /// Whether it is noise as strong from its beginning to its end that explains more than so many `nats`.
    pub fn is_even(&self, nats: f64) -> bool {
        self.about(1, 0)
            .and_then(|about| even(&about, self.samples()))
            .is_some_and(|gain| gain > nats)
    }

    /// The score from which it stands out of the noise right beside it, which may be louder for a while.
    fn needed(&self) -> f64 {
        let len = self.samples().len().max(self.stretch.window);
        let Some(about) = self.about(1, 4 * len) else {
            return 0.0;
        };
        let inside = about.means_of(self.samples());
        // Of what goes before, and of what comes after, the one that is quieter.
        let near = self.stretch.window / 2;
        let len = about.errors().len();
        let before = about.said(0..inside.start.saturating_sub(near));
        let after = about.said((inside.end + near).min(len)..len);
        let power = |errors: Vec<f64>| {
            let square = errors.iter().map(|error| error * error).sum::<f64>();
            square / errors.len() as f64
        };
        let sides = [before, after]
            .into_iter()
            .filter(|errors| errors.len() >= LONG);
        let quieter = sides.map(power).fold(f64::INFINITY, f64::min);
        if quieter.is_finite() {
            quieter * self.scan.threshold().powi(2)
        } else {
            0.0
        }
    }

    /// Samples on either side that a fit looks at: more of them tell no level better than it is needed.
    fn margin(&self) -> usize {
        let len = self.samples().len();
        (len / 2).min(1024).max(self.stretch.window / 2).max(32)
    }

    /// Samples of a mean: enough to see its frequency, and not many more than a hundred in all.
    fn factor(&self) -> usize {
        let by_length = self.samples().len() / 128;
        let by_frequency = (0.12 / self.stretch.frequency) as usize;
        by_length.min(by_frequency).max(1)
    }

    fn about(&self, factor: usize, margin: usize) -> Option<About> {
        let samples = self.samples();
        let from = samples.start.saturating_sub(margin).max(self.whole.start);
        let range = from..(samples.end + margin).min(self.whole.end);
        if range.len() > WHITENED * factor {
            return None;
        }
        let beside = Beside {
            values: self.scan.seen(),
            quiet: &self.quiet.whole,
            faint: self.scan.faint(),
        };
        About::new(&beside, self.samples(), &range, factor)
    }

    /// The stretch as one moment, where it is short enough.
    fn moment(&self) -> Option<Moment<'a>> {
        let samples = self.samples();
        let near = self.with(MOMENT);
        (samples.len() <= MOMENT).then(|| Moment::new(self.scan, near, samples))
    }

    /// Whether nothing is left without single samples of it that come close together by chance.
    pub fn are_single_samples(&self) -> bool {
        let near = self.with(self.stretch.window);
        alone::are_all(
            self.scan,
            self.stretch,
            &near,
            self.stretch.window.max(MOMENT),
        )
    }

    /// How many samples of it are plainly far off, each by itself.
    fn singles(&self) -> usize {
        alone::count(self.scan, self.stretch, &self.with(self.stretch.window))
    }

    /// A jump, or single samples, where these explain it as well as a shock.
    fn other(&self, about: &About, fitted: &Fitted) -> Option<What> {
        /// What the numbers of a shock beyond those of a jump or of one sample are worth, and each further sample:
        /// as by the information criterion of G. Schwarz, Ann. Stat. 6 (1978), for some thousand samples.
        const MORE_NUMBERS: f64 = 14.0;
        const ONE_SAMPLE: f64 = 9.0;
        /// Samples that come together by chance beside those that are plainly far off, at most, and the error that is none.
        const TOGETHER: usize = 4;
        const NO_ERROR: f64 = 5.0;
        let worth = fitted.score - MORE_NUMBERS;
        let singles = Singles::new(about)?;
        if singles.jump() > worth {
            return Some(What::Jump);
        }
        let is_samples = about.factor() == 1
            && (1..=TOGETHER + self.singles()).any(|count| {
                let (score, largest) = singles.some(count);
                largest < NO_ERROR && score - ONE_SAMPLE * (count - 1) as f64 > worth
            });
        is_samples.then_some(What::Singles)
    }
}
