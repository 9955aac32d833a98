//! Who may ask: those that know the token, under a name of this machine, from no other site's page.
//!
//! The port is this user's no more than any other's on the machine, and any page that the browser shows can send requests to it.
//! The token keeps both out. The host keeps out pages whose name was led to this machine (DNS rebinding); through a tunnel the port
//! is another one, so any is taken.

use super::http::Head;
use std::fmt::Write;
use thiserror::Error;

/// The names under which this machine asks itself.
const HOSTS: [&str; 2] = ["127.0.0.1", "localhost"];

/// Why a request is refused.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Refusal {
    #[error("the server answers requests to 127.0.0.1 and localhost only")]
    Host,
    #[error("the server answers its own page only, not that of another site")]
    Origin,
    #[error("the address has not the token that the server printed at its start")]
    Token,
}

/// Refuses what does not come from the user.
pub struct Guard {
    token: String,
}

impl Guard {
    /// A guard with a new random token of 128 bits.
    ///
    /// # Errors
    /// Where the operating system has no random numbers.
    pub fn new() -> Result<Self, getrandom::Error> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)?;
        let token = bytes.iter().fold(String::new(), |mut token, byte| {
            let _ = write!(token, "{byte:02x}");
            token
        });
        Ok(Self { token })
    }

    /// The token, which all addresses begin with.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// What is behind the token in the address of a request.
    ///
    /// # Errors
    /// Where the request is not the user's.
    pub fn admit<'a>(&self, head: &'a Head) -> Result<&'a str, Refusal> {
        let host = head.host.as_deref().filter(|host| is_here(host)).ok_or(Refusal::Host)?;
        // Programs that are no browsers name no origin; browsers do so with each POST.
        if let Some(origin) = &head.origin
            && !origin.strip_prefix("http://").is_some_and(|origin| origin.eq_ignore_ascii_case(host))
        {
            return Err(Refusal::Origin);
        }
        let (token, rest) = head.path.strip_prefix('/').and_then(|path| path.split_once('/')).ok_or(Refusal::Token)?;
        if self.is_token(token) { Ok(rest) } else { Err(Refusal::Token) }
    }

    /// Whether a text is the token; how long it takes does not depend on where it differs.
    fn is_token(&self, text: &str) -> bool {
        let pairs = self.token.bytes().zip(text.bytes());
        text.len() == self.token.len() && pairs.fold(0, |sum, (a, b)| sum | (a ^ b)) == 0
    }
}

/// Whether a host is this machine, on any port.
fn is_here(host: &str) -> bool {
    let name = match host.split_once(':') {
        Some((name, port)) if port.parse::<u16>().is_ok() => name,
        Some(_) => return false,
        None => host,
    };
    HOSTS.iter().any(|here| name.eq_ignore_ascii_case(here))
}

#[cfg(test)]
mod tests {
    use super::super::http::read_head;
    use super::*;

    #[test]
    fn only_the_token_the_machine_and_the_page_are_let_in() {
        let guard = Guard::new().unwrap_or_else(|error| panic!("{error}"));
        let admitted = |token: &str, host: &str, origin: &str| {
            let origin = if origin.is_empty() { String::new() } else { format!("Origin: {origin}\r\n") };
            let text = format!("POST /{token}/run HTTP/1.1\r\nHost: {host}\r\n{origin}\r\n");
            let (head, _) = read_head(&mut text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
            guard.admit(&head).map(str::to_owned)
        };
        let token = guard.token();
        let let_in = Ok("run".to_owned());
        for (host, origin) in [
            ("127.0.0.1:4000", ""),
            ("localhost", ""),
            ("LOCALHOST:1", "http://localhost:1"),
            ("127.0.0.1:9", "http://127.0.0.1:9"),
        ] {
            assert_eq!(admitted(token, host, origin), let_in, "{host} {origin}");
        }
        for host in [
            "evil.example",
            "127.0.0.1.evil.example:4000",
            "localhost:",
            "localhost:1:2",
            "127.0.0.2",
            "evil@localhost",
        ] {
            assert_eq!(admitted(token, host, ""), Err(Refusal::Host), "{host}");
        }
        for origin in ["http://evil.example", "null", "http://localhost:2", "https://localhost:1", "http://127.0.0.1:1"]
        {
            assert_eq!(admitted(token, "localhost:1", origin), Err(Refusal::Origin), "{origin}");
        }
        let changed = format!("{}{}", &token[1..], if token.ends_with('0') { '1' } else { '0' });
        for wrong in ["", &token[1..], &format!("{token}0"), &changed, "."] {
            assert_eq!(admitted(wrong, "localhost", ""), Err(Refusal::Token), "{wrong}");
        }
        assert_ne!(token, Guard::new().unwrap_or_else(|error| panic!("{error}")).token());
    }
}
