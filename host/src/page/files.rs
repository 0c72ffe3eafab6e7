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

#[cfg(test)]
mod tests {
    use inm_protocol::Rate;

    use super::*;

    #[test]
    fn the_form_has_every_data_rate_of_the_board_and_no_other() {
        let (_, page) = find("/").expect("the page");
        let (_, form) = page.split_once("id=\"rate\"").expect("a choice");
        let (form, _) = form.split_once("</select>").expect("its end");
        let values = form.split("value=\"").skip(1);
        let values = values.map(|value| value.split('"').next().unwrap_or_default());
        let rates = Rate::ALL.map(|rate| rate.hz().to_string());
        assert_eq!(values.collect::<Vec<_>>(), rates);
    }
}
