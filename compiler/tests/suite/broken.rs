//! Breaking any declaration of a shipped task gives an error, and never a smaller program.

use crate::common::{Changed, workspace};
use fab_compiler::Compiled;
use fab_grammar::ast::{Component, Expr};
use fab_grammar::{Kind, Node, Sources};
use fab_program::Program;
use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;

fn compile(entry: &str, name: &str, text: &str) -> Compiled {
    let folder = workspace().join("tasks");
    fab_compiler::compile(
        entry,
        &Changed {
            folder: &folder,
            name,
            text,
        },
    )
    .unwrap()
}

/// The programs by their titles, without the hashes of their sources.
fn programs(compiled: &Compiled) -> BTreeMap<String, Program> {
    let programs = compiled.programs.iter().cloned();
    programs
        .map(|program| {
            (
                program.title(),
                Program {
                    sources: Vec::new(),
                    ..program
                },
            )
        })
        .collect()
}

/// The replacement that breaks a declaration: nothing has this name, and it is not a value.
const NOTHING: &str = "nothing_has_this_name";

/// Returns which part of a declaration to replace, and with what; `None` if a node declares nothing.
fn broken(node: Node<'_>) -> Option<(Range<usize>, String)> {
    let nothing = |view: Node<'_>| Some((view.range(), NOTHING.to_owned()));
    let first_name = || {
        node.children()
            .find(|child| child.kind() == Kind::Name)
            .and_then(nothing)
    };
    let last_expr = || {
        let exprs = node.children().filter(|child| Expr::cast(*child).is_some());
        exprs.last().and_then(nothing)
    };
    match node.kind() {
        Kind::Constant | Kind::Statement | Kind::Keypoint | Kind::Attempts | Kind::Result => {
            last_expr()
        }
        Kind::Move | Kind::Check | Kind::Guard | Kind::Placeholder | Kind::Given => last_expr(),
        Kind::Field => match node.child(Kind::AnyOf) {
            Some(any) => any.child(Kind::Name).and_then(nothing),
            None => last_expr(),
        },
        Kind::Component | Kind::OverrideComponent => {
            let text = Component::cast(node)?.text();
            // Keep the number of lines, because templates store theirs.
            let lines = "\n".repeat(text.node().text().matches('\n').count());
            Some((
                text.node().range(),
                format!("\"\"\"{lines}{{{{ {NOTHING} }}}}\"\"\""),
            ))
        }
        Kind::Extends | Kind::ExpertsUsed | Kind::Demos | Kind::Without | Kind::WithoutCheck => {
            first_name()
        }
        Kind::Relax | Kind::Ablate | Kind::Setting | Kind::Read | Kind::Expect => first_name(),
        Kind::ComponentOrText | Kind::Picture => nothing(node),
        Kind::UseFile | Kind::Image => {
            let text = node.children().find(|child| child.kind() == Kind::String)?;
            Some((text.range(), "\"\"".to_owned()))
        }
        _ => None,
    }
}

fn entries() -> Vec<String> {
    let files = fs::read_dir(workspace().join("tasks")).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".fab")).collect();
    names.sort();
    names
}

/// Breaks each declaration of `name` in turn, and compiles `entry`, which uses it.
fn break_each(entry: &str, name: &str) {
    let text = fs::read_to_string(workspace().join("tasks").join(name)).unwrap();
    let before = programs(&compile(entry, name, &text));
    assert!(!before.is_empty(), "{entry}");
    let mut sources = Sources::default();
    let file = sources.add(name.to_owned(), text.clone());
    let tree = fab_grammar::parse(file, &text).tree;
    let breaks: Vec<_> = tree.nodes().filter_map(broken).collect();
    assert!(breaks.len() > 3, "{name} declares something");
    for (part, replacement) in breaks {
        let broken = format!("{}{replacement}{}", &text[..part.start], &text[part.end..]);
        let compiled = compile(entry, name, &broken);
        let at = format!(
            "`{}` -> `{replacement}` in {name}, byte {}",
            &text[part.clone()],
            part.start
        );
        assert!(compiled.has_errors(), "{at}: no error");
        for (title, program) in programs(&compiled) {
            // A task without the declaration must be unchanged.
            assert_eq!(
                Some(&program),
                before.get(&title),
                "{at}: `{title}` changed"
            );
        }
    }
}

#[test]
#[ignore = "long"]
fn a_broken_declaration_of_a_shipped_task_is_an_error_and_never_a_smaller_program() {
    for entry in entries() {
        break_each(&entry, &entry);
    }
}

#[test]
#[ignore = "long"]
fn a_broken_declaration_of_a_shared_library_is_an_error_and_never_a_smaller_program() {
    break_each("double_straight.fab", "lib/folding.fab");
    break_each("double_straight.fab", "lib/experts.fab");
    break_each("smoothing.fab", "lib/smoothing.fab");
}
