//! The Allan deviation of the axes as curves of dots.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::text::Line;
use ratatui::widgets::{Axis, Chart, Dataset, GraphType, Paragraph};

use crate::live::Snapshot;

/// Colours of the axes, by number: blue, yellow and magenta differ in brightness too, for eyes that
/// see no colours.
const COLOURS: [Color; 3] = [Color::LightBlue, Color::Yellow, Color::LightMagenta];

/// Labels of averaging times at most: more decades than any record has.
const DECADES: usize = 20;

/// The colour of the axis of a number.
pub fn colour(axis: usize) -> Style {
    Style::new().fg(COLOURS[axis % COLOURS.len()])
}

/// Draws the curves of all axes, or of `alone`.
pub fn draw(frame: &mut Frame<'_>, area: Rect, snapshot: &Snapshot, alone: Option<usize>) {
    let curves: Vec<(usize, Vec<(f64, f64)>)> = (0..snapshot.axes.len())
        .filter(|axis| alone.is_none_or(|alone| alone == *axis))
        .map(|axis| (axis, curve(snapshot, axis)))
        .collect();
    let points = || curves.iter().flat_map(|(_, points)| points);
    let (Some(tau_s), Some(adev)) = (
        decades(points().map(|point| point.0)),
        decades(points().map(|point| point.1)),
    ) else {
        return frame.render_widget(Paragraph::new("no samples yet"), area);
    };
    let datasets = curves.iter().map(|(axis, points)| {
        Dataset::default()
            .marker(Marker::Braille)
            .graph_type(GraphType::Line)
            .style(colour(*axis))
            .data(points)
    });
    let of = |axis: usize| snapshot.axes[axis].split_once(", ").unwrap_or_default();
    let names: Vec<&str> = curves.iter().map(|(axis, _)| of(*axis).0).collect();
    let title = format!(
        "Allan deviation of {}, {}",
        names.join(" "),
        of(curves[0].0).1
    );
    // A label every decade, as far as there are rows for them.
    let rows = usize::from(area.height.saturating_sub(2)).max(2);
    let chart = Chart::new(datasets.collect())
        .x_axis(scale("averaging time, s".to_owned(), tau_s, DECADES))
        .y_axis(scale(title, adev, rows));
    frame.render_widget(chart, area);
}

/// Common logarithms of averaging time and deviation.
fn curve(snapshot: &Snapshot, axis: usize) -> Vec<(f64, f64)> {
    let rows = snapshot.table.iter();
    rows.filter_map(|row| {
        let cell = (*row.cells.get(axis)?)?;
        (cell.adev > 0.0).then(|| (row.tau_s.log10(), cell.adev.log10()))
    })
    .collect()
}

/// The whole decades around values given by their logarithms.
fn decades(logarithms: impl Iterator<Item = f64>) -> Option<(i32, i32)> {
    let range = logarithms.fold(None, |range: Option<(f64, f64)>, one| {
        let (from, to) = range.unwrap_or((one, one));
        Some((from.min(one), to.max(one)))
    });
    let (from, to) = range?;
    let from = from.floor() as i32;
    Some((from, (to.ceil() as i32).max(from + 1)))
}

/// An axis over whole decades, with a label at each, or at every second or third so that no more than
/// `most` are needed.
fn scale(title: String, (from, to): (i32, i32), most: usize) -> Axis<'static> {
    // The labels stand at even distances from end to end.
    let steps = |step: i32| (to - from + step - 1) / step;
    let step = (1..to - from).find(|&step| steps(step) < most as i32);
    let step = step.unwrap_or(to - from);
    let to = from + steps(step) * step;
    let labels = (from..=to).step_by(step as usize);
    Axis::default()
        .title(Line::from(title))
        .bounds([f64::from(from), f64::from(to)])
        .labels(labels.map(|decade| format!("1e{decade}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_is_of_whole_decades() {
        assert_eq!(decades([-3.3, 1.2].into_iter()), Some((-4, 2)));
        assert_eq!(decades([2.0].into_iter()), Some((2, 3)));
        assert_eq!(decades([].into_iter()), None);
    }
}
