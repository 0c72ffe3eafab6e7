//! The files of the page, which are in the program: nothing is read from a disk.

use crate::report::page::STYLE;

/// What is at `path`, and of which kind it is.
pub fn find(path: &str) -> Option<(&'static str, &'static str)> {
    match path {
        "/" => Some(("text/html; charset=utf-8", include_str!("page.html"))),
        "/live.js" => Some(("text/javascript; charset=utf-8", include_str!("live.js"))),
        "/live.css" => Some(("text/css; charset=utf-8", include_str!("live.css"))),
        // The colours and tables of the reports.
        "/page.css" => Some(("text/css; charset=utf-8", STYLE)),
        _ => None,
    }
}
