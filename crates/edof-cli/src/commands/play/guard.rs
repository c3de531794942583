//! Who may speak to the page's server: a request to this very address, from its own page, with its token.

use crate::error::Error;
use hyper::header::{HOST, ORIGIN};
use hyper::{HeaderMap, StatusCode, Uri};

/// Bytes of the token.
const TOKEN_BYTES: usize = 16;

/// The address, and the token in it.
pub struct Guard {
    token: String,
    hosts: [String; 2],
}

/// Why a request is refused: its status, and a line.
pub type Refusal = (StatusCode, String);

impl Guard {
    /// Draws a token for a port of this computer.
    ///
    /// # Errors
    /// A system without random numbers.
    pub fn new(port: u16) -> Result<Self, Error> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(|e| Error::message(format!("no random token: {e}")))?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { token, hosts: ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}")) })
    }

    /// The page's address.
    pub fn address(&self) -> String {
        format!("http://{}/{}/", self.hosts[0], self.token)
    }

    /// Returns what follows the token in a request's path.
    ///
    /// # Errors
    /// [`Refusal`]: another host (a name that somebody made lead here), another page, no token or a wrong one.
    pub fn path<'a>(&self, uri: &'a Uri, headers: &HeaderMap) -> Result<&'a str, Refusal> {
        let forbidden = |line: &str| (StatusCode::FORBIDDEN, line.to_owned());
        let text = |name| headers.get_all(name).iter().map(|value| value.to_str().unwrap_or_default());
        let is_own = |host: &str| self.hosts.iter().any(|own| own == host);
        if text(HOST).count() != 1 || !text(HOST).all(is_own) {
            return Err(forbidden("Host: expected the address that 'edof play' printed"));
        }
        if !text(ORIGIN).all(|origin| origin.strip_prefix("http://").is_some_and(is_own)) {
            return Err(forbidden("Origin: only the page of this address may ask"));
        }
        let own = uri.path().strip_prefix('/').and_then(|path| path.split_once('/'));
        match own {
            Some((token, path)) if is_equal(token, &self.token) => Ok(path),
            _ => Err(forbidden("token: missing or wrong; open the address that 'edof play' printed")),
        }
    }
}

/// Compares in a time that does not depend on where the texts differ.
fn is_equal(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}
