//! Tests of the table of causes, with those that cannot be played without another machine.

use super::*;
use crate::remote::exchange::{Came, Sent};
use crate::remote::transport::{Incoming, NoReply};
use crate::remote::{BaseUrl, Settings};

fn sent(base_url: &str, proxy: Option<&str>) -> Sent {
    let base_url = BaseUrl::parse(base_url).expect("a base URL");
    Sent {
        url: base_url.endpoint(Wire::OpenaiChat, "a-model"),
        settings: Settings {
            key_names: vec!["FABC_VLLM_KEY".to_owned()],
            start: Some("vllm serve MODEL".to_owned()),
            ..Settings::new("vllm", "a-model", Wire::OpenaiChat, base_url)
        },
        proxy: proxy.map(str::to_owned),
    }
}

fn message(sent: &Sent, came: &Came, fault: Fault) -> String {
    let exchange = Exchange {
        sent,
        came,
        fault,
        served: None,
        omit: None,
    };
    let message = exchange.message();
    format!("{}{}", message.headline, message.details)
}

#[test]
fn each_way_to_miss_another_machine_says_what_to_do() {
    let proxy = Some("HTTPS_PROXY");
    for (name, base, proxy, obstacle, words) in [
        (
            "another_machine_refuses",
            "http://10.0.0.5:8000/v1",
            None,
            Obstacle::Refused,
            "Connection refused (os error 111)",
        ),
        (
            "unknown_host",
            "https://api.opnai.com/v1",
            None,
            Obstacle::UnknownHost,
            "dns error: Name or service not known",
        ),
        (
            "connect_timeout",
            "http://10.0.0.5:8000/v1",
            None,
            Obstacle::ConnectTimeout,
            "operation timed out",
        ),
        (
            "proxy_that_is_not_there",
            "https://api.openai.com/v1",
            proxy,
            Obstacle::Refused,
            "Connection refused (os error 111)",
        ),
        (
            "proxy_that_is_not_used",
            "http://127.0.0.1:8000/v1",
            None,
            Obstacle::Refused,
            "Connection refused (os error 111)",
        ),
        (
            "proxy_that_does_not_pass_it_on",
            "https://api.openai.com/v1",
            proxy,
            Obstacle::Unconnected,
            "tunnel error: unsuccessful",
        ),
    ] {
        let came = Came::Nothing(NoReply {
            obstacle,
            words: words.to_owned(),
        });
        let (fault, _) = obstacle.fault();
        insta::assert_snapshot!(name, message(&sent(base, proxy), &came, fault));
    }
}

#[test]
fn a_proxy_that_wants_a_login_is_named() {
    let incoming = Incoming {
        status: 407,
        content_type: Some("text/html".to_owned()),
        coding: None,
        location: None,
        wait: None,
        body: b"<html>Proxy Authentication Required</html>".to_vec(),
    };
    let sent = sent("http://models.example/v1", Some("http_proxy"));
    let came = Came::reply(incoming, None);
    insta::assert_snapshot!(
        "proxy_that_wants_a_login",
        message(&sent, &came, Fault::BadRequest)
    );
}
