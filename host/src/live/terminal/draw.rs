//! The picture: head, curve or list, coefficients, the last event, keys.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::Stylize;
use ratatui::text::{Line, Span, Text};
use ratatui::widgets::Paragraph;

use super::curve;
use super::pad::{Mode, Pad, Pane};
use crate::live::{Phase, Snapshot, words};
use crate::plain::shown;

/// Columns of the averaging time, or of a coefficient's letter, ahead of the axes.
const FIRST: usize = 10;

/// Rows that a curve needs to be one: below, the coefficients give way.
const LEAST_MIDDLE: u16 = 5;

/// Draws `snapshot` as `pad` has it, and tells `pad` how far its list goes.
pub fn draw(frame: &mut Frame<'_>, snapshot: &Snapshot, pad: &mut Pad) {
    let area = frame.area();
    let head = head(snapshot, pad);
    let coefficients = coefficients(snapshot, area.width);
    let news = snapshot.news.last().map(|news| line(&format!("! {news}")));
    let [foot, last, top] = [1, u16::from(news.is_some()), head.len() as u16];
    let below = coefficients.len() as u16;
    let fits = area.height >= foot + last + top + below + LEAST_MIDDLE;
    let rows = Layout::vertical([
        Constraint::Length(top),
        Constraint::Fill(1),
        Constraint::Length(if fits { below } else { 0 }),
        Constraint::Length(last),
        Constraint::Length(foot),
    ]);
    let [top, middle, below, last, foot] = rows.areas(area);
    frame.render_widget(Text::from(head), top);
    match pad.pane {
        Pane::Curve => curve::draw(frame, middle, snapshot, pad.axis),
        Pane::Table => list(frame, middle, &table(snapshot, area.width), 1, pad),
        Pane::Events => list(frame, middle, &events(snapshot), 0, pad),
    }
    frame.render_widget(Text::from(coefficients), below);
    if let Some(news) = news {
        frame.render_widget(news.bold(), last);
    }
    frame.render_widget(keys(pad), foot);
}

/// Text of others as a line: what does not show is written out.
fn line(text: &str) -> Line<'static> {
    Line::from(shown(text).into_owned())
}

/// What is recorded and how the link is.
fn head(snapshot: &Snapshot, pad: &Pad) -> Vec<Line<'static>> {
    let mut head = vec![line(&snapshot.headline()).bold()];
    let progress = snapshot.progress();
    head.push(match snapshot.phase {
        _ if pad.ending => line(&format!("ENDING  {progress}")),
        Phase::Recording if pad.paused => {
            line(&format!("PAUSED, and recording  {progress}")).reversed()
        }
        Phase::Recording => line(&progress),
        phase => line(&format!("{}  {progress}", phase.word())).reversed(),
    });
    head.extend(snapshot.state().iter().map(|text| line(text)));
    let page = snapshot.page.iter();
    head.extend(page.map(|address| line(&format!("page: {address}"))));
    head
}

/// Cells under the names of the axes.
fn row(first: &str, cells: impl Iterator<Item = String>, axes: usize, width: u16) -> String {
    let column = usize::from(width).saturating_sub(FIRST) / axes.max(1);
    let cells = cells.map(|cell| format!("{cell:>column$}"));
    format!("{first:>FIRST$}{}", cells.collect::<String>())
}

/// The names of the axes, in the colours of their curves.
fn heading(first: &str, snapshot: &Snapshot, width: u16) -> Line<'static> {
    let text = row(
        first,
        snapshot.axes.iter().cloned(),
        snapshot.axes.len(),
        width,
    );
    let mut rest = shown(&text).into_owned();
    let mut heading = Line::default();
    for (axis, name) in snapshot.axes.iter().enumerate() {
        let end = rest
            .find(&*shown(name))
            .map_or(0, |at| at + shown(name).len());
        let after = rest.split_off(end);
        heading.push_span(Span::styled(rest, curve::colour(axis)));
        rest = after;
    }
    heading
}

/// The coefficients, once there is a fit.
fn coefficients(snapshot: &Snapshot, width: u16) -> Vec<Line<'static>> {
    let axes = snapshot.axes.len();
    let rows = snapshot.noise.iter().map(|noise| {
        let cells = noise.cells.iter().map(|cell| words::coefficient(*cell));
        line(&row(noise.symbol, cells, axes, width))
    });
    let heading = (!snapshot.noise.is_empty()).then(|| heading("", snapshot, width));
    heading.into_iter().chain(rows).collect()
}

/// The Allan table, its heading first.
fn table(snapshot: &Snapshot, width: u16) -> Vec<Line<'static>> {
    let axes = snapshot.axes.len();
    let rows = snapshot.table.iter().map(|one| {
        let cells = one.cells.iter().map(|cell| words::deviation(*cell));
        line(&row(&words::short(one.tau_s), cells, axes, width))
    });
    let heading = heading("tau, s", snapshot, width);
    std::iter::once(heading).chain(rows).collect()
}

/// What happened, the last first.
fn events(snapshot: &Snapshot) -> Vec<Line<'static>> {
    if snapshot.news.is_empty() {
        return vec![line("nothing has happened so far")];
    }
    snapshot.news.iter().rev().map(|news| line(news)).collect()
}

/// Lines of which the first `fixed` stay while the others are moved.
fn list(frame: &mut Frame<'_>, area: Rect, lines: &[Line<'static>], fixed: u16, pad: &mut Pad) {
    let rows = Layout::vertical([Constraint::Length(fixed), Constraint::Fill(1)]);
    let [top, moved] = rows.areas(area);
    let (heading, lines) = lines.split_at(usize::from(fixed).min(lines.len()));
    pad.most_above = lines.len().saturating_sub(usize::from(moved.height));
    pad.above = pad.above.min(pad.most_above);
    frame.render_widget(Text::from(heading.to_vec()), top);
    let seen = lines.iter().skip(pad.above).take(moved.height.into());
    frame.render_widget(Text::from_iter(seen.cloned()), moved);
}

/// What keys do now, or the answer to the last one.
fn keys(pad: &Pad) -> Paragraph<'static> {
    let text = match (&pad.mode, &pad.said) {
        (Mode::Mark(text), _) => {
            format!("mark this moment: {text}_   (Enter sets it, Esc does not)")
        }
        (Mode::End, _) => "end the recording? y ends it, any other key does not".to_owned(),
        (Mode::Watch, Some(said)) => said.clone(),
        (Mode::Watch, None) => {
            let panes = Pane::ALL.map(|pane| {
                let name = pane.name();
                if pane == pad.pane {
                    format!("[{name}]")
                } else {
                    name.to_owned()
                }
            });
            format!(
                "q end  m mark  p pause  a axes  Tab {}  arrows scroll",
                panes.join(" ")
            )
        }
    };
    Paragraph::new(line(&text).reversed())
}
