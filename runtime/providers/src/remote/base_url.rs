//! The base URL of a provider's interface.
//!
//! In: a URL written by a person. Out: the addresses for calls. A URL that contains a secret is refused, and no message
//! repeats any of it.

use super::Wire;
use reqwest::Url;
use std::fmt;

/// Parts of a query parameter's name that suggest a secret value.
const SECRET_NAMES: [&str; 7] = [
    "key",
    "token",
    "secret",
    "password",
    "auth",
    "sig",
    "credential",
];

/// The address up to the version, such as `https://api.openai.com/v1`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BaseUrl(Url);

/// Why a base URL is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BaseUrlError {
    /// It cannot be parsed, or is not an HTTP address.
    #[error(
        "the base URL is not valid; it must look like `http://localhost:8000/v1` or `https://host/v1`"
    )]
    NoUrl,
    /// It contains a user name or password.
    #[error(
        "the base URL carries a user name or password, which would end up in logs; leave it out, and give the key in \
         the environment or in the file of keys"
    )]
    UserInformation,
    /// Its query seems to contain a key.
    #[error(
        "the base URL's query seems to carry a key, which would end up in logs; leave it out, and give the key in \
         the environment or in the file of keys"
    )]
    KeyInQuery,
}

impl BaseUrl {
    /// Reads a base URL.
    ///
    /// A URL without a path gets the interface's usual version when an endpoint is built.
    pub fn parse(text: &str) -> Result<BaseUrl, BaseUrlError> {
        let mut url = Url::parse(text.trim()).map_err(|_| BaseUrlError::NoUrl)?;
        if !matches!(url.scheme(), "http" | "https") || !url.has_host() {
            return Err(BaseUrlError::NoUrl);
        }
        if !url.username().is_empty() || url.password().is_some() {
            return Err(BaseUrlError::UserInformation);
        }
        let secret = url.query_pairs().any(|(name, _)| {
            let name = name.to_lowercase();
            SECRET_NAMES.iter().any(|part| name.contains(part))
        });
        if secret {
            return Err(BaseUrlError::KeyInQuery);
        }
        url.set_fragment(None);
        Ok(BaseUrl(url))
    }

    /// Returns whether the host is this computer, by name or address.
    pub fn is_loopback(&self) -> bool {
        match self.0.host_str() {
            Some("localhost") => true,
            Some(host) => {
                let address = host.trim_start_matches('[').trim_end_matches(']');
                let address = address.parse::<std::net::IpAddr>();
                address.is_ok_and(|address| address.is_loopback())
            }
            None => false,
        }
    }

    /// Returns whether a key may be sent there: nobody on the way can read it.
    pub fn keeps_secrets(&self) -> bool {
        self.0.scheme() == "https" || self.is_loopback()
    }

    /// Returns the endpoint for questions to a model.
    pub(super) fn endpoint(&self, wire: Wire, model: &str) -> Url {
        let mut url = self.0.clone();
        let is_bare = url.path().trim_matches('/').is_empty();
        if let Ok(mut segments) = url.path_segments_mut() {
            segments.pop_if_empty();
            if is_bare {
                segments.push(wire.version_segment());
            }
            segments.extend(wire.path(model));
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
mod tests {
    use super::*;

    fn endpoint(base: &str, wire: Wire) -> String {
        let base = BaseUrl::parse(base).expect("a base URL");
        base.endpoint(wire, "gemini/x y").to_string()
    }

    #[test]
    fn addresses_follow_the_base_and_a_bare_host_gets_the_usual_version() {
        for (base, wire, expected) in [
            (
                "http://localhost:8000",
                Wire::OpenaiChat,
                "http://localhost:8000/v1/chat/completions",
            ),
            (
                "http://localhost:8000/",
                Wire::OpenaiChat,
                "http://localhost:8000/v1/chat/completions",
            ),
            (
                "https://h/a/v9/",
                Wire::OpenaiResponses,
                "https://h/a/v9/responses",
            ),
            (
                "https://h?api-version=2",
                Wire::OpenaiChat,
                "https://h/v1/chat/completions?api-version=2",
            ),
            ("https://h", Wire::Anthropic, "https://h/v1/messages"),
            (
                "https://h",
                Wire::Gemini,
                "https://h/v1beta/models/gemini%2Fx%20y:generateContent",
            ),
        ] {
            assert_eq!(endpoint(base, wire), expected);
        }
    }

    #[test]
    fn urls_that_carry_secrets_are_refused_without_repeating_them() {
        for (text, expected) in [
            (
                "https://me:canary-secret@host/v1",
                BaseUrlError::UserInformation,
            ),
            (
                "https://canary-secret@host/v1",
                BaseUrlError::UserInformation,
            ),
            (
                "https://host/v1?key=canary-secret",
                BaseUrlError::KeyInQuery,
            ),
            (
                "https://host/v1?x=1&Access_Token=canary-secret",
                BaseUrlError::KeyInQuery,
            ),
            ("canary-secret", BaseUrlError::NoUrl),
            ("file:///canary-secret", BaseUrlError::NoUrl),
            ("", BaseUrlError::NoUrl),
        ] {
            let error = BaseUrl::parse(text).expect_err("refused");
            assert_eq!(error, expected, "{text}");
            assert!(!format!("{error} {error:?}").contains("canary"));
        }
    }

    #[test]
    fn this_computer_is_known_by_name_and_address() {
        for (text, expected) in [
            ("http://localhost:1/v1", true),
            ("http://127.0.0.1:1", true),
            ("http://[::1]:1", true),
            ("http://10.0.0.1", false),
            ("http://localhost.example", false),
        ] {
            assert_eq!(
                BaseUrl::parse(text).map(|url| url.is_loopback()),
                Ok(expected),
                "{text}"
            );
        }
    }
}
