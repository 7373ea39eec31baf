//! Who may come in: the token, and the names by which this server may be called.
//!
//! A page of another site can make the browser send requests here, and, by a name of its own that it points at this
//! address (DNS rebinding), even read the answers. So a request must name this server as the one it is: by an address in
//! digits, by `localhost`, or by the name that `--host` gave; a WebSocket must come from a page of that same server; and
//! what shows or changes the scene needs the token, which nobody can guess.

use std::net::IpAddr;

/// Random bytes of a token.
const TOKEN_BYTES: usize = 16;

/// What a request must show.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    /// The token, in hexadecimal digits.
    pub(super) token: String,
    /// The name that the server was told to listen on.
    name: String,
    port: u16,
}

/// Why a request is refused, and the status that says so.
pub(super) type Refused = (u16, &'static str);

impl Guard {
    /// A guard with a new token; the error is the system's, where it has no random numbers.
    pub(super) fn new(name: &str, port: u16) -> Result<Guard, String> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(|error| error.to_string())?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let name = name.to_ascii_lowercase();
        Ok(Guard { token, name, port })
    }

    /// Refuses a request that calls the server by a foreign name.
    pub(super) fn host(&self, host: Option<&str>) -> Result<(), Refused> {
        match host {
            Some(host) if self.is_own(host) => Ok(()),
            _ => Err((421, "this server is called by its address alone")),
        }
    }

    /// Refuses a page of another server.
    pub(super) fn origin(&self, origin: Option<&str>, host: Option<&str>) -> Result<(), Refused> {
        let own = origin.and_then(|origin| origin.strip_prefix("http://"));
        match (own, host) {
            (Some(own), Some(host)) if own.eq_ignore_ascii_case(host) && self.is_own(own) => Ok(()),
            _ => Err((403, "a WebSocket is for pages of this server alone")),
        }
    }

    /// Refuses a request without the token.
    pub(super) fn token(&self, query: &str) -> Result<(), Refused> {
        let mut fields = query.split('&');
        let given = fields.find_map(|field| field.strip_prefix("token="));
        match given {
            Some(given) if self.is_token(given) => Ok(()),
            _ => Err((
                403,
                "open the address that sweeplight printed, with its token",
            )),
        }
    }

    /// Compares every letter, so that the time tells nothing of the first that is wrong.
    fn is_token(&self, given: &str) -> bool {
        let pairs = given.bytes().zip(self.token.bytes());
        let differ = pairs.fold(0, |differ, (a, b)| differ | (a ^ b));
        given.len() == self.token.len() && differ == 0
    }

    /// Whether a host with its port is this server.
    fn is_own(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        let name = name.to_ascii_lowercase();
        let bare = name.trim_start_matches('[').trim_end_matches(']');
        let is_address = bare.parse::<IpAddr>().is_ok();
        port == Some(self.port) && (is_address || name == "localhost" || name == self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard() -> Guard {
        Guard::new("studio", 8080).expect("random numbers")
    }

    #[test]
    fn own_names_are_addresses_localhost_and_the_one_given() {
        for (host, own) in [
            ("127.0.0.1:8080", true),
            ("[::1]:8080", true),
            ("localhost:8080", true),
            ("STUDIO:8080", true),
            ("127.0.0.1:8081", false),
            ("127.0.0.1", false),
            ("evil.example:8080", false),
            ("127.0.0.1.evil.example:8080", false),
            ("localhost.evil:8080", false),
            ("", false),
        ] {
            assert_eq!(guard().host(Some(host)).is_ok(), own, "{host}");
        }
        assert!(guard().host(None).is_err());
    }

    #[test]
    fn a_socket_comes_from_a_page_of_the_same_server() {
        let host = Some("127.0.0.1:8080");
        for (origin, own) in [
            (Some("http://127.0.0.1:8080"), true),
            (Some("http://localhost:8080"), false),
            (Some("https://127.0.0.1:8080"), false),
            (Some("http://evil.example"), false),
            (Some("null"), false),
            (None, false),
        ] {
            assert_eq!(guard().origin(origin, host).is_ok(), own, "{origin:?}");
        }
    }

    #[test]
    fn a_token_is_whole() {
        let guard = guard();
        assert_eq!(guard.token.len(), 2 * TOKEN_BYTES);
        assert!(guard.token(&format!("a=1&token={}", guard.token)).is_ok());
        let cut = &guard.token[1..];
        for query in [
            "",
            "token=",
            "a=1",
            &format!("token={cut}"),
            &format!("token=0{cut}0"),
        ] {
            assert!(guard.token(query).is_err(), "{query}");
        }
    }
}
