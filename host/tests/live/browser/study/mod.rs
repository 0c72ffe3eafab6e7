//! Three tabs through ten minutes of a board, for `cargo xtask study live`: no test, so only run when asked for.
//!
//! One tab is left alone, one is slow, one is closed for a while. The board is behind a serial port, where a
//! program that does not read in time loses samples.

mod course;
mod truth;

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use inm_host::internals::virtual_board::{VirtualConnect, Witness};

use self::course::Course;
use super::driver::{Browser, Tab};
use crate::pty::PtyBoard;
use crate::served::Served;

/// Minutes of the board, where others than ten are asked for.
const MINUTES: &str = "INM_STUDY_MINUTES";

/// Seconds of the board in a second.
const SPEED: f64 = 10.0;

/// Of the board's noise.
const SEED: u64 = 1;

/// Bytes that the driver of the port holds, as Linux's do (`TTYB_DEFAULT_MEM_LIMIT`).
const ROOM: usize = 640 * 1024;

/// What reaches the slow tab, bytes a second: a seventh of what the page sends to one that keeps up.
const SLOW_BYTES_PER_S: f64 = 20_000.0;

/// How many times slower its processor is.
const SLOWER: f64 = 4.0;

/// Looks at what is held, evenly through the time; the last would be at the end.
const LOOKS: u32 = 24;

/// Looks with which the third tab is closed, and opened again.
const CLOSED: u32 = 8;
const OPENED: u32 = 12;

/// Counts the states that a tab shows: each tells another time.
const COUNT: &str = "window.states = 0; new MutationObserver(() => states++)\
                     .observe(document.getElementById('progress'), { childList: true }); true";

/// Where the tab has come to in the recording.
const TIME: &str = "document.getElementById('progress').innerText.split(' ')[0]";

/// A tab, and what became of it.
struct Watched {
    name: &'static str,
    tab: Tab,
    /// It has been counted since the page came.
    is_counted: bool,
    course: Course,
}

impl Watched {
    fn open(browser: &mut Browser, served: &Served, name: &'static str) -> Self {
        let tab = browser.blank();
        if name == "slow" {
            // What is asked for from then on is slow; a connection that is there stays as fast as it was.
            browser.slow_down(&tab, SLOW_BYTES_PER_S, SLOWER);
        }
        browser.go(&tab, &served.url());
        Self {
            name,
            tab,
            is_counted: false,
            course: Course::default(),
        }
    }

    /// Looks at what it holds, and prints it; a page that has not come whole is let be.
    fn look(&mut self, browser: &mut Browser) {
        let has_come = "!!document.querySelector('#coefficients td') \
                        && !!document.querySelector('#spectrum2 svg')";
        if !self.is_counted {
            self.is_counted = browser.value(&self.tab, has_come) == true;
            if self.is_counted {
                browser.value(&self.tab, COUNT);
            }
        }
        if !self.is_counted {
            print!(" | {} waits", self.name);
            return;
        }
        let held = browser.held(&self.tab);
        let states = browser
            .value(&self.tab, "states")
            .as_f64()
            .expect("a count");
        let time = browser.value(&self.tab, TIME);
        let time = time.as_str().expect("a text");
        print!(
            " | {} {:.0} kB, {} nodes, {} listeners, {states} states, at {time}",
            self.name, held.heap_kb, held.nodes, held.listeners
        );
        self.course.push(states, held);
    }
}

#[test]
#[ignore = "a study: `cargo xtask study live`"]
fn tabs_cost_no_sample_and_hold_no_more_with_time() {
    let minutes: u32 = std::env::var(MINUTES).map_or(10, |text| text.parse().expect(MINUTES));
    let mut browser = Browser::start().expect("a browser");
    let witness = Witness::default();
    let connect = VirtualConnect {
        witness: Some(Arc::clone(&witness)),
        ..VirtualConnect::published(SEED, SPEED)
    };
    let board = PtyBoard::with_room(connect, ROOM);
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    let mut served = Served::on(&[&board.port], &capture, 60 * minutes);
    let begun = Instant::now();
    let courses = watch(&mut browser, &served, 60.0 * f64::from(minutes) / SPEED);
    let said = served.end();
    println!("{said}ended after {:.1} s", begun.elapsed().as_secs_f64());
    let most_waiting = board.most_waiting.load(Ordering::Relaxed);
    println!("waiting in the driver at most: {most_waiting} bytes of {ROOM}");
    drop(board);
    truth::compare(&capture, &witness.lock().expect("no panic"));
    for (name, course) in courses {
        course.tell(name);
    }
}

/// Opens the tabs, closes one and opens it again, and looks at all of them while the recording lasts
/// `lasts_s`.
fn watch(browser: &mut Browser, served: &Served, lasts_s: f64) -> Vec<(&'static str, Course)> {
    let begun = Instant::now();
    let mut tabs: Vec<Watched> = ["alone", "slow", "closed"]
        .map(|name| Watched::open(browser, served, name))
        .into();
    browser.wait_for(&tabs[0].tab, "!!document.getElementById('allan0')");
    let mut courses = Vec::new();
    for look in 1..LOOKS {
        let due = Duration::from_secs_f64(lasts_s * f64::from(look) / f64::from(LOOKS));
        thread::sleep(due.saturating_sub(begun.elapsed()));
        if look == CLOSED {
            let closed = tabs.pop().expect("it is open");
            browser.close(&closed.tab);
            courses.push((closed.name, closed.course));
        }
        if look == OPENED {
            tabs.push(Watched::open(browser, served, "again"));
        }
        let resident_mb = served.resident_mb().unwrap_or(f64::NAN);
        print!(
            "{:5.1} s, inm {resident_mb:.1} MB",
            begun.elapsed().as_secs_f64()
        );
        tabs.iter_mut().for_each(|tab| tab.look(browser));
        println!();
    }
    courses.extend(tabs.into_iter().map(|tab| (tab.name, tab.course)));
    courses
}
