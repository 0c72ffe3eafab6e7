//! The pictures of the documentation, for `cargo xtask pictures`: no test, so only run when asked for.

use super::{Browser, CURVE};
use crate::pictures::folder;
use crate::served::Served;

/// Name, colours, and size of the screen in pixels.
const PAGES: [(&str, &str, [u32; 2]); 3] = [
    ("live-light", "light", [1520, 1450]),
    ("live-dark", "dark", [1520, 1450]),
    ("live-phone", "light", [390, 1250]),
];

/// Seconds of the board that are to be seen: until the coefficients of the published noise are found.
const RECORDED_S: u32 = 900;

#[test]
#[ignore = "writes pictures: `cargo xtask pictures`"]
fn the_page_as_the_documentation_shows_it() {
    let mut browser = Browser::start().expect("a browser");
    let place = tempfile::tempdir().expect("a folder");
    let served = Served::start(&place.path().join("run1.inmcap"), 5400);
    let tab = browser.open(&served.url());
    browser.wait_for(&tab, CURVE);
    let seconds = "document.getElementById('progress').innerText.split(' ')[0].split(':')\
                   .reduce((sum, part) => 60 * sum + Number(part), 0)";
    browser.wait_for(&tab, &format!("{seconds} >= {RECORDED_S}"));
    for (name, scheme, size) in PAGES {
        browser.look(&tab, scheme, size);
        // The size is the browser's own affair, and takes it a moment.
        browser.wait_for(&tab, &format!("innerWidth === {}", size[0]));
        let file = folder().join(format!("{name}.png"));
        std::fs::write(file, browser.picture(&tab)).expect("written");
    }
    served.stop();
}
