//! Refuses requests that a foreign web page could send through a local browser.
//!
//! In: the headers of a request. Out: the answer, or 403 with the header at fault. Only programs on this machine can reach
//! the port, but a browser is one of them: any site's page may send it plain forms, or reach it through its own host name
//! that resolves to this machine.

use axum::extract::Request;
use axum::http::StatusCode;
use axum::http::header::{HOST, HeaderMap, HeaderName, ORIGIN};
use axum::http::uri::{Authority, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

/// Host names of this machine.
const NAMES: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];

/// Refuses a request that names another host, or comes from a page of one.
pub(super) async fn refuse_foreign(request: Request, next: Next) -> Response {
    let headers = request.headers();
    let foreign = if !headers.contains_key(HOST) || !all(headers, &HOST, is_local_host) {
        "Host"
    } else if !all(headers, &ORIGIN, is_local_origin) {
        "Origin"
    } else {
        return next.run(request).await;
    };
    let message = format!(
        "`{foreign}` is not this machine; it has to be 127.0.0.1, localhost or [::1], with any port"
    );
    (StatusCode::FORBIDDEN, message).into_response()
}

fn all(headers: &HeaderMap, name: &HeaderName, holds: impl Fn(&str) -> bool) -> bool {
    let mut values = headers.get_all(name).iter();
    values.all(|value| value.to_str().is_ok_and(&holds))
}

fn is_local_origin(origin: &str) -> bool {
    let origin = origin.parse::<Uri>().unwrap_or_default();
    let is_page = matches!(origin.scheme_str(), Some("http" | "https"));
    let authority = origin.authority();
    is_page && authority.is_some_and(|authority| is_local_host(authority.as_str()))
}

fn is_local_host(host: &str) -> bool {
    let Ok(authority) = host.parse::<Authority>() else {
        return false;
    };
    let is_named = |name: &&str| authority.host().eq_ignore_ascii_case(name);
    !host.contains('@') && NAMES.iter().any(is_named)
}
