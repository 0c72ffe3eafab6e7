//! The picture at the sizes that terminals have.

use inm_protocol::Health;
use ratatui::Terminal;
use ratatui::backend::TestBackend;

use super::draw::draw;
use super::pad::{Mode, Pad, Pane};
use crate::live::{Cell, Noise, NoiseRow, Phase, Row, Snapshot};
use crate::source::assemble::Losses;
use crate::source::audit::{Proof, State};

const AXES: usize = 3;

/// An hour and a half, half over: the published noise in round figures, one axis louder than the other.
fn snapshot() -> Snapshot {
    let cell = |tau_s: f64, axis: usize| {
        let louder = 1.0 + axis as f64;
        let variance = (4e-4 / tau_s).powi(2) + 1e-8 / tau_s + 1e-9 * tau_s;
        Some(Cell {
            adev: louder * variance.sqrt(),
            relative: 0.001 * tau_s.sqrt(),
        })
    };
    let table = (0..21).map(|octave| f64::from(1 << octave) / 2000.0);
    let table = table.map(|tau_s| Row {
        tau_s,
        cells: (0..AXES).map(|axis| cell(tau_s, axis)).collect(),
    });
    let below = Noise::Below {
        bound: 1.98e-6,
        more_s: Some(700.0),
    };
    let noise = ["R", "K", "B", "N", "Q"].map(|symbol| NoiseRow {
        symbol,
        cells: vec![
            Some(below),
            Some(Noise::Value(1.058e-4, 0.0213)),
            (symbol != "R").then_some(Noise::Value(2.249e-4, 0.0004)),
        ],
    });
    Snapshot {
        source: "/dev/ttyUSB0".into(),
        phase: Phase::Recording,
        settings: None,
        capture: Some("run1.inmcap".into()),
        page: None,
        rate_hz: 2000.0,
        samples: 5_400_000,
        expected: Some(10_800_000),
        bytes: 68_400_000,
        losses: Losses {
            lost_samples: 32,
            gaps: 1,
            ..Losses::default()
        },
        damaged: 1,
        health: Some(Health {
            mcu_centi_celsius: Some(3120),
            supply_mv: Some(3301),
            ..Health::default()
        }),
        proof: Some(Proof {
            state: State::Proven {
                epoch: 0,
                index: 5_399_872,
            },
            ..Proof::default()
        }),
        axes: ["X", "Y", "Z"]
            .map(|name| format!("{name}, m/s^2"))
            .to_vec(),
        table: table.collect(),
        noise: noise.to_vec(),
        news: (0..40)
            .map(|k| format!("sample {k}: X: the converter clips\u{1b}[2J"))
            .collect(),
    }
}

/// A terminal of so many columns and rows, with the view on it.
fn drawn(size: (u16, u16), snapshot: &Snapshot, pad: &mut Pad) -> Terminal<TestBackend> {
    let mut terminal = Terminal::new(TestBackend::new(size.0, size.1)).expect("a terminal");
    let drawn = terminal.draw(|frame| draw(frame, snapshot, pad));
    drawn.expect("a picture");
    terminal
}

/// The view as text.
fn picture(size: (u16, u16), snapshot: &Snapshot, pad: &mut Pad) -> String {
    drawn(size, snapshot, pad).backend().to_string()
}

fn pad(pane: Pane) -> Pad {
    Pad {
        pane,
        axes: AXES,
        ..Pad::default()
    }
}

#[test]
fn all_of_it_fits_80_columns_and_24_rows() {
    let size = (80, 24);
    insta::assert_snapshot!(picture(size, &snapshot(), &mut pad(Pane::Curve)));
}

#[test]
fn there_is_more_of_the_curve_in_120_columns_and_40_rows() {
    insta::assert_snapshot!(picture((120, 40), &snapshot(), &mut pad(Pane::Curve)));
}

#[test]
fn a_list_is_scrolled_under_its_heading() {
    let mut pad = pad(Pane::Table);
    pad.above = usize::MAX;
    insta::assert_snapshot!(picture((80, 24), &snapshot(), &mut pad));
    assert_eq!(pad.above, pad.most_above);
    assert!(pad.most_above > 0 && pad.most_above < snapshot().table.len());
}

#[test]
fn the_page_has_its_address_in_the_view() {
    let address = "http://127.0.0.1:4000/0123456789abcdef0123456789abcdef/";
    let mut with = snapshot();
    with.page = Some(address.into());
    let shown = picture((80, 24), &with, &mut pad(Pane::Curve));
    assert!(shown.contains(address), "{shown}");
}

#[test]
fn an_axis_is_shown_alone() {
    let mut pad = pad(Pane::Curve);
    pad.axis = Some(1);
    let shown = picture((80, 24), &snapshot(), &mut pad);
    assert!(shown.contains("Allan deviation of Y, m/s^2"), "{shown}");
}

#[test]
fn events_come_last_first_and_move_no_cursor() {
    let shown = picture((80, 24), &snapshot(), &mut pad(Pane::Events));
    let place = |text: &str| {
        shown
            .find(text)
            .unwrap_or_else(|| panic!("{text}: {shown}"))
    };
    assert!(place("sample 39") < place("sample 38"), "{shown}");
    assert!(!shown.contains('\u{1b}'), "{shown}");
}

#[test]
fn what_keys_do_is_said_and_what_is_asked_is_asked() {
    let with = |change: &dyn Fn(&mut Pad)| {
        let mut pad = pad(Pane::Curve);
        change(&mut pad);
        picture((80, 24), &snapshot(), &mut pad)
    };
    let told = |text: &str, shown: String| assert!(shown.contains(text), "`{text}`: {shown}");
    told("m mark", with(&|_| {}));
    told(
        "mark this moment: fan on_",
        with(&|pad| pad.mode = Mode::Mark("fan on".into())),
    );
    told("end the recording? y", with(&|pad| pad.mode = Mode::End));
    told("PAUSED", with(&|pad| pad.paused = true));
    told(
        "not marked",
        with(&|pad| pad.said = Some("not marked".into())),
    );
}

#[test]
fn a_bench_that_does_not_record_says_so() {
    for (phase, said) in [
        (Phase::Resting, "STOPPED"),
        (Phase::Starting, "STARTING"),
        (Phase::Testing, "SELF-TEST"),
    ] {
        let mut snapshot = snapshot();
        snapshot.phase = phase;
        let shown = picture((80, 24), &snapshot, &mut pad(Pane::Curve));
        assert!(shown.contains(said), "{shown}");
    }
}

#[test]
fn no_size_and_no_state_is_too_little() {
    for width in [0, 1, 7, 40, 300] {
        for height in [0, 1, 2, 5, 9, 16, 100] {
            for snapshot in [snapshot(), Snapshot::default()] {
                for pane in Pane::ALL {
                    drawn((width, height), &snapshot, &mut pad(pane));
                }
            }
        }
    }
}
