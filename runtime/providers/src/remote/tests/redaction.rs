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
    assert!(!format!("{:?}", redactor(&keys)).contains("canary"));
}

#[test]
fn a_body_holds_no_key_however_it_is_escaped_and_stays_as_it_is_without_one() {
    let escaped: String = CANARY.bytes().map(|it| format!("\\u{it:04X}")).collect();
    for form in [
        CANARY,
        r"sk-can\/ary+0123=abc",
        r"sk-can/ary\u002b0123\u003dabc",
        r"sk-can\\\/ary\\u002B0123=abc",
        "sk-can%2Fary%2B0123%3Dabc",
        "sk-can/ary%2b0123=abc",
        "%73k-can%2fary+0123=ab%63",
        &escaped,
    ] {
        for body in [
            r#"{"KEY":[1.50,{"a":"<KEY>"}],"b":null}"#,
            "data: {\"error\":\"wrong key KEY\"}\n\ndata: [DONE]\n",
            r#"{"error":"GET https://x.example/v1?key=KEY&page=100%25 \"#,
            "<p>KEY</p> %",
            r"KEY \u %u%7 \",
        ] {
            let hidden = redactor(&[CANARY]).body(body.replace("KEY", form).as_bytes());
            let hidden = String::from_utf8_lossy(&hidden);
            assert_eq!(hidden, body.replace("KEY", "[key]"), "{form}");
        }
    }
    for body in [
        r#"{ "a": 1.50, "a": 2, "b": "\u0073k-can\/ar\\ 20%" }"#.as_bytes(),
        b"no JSON",
        b"\xff%73k\\",
        b"",
    ] {
        assert_eq!(redactor(&[CANARY]).body(body), body);
    }
}

#[test]
fn a_key_of_signs_that_escape_is_found_plainly_and_escaped() {
    let key = r#"a"b\c%d/e"#;
    for form in [key, r#"a\"b\\c%d\/e"#, "a%22b%5Cc%25d%2Fe"] {
        assert_eq!(redactor(&[key]).text(&format!("<{form}>")), "<[key]>");
    }
    let backslashes = r"\".repeat(200_000);
    assert_eq!(redactor(&[key]).text(&backslashes), backslashes);
}

proptest! {
    #[test]
    fn any_bytes_are_taken(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let body = [&bytes[..], CANARY.as_bytes()].concat();
        let hidden = redactor(&[CANARY]).body(&body);
        prop_assert!(!String::from_utf8_lossy(&hidden).contains(CANARY));
    }
}
