//! The files of the page, which are in the program: nothing is read from a disk.

use axum::http::StatusCode;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS,
};
use axum::response::{IntoResponse, Response};

use crate::report::page::STYLE;

/// What the page may load: what is its own, and nothing from elsewhere.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
                      img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

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

/// The answer to who asks for the file at `path`.
pub fn answer(path: &str) -> Response {
    let Some((kind, text)) = find(path) else {
        return StatusCode::NOT_FOUND.into_response();
    };
    let headers = [
        (CONTENT_TYPE, kind),
        (CONTENT_SECURITY_POLICY, POLICY),
        (CACHE_CONTROL, "no-store"),
        (REFERRER_POLICY, "no-referrer"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    (headers, text).into_response()
}

#[cfg(test)]
mod tests {
    use inm_protocol::Rate;

    use super::*;

    #[test]
    fn a_browser_is_told_to_load_nothing_from_elsewhere_and_to_keep_nothing() {
        for path in ["/", "/live.js", "/live.css", "/page.css"] {
            let answer = answer(path);
            let header = |name| answer.headers().get(name).map(|value| value.as_bytes());
            assert_eq!(header(CONTENT_SECURITY_POLICY), Some(POLICY.as_bytes()));
            assert_eq!(header(CACHE_CONTROL), Some(&b"no-store"[..]));
            assert_eq!(header(REFERRER_POLICY), Some(&b"no-referrer"[..]));
            assert_eq!(header(X_CONTENT_TYPE_OPTIONS), Some(&b"nosniff"[..]));
        }
        assert!(POLICY.starts_with("default-src 'none';"));
        assert!(!POLICY.contains("unsafe") && !POLICY.contains('*') && !POLICY.contains("http"));
    }

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
