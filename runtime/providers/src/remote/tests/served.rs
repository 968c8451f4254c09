//! Tests of the lists of models.

use super::*;

fn listed(status: u16, body: &str) -> Result<Vec<String>, NotListed> {
    read(&Incoming {
        status,
        content_type: None,
        location: None,
        wait: None,
        body: body.as_bytes().to_vec(),
    })
}

#[test]
fn lists_of_all_interfaces_are_read() {
    let ids = |ids: &[&str]| Ok(ids.iter().map(|id| (*id).to_owned()).collect::<Vec<_>>());
    for (body, expected) in [
        (
            r#"{"object":"list","data":[{"id":"a"},{"id":"b"}]}"#,
            ids(&["a", "b"]),
        ),
        (
            r#"{"data":[{"type":"model","id":"claude"}],"has_more":false}"#,
            ids(&["claude"]),
        ),
        (
            r#"{"models":[{"name":"models/gemini-4"}]}"#,
            ids(&["gemini-4"]),
        ),
        (
            r#"{"models":[{"name":"a.gguf"}],"data":[{"id":"a","name":"A"}]}"#,
            ids(&["a"]),
        ),
        (r#"{"object":"list","data":[]}"#, ids(&[])),
        (r#"{"object":"list","data":null}"#, ids(&[])),
        (r#"{"data":[{"id":"a\u001b[2J"}]}"#, ids(&["a\\u{1b}[2J"])),
    ] {
        assert_eq!(listed(200, body), expected, "{body}");
    }
    for body in ["", "<html>", "{}", "{\"data\":3}"] {
        assert!(
            matches!(listed(200, body), Err(NotListed::Other(_))),
            "{body}"
        );
    }
    for status in [401, 403] {
        assert_eq!(listed(status, ""), Err(NotListed::Unauthorised { status }));
    }
    assert_eq!(
        listed(404, ""),
        Err(NotListed::Other("HTTP 404".to_owned()))
    );
}
