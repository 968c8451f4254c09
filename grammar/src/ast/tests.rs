//! Tests which view an expression has, and what texts become.

use super::*;
use crate::{FileId, Tree, parse};

fn tree(text: &str) -> Tree {
    let parsed = parse(FileId::FIRST, text);
    assert_eq!(parsed.faults, []);
    parsed.tree
}

#[test]
fn layers_that_say_nothing_are_passed_over() {
    let shapes = [
        ("(1mm)", "Quantity"),
        ("not not a", "Name"),
        ("not not not a", "Not"),
        ("((a), b)", "Pair"),
        ("a and (b or c)", "All"),
        ("a < 1 or b", "Any"),
        ("(a < b)", "Compare"),
        ("a within 1px of b", "Within"),
        ("1 to 2", "Range"),
        ("from a to b", "Heading"),
        ("a.b in px", "Converted"),
        ("a.b", "Path"),
        ("a(b: 1)", "Call"),
        ("\"a\"", "Text"),
    ];
    for (text, shape) in shapes {
        let tree = tree(&format!("task a {{ goal {text} }}"));
        let task = tree.view().tasks().next().unwrap();
        let value = task.body().statements().next().unwrap().value();
        assert!(
            format!("{value:?}").starts_with(&format!("{shape}(")),
            "{text}: {value:?}"
        );
    }
}

#[test]
fn a_text_loses_the_indentation_that_its_lines_share() {
    let text = "task a { component b \"\"\"\r\n    One {{ c }}\r\n      two\r\n    \"\"\" }";
    let tree = tree(text);
    let body = tree.view().tasks().next().unwrap().body();
    let block = body.components().next().unwrap().text();
    assert_eq!(&text[block.start()..block.start() + 3], "One");
    let pieces = block.pieces();
    assert!(matches!(
        &pieces[..],
        [Piece::Literal(one), Piece::Value(Expr::Name(_)), Piece::Literal(two)] if one == "One " && two == "\n  two"
    ));
    assert_eq!(block.plain(), None);
    assert_eq!(block.literal_bytes(), "One \n  two".len());
}
