//! Who may ask for what. Any page that a browser shows can reach a port of this machine, so a request
//! counts only with the token of the printed address, by a name of this server, and from its own page.

use std::fmt::{self, Write};
use std::net::SocketAddr;

/// Bytes of a token: as many as nobody guesses in the life of a recording, or of the universe.
const TOKEN_BYTES: usize = 16;

/// The secret in the address of the page.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

impl Token {
    /// A new one, of the system's randomness.
    ///
    /// # Errors
    /// If the system has none.
    pub fn random() -> Result<Self, getrandom::Error> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes)?;
        let mut text = String::new();
        for byte in bytes {
            // Writing to a string cannot fail.
            let _ = write!(text, "{byte:02x}");
        }
        Ok(Self(text))
    }

    /// Whether `text` is the token, in a time that does not tell how much of it is.
    fn is(&self, text: &str) -> bool {
        let differ = self
            .0
            .bytes()
            .zip(text.bytes())
            .fold(0, |all, (a, b)| all | (a ^ b));
        self.0.len() == text.len() && differ == 0
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// What a request says of where it comes from.
#[derive(Debug, Clone, Copy, Default)]
pub struct Asked<'a> {
    /// Path, as it was sent.
    pub path: &'a str,
    /// Header `Host`.
    pub host: Option<&'a str>,
    /// Header `Origin`.
    pub origin: Option<&'a str>,
    /// Header `Sec-Fetch-Site`, which browsers set and pages cannot.
    pub site: Option<&'a str>,
}

/// Why a request is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// It names another server: a name that was made to lead here.
    #[error("this server has another name: use the address that inm printed")]
    Host,
    /// Another page asks.
    #[error("asked by a page from elsewhere")]
    Origin,
    /// It does not know the token.
    #[error("the token is not that of this recording: use the address that inm printed")]
    Token,
}

/// What is asked of everyone.
pub struct Guard {
    token: Token,
    /// Names that the server goes by, with their port.
    names: Vec<String>,
}

impl Guard {
    /// For a server at `address`.
    pub fn new(token: Token, address: SocketAddr) -> Self {
        let mut names = vec![address.to_string()];
        if address.ip().is_loopback() {
            names.push(format!("localhost:{}", address.port()));
        }
        Self { token, names }
    }

    /// What is asked for, behind the token, with a slash ahead.
    ///
    /// # Errors
    /// [`Refused`].
    pub fn admit<'a>(&self, asked: &Asked<'a>) -> Result<&'a str, Refused> {
        let host = asked
            .host
            .filter(|host| self.is_ours(host))
            .ok_or(Refused::Host)?;
        let own = |origin: &str| origin.strip_prefix("http://") == Some(host);
        if !asked.origin.is_none_or(own) {
            return Err(Refused::Origin);
        }
        // `none` is a person who typed the address.
        if !asked
            .site
            .is_none_or(|site| matches!(site, "same-origin" | "none"))
        {
            return Err(Refused::Origin);
        }
        let path = asked.path.strip_prefix('/').ok_or(Refused::Token)?;
        let end = path.find('/').ok_or(Refused::Token)?;
        let (token, rest) = path.split_at(end);
        if self.token.is(token) {
            Ok(rest)
        } else {
            Err(Refused::Token)
        }
    }

    fn is_ours(&self, host: &str) -> bool {
        self.names
            .iter()
            .any(|name| name.eq_ignore_ascii_case(host))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOST: &str = "127.0.0.1:4000";

    fn guard() -> Guard {
        Guard::new(Token("0123abcd".into()), HOST.parse().expect("an address"))
    }

    fn asked(path: &str) -> Asked<'_> {
        Asked {
            path,
            host: Some(HOST),
            ..Asked::default()
        }
    }

    #[test]
    fn who_knows_the_token_is_admitted() {
        let guard = guard();
        assert_eq!(guard.admit(&asked("/0123abcd/events")), Ok("/events"));
        let by_name = Asked {
            host: Some("LocalHost:4000"),
            origin: Some("http://LocalHost:4000"),
            site: Some("same-origin"),
            ..asked("/0123abcd/")
        };
        assert_eq!(guard.admit(&by_name), Ok("/"));
    }

    #[test]
    fn another_token_is_refused() {
        for path in [
            "/",
            "",
            "0123abcd/",
            "/0123abcd",
            "/0123abce/",
            "/0123abc/",
            "/0123abcd0/",
            "//0123abcd/",
            "/../0123abcd/",
            "/0123ABCD/",
            "/%30123abcd/",
        ] {
            assert_eq!(guard().admit(&asked(path)), Err(Refused::Token), "{path}");
        }
    }

    #[test]
    fn another_name_is_refused() {
        let names = [
            "evil.example:4000",
            "127.0.0.1",
            "127.0.0.1:4001",
            "localhost",
            "[::1]:4000",
            "",
        ];
        for host in names.into_iter().map(Some).chain([None]) {
            let asked = Asked {
                host,
                ..asked("/0123abcd/")
            };
            assert_eq!(guard().admit(&asked), Err(Refused::Host), "{host:?}");
        }
    }

    #[test]
    fn another_page_is_refused() {
        let from = |origin, site| Asked {
            origin,
            site,
            ..asked("/0123abcd/stop")
        };
        for asked in [
            from(Some("http://evil.example"), None),
            from(Some("null"), None),
            from(Some("https://127.0.0.1:4000"), None),
            from(Some("http://localhost:4000"), None),
            from(None, Some("cross-site")),
            from(None, Some("same-site")),
        ] {
            assert_eq!(guard().admit(&asked), Err(Refused::Origin), "{asked:?}");
        }
    }

    #[test]
    fn tokens_differ_and_are_long() {
        let [one, other] = [(); 2].map(|()| Token::random().expect("randomness"));
        assert!(one != other);
        assert_eq!(one.to_string().len(), 2 * TOKEN_BYTES);
    }
}
