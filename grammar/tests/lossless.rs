//! Every text has a tree, and the tree prints the text.

#![allow(clippy::unwrap_used)]

use fab_grammar::{FileId, Kind, Node, Problem, parse};
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Asserts a tree's invariants: leaves tile the text, children lie in their parents, junk has a fault.
fn hold(text: &str) {
    let parsed = parse(FileId::FIRST, text);
    let printed: String = parsed.tree.leaves().map(|leaf| leaf.text()).collect();
    assert_eq!(printed, text);
    let mut at = 0;
    for leaf in parsed.tree.leaves() {
        assert_eq!(leaf.range().start, at);
        at = leaf.range().end;
    }
    for node in parsed.tree.nodes() {
        for child in node.children() {
            assert_eq!(child.parent().unwrap().range(), node.range());
            assert!(
                node.range().start <= child.range().start && child.range().end <= node.range().end
            );
        }
    }
    let has_junk = parsed.tree.nodes().any(|node| node.kind().is_junk());
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
        assert_eq!(parse(FileId::FIRST, &text).faults, []);
        hold(&text);
        hold(&format!("\u{feff}{}", text.replace('\n', "\r\n")));
    }
}

/// Cuts a piece out of each task at many places and puts something else there.
#[test]
#[ignore = "long"]
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
    let parsed = parse(FileId::FIRST, text);
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
        .find(|node| node.kind() == Kind::Statement)
        .unwrap();
    assert_eq!(
        horizon.text(),
        "horizon 1",
        "a node ends with its last word"
    );
}

#[test]
#[ignore = "long"]
fn one_slip_is_one_fault() {
    for text in tasks() {
        // A missing brace must not cause an avalanche of faults, wherever it is.
        let tree = parse(FileId::FIRST, &text).tree;
        for brace in tree
            .nodes()
            .filter(|node| matches!(node.kind(), Kind::Open | Kind::Close))
        {
            let at = brace.range().start;
            let without = format!("{}{}", &text[..at], &text[at + 1..]);
            let faults = parse(FileId::FIRST, &without).faults;
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
        parse(FileId::FIRST, &deep).faults[0].problem,
        Problem::TooDeep {
            limit: fab_grammar::MAX_NESTING
        }
    );
    let long = "x".repeat(fab_grammar::MAX_BYTES + 1);
    assert!(matches!(
        parse(FileId::FIRST, &long).faults[0].problem,
        Problem::TooLong { .. }
    ));
    hold(&deep);
    hold(&long);
    // Brackets in texts and comments do not count.
    let quoted =
        format!("# {deep}\ntask a {{ component b \"{deep}\" component c \"\"\"{deep}\"\"\" }}");
    assert_eq!(parse(FileId::FIRST, &quoted).faults, []);
}

/// One change of a text; positions are thousandths of its length.
#[derive(Clone, Debug)]
enum Change {
    /// Cuts the text off.
    Cut(usize),
    Delete(usize, usize),
    Duplicate(usize, usize),
    Swap(usize, usize),
    Insert(usize, String),
}

fn change() -> impl Strategy<Value = Change> {
    let place = || 0..=1000usize;
    let piece = prop_oneof![
        Just("}".to_owned()),
        Just("{".to_owned()),
        Just("\"\"\"".to_owned()),
        Just("\"".to_owned()),
        Just("{{".to_owned()),
        Just("\n".to_owned()),
        Just(" test \"a\" {".to_owned()),
        ".{0,12}",
        "\\PC{1,3}",
    ];
    prop_oneof![
        place().prop_map(Change::Cut),
        (place(), 0..40usize).prop_map(|(at, length)| Change::Delete(at, length)),
        (place(), 0..40usize).prop_map(|(at, length)| Change::Duplicate(at, length)),
        (place(), place()).prop_map(|(a, b)| Change::Swap(a, b)),
        (place(), piece).prop_map(|(at, piece)| Change::Insert(at, piece)),
    ]
}

fn changed(text: &str, change: &Change) -> String {
    let place = |part: usize| text.floor_char_boundary(text.len() * part / 1000);
    let piece = |part: usize, length: usize| {
        let start = place(part);
        start..text.ceil_char_boundary((start + length).min(text.len()))
    };
    let mut changed = text.to_owned();
    match change {
        Change::Cut(at) => changed.truncate(place(*at)),
        Change::Delete(at, length) => changed.replace_range(piece(*at, *length), ""),
        Change::Duplicate(at, length) => {
            let piece = piece(*at, *length);
            changed.insert_str(piece.end, &text[piece]);
        }
        Change::Swap(a, b) => {
            let (a, b) = (place(*a.min(b)), place(*a.max(b)));
            let middle = text.floor_char_boundary(a.midpoint(b));
            changed.replace_range(a..b, &format!("{}{}", &text[middle..b], &text[a..middle]));
        }
        Change::Insert(at, piece) => changed.insert_str(place(*at), piece),
    }
    changed
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn changed_tasks_keep_every_byte(
        task in prop::sample::select(tasks()),
        changes in prop::collection::vec(change(), 1..4),
    ) {
        hold(&changes.iter().fold(task, |text, change| changed(&text, change)));
    }
}

/// Returns whether a node is a line of a block: a statement, or a block in another.
fn is_line(node: &Node<'_>) -> bool {
    let in_block = node
        .parent()
        .is_some_and(|parent| parent.child(Kind::Head).is_some());
    in_block
        && !node.kind().is_trivia()
        && !matches!(
            node.kind(),
            Kind::Head | Kind::Extends | Kind::Token | Kind::Open | Kind::Close | Kind::Expr
        )
        && node
            .parent()
            .is_some_and(|parent| parent.kind() != Kind::Check)
}

#[test]
#[ignore = "long"]
fn after_an_error_the_rest_of_the_file_has_its_tree() {
    for text in tasks() {
        let tree = parse(FileId::FIRST, &text).tree;
        let lines: Vec<Node<'_>> = tree.nodes().filter(is_line).collect();
        for broken in &lines {
            let at = broken.range().start;
            let parsed = parse(FileId::FIRST, &format!("{}?{}", &text[..at], &text[at..]));
            let found: BTreeSet<(String, &str)> = parsed
                .tree
                .nodes()
                .map(|node| (format!("{:?}", node.kind()), node.text()))
                .collect();
            let is_apart = |node: &&Node<'_>| {
                node.range().end <= at || node.range().start >= broken.range().end
            };
            for rest in lines.iter().filter(is_apart) {
                let rest = (format!("{:?}", rest.kind()), rest.text());
                assert!(
                    found.contains(&rest),
                    "with {broken:?} broken, {rest:?} is lost"
                );
            }
        }
    }
}

