//! Those who show the recordings of a bench, one after the other, and what the bench does between them.

use std::sync::Arc;

use super::view::View;
use super::{Artist, Phase, Scene, give_terminal_back};
use crate::inspect::self_test::SelfTest;

/// See above.
pub struct Stage {
    views: Vec<View>,
    /// What was to be seen last.
    last: Option<Scene>,
    /// Recordings that have begun.
    recordings: usize,
    /// The last self-test.
    tested: Option<Arc<SelfTest>>,
}

impl Stage {
    /// Has each of `artists` show, on a thread of its own.
    pub fn new(artists: Vec<Box<dyn Artist>>) -> Self {
        Self {
            views: artists.into_iter().map(View::new).collect(),
            last: None,
            recordings: 0,
            tested: None,
        }
    }

    /// Another recording begins.
    pub(super) fn begin(&mut self) {
        self.recordings += 1;
    }

    /// Shows a scene of the recording to those for whom it is time.
    pub(super) fn show(&mut self, scene: impl FnOnce() -> Scene) {
        if self.views.iter().any(View::is_due) {
            let scene = self.entered(scene());
            for view in self.views.iter_mut().filter(|view| view.is_due()) {
                view.show(scene.clone());
            }
        }
    }

    /// Shows the end of the recording.
    pub(super) fn end(&mut self, scene: Scene) {
        let scene = self.entered(scene);
        self.show_all(&scene);
        self.last = Some(scene);
    }

    /// Shows what the bench does between two recordings, and what there is to say of it.
    pub fn idle(&mut self, phase: Phase, said: &str) {
        let Some(mut last) = self.last.take() else {
            return;
        };
        let news = last.snapshot.phase != phase || last.said != said;
        last.snapshot.phase = phase;
        if news {
            said.clone_into(&mut last.said);
            self.show_all(&last);
        } else {
            let due = self.views.iter_mut().filter(|view| view.is_due());
            due.for_each(|view| view.show(last.clone()));
        }
        self.last = Some(last);
    }

    /// Shows the outcome of a self-test from now on.
    pub fn tested(&mut self, tested: SelfTest) {
        self.tested = Some(Arc::new(tested));
        if let Some(last) = &mut self.last {
            last.tested.clone_from(&self.tested);
        }
    }

    /// Waits until the last scene is drawn, but not for ever. What is printed from then on stands where the
    /// terminal was before.
    pub fn close(self) {
        self.views.into_iter().for_each(View::close);
        give_terminal_back();
    }

    fn show_all(&mut self, scene: &Scene) {
        for view in &mut self.views {
            view.show(scene.clone());
        }
    }

    /// The scene with what the stage itself knows.
    fn entered(&self, scene: Scene) -> Scene {
        Scene {
            recording: self.recordings,
            tested: self.tested.clone(),
            ..scene
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{self, Sender};
    use std::time::Duration;

    use super::*;
    use crate::live::{Snapshot, Strip};
    use crate::signal::Signal;

    /// Notes down what it is shown: recording, what the bench does, whether it has ended, what is said.
    struct Witness(Sender<(usize, Phase, bool, String)>);

    impl Artist for Witness {
        fn period(&self) -> Duration {
            Duration::from_secs(3600)
        }

        fn draw(&mut self, scene: Scene) {
            let seen = (
                scene.recording,
                scene.snapshot.phase,
                scene.last,
                scene.said,
            );
            self.0.send(seen).expect("the test listens");
        }
    }

    fn scene(last: bool) -> Scene {
        Scene {
            recording: 0,
            signal: Signal {
                name: "test".into(),
                rate_hz: 2000.0,
                axes: Vec::new(),
                start: None,
            },
            snapshot: Snapshot::default(),
            record: None,
            strip: Strip::default(),
            last,
            said: String::new(),
            tested: None,
        }
    }

    #[test]
    fn the_end_of_a_recording_and_what_follows_are_shown_before_it_is_time() {
        let (tell, told) = mpsc::channel();
        let mut stage = Stage::new(vec![Box::new(Witness(tell))]);
        stage.begin();
        stage.show(|| scene(false));
        stage.show(|| panic!("it is not time for another"));
        stage.end(scene(true));
        stage.idle(Phase::Resting, "");
        stage.idle(Phase::Resting, "");
        stage.idle(Phase::Resting, "not started");
        stage.begin();
        stage.end(scene(true));
        stage.close();
        let seen = [
            (1, Phase::Recording, false, ""),
            (1, Phase::Recording, true, ""),
            (1, Phase::Resting, true, ""),
            (1, Phase::Resting, true, "not started"),
            (2, Phase::Recording, true, ""),
        ];
        let seen = seen.map(|(number, phase, last, said)| (number, phase, last, said.to_owned()));
        assert_eq!(told.iter().collect::<Vec<_>>(), seen);
    }
}
