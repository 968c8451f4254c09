//! Tests that keys are found as servers echo them.

use super::*;
use proptest::prelude::*;

const CANARY: &str = "sk-canary_0123.abc";

fn redactor(keys: &[&str]) -> Redactor {
    let keys: Vec<Key> = keys
        .iter()
        .map(|key| Key::new("NAME", key).expect("a key"))
        .collect();
    Redactor::of(&keys)
}

#[test]
fn the_longer_of_two_keys_is_hidden_whole_and_short_ones_stay() {
    let keys = ["sk-canary", "sk-canary-with-a-tail", "EMPTY"];
    let hidden = redactor(&keys).text("sk-canary-with-a-tail sk-canary EMPTY sk-canar");
    assert_eq!(hidden, "[key] [key] EMPTY sk-canar");
    assert!(!format!("{:?}", redactor(&keys)).contains("canary"));
}

#[test]
fn a_body_holds_no_key_and_stays_as_it_is_without_one() {
    for body in [
        r#"{"KEY":[1.50,{"a":"<KEY>"}],"b":null}"#,
        "data: {\"error\":\"wrong key KEY\"}\n\ndata: [DONE]\n",
        r#"{"error":"GET https://x.example/v1?key=KEY&page=100%25 \"#,
        "<p>KEY</p> %",
    ] {
        let hidden = redactor(&[CANARY]).body(body.replace("KEY", CANARY).as_bytes());
        let hidden = String::from_utf8_lossy(&hidden);
        assert_eq!(hidden, body.replace("KEY", "[key]"));
    }
    for body in [b"no JSON".as_slice(), b"\xff%73k\\", b""] {
        assert_eq!(redactor(&[CANARY]).body(body), body);
    }
}

proptest! {
    #[test]
    fn any_bytes_are_taken(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let body = [&bytes[..], CANARY.as_bytes()].concat();
        let hidden = redactor(&[CANARY]).body(&body);
        prop_assert!(!String::from_utf8_lossy(&hidden).contains(CANARY));
    }
}
