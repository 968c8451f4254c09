//! Invariants that hold for every text; the property tests and the fuzz target check the same ones.

use fab_compiler::diag::{self, Color, Diagnostic};
use fab_compiler::{Compiled, LoadError, Loader, Sources, Span};
use fab_grammar::Kind;
use fab_program::Program;

const ENTRY: &str = "entry.fab";

/// Gives one text as the entry, and its beginning as every other file: with whole texts, dozens would be compiled.
struct Everywhere<'t>(&'t str);

impl Loader for Everywhere<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        const MOST_BYTES: usize = 200;
        let end = if name == ENTRY {
            self.0.len()
        } else {
            self.0.floor_char_boundary(MOST_BYTES)
        };
        Ok(self.0[..end].to_owned())
    }
}

/// Compiles a text and panics if an invariant is broken.
pub fn hold(text: &str) {
    tree(text);
    let compiled = compile(text);
    for diagnostic in &compiled.diagnostics {
        places(diagnostic, &compiled.sources);
    }
    let plain = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
    assert_eq!(plain.is_empty(), compiled.diagnostics.is_empty());
    diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Ansi);
    let json = diag::to_json(&compiled.diagnostics, &compiled.sources);
    for program in &compiled.programs {
        self::program(program);
    }
    assert!(
        compiled.left_out == 0 || compiled.diagnostics.len() >= diag::MAX_FINDINGS,
        "what is found is left out only where there is too much of it"
    );
    let again = compile(text);
    assert_eq!(
        bytes(&compiled.programs),
        bytes(&again.programs),
        "the same text gives other programs"
    );
    assert_eq!(
        json,
        diag::to_json(&again.diagnostics, &again.sources),
        "the same text gives other findings"
    );
}

fn compile(text: &str) -> Compiled {
    fab_compiler::compile(ENTRY, &Everywhere(text)).expect("the entry can be loaded")
}

fn bytes(programs: &[Program]) -> Vec<u8> {
    serde_json::to_vec(programs).expect("a program is plain data")
}

/// Asserts a tree's invariants: leaves tile the text, children lie in their parents, junk has a fault.
fn tree(text: &str) {
    let parsed = fab_grammar::parse(fab_grammar::FileId::FIRST, text);
    let mut at = 0;
    for leaf in parsed.tree.leaves() {
        assert_eq!(leaf.span().start, at, "the leaves do not tile the text");
        assert_eq!(leaf.text(), &text[leaf.range()]);
        at = leaf.span().end;
    }
    assert_eq!(at, text.len(), "the leaves end before the text");
    let mut has_junk = false;
    for node in parsed.tree.nodes() {
        has_junk |= matches!(
            node.kind(),
            Kind::Junk | Kind::JunkSection | Kind::JunkCondition | Kind::Stray
        );
        for child in node.children() {
            assert!(node.span().start <= child.span().start);
            assert!(child.span().end <= node.span().end);
        }
    }
    assert!(
        !has_junk || !parsed.faults.is_empty(),
        "there is junk and no fault"
    );
    for fault in &parsed.faults {
        assert!(text.get(fault.span.range()).is_some(), "{fault:?}");
    }
}

/// Asserts that every span is a piece of its file, and every change can be made.
fn places(diagnostic: &Diagnostic, sources: &Sources) {
    let labels = diagnostic.labels.iter().map(|label| label.span);
    let edits = diagnostic.edits.iter().map(|edit| edit.span);
    for span in std::iter::once(diagnostic.span).chain(labels).chain(edits) {
        let text = &sources.get(span.file).text;
        assert!(text.get(span.range()).is_some(), "{diagnostic:?}");
    }
    for edit in &diagnostic.edits {
        let Span { file, .. } = edit.span;
        let mut text = sources.get(file).text.clone();
        text.replace_range(edit.span.range(), &edit.replacement);
    }
}

/// Asserts that a program can be written and read again, and that its hash is that of its bytes.
fn program(program: &Program) {
    let bytes = serde_json::to_vec(program).expect("a program is plain data");
    let again: Program = serde_json::from_slice(&bytes).expect("a program that is written is read");
    assert_eq!(&again, program);
    assert_eq!(again.hash(), program.hash());
}
