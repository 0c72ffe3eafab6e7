//! The record in time: extremes of its samples and of the model's deterministic part, and in the
//! strip the means of both, which show what the noise hides.

use super::super::plot::Stroke;
use super::super::plot::frame::{Field, Frame, Title, Titles};
use super::super::plot::legend::Mark;
use super::super::plot::scale::Scale;
use super::super::svg::{Theme, escape, typeset};
use super::{DIFFERS, WITH_STRIP};
use crate::diagnosis::result::finding::AxisDiagnosis;
use crate::diagnosis::result::views::{Column, Course, Extent};
use crate::numeric::written::significant;

/// Opacity of extremes.
const EXTREMES: f64 = 0.4;

/// Part of the range that is left free above and below.
const MARGIN: f64 = 0.08;

/// Moments of one effect up to which each has its own line.
const FEW: usize = 40;

/// The picture as SVG elements; `id` is unique within the document.
pub fn panel(axis: &AxisDiagnosis, id: &str, theme: &Theme) -> String {
    let course = &axis.views.course;
    let unit = escape(&typeset(axis.unit.symbol()));
    let titles = Titles {
        head: escape(&format!("Axis {} in time", axis.name)),
        x: Title::new("time", "s"),
        y: Title::new(
            format!("signal about {}", significant(course.mean, 6)),
            &*unit,
        ),
        strip: Title::new(
            format!("means over {} s", significant(course.column_s, 3)),
            unit,
        ),
    };
    let modelled = course
        .columns
        .iter()
        .any(|one| one.modelled.lo != 0.0 || one.modelled.hi != 0.0);
    let extremes = range(course, |one| [one.measured.lo, one.measured.hi]);
    let mut frame = Frame::new(
        id,
        theme,
        WITH_STRIP,
        titles,
        (
            |pixels| Scale::linear((0.0, course.duration_s()), pixels),
            |pixels| Scale::linear(extremes, pixels),
        ),
    );
    frame.set_strip(range(course, |one| [one.measured.mean, one.modelled.mean]));
    marks(&mut frame, course);
    let blue = theme.measured;
    frame.band(
        Field::Main,
        &band(course, |one| one.measured),
        blue,
        EXTREMES,
    );
    frame.explain(Mark::Area(blue, EXTREMES), "extremes");
    let mean = Stroke::solid(blue, 1.0);
    frame.line(Field::Strip, line(course, |one| one.measured), mean);
    frame.line(Field::Main, line(course, |one| one.measured), mean);
    frame.explain(Mark::Line(mean), "mean");
    if modelled {
        let model = Stroke::solid(theme.fitted, 1.6);
        frame.band(
            Field::Main,
            &band(course, |one| one.modelled),
            theme.fitted,
            EXTREMES,
        );
        for field in [Field::Main, Field::Strip] {
            frame.line(field, line(course, |one| one.modelled), model);
        }
        frame.explain(Mark::LineOnBand(model, EXTREMES), "course of the model");
    }
    frame.finish()
}

fn at(course: &Course, index: usize) -> f64 {
    (index as f64 + 0.5) * course.column_s
}

fn line(course: &Course, which: fn(&Column) -> Extent) -> Vec<(f64, f64)> {
    let columns = course.columns.iter().enumerate();
    columns
        .map(|(index, column)| (at(course, index), which(column).mean))
        .collect()
}

fn band(course: &Course, which: fn(&Column) -> Extent) -> Vec<(f64, f64, f64)> {
    let columns = course.columns.iter().enumerate();
    columns
        .map(|(index, column)| {
            let extent = which(column);
            (at(course, index), extent.lo, extent.hi)
        })
        .collect()
}

/// The range of some values of all columns, with a margin.
fn range(course: &Course, values: fn(&Column) -> [f64; 2]) -> (f64, f64) {
    let values = course.columns.iter().flat_map(values);
    let (lo, hi) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), value| {
            (lo.min(value), hi.max(value))
        });
    if lo >= hi {
        return (-1.0, 1.0);
    }
    let margin = MARGIN * (hi - lo);
    (lo - margin, hi + margin)
}

/// What findings say of moments and stretches. Single samples are dots, at the extreme of their
/// column.
fn marks(frame: &mut Frame<'_>, course: &Course) {
    let red = frame.theme().differs;
    let mut names: Vec<(f64, String)> = Vec::new();
    let mut dots = Vec::new();
    let mut marks: Vec<_> = course.marks.iter().collect();
    marks.sort_by_key(|mark| mark.effect.name());
    for same in marks.chunk_by(|a, b| a.effect == b.effect) {
        for mark in same {
            let index = (mark.from_s / course.column_s) as usize;
            if mark.is_sample {
                let column = course.columns.get(index).map(|column| column.measured);
                dots.extend(column.map(|one| {
                    let above = one.hi - one.mean > one.mean - one.lo;
                    (mark.from_s, if above { one.hi } else { one.lo })
                }));
            } else if mark.to_s > mark.from_s {
                frame.shade(mark.from_s, mark.to_s, red, DIFFERS);
            } else if same.len() <= FEW {
                frame.upright(mark.from_s, Stroke::dashed(red, 1.0, "3 3"));
            }
        }
        if let Some(first) = same.first().filter(|first| !first.is_sample) {
            names.push((first.from_s, first.effect.to_string()));
        }
    }
    if !dots.is_empty() {
        frame.dots(Field::Main, dots, 2.2, red);
        let samples = course.marks.iter().find(|mark| mark.is_sample);
        let name = samples.map_or("", |mark| mark.effect.name());
        frame.explain(Mark::DotOnBand(red, 0.0), name);
    }
    frame.tags(names, red);
}
