//! Refuses requests that a foreign web page could send through a local browser.
//!
//! In: the headers of a request. Out: nothing, or a refusal. Only programs on this machine can reach the port, but a
//! browser is one of them: any site's page may send it plain forms, or reach it through its own host name that resolves
//! to this machine. Bodies are not checked here.

use super::refusal::Refusal;
use axum::http::header::{CONTENT_TYPE, HOST, HeaderMap, HeaderName, ORIGIN};
use axum::http::uri::{Authority, Uri};

/// Host names of this machine.
const NAMES: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];

/// Refuses a request that names another host, or comes from a page of one.
pub(super) fn check(headers: &HeaderMap) -> Result<(), Refusal> {
    if !headers.contains_key(HOST) || !all(headers, &HOST, is_local_host) {
        return Err(Refusal::forbidden(
            "`Host` is not this machine; it has to be 127.0.0.1, localhost or [::1], with any port",
        ));
    }
    if !all(headers, &ORIGIN, is_local_origin) {
        return Err(Refusal::forbidden(
            "`Origin` is not this machine; pages of 127.0.0.1, localhost and [::1] alone are answered",
        ));
    }
    Ok(())
}

/// Refuses a body that is not declared as JSON: browsers send other types without asking first.
pub(super) fn check_type(headers: &HeaderMap) -> Result<(), Refusal> {
    let is_json = |value: &str| {
        let kind = value.split(';').next().unwrap_or_default();
        kind.trim().eq_ignore_ascii_case("application/json")
    };
    match headers.contains_key(CONTENT_TYPE) && all(headers, &CONTENT_TYPE, is_json) {
        true => Ok(()),
        false => Err(Refusal::wrong_type()),
    }
}

fn all(headers: &HeaderMap, name: &HeaderName, holds: impl Fn(&str) -> bool) -> bool {
    let mut values = headers.get_all(name).iter();
    values.all(|value| value.to_str().is_ok_and(&holds))
}

fn is_local_origin(origin: &str) -> bool {
    let origin = origin.parse::<Uri>().unwrap_or_default();
    let is_page = matches!(origin.scheme_str(), Some("http" | "https"));
    is_page
        && origin
            .authority()
            .is_some_and(|host| is_local_host(host.as_str()))
}

fn is_local_host(host: &str) -> bool {
    let Ok(authority) = host.parse::<Authority>() else {
        return false;
    };
    let is_named = |name: &&str| authority.host().eq_ignore_ascii_case(name);
    !host.contains('@') && NAMES.iter().any(is_named)
}