#[test]
fn every_byte_has_an_innermost_node() {
    for text in tasks() {
        let tree = parse(FileId::FIRST, &text).tree;
        for at in 0..text.len() {
            let node = tree.node_at(at);
            assert!(node.range().contains(&at));
            assert_eq!(node.children().count(), 0);
            assert!(node.ancestors().all(|outer| outer.range().contains(&at)));
        }
    }
    let empty = parse(FileId::FIRST, "").tree;
    assert_eq!(empty.node_at(7).kind(), Kind::File);
}

#[test]
fn a_word_apart_from_its_number_is_a_unit_where_nothing_else_fits() {
    let unit = |line: &str| {
        let text = format!("task a {{\n{line}\n}}");
        let tree = parse(FileId::FIRST, &text).tree;
        let units = tree.nodes().filter(|node| node.kind() == Kind::Unit);
        units.map(|node| node.text().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(unit("goal x < 40 mm"), ["mm"]);
    assert_eq!(unit("goal x < 40 furlongs # far"), ["furlongs"]);
    assert_eq!(unit("goal x < 40 %"), ["%"]);
    assert_eq!(unit("component a when b < 40 mm \"c\""), ["mm"]);
    assert_eq!(
        unit("verify { check a when b < 40 mm { c } else \"d\" }"),
        ["mm"]
    );
    for line in [
        "const a = 40 cloth grid(4, 4)",
        "const a = 40 test \"b\" { }",
        "keypoints { a = 40 b = c }",
        "actions { a: one of 1, 2 b: one of c }",
        "verify { attempts 3 then without a result overlap > 1 retries 2 }",
        "test \"a\" { given b = 40 reply c \"d\" }",
        "test \"a\" { given b = 40 expect accept }",
        "stage a { model b, temperature 0 example { } }",
        "horizon 10 goal x",
    ] {
        assert_eq!(unit(line), [""; 0], "{line}");
    }
}
