//! Tests that keys are found in every form in which a server may echo them.

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

fn percent(text: &str) -> String {
    text.bytes().map(|byte| format!("%{byte:02x}")).collect()
}

fn json(text: &str) -> String {
    text.bytes().map(|byte| format!("\\u{byte:04X}")).collect()
}

#[test]
fn every_form_of_a_key_is_hidden_and_what_is_around_it_stays() {
    let forms = [
        CANARY.to_owned(),
        "sk-can%2Fary%2B0123%3dabc".to_owned(),
        percent(CANARY),
        r"sk-can\/ary+0123=abc".to_owned(),
        json(CANARY),
        json(CANARY).replace('\\', r"\\"),
        r"\u0073k-can%2fary+0123=abc".to_owned(),
    ];
    for form in forms {
        let hidden = redactor(&[CANARY]).text(&format!("ä <{form}> {form}"));
        assert_eq!(hidden, "ä <[key]> [key]", "{form}");
    }
}

#[test]
fn base64_of_a_key_is_hidden_wherever_the_key_begins() {
    for before in ["", "x", "Bearer ", "user:", "{\"key\": \""] {
        for after in ["", "y", "\"}"] {
            for alphabet in [&STANDARD_NO_PAD, &URL_SAFE_NO_PAD] {
                let text = alphabet.encode(format!("{before}{CANARY}{after}"));
                let hidden = redactor(&[CANARY]).text(&text);
                assert!(hidden.contains("[key]"), "{before:?} {after:?}: {hidden}");
                assert!(
                    hidden.len() < text.len() - CANARY.len() / 2,
                    "{text}: {hidden}"
                );
            }
        }
    }
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
    let twice = percent(CANARY).replace('%', r"\u0025");
    let body = format!(r#"{{"{twice}":[1.50,{{"a":"<{twice}>"}}],"b":null}}"#);
    let hidden = redactor(&[CANARY]).body(body.as_bytes());
    let expected = r#"{"[key]":[1.5,{"a":"<[key]>"}],"b":null}"#;
    assert_eq!(String::from_utf8_lossy(&hidden), expected);
    for body in [r#"{ "a": 1.50, "a": 2 }"#, "no JSON", ""] {
        assert_eq!(redactor(&[CANARY]).body(body.as_bytes()), body.as_bytes());
    }
}

#[test]
fn a_key_is_hidden_whatever_run_of_backslashes_its_letters_bear() {
    for run in 1..=20 {
        let run = "\\".repeat(run);
        for key in [
            format!("sk-can{run}/ary+0123=abc"),
            format!("sk-can{run}u002Fary+0123=abc"),
            CANARY
                .chars()
                .map(|letter| format!("{run}{letter}"))
                .collect(),
        ] {
            let hidden = redactor(&[CANARY]).text(&format!("<{key}>"));
            assert_eq!(hidden, "<[key]>", "{key}");
        }
    }
}

#[test]
#[ignore = "long"]
fn a_key_after_millions_of_backslashes_is_hidden() {
    let run: &[u8] = &vec![b'\\'; 4 << 20];
    let body = [run, CANARY.as_bytes()].concat();
    let hidden = redactor(&[CANARY]).body(&body);
    let expected = [&run[MOST_SLASHES..], HIDDEN].concat();
    assert!(hidden == expected, "{} bytes", hidden.len());
}

proptest! {
    #[test]
    fn text_without_a_key_stays_as_it_is(text in "[a-zA-Z0-9%\\\\u/+=\\- ]{0,60}") {
        prop_assume!(!text.contains("sk-"));
        prop_assert_eq!(redactor(&["sk-0123456789"]).text(&text), text);
    }

    #[test]
    fn any_bytes_are_taken(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let hidden = redactor(&[CANARY]).bytes(&bytes);
        prop_assert!(hidden.len() <= bytes.len());
    }
}
