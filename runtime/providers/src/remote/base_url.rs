//! The base URL of a provider's interface.
//!
//! In: a URL written by a person. Out: the addresses for calls. A URL that contains a secret is refused, and no message
//! repeats any of it. So is a URL that already ends in an endpoint: the message gives the base that was meant.

use super::Wire;
use reqwest::Url;
use std::fmt;
use std::net::IpAddr;

/// Parts of a query parameter's name that suggest a secret value.
const SECRET_NAMES: [&str; 5] = ["key", "token", "secret", "password", "sig"];

/// Endpoints that are pasted at the end of a base URL; longer ones first.
const ENDPOINTS: [&str; 5] = [
    "/chat/completions",
    "/responses",
    "/messages",
    "/models",
    "/api/chat",
];

/// The address up to the version, such as `https://api.openai.com/v1`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BaseUrl(Url);

const NO_URL: &str =
    "the base URL is not valid; it must look like `http://localhost:8000/v1` or `https://host/v1`";

const SECRET: &str = "the base URL carries a key or a password, which would end up in logs; leave it out, and give the key in the \
                      environment or in the file of keys";

impl BaseUrl {
    /// Reads a base URL.
    ///
    /// A URL without a path gets the interface's usual version when an endpoint is built. Fails with the reason.
    pub fn parse(text: &str) -> Result<BaseUrl, String> {
        let mut url = Url::parse(text.trim()).map_err(|_| NO_URL)?;
        if !matches!(url.scheme(), "http" | "https") || !url.has_host() {
            return Err(NO_URL.to_owned());
        }
        let is_secret = |name: &str| {
            let name = name.to_lowercase();
            SECRET_NAMES.iter().any(|part| name.contains(part))
        };
        let has_user = !url.username().is_empty() || url.password().is_some();
        if has_user || url.query_pairs().any(|(name, _)| is_secret(&name)) {
            return Err(SECRET.to_owned());
        }
        url.set_fragment(None);
        let path = url.path().trim_end_matches('/').to_owned();
        for endpoint in ENDPOINTS {
            if let Some(base) = path.strip_suffix(endpoint) {
                url.set_path(base);
                return Err(format!(
                    "the base URL ends in `{endpoint}`, and fabc appends the endpoint itself; write `{url}`"
                ));
            }
        }
        Ok(BaseUrl(url))
    }

    /// Returns whether the host is this computer, by name or address.
    pub fn is_loopback(&self) -> bool {
        let host = self.0.host_str().unwrap_or_default();
        let address = host.trim_matches(['[', ']']).parse::<IpAddr>();
        host == "localhost" || address.is_ok_and(|address| address.is_loopback())
    }

    /// Returns whether a key may be sent there: nobody on the way can read it.
    pub fn keeps_secrets(&self) -> bool {
        self.0.scheme() == "https" || self.is_loopback()
    }

    /// Returns the endpoint for questions to a model.
    pub(super) fn endpoint(&self, wire: Wire, model: &str) -> Url {
        self.below(wire, wire.path(model))
    }

    /// Returns the endpoint that lists the models.
    pub(super) fn models(&self, wire: Wire) -> Url {
        self.below(wire, vec!["models".to_owned()])
    }

    fn below(&self, wire: Wire, path: Vec<String>) -> Url {
        let mut url = self.0.clone();
        let is_bare = url.path().trim_matches('/').is_empty();
        if let Ok(mut segments) = url.path_segments_mut() {
            segments.pop_if_empty();
            if is_bare {
                segments.push(wire.version_segment());
            }
            segments.extend(path);
        }
        url
    }
}

impl fmt::Display for BaseUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
#[path = "tests/base_url.rs"]
mod tests;
