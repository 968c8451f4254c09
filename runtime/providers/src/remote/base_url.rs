//! The base URL of a provider's interface.
//!
//! In: a URL written by a person. Out: the addresses for calls. A URL that contains a secret is refused, and no message
//! repeats any of it. So is a URL that already ends in an endpoint: the message gives the base that was meant.

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

/// Endpoints that are pasted at the end of a base URL; longer ones first. The last three are Ollama's own interface.
const ENDPOINTS: [&[&str]; 8] = [
    &["chat", "completions"],
    &["completions"],
    &["responses"],
    &["messages"],
    &["models"],
    &["api", "chat"],
    &["api", "generate"],
    &["api", "tags"],
];

/// The address up to the version, such as `https://api.openai.com/v1`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BaseUrl(Url);

/// Why a base URL is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
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
    /// It ends in an endpoint, which would be appended once more.
    #[error(
        "the base URL ends in `/{endpoint}`, and fabc appends the endpoint itself; write `{meant}`"
    )]
    Endpoint {
        /// The end that is too much.
        endpoint: String,
        /// The URL without it.
        meant: String,
    },
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
        if let Some(endpoint) = cut_endpoint(&mut url) {
            let meant = url.to_string();
            return Err(BaseUrlError::Endpoint { endpoint, meant });
        }
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
        self.below(wire, wire.path(model))
    }

    /// Returns the endpoint that lists the models.
    pub(super) fn models(&self, wire: Wire) -> Url {
        self.below(wire, vec!["models".to_owned()])
    }

    /// Returns the base that a server without anything unusual has: its root and the version.
    pub(super) fn usual(&self, wire: Wire) -> String {
        let mut url = self.0.clone();
        url.set_query(None);
        url.set_path(wire.version_segment());
        url.to_string()
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

/// Removes an endpoint from the end of a URL, and returns it.
fn cut_endpoint(url: &mut Url) -> Option<String> {
    let path = url.path().trim_end_matches('/').to_owned();
    let segments: Vec<&str> = path.split('/').skip(1).collect();
    let is_call = |segment: &&str| segment.contains(":generateContent");
    let cut = match segments.as_slice() {
        [.., "models", last] if is_call(last) => 2,
        segments => ENDPOINTS.iter().find(|end| segments.ends_with(end))?.len(),
    };
    let (base, endpoint) = segments.split_at(segments.len() - cut);
    url.set_path(&base.join("/"));
    Some(endpoint.join("/"))
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
    fn a_pasted_endpoint_is_refused_with_the_base_that_was_meant() {
        for (text, endpoint, meant) in [
            (
                "http://h:8000/v1/chat/completions",
                "chat/completions",
                "http://h:8000/v1",
            ),
            (
                "https://h/v1/chat/completions/",
                "chat/completions",
                "https://h/v1",
            ),
            (
                "https://h/v1/responses?a=1",
                "responses",
                "https://h/v1?a=1",
            ),
            ("https://h/v1/messages", "messages", "https://h/v1"),
            ("https://h/v1/models", "models", "https://h/v1"),
            ("http://h:11434/api/chat", "api/chat", "http://h:11434/"),
            (
                "https://h/v1beta/models/gemini-4:generateContent",
                "models/gemini-4:generateContent",
                "https://h/v1beta",
            ),
        ] {
            let error = BaseUrl::parse(text).expect_err(text);
            let (endpoint, meant) = (endpoint.to_owned(), meant.to_owned());
            assert_eq!(error, BaseUrlError::Endpoint { endpoint, meant }, "{text}");
        }
        for text in [
            "https://h/api",
            "https://h/api/v1",
            "https://h/openai/deployments/models-x",
            "https://h/responses/v1",
        ] {
            assert!(BaseUrl::parse(text).is_ok(), "{text}");
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
