//! The page in a browser, where one is installed.

mod driver;
mod gauge;
mod pictures;
mod study;

use serde_json::{Value, json};

pub use driver::Browser;

use crate::served::{Served, source};

/// Whether there is a curve, and coefficients that are found.
const CURVE: &str = "!!document.querySelector('#allan2 svg') \
                     && !!document.querySelector('#coefficients td.well')";

/// The longest averaging time that the picture of the first axis reaches, as its common logarithm.
const REACHES: &str = "Number(document.querySelector('#allan0 figure').dataset.x.split(' ')[2])";

const MARKED: &str = "document.getElementById('events').innerText.includes(': door')";

fn doing(words: &str) -> String {
    format!("document.getElementById('doing').innerText.startsWith('{words}')")
}

#[test]
fn a_browser_shows_marks_and_stops_a_recording_and_costs_no_sample() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let capture = folder.path().join("run.inmcap");
    // The rate whose analyses take least, and so come soonest.
    let board = ["virtual", "--speed", "10", "--rate", "250"];
    let mut served = Served::on(&board, &capture, 3600);
    let tab = browser.open(&served.url());
    browser.wait_for(&tab, CURVE);
    let reached = browser.value(&tab, REACHES);

    browser.value(&tab, "document.getElementById('note').value = 'door'");
    browser.click(&tab, "#mark button", false);
    browser.wait_for(&tab, MARKED);
    // Opened anew it has all of it.
    let other = browser.open(&served.url());
    browser.wait_for(&other, CURVE);
    browser.wait_for(&other, MARKED);
    // The curves grow with the record.
    browser.wait_for(&tab, &format!("{REACHES} > {reached}"));

    browser.click(&tab, "#stop", true);
    for tab in [&tab, &other] {
        browser.wait_for(tab, &doing("Stopped"));
        let test = "document.getElementById('selftest-start').ariaDisabled";
        browser.wait_for(tab, &format!("{test} === 'false'"));
    }
    // The connections of the tabs are cut at the end, which their consoles may call an error.
    assert_eq!(browser.errors, [Value::Null; 0]);
    browser.click(&tab, "#end", true);
    browser.wait_for(&tab, "document.getElementById('end').disabled");
    served.end();
    let source = source(&capture);
    assert_eq!(source["gaps"], json!([]));
    assert!(source["news"].to_string().contains(": door"), "{source}");
}

#[test]
fn a_browser_lets_no_other_page_and_no_other_token_do_anything() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let served = Served::start(&folder.path().join("run.inmcap"), 3600);
    let tab = browser.open(&served.url());
    browser.wait_for(&tab, &doing("Recording"));
    // A page from elsewhere, even one that knows the token.
    let evil = browser.open("data:text/html,<p>elsewhere</p>");
    for what in ["stop", "end", "record", "mark"] {
        let url = format!("{}{what}", served.url());
        // Whether the browser itself lets it go out is the browser's affair.
        let post = format!(
            "fetch('{url}', {{method: 'POST', mode: 'no-cors', body: 'door'}})\
             .then(() => true, () => true)"
        );
        assert_eq!(browser.value(&evil, &post), true, "{what}");
    }
    let wrong = browser.open(&format!("http://{}/0123456789abcdef/", served.host));
    let refused = "document.body?.innerText.includes('the token is not')";
    browser.wait_for(&wrong, refused);
    // A mark of ours comes behind whatever the other page has reached: nothing.
    browser.click(&tab, "#mark button", false);
    let events = "document.getElementById('events').innerText";
    browser.wait_for(&tab, &format!("{events}.includes('mark ahead')"));
    let told = browser.value(&tab, events);
    assert!(!told.to_string().contains("door"), "{told}");
    browser.wait_for(&tab, &doing("Recording"));
    served.stop();
}
