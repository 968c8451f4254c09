//! Tests of where two documents differ first.

use super::*;
use serde_json::json;

#[test]
fn the_first_difference_is_named_with_both_values() {
    let long = "a".repeat(100);
    let cases = [
        (json!({"a": 1}), json!({"a": 1}), None),
        (
            json!({"a": 1, "b": 2}),
            json!({"a": 1, "b": 3}),
            Some("`b` (recorded 2, now 3)"),
        ),
        (
            json!({"a": [1, 2]}),
            json!({"a": [1]}),
            Some("`a[1]` (recorded 2, now nothing)"),
        ),
        (
            json!({}),
            json!({"c": null}),
            Some("`c` (recorded nothing, now null)"),
        ),
        (
            json!({"a": {"b": "x"}}),
            json!({"a": {"b": "y"}}),
            Some("`a.b` (recorded \"x\", now \"y\")"),
        ),
        (
            json!({"t": "one\ntwo"}),
            json!({"t": "one\ntoo\nthree"}),
            Some("`t`, line 2 (recorded \"two\", now \"too\")"),
        ),
        (
            json!({"t": "one"}),
            json!({"t": "one\n"}),
            Some("`t`, line 2 (recorded nothing, now \"\")"),
        ),
        (
            json!([format!("{long}b")]),
            json!([format!("{long}c")]),
            Some("`[0]` (recorded \"…aaaaaaaaaaaaaaaaaaaab\", now \"…aaaaaaaaaaaaaaaaaaaac\")"),
        ),
        (json!(1), json!([1]), Some("`` (recorded 1, now [1])")),
    ];
    for (stored, now, expected) in cases {
        let found = first(&stored, &now).map(|it| it.to_string());
        assert_eq!(found.as_deref(), expected);
    }
}
