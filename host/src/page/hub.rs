//! The newest state of the page, part by part, for as many tabs as look. Nobody is waited for: who is
//! slow finds the newest when it comes to ask, and what was between is skipped.

use std::sync::Arc;

use tokio::sync::watch;

/// A part of the page: an element, and what is in it.
#[derive(Debug, Clone)]
pub struct Part {
    /// Identifier of the element.
    pub id: Arc<str>,
    /// What is in it, as HTML.
    pub html: Arc<str>,
    /// Counts its changes.
    version: u64,
}

/// The page as it is now.
#[derive(Debug, Clone, Default)]
pub struct Shown {
    /// Its parts.
    pub parts: Vec<Part>,
    /// Nothing more will come.
    pub ended: bool,
    version: u64,
}

/// Where the page is put together.
#[derive(Default)]
pub struct Hub(watch::Sender<Shown>);

impl Hub {
    /// Puts `parts` on the page; what is as it was is not sent again.
    pub fn put(&self, parts: impl IntoIterator<Item = (String, String)>) {
        self.0.send_if_modified(|shown| {
            let before = shown.version;
            for (id, html) in parts {
                shown.put(id, html);
            }
            shown.version != before
        });
    }

    /// Nothing more will come.
    pub fn end(&self) {
        self.0.send_modify(|shown| shown.ended = true);
    }

    /// What a tab follows.
    pub fn follow(&self) -> watch::Receiver<Shown> {
        self.0.subscribe()
    }

    /// Tabs that look at the moment.
    pub fn tabs(&self) -> usize {
        self.0.receiver_count()
    }
}

impl Shown {
    fn put(&mut self, id: String, html: String) {
        let version = self.version + 1;
        match self.parts.iter_mut().find(|part| *part.id == *id) {
            Some(part) if *part.html == *html => return,
            Some(part) => (part.html, part.version) = (html.into(), version),
            None => self.parts.push(Part {
                id: id.into(),
                html: html.into(),
                version,
            }),
        }
        self.version = version;
    }

    /// What has changed since the version `seen`, which becomes this one.
    pub fn since(&self, seen: &mut u64) -> Vec<&Part> {
        let new = self.parts.iter().filter(|part| part.version > *seen);
        let new = new.collect();
        *seen = self.version;
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(shown: &Shown, seen: &mut u64) -> Vec<String> {
        let new = shown.since(seen);
        new.iter().map(|part| part.id.to_string()).collect()
    }

    fn put(hub: &Hub, parts: &[(&str, &str)]) {
        hub.put(
            parts
                .iter()
                .map(|&(id, html)| (id.to_owned(), html.to_owned())),
        );
    }

    #[test]
    fn a_tab_gets_what_has_changed_and_skips_what_was_between() {
        let hub = Hub::default();
        let tab = hub.follow();
        let mut seen = 0;
        put(&hub, &[("allan", "1"), ("link", "1")]);
        assert_eq!(ids(&tab.borrow(), &mut seen), ["allan", "link"]);
        for count in 2..100 {
            put(&hub, &[("allan", &count.to_string()), ("link", "1")]);
        }
        assert_eq!(ids(&tab.borrow(), &mut seen), ["allan"]);
        assert_eq!(ids(&tab.borrow(), &mut seen), [""; 0]);
        assert_eq!(&*tab.borrow().parts[0].html, "99");
        // A tab that is opened now gets all of it.
        assert_eq!(ids(&hub.follow().borrow(), &mut 0), ["allan", "link"]);
    }

    #[test]
    fn tabs_that_are_closed_are_not_counted() {
        let hub = Hub::default();
        let tab = hub.follow();
        assert_eq!(hub.tabs(), 1);
        drop(tab);
        assert_eq!(hub.tabs(), 0);
    }
}
