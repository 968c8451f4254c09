//! What is said about a failed call.
//!
//! In: an [`Exchange`]. Out: a [`Message`] with method, URL, status, content type, the beginning of the body, and the likely
//! cause with its remedy, which [`causes`] knows. Keys were hidden when the bytes came in, and are hidden again in the
//! finished message.

use super::causes;
use super::exchange::{Came, Exchange, Received};
use super::transport::{Incoming, Obstacle};
use fab_base::wording::shown;
use fab_model::calls::Fault;
use reqwest::StatusCode;

/// How much of a body is shown, characters.
const MAX_EXCERPT: usize = 200;

/// The longest content coding that is shown, characters.
const MAX_CODING: usize = 20;

/// A failure in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    /// What happened, on one line.
    pub headline: String,
    /// The rest, a line each, which begins with a line break.
    pub details: String,
}

impl Exchange<'_> {
    /// Describes the failure.
    pub(super) fn message(&self) -> Message {
        let request = format!("request: POST {}", self.sent.url);
        let reply = match self.came {
            Came::Reply(received) => format!("reply: {}", described(&received.incoming)),
            Came::Nothing(nothing) => {
                format!("reply: none ({})", shown(&nothing.words, MAX_EXCERPT))
            }
        };
        let mut lines = vec![request, reply];
        if let Some((cause, help)) = causes::likely(self) {
            lines.push(format!("likely cause: {cause}"));
            lines.push(format!("help: {help}"));
        }
        let details = lines.iter().map(|line| format!("\n  {line}"));
        Message {
            headline: self.headline(),
            details: details.collect(),
        }
    }

    fn headline(&self) -> String {
        let received = match self.came {
            Came::Reply(received) => received,
            Came::Nothing(nothing) => return words(nothing.obstacle).to_owned(),
        };
        let Received { error, problem, .. } = &**received;
        let status = received.incoming.status;
        let reason = StatusCode::from_u16(status).ok();
        let reason = reason.and_then(|status| status.canonical_reason());
        let status = match reason {
            Some(reason) => format!("HTTP {status} {reason}"),
            None => format!("HTTP {status}"),
        };
        let repeats = |text: &str| reason.is_some_and(|reason| reason.eq_ignore_ascii_case(text));
        match problem {
            Some(problem) if *problem == error.words() => match error.message.is_empty() {
                true => format!("{status} with {problem}"),
                false => format!("{status} with an error in it: {problem}"),
            },
            Some(problem) if self.fault == Fault::Refused => {
                format!("{status}, but the model declined: {problem}")
            }
            Some(problem) => format!("{status}, but {problem}"),
            None if error.message.is_empty() || repeats(&error.message) => status,
            None => format!("{status}: {}", error.message),
        }
    }
}

/// Returns content type, length and beginning of a reply.
fn described(incoming: &Incoming) -> String {
    let mut kind = match &incoming.content_type {
        Some(kind) => shown(kind, MAX_EXCERPT),
        None => "no content type".to_owned(),
    };
    if let Some(coding) = &incoming.coding {
        kind.push_str(&format!(" in `{}`", shown(coding, MAX_CODING)));
    }
    match incoming.body.len() {
        0 => format!("{kind}, no body"),
        1 => format!("{kind}, 1 byte: `{}`", excerpt(&incoming.body)),
        length => format!("{kind}, {length} bytes: `{}`", excerpt(&incoming.body)),
    }
}

/// Returns the beginning of a body; bytes that are not UTF-8 are written as `\xNN`.
fn excerpt(body: &[u8]) -> String {
    // No character has more bytes.
    let beginning = &body[..body.len().min(4 * MAX_EXCERPT + 4)];
    let mut text = String::new();
    for chunk in beginning.utf8_chunks() {
        text.push_str(chunk.valid());
        for byte in chunk.invalid() {
            text.push_str(&format!("\\x{byte:02x}"));
        }
    }
    shown(&text, MAX_EXCERPT)
}

/// Says what prevented a reply.
fn words(obstacle: Obstacle) -> &'static str {
    match obstacle {
        Obstacle::Refused => "the connection was refused",
        Obstacle::UnknownHost => "the host's name could not be resolved",
        Obstacle::Unrouted => "the network has no route to the host",
        Obstacle::ConnectTimeout => "the connection was not accepted in time",
        Obstacle::UntrustedCertificate => "the server's certificate is not trusted",
        Obstacle::ExpiredCertificate => "the server's certificate is not valid today",
        Obstacle::CertificateOfAnotherName => "the server's certificate is for another name",
        Obstacle::NoTls => "the server does not speak TLS",
        Obstacle::Tls => "no encrypted connection could be made",
        Obstacle::Unconnected => "no connection could be made",
        Obstacle::Timeout => "no complete reply came in time",
        Obstacle::NoHttp => "the reply is not HTTP",
        Obstacle::BadHttp => "the reply breaks the rules of HTTP",
        Obstacle::Cut => "the connection ended before the reply was complete",
        Obstacle::TooLong => "the reply is longer than the limit",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_shown_to_its_two_hundredth_character_and_no_control_character_reaches_the_terminal()
     {
        for (body, expected) in [
            (&b"plain"[..], "plain"),
            (b"a\r\nb\x1b[2J", "a\\r\\nb\\u{1b}[2J"),
            (b"\x1f\x8b\x08\x00", "\\u{1f}\\x8b\\u{8}\\u{0}"),
            ("\u{feff}\u{202e}x".as_bytes(), "\\u{feff}\\u{202e}x"),
        ] {
            assert_eq!(excerpt(body), expected);
        }
        let long = excerpt("ä".repeat(1000).as_bytes());
        assert_eq!(long, format!("{}…", "ä".repeat(200)));
    }
}
