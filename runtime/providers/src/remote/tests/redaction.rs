//! Tests that keys are found as servers echo them.

use super::*;
use proptest::prelude::*;

const CANARY: &str = "sk-can/ary+0123=abc";

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
    assert_eq!(format!("{:?}", redactor(&keys)), "Redactor(2 keys)");
}

#[test]
fn a_body_holds_no_key_in_what_it_means_and_stays_as_it_is_without_one() {
    let escaped: String = CANARY.bytes().map(|it| format!("\\u{it:04x}")).collect();
    for form in [CANARY, r"sk-can\/ary+0123=abc", &escaped] {
        let body = format!(r#"{{"{form}":[1.50,{{"a":"<{form}>"}}],"b":null}}"#);
        let hidden = redactor(&[CANARY]).body(body.as_bytes());
        let expected = r#"{"[key]":[1.5,{"a":"<[key]>"}],"b":null}"#;
        assert_eq!(String::from_utf8_lossy(&hidden), expected);
    }
    for body in [r#"{ "a": 1.50, "a": 2 }"#, "no JSON", ""] {
        assert_eq!(redactor(&[CANARY]).body(body.as_bytes()), body.as_bytes());
    }
    let page = format!("<p>{CANARY}</p>");
    assert_eq!(redactor(&[CANARY]).body(page.as_bytes()), b"<p>[key]</p>");
}

proptest! {
    #[test]
    fn any_bytes_are_taken(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let body = [&bytes[..], CANARY.as_bytes()].concat();
        let hidden = redactor(&[CANARY]).body(&body);
        prop_assert!(!String::from_utf8_lossy(&hidden).contains(CANARY));
    }
}
