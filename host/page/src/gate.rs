//! Gate: who may come in.
//!
//! A server on this computer's own address is reached by every program on it, and by every page that a browser on it
//! shows: a page of somebody else may open a WebSocket to 127.0.0.1, or have its own name lead there. So a browser's
//! `Origin` must be the server's own, and the `Host` that it asks for a name of this computer. Where others are let in,
//! they need the token, which no page of somebody else knows.

use std::net::SocketAddr;

/// Who may come in.
#[derive(Clone, Debug)]
pub struct Gate {
    /// Where the server listens.
    pub listen: SocketAddr,
    /// What whoever comes must bring along; none: nothing.
    pub token: Option<String>,
    /// Pages of others that may come in, as a browser names them: `https://app.foxglove.dev`.
    pub origins: Vec<String>,
}

/// What a client says of itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Visitor {
    /// The name that it has asked for.
    pub host: Option<String>,
    /// The page that asks, of a browser.
    pub origin: Option<String>,
    /// The token in its address.
    pub token: Option<String>,
}

/// Why somebody does not come in.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// Asked for by another name.
    #[error(
        "this server is asked for as {0:?}, which is no name of it; use the address that was printed at the start"
    )]
    Host(String),
    /// A page of somebody else.
    #[error("the page {0:?} may not look on; allow it with `--allow-origin`")]
    Origin(String),
    /// Without the token, or with another.
    #[error("the token is missing or wrong; use the address that was printed at the start")]
    Token,
}

impl Gate {
    /// Whether a visitor comes in.
    pub fn check(&self, visitor: &Visitor) -> Result<(), Refused> {
        let host = visitor.host.as_deref().unwrap_or_default();
        if let Some(token) = &self.token {
            if !is_equal(visitor.token.as_deref().unwrap_or_default(), token) {
                return Err(Refused::Token);
            }
        } else if !self.is_own_name(host) {
            return Err(Refused::Host(host.to_owned()));
        }
        match &visitor.origin {
            Some(origin) if *origin != format!("http://{host}") && !self.origins.contains(origin) => {
                Err(Refused::Origin(origin.clone()))
            }
            _ => Ok(()),
        }
    }

    fn is_own_name(&self, host: &str) -> bool {
        let port = format!(":{}", self.listen.port());
        let name = host.strip_suffix(&port).unwrap_or(host);
        let own = self.listen.ip().to_string();
        ["127.0.0.1", "localhost", "[::1]"].contains(&name) || name == own || name == format!("[{own}]")
    }
}

/// A text that nobody guesses: a token, or a session's name. None where the system has no randomness.
#[must_use]
pub fn random_text() -> Option<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).ok()?;
    Some(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Compares in a time that does not tell how much is equal.
fn is_equal(a: &str, b: &str) -> bool {
    let differ = a.bytes().zip(b.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b));
    differ == 0 && a.len() == b.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn visitor(host: &str, origin: Option<&str>, token: Option<&str>) -> Visitor {
        let own = |text: &str| text.to_owned();
        Visitor { host: Some(own(host)), origin: origin.map(own), token: token.map(own) }
    }

    #[test]
    fn on_this_computer_our_page_and_programs_come_in_and_pages_of_others_do_not() {
        let gate = Gate {
            listen: "127.0.0.1:8765".parse().unwrap(),
            token: None,
            origins: vec!["https://app.foxglove.dev".to_owned()],
        };
        for (host, origin) in [
            ("127.0.0.1:8765", None),
            ("127.0.0.1:8765", Some("http://127.0.0.1:8765")),
            ("localhost:8765", Some("http://localhost:8765")),
            ("127.0.0.1:8765", Some("https://app.foxglove.dev")),
        ] {
            assert_eq!(gate.check(&visitor(host, origin, None)), Ok(()), "{host} {origin:?}");
        }
        let evil = "http://evil.example";
        let refused = gate.check(&visitor("127.0.0.1:8765", Some(evil), None));
        assert_eq!(refused, Err(Refused::Origin(evil.to_owned())));
        let refused = gate.check(&visitor("evil.example:8765", Some("http://evil.example:8765"), None));
        assert_eq!(refused, Err(Refused::Host("evil.example:8765".to_owned())), "a name that leads here");
        let other_port = gate.check(&visitor("127.0.0.1:8765", Some("http://127.0.0.1:9000"), None));
        assert!(matches!(other_port, Err(Refused::Origin(_))), "a page of another program");
    }

    #[test]
    fn where_others_are_let_in_they_need_the_token() {
        let token = Some("secret".to_owned());
        let gate = Gate { listen: "0.0.0.0:8765".parse().unwrap(), token, origins: Vec::new() };
        let host = "robot.local:8765";
        let own = Some("http://robot.local:8765");
        assert_eq!(gate.check(&visitor(host, own, Some("secret"))), Ok(()));
        for token in [None, Some(""), Some("secre"), Some("secrets"), Some("Secret")] {
            assert_eq!(gate.check(&visitor(host, own, token)), Err(Refused::Token), "{token:?}");
        }
        let other = gate.check(&visitor(host, Some("http://evil.example"), Some("secret")));
        assert!(matches!(other, Err(Refused::Origin(_))));
    }
}
