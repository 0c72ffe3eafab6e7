//! The spectrum of an axis, measured and modelled; lines, peaks and corners of the findings have
//! their names; where the five terms alone differ is underlined, what is left unexplained shaded.

use super::super::plot::Stroke;
use super::super::plot::frame::Field;
use super::super::plot::frame::Frame;
use super::super::plot::legend::Mark;
use super::super::plot::ratio::{self, Compared};
use super::super::plot::scale::Scale;
use super::super::spectrum_plot::{decades_of, measured, titles, typical_limit};
use super::super::svg::Theme;
use super::{DIFFERS, WITH_STRIP, models, places};
use crate::diagnosis::result::finding::AxisDiagnosis;
use crate::diagnosis::result::views::SpectrumPoint;

/// Opacity of a resonance's band.
const PEAK: f64 = 0.14;

/// The picture as SVG elements; `id` is unique within the document.
pub fn panel(axis: &AxisDiagnosis, id: &str, theme: &Theme) -> String {
    let points = &axis.views.spectrum;
    let [f_hz, density] = decades_of(points.iter().map(|one| (one.f_hz, one.psd)));
    let head = format!("Axis {}", axis.name);
    let titles = titles(&head, axis.unit.symbol(), "measured over modelled");
    let mut frame = Frame::new(
        id,
        theme,
        WITH_STRIP,
        titles,
        (
            |pixels| Scale::log(f_hz, pixels),
            |pixels| Scale::log(density, pixels),
        ),
    );
    let (peaks, unexplained) = places::bands(axis);
    for (from, to) in peaks {
        frame.shade(from, to, theme.fitted, PEAK);
    }
    for &(from, to) in &unexplained {
        frame.shade(from, to, theme.before, 2.0 * DIFFERS);
    }
    let mut tags = places::frequencies(axis);
    for (at, _) in &tags {
        frame.upright(*at, Stroke::dashed(theme.faint, 0.8, "1 4"));
    }
    let after = compared(points, |one| one.after);
    measured(&mut frame, &after);
    let modelled: Vec<_> = points
        .iter()
        .map(|one| (one.f_hz, one.before, one.after, one.simulated))
        .collect();
    let simulated = Stroke::solid(theme.simulated, 0.9);
    models(&mut frame, &modelled, Mark::Line(simulated));
    underline(&mut frame, points);
    let before = compared(points, |one| one.before);
    let limit = typical_limit(&before).max(typical_limit(&after));
    ratio::open(&mut frame, limit);
    if !axis.findings.is_empty() {
        // Where a single point says little the line would be a scribble.
        let line = before.iter().map(|one| {
            let sure = one.width() < limit;
            (one.x, if sure { one.off() } else { f64::NAN })
        });
        frame.line(Field::Strip, line, super::before(theme));
    }
    ratio::points(&mut frame, &after, 1.6);
    let unexplained = unexplained.into_iter();
    tags.extend(unexplained.map(|(_, to_hz)| (to_hz, "unexplained".into())));
    frame.tags(tags, theme.ink);
    frame.finish()
}

/// Underlines where the five terms alone differ; neighbours as one.
fn underline(frame: &mut Frame<'_>, points: &[SpectrumPoint]) {
    let red = frame.theme().differs;
    let mut any = false;
    for run in points.chunk_by(|a, b| a.differs_before() == b.differs_before()) {
        if let (Some(first), Some(last)) = (run.first(), run.last())
            && first.differs_before()
        {
            frame.underline(first.f_hz, last.f_hz, red);
            any = true;
        }
    }
    if any {
        frame.explain(Mark::Line(Stroke::solid(red, 5.0)), "before differs");
    }
}

fn compared(points: &[SpectrumPoint], expected: fn(&SpectrumPoint) -> f64) -> Vec<Compared> {
    let one = |point: &SpectrumPoint| Compared {
        x: point.f_hz,
        measured: point.psd,
        lo: point.lo,
        hi: point.hi,
        expected: expected(point),
    };
    points
        .iter()
        .map(one)
        .filter(|one| one.expected > 0.0)
        .collect()
}
