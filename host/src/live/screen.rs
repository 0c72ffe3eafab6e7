//! Where the state of a recording is shown.

use std::time::Duration;

use super::lines::Lines;
use super::noise::Noises;
use super::table::table;
use super::terminal::{self, TerminalView};
use super::view::{Artist, Scene};
use super::{Controls, Snapshot};

/// Between two pictures on a terminal: often enough to see it move.
const PERIOD: Duration = Duration::from_millis(500);

/// Between two lines in a log: a night is some thousand of them.
const LOG_PERIOD: Duration = Duration::from_secs(10);

/// On standard error in any case, so that results can be piped.
pub struct Screen(Kind);

enum Kind {
    Lines(Lines),
    Terminal(TerminalView),
}

impl Screen {
    /// A few lines drawn over themselves; where standard error is not a terminal, a line now and then.
    pub fn lines() -> Self {
        Self(Kind::Lines(Lines::stderr()))
    }

    /// The whole terminal, with keys for what `controls` allow; [`Screen::lines`] where there is none to
    /// take, or it is another program's at the moment.
    pub fn terminal(controls: Controls) -> Self {
        let taken = terminal::is_ours().then(|| TerminalView::take(controls));
        match taken {
            Some(Ok(view)) => Self(Kind::Terminal(view)),
            _ => Self::lines(),
        }
    }

    /// Between two pictures.
    pub fn period(&self) -> Duration {
        match &self.0 {
            Kind::Lines(lines) if !lines.is_term() => LOG_PERIOD,
            _ => PERIOD,
        }
    }

    /// Shows the state of a moment. Lines wait for a terminal that stands still.
    pub fn show(&mut self, snapshot: Snapshot) {
        match &mut self.0 {
            // A terminal that went away is no reason to stop a recording.
            Kind::Lines(lines) => drop(lines.show(&snapshot.render())),
            Kind::Terminal(view) => view.show(snapshot),
        }
    }

    /// Leaves the last state on the terminal, as lines.
    pub fn close(self) {
        if let Kind::Terminal(view) = self.0 {
            let last = view.close();
            drop(Lines::stderr().show(&last.render()));
        }
    }
}

/// Fits a record while it grows, and shows it on a screen.
pub struct ScreenArtist {
    screen: Screen,
    page: Option<String>,
    /// Of which recording the coefficients are.
    recording: usize,
    noise: Noises,
}

impl ScreenArtist {
    /// Lines.
    pub fn lines() -> Box<Self> {
        Self::on(Screen::lines(), None)
    }

    /// Shows what comes on `screen`, and where its `page` is.
    pub fn on(screen: Screen, page: Option<String>) -> Box<Self> {
        Box::new(Self {
            screen,
            page,
            recording: 0,
            noise: Noises::default(),
        })
    }
}

impl Artist for ScreenArtist {
    fn period(&self) -> Duration {
        self.screen.period()
    }

    fn draw(&mut self, scene: Scene) {
        let mut snapshot = scene.snapshot;
        snapshot.page.clone_from(&self.page);
        if self.recording != scene.recording {
            (self.recording, self.noise) = (scene.recording, Noises::default());
        }
        if let Some(record) = &scene.record {
            self.noise.keep_up(&scene.signal, record, scene.last);
            snapshot.table = table(&scene.signal, record);
            snapshot.noise.clone_from(&self.noise.rows);
        }
        self.screen.show(snapshot);
    }

    fn close(self: Box<Self>) {
        self.screen.close();
    }
}
