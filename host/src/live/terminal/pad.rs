//! What the keys do: a state that each key changes, and what it asks of the recording.

use inm_protocol::MAX_MARK;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

/// Lines that a page up or down moves a list by: a little less than the smallest list shows, so that
/// one line stays to go on from.
const PAGE: usize = 8;

/// What the middle of the view shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pane {
    /// The Allan deviation as a curve.
    #[default]
    Curve,
    /// The same in figures.
    Table,
    /// What happened.
    Events,
}

impl Pane {
    /// All panes, in the order of the tab key.
    pub const ALL: [Self; 3] = [Self::Curve, Self::Table, Self::Events];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Curve => "curve",
            Self::Table => "table",
            Self::Events => "events",
        }
    }

    fn next(self) -> Self {
        let place = Self::ALL.iter().position(|&one| one == self);
        Self::ALL[place.map_or(0, |place| (place + 1) % Self::ALL.len())]
    }
}

/// What keys mean at the moment.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Mode {
    /// Each is a command.
    #[default]
    Watch,
    /// They write the note of a mark.
    Mark(String),
    /// They answer whether the recording is to end.
    End,
}

/// What a key asks of the recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Act {
    /// Ctrl-C, or a recording that is to end.
    Interrupt,
    /// Mark this moment with a note.
    Mark(String),
}

/// The state of the view that keys change.
#[derive(Debug, Clone, Default)]
pub struct Pad {
    /// What keys mean.
    pub mode: Mode,
    /// The picture stays as it is; the recording goes on.
    pub paused: bool,
    /// What the middle shows.
    pub pane: Pane,
    /// The axis whose curve is shown alone, by number.
    pub axis: Option<usize>,
    /// Lines of the list that are above what is seen.
    pub above: usize,
    /// Most of them that there can be, as it was last drawn.
    pub most_above: usize,
    /// The answer to the last key.
    pub said: Option<String>,
    /// Axes that there are.
    pub axes: usize,
    /// The recording was asked to end.
    pub ending: bool,
}

impl Pad {
    /// Takes a key.
    pub fn press(&mut self, key: KeyEvent) -> Option<Act> {
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        if control && key.code == KeyCode::Char('c') {
            self.ending = true;
            return Some(Act::Interrupt);
        }
        self.said = None;
        match std::mem::take(&mut self.mode) {
            Mode::Watch => {
                self.command(key.code);
                None
            }
            Mode::Mark(text) => self.write(text, key.code, control),
            Mode::End => (key.code == KeyCode::Char('y')).then(|| {
                self.ending = true;
                Act::Interrupt
            }),
        }
    }

    fn command(&mut self, key: KeyCode) {
        match key {
            KeyCode::Char('q') if !self.ending => self.mode = Mode::End,
            KeyCode::Char('m') if !self.ending => {
                self.mode = Mode::Mark(String::new());
            }
            KeyCode::Char('p') => self.paused = !self.paused,
            KeyCode::Char('a') => {
                let next = self.axis.map_or(0, |axis| axis + 1);
                self.axis = (next < self.axes).then_some(next);
            }
            KeyCode::Tab => {
                self.pane = self.pane.next();
                self.above = 0;
            }
            KeyCode::Up => self.above = self.above.saturating_sub(1),
            KeyCode::Down => self.above += 1,
            KeyCode::PageUp => self.above = self.above.saturating_sub(PAGE),
            KeyCode::PageDown => self.above += PAGE,
            KeyCode::Home => self.above = 0,
            KeyCode::End => self.above = self.most_above,
            _ => {}
        }
        self.above = self.above.min(self.most_above);
    }

    /// A key while the note of a mark is written.
    fn write(&mut self, mut text: String, key: KeyCode, control: bool) -> Option<Act> {
        match key {
            KeyCode::Enter => return Some(Act::Mark(text)),
            KeyCode::Esc => return None,
            KeyCode::Backspace => {
                text.pop();
            }
            KeyCode::Char(c) if !control && text.len() + c.len_utf8() <= MAX_MARK => text.push(c),
            _ => {}
        }
        self.mode = Mode::Mark(text);
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pad() -> Pad {
        Pad {
            axes: 3,
            ..Pad::default()
        }
    }

    fn press(pad: &mut Pad, keys: &[KeyCode]) -> Vec<Act> {
        let keys = keys.iter().map(|&key| KeyEvent::from(key));
        keys.filter_map(|key| pad.press(key)).collect()
    }

    fn letters(text: &str) -> Vec<KeyCode> {
        text.chars().map(KeyCode::Char).collect()
    }

    #[test]
    fn a_recording_ends_only_after_a_yes() {
        let mut pad = pad();
        assert_eq!(press(&mut pad, &letters("qn")), []);
        assert_eq!(pad.mode, Mode::Watch);
        assert_eq!(press(&mut pad, &letters("qy")), [Act::Interrupt]);
        // Asked once, it is under way.
        assert_eq!(press(&mut pad, &letters("qy")), []);
    }

    #[test]
    fn control_c_ends_it_in_any_mode() {
        let key = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
        for before in ["", "q", "mfan"] {
            let mut pad = pad();
            press(&mut pad, &letters(before));
            assert_eq!(pad.press(key), Some(Act::Interrupt), "{before}");
        }
    }

    #[test]
    fn a_mark_is_written_corrected_and_set() {
        let mut pad = pad();
        let keys = [letters("mquit?"), vec![KeyCode::Backspace, KeyCode::Enter]].concat();
        assert_eq!(press(&mut pad, &keys), [Act::Mark("quit".into())]);
        assert_eq!(pad.mode, Mode::Watch);
        let keys = [letters("mfan"), vec![KeyCode::Esc]].concat();
        assert_eq!(press(&mut pad, &keys), []);
        assert_eq!(pad.mode, Mode::Watch);
    }

    #[test]
    fn a_mark_holds_no_more_than_a_note_does() {
        let mut pad = pad();
        let text = "\u{e9}".repeat(MAX_MARK);
        press(&mut pad, &letters(&format!("m{text}")));
        let written = press(&mut pad, &[KeyCode::Enter]);
        assert_eq!(written, [Act::Mark("\u{e9}".repeat(MAX_MARK / 2))]);
    }

    #[test]
    fn the_axes_are_shown_together_then_one_by_one() {
        let mut pad = pad();
        let seen: Vec<_> = (0..5)
            .map(|_| {
                press(&mut pad, &letters("a"));
                pad.axis
            })
            .collect();
        assert_eq!(seen, [Some(0), Some(1), Some(2), None, Some(0)]);
    }

    #[test]
    fn a_list_is_moved_within_its_ends() {
        let mut pad = pad();
        pad.most_above = 5;
        press(&mut pad, &[KeyCode::Up]);
        assert_eq!(pad.above, 0);
        press(&mut pad, &[KeyCode::PageDown, KeyCode::Down]);
        assert_eq!(pad.above, 5);
        press(&mut pad, &[KeyCode::Up]);
        assert_eq!(pad.above, 4);
        press(&mut pad, &[KeyCode::Tab]);
        assert_eq!((pad.pane, pad.above), (Pane::Table, 0));
    }
}
