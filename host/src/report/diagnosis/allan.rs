//! The Allan deviation of an axis, measured and modelled; averaging times at which the five terms
//! alone lie outside the measured interval are underlined.

use super::super::allan_plot::decades_of;
use super::super::plot::Stroke;
use super::super::plot::frame::{Field, Frame, Title, Titles};
use super::super::plot::legend::Mark;
use super::super::plot::ratio::{self, Compared};
use super::super::plot::scale::Scale;
use super::super::svg::{Theme, escape, typeset};
use super::{WITH_STRIP, models, places};
use crate::diagnosis::result::finding::AxisDiagnosis;
use crate::diagnosis::result::views::AllanPoint;

/// Opacity of the measured band.
const BAND: f64 = 0.18;

/// Relative width of an interval up to which a point sets the scale of the strip.
const SURE: f64 = 0.4;

/// Half the distance of averaging times that are four an octave, as a factor.
const HALF_STEP: f64 = 1.0905;

/// The picture as SVG elements; `id` is unique within the document.
pub fn panel(axis: &AxisDiagnosis, id: &str, theme: &Theme) -> String {
    let points: Vec<&AllanPoint> = axis
        .views
        .allan
        .iter()
        .filter(|one| one.adev > 0.0)
        .collect();
    let [tau_s, deviation] = decades_of(points.iter().map(|one| (one.tau_s, one.adev)));
    let titles = Titles {
        head: escape(&format!("Axis {}", axis.name)),
        x: Title::new("averaging time", "s"),
        y: Title::new("Allan deviation", escape(&typeset(axis.unit.symbol()))),
        strip: Title::new("measured over modelled", "percent"),
    };
    let mut frame = Frame::new(
        id,
        theme,
        WITH_STRIP,
        titles,
        (
            |pixels| Scale::log(tau_s, pixels),
            |pixels| Scale::log(deviation, pixels),
        ),
    );
    let blue = theme.measured;
    let band: Vec<_> = points
        .iter()
        .map(|one| (one.tau_s, one.lo, one.hi))
        .collect();
    frame.band(Field::Main, &band, blue, BAND);
    let curve = || points.iter().map(|one| (one.tau_s, one.adev));
    frame.line(Field::Main, curve(), Stroke::solid(blue, 1.0));
    frame.dots(Field::Main, curve(), 2.3, blue);
    frame.explain(Mark::DotOnBand(blue, BAND), "measured, 95 %");
    let modelled: Vec<_> = points
        .iter()
        .map(|one| (one.tau_s, one.before, one.after, one.simulated))
        .collect();
    models(&mut frame, &modelled, Mark::Cross(theme.simulated));
    underline(&mut frame, &points);
    strip(&mut frame, &points, !axis.findings.is_empty());
    let tags = places::averaging_times(axis);
    for (at, _) in &tags {
        frame.upright(*at, Stroke::dashed(theme.faint, 0.8, "1 4"));
    }
    frame.tags(tags, theme.ink);
    frame.finish()
}

/// Underlines where the five terms alone differ; neighbours as one.
fn underline(frame: &mut Frame<'_>, points: &[&AllanPoint]) {
    let red = frame.theme().differs;
    let mut any = false;
    for run in points.chunk_by(|a, b| a.differs_before() == b.differs_before()) {
        if let [first, ..] = run
            && first.differs_before()
        {
            let last = run.last().unwrap_or(first);
            frame.underline(first.tau_s / HALF_STEP, last.tau_s * HALF_STEP, red);
            any = true;
        }
    }
    if any {
        frame.explain(Mark::Line(Stroke::solid(red, 5.0)), "before differs");
    }
}

/// Measured over what the extended model expects, and where anything was found over what the five
/// terms alone do.
fn strip(frame: &mut Frame<'_>, points: &[&AllanPoint], found: bool) {
    let theme = frame.theme();
    let compared = |expected: fn(&AllanPoint) -> f64| -> Vec<Compared> {
        let one = |point: &&AllanPoint| Compared {
            x: point.tau_s,
            measured: point.adev,
            lo: point.lo,
            hi: point.hi,
            expected: expected(point),
        };
        points
            .iter()
            .map(one)
            .filter(|one| one.expected > 0.0)
            .collect()
    };
    let (before, after) = (compared(|one| one.before), compared(|one| one.after));
    let sure = |one: &&Compared| one.hi / one.lo < 1.0 + SURE;
    let largest = before
        .iter()
        .chain(&after)
        .filter(sure)
        .map(|one| one.off().abs())
        .fold(0.0, f64::max);
    ratio::open(frame, ratio::limit(largest));
    if found {
        let line = before.iter().map(|one| (one.x, one.off()));
        frame.line(Field::Strip, line, super::before(theme));
    }
    ratio::points(frame, &after, 2.0);
}
