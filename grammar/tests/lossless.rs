//! Every text has a tree, and the tree prints the text.

#![allow(clippy::unwrap_used)]

use fab_grammar::{Kind, Problem, parse};
use std::fs;
use std::path::Path;

/// Holds a tree to its promises: leaves tile the text, children lie in their parents, junk has a fault.
fn hold(text: &str) {
    let parsed = parse(text);
    let printed: String = parsed.tree.leaves().map(|leaf| leaf.text()).collect();
    assert_eq!(printed, text);
    let mut at = 0;
    for leaf in parsed.tree.leaves() {
        assert_eq!(leaf.span().start, at);
        at = leaf.span().end;
    }
    for node in parsed.tree.nodes() {
        for child in node.children() {
            assert!(node.span().start <= child.span().start && child.span().end <= node.span().end);
        }
    }
    let is_junk = |kind| {
        matches!(
            kind,
            Kind::Junk | Kind::JunkSection | Kind::JunkCondition | Kind::Stray
        )
    };
    let has_junk = parsed.tree.nodes().any(|node| is_junk(node.kind()));
    assert!(
        !has_junk || !parsed.faults.is_empty(),
        "{text:?} has junk and no fault"
    );
    for fault in &parsed.faults {
        assert!(
            text.is_char_boundary(fault.span.start) && text.is_char_boundary(fault.span.end),
            "{fault:?}"
        );
    }
}

fn tasks() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tasks");
    let mut texts = Vec::new();
    for folder in [folder.clone(), folder.join("lib")] {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "fab") {
                texts.push(fs::read_to_string(path).unwrap());
            }
        }
    }
    texts
}

#[test]
fn the_tasks_are_without_fault() {
    let tasks = tasks();
    assert!(tasks.len() >= 4);
    for text in tasks {
        assert_eq!(parse(&text).faults, []);
        hold(&text);
        hold(&format!("\u{feff}{}", text.replace('\n', "\r\n")));
    }
}

/// Cuts each task at many places, drops a piece at each, and puts something else there.
#[test]
fn mutilated_tasks_keep_every_byte() {
    for text in tasks() {
        let places: Vec<usize> = (0..text.len())
            .step_by(499)
            .filter(|at| text.is_char_boundary(*at))
            .collect();
        for at in places {
            hold(&text[..at]);
            hold(&text[at..]);
            for put in [
                "", "{", "}", "\"", "\"\"\"", "“", "(", ",", "=", "#", "\n", "{{", "é", "\\",
                "task x {",
            ] {
                let end = (at + 5..text.len())
                    .find(|end| text.is_char_boundary(*end))
                    .unwrap_or(text.len());
                hold(&format!("{}{put}{}", &text[..at], &text[end..]));
            }
        }
    }
}

#[test]
fn odd_texts_keep_every_byte() {
    for text in [
        "",
        " ",
        "\n",
        "\r",
        "\u{feff}",
        "#",
        "# a",
        "{",
        "}",
        "\"",
        "\"\"\"",
        "task",
        "task {",
        "use",
        "é",
        "\0",
        "task a {",
        "task a { }}",
        "→",
    ] {
        hold(text);
    }
}

#[test]
fn comments_and_blank_lines_are_in_the_tree() {
    let text = "# one\n\ntask a { # two\n    horizon 1 # three\n}\n# four";
    let parsed = parse(text);
    let comments: Vec<&str> = parsed
        .tree
        .nodes()
        .filter(|node| node.kind() == Kind::Comment)
        .map(|node| node.text())
        .collect();
    assert_eq!(comments, ["# one", "# two", "# three", "# four"]);
    let horizon = parsed
        .tree
        .nodes()
        .find(|node| node.kind() == Kind::Horizon)
        .unwrap();
    assert_eq!(
        horizon.text(),
        "horizon 1",
        "a node ends with its last word"
    );
}

#[test]
fn one_slip_is_one_fault() {
    for text in tasks() {
        // A brace that is missing anywhere must not make an avalanche.
        let tree = parse(&text).tree;
        for brace in tree
            .nodes()
            .filter(|node| matches!(node.kind(), Kind::Open | Kind::Close))
        {
            let at = brace.span().start;
            let without = format!("{}{}", &text[..at], &text[at + 1..]);
            let faults = parse(&without).faults;
            assert!(
                (1..=3).contains(&faults.len()),
                "without the brace at {at}: {faults:?}"
            );
        }
    }
}

#[test]
fn limits_are_faults() {
    let deep = "(".repeat(fab_grammar::MAX_NESTING + 1);
    assert_eq!(
        parse(&deep).faults[0].problem,
        Problem::TooDeep {
            limit: fab_grammar::MAX_NESTING
        }
    );
    let long = "x".repeat(fab_grammar::MAX_BYTES + 1);
    assert!(matches!(
        parse(&long).faults[0].problem,
        Problem::TooLong { .. }
    ));
    hold(&deep);
    hold(&long);
    // Brackets in texts and comments do not count.
    let quoted =
        format!("# {deep}\ntask a {{ component b \"{deep}\" component c \"\"\"{deep}\"\"\" }}");
    assert_eq!(parse(&quoted).faults, []);
}
