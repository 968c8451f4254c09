//! What a file says, as written: typed, with a place for everything, and perhaps wrong.
//!
//! In: a syntax tree whose form may be faulty; what does not fit is left out. Out: a [`File`]. Names are
//! not looked up and quantities not judged here.

mod expr;
mod lower;
mod talk;
mod text;

pub(crate) use expr::{Argument, Expr, ExprKind};
pub(crate) use lower::lower;
pub(crate) use text::{Piece, Text};

use crate::source::{FileId, Span};
use std::collections::BTreeSet;

/// A name or a word with its place.
#[derive(Clone, Debug)]
pub(crate) struct Ident {
    pub text: String,
    pub span: Span,
}

/// One file.
#[derive(Clone, Debug)]
pub(crate) struct File {
    pub id: FileId,
    pub uses: Vec<Text>,
    pub experts: Vec<Experts>,
    pub tasks: Vec<Task>,
    /// The words of everything that does not fit: a name among them may be declared there, so it is not reported as unknown.
    pub junk_words: BTreeSet<String>,
}

/// `experts NAME { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Experts {
    pub name: Ident,
    pub sequences: Vec<Folds>,
    pub has_faults: bool,
}

/// `sequence { … }` or `demonstrate { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Folds {
    pub span: Span,
    pub moves: Vec<Move>,
    pub has_faults: bool,
}

/// `A -> B at F`.
#[derive(Clone, Debug)]
pub(crate) struct Move {
    pub span: Span,
    pub pick: Expr,
    pub place: Expr,
    pub fraction: Option<Expr>,
}

/// `task NAME extends BASE { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    pub name: Ident,
    pub extends: Option<Ident>,
    pub body: Body,
    pub variants: Vec<Variant>,
    pub ablated: Vec<Ident>,
    pub tests: Vec<Test>,
}

/// The sections of a task or a variant.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub constants: Vec<Keypoint>,
    pub cloth: Vec<Statement>,
    pub camera: Vec<Statement>,
    pub picker: Vec<Statement>,
    pub goal: Vec<Statement>,
    pub horizon: Vec<Statement>,
    pub subgoals: Vec<Subgoals>,
    pub experts: Vec<Reference>,
    pub demos: Vec<Demos>,
    pub keypoints: Vec<Keypoints>,
    pub annotate: Vec<Keypoints>,
    pub actions: Vec<Actions>,
    pub components: Vec<Component>,
    pub without: Vec<Ident>,
    pub stages: Vec<Stage>,
    pub verify: Vec<Verify>,
    /// Those with `override`.
    pub checks: Vec<Check>,
    pub without_checks: Vec<Ident>,
    /// Its length, bytes.
    pub bytes: usize,
    /// Whether something in it does not fit, so that what it lacks says nothing.
    pub has_faults: bool,
}

/// `demos STAGE from "FILE"`.
#[derive(Clone, Debug)]
pub(crate) struct Demos {
    pub span: Span,
    pub stage: Ident,
    pub file: Text,
}

/// `variant NAME { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Variant {
    pub name: Ident,
    pub body: Body,
}

/// `test "…" { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Test {
    /// The head.
    pub span: Span,
    pub name: Option<Text>,
    pub given: Vec<Given>,
    pub replies: Vec<Reply>,
    pub expect: Vec<Expect>,
    pub has_faults: bool,
}

/// `given NAME = …`.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    pub name: Ident,
    pub values: Vec<Expr>,
    pub text: Option<Text>,
}

/// `reply "…"`.
#[derive(Clone, Debug)]
pub(crate) struct Reply {
    pub span: Span,
    pub stage: Option<Ident>,
    pub text: Text,
}

/// `expect reject(CHECK)`.
#[derive(Clone, Debug)]
pub(crate) struct Expect {
    pub span: Span,
    pub what: Ident,
    pub check: Option<Ident>,
    pub text: Option<Text>,
}

/// A keyword and its value.
#[derive(Clone, Debug)]
pub(crate) struct Statement {
    pub span: Span,
    pub value: Expr,
}

/// `experts NAME` of a task.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    pub span: Span,
    pub name: Ident,
}

/// `subgoals { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Subgoals {
    pub span: Span,
    pub demonstrate: Vec<Folds>,
    pub images: Vec<Image>,
    pub has_faults: bool,
}

/// `image "…" arrow (…) -> (…)`.
#[derive(Clone, Debug)]
pub(crate) struct Image {
    pub span: Span,
    pub path: Text,
    pub arrow: Option<[[Expr; 2]; 2]>,
}

/// `keypoints { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Keypoints {
    pub span: Span,
    pub list: Vec<Keypoint>,
}

/// `NAME = …`.
#[derive(Clone, Debug)]
pub(crate) struct Keypoint {
    pub name: Ident,
    pub value: Expr,
}

/// `actions { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Actions {
    pub span: Span,
    pub fields: Vec<Field>,
    pub has_faults: bool,
}

/// `NAME: one of …`, or `NAME: any of MASK`.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub name: Ident,
    pub one_of: Vec<Expr>,
    /// The mask; then `one_of` is empty.
    pub any_of: Option<Ident>,
}

/// Whether a component is new or replaces one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Declares {
    New,
    Override,
}

/// `component NAME …`, with or without `override` and `when`.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    pub declares: Declares,
    pub name: Ident,
    pub when: Option<Expr>,
    pub text: Text,
}

/// `stage NAME { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    pub name: Ident,
    pub model: Vec<Settings>,
    pub show: Vec<Pictures>,
    pub say: Vec<Sayings>,
    pub system: Vec<Sayings>,
    pub read: Vec<Read>,
    pub examples: Vec<Example>,
    pub has_faults: bool,
}

/// `example { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Example {
    /// The head.
    pub span: Span,
    pub say: Vec<Sayings>,
    pub images: Vec<Image>,
    pub replies: Vec<Reply>,
    pub has_faults: bool,
}

/// `model …`.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub span: Span,
    pub list: Vec<(Ident, Option<Expr>)>,
}

/// `show …`.
#[derive(Clone, Debug)]
pub(crate) struct Pictures {
    pub span: Span,
    pub list: Vec<(Expr, Option<Ident>)>,
}

/// `say …` or `system …`.
#[derive(Clone, Debug)]
pub(crate) struct Sayings {
    pub span: Span,
    pub list: Vec<Saying>,
}

/// A component by name, or a text.
#[derive(Clone, Debug)]
pub(crate) enum Saying {
    Component(Ident),
    Text(Text),
}

/// `read NAME from "…"`.
#[derive(Clone, Debug)]
pub(crate) struct Read {
    pub span: Span,
    pub name: Ident,
    pub pattern: Option<Text>,
}

/// `verify { … }`.
#[derive(Clone, Debug)]
pub(crate) struct Verify {
    pub span: Span,
    pub checks: Vec<Check>,
    pub attempts: Vec<Attempts>,
    pub results: Vec<ResultCheck>,
}

/// `result overlap > N, retries N else "…"`.
#[derive(Clone, Debug)]
pub(crate) struct ResultCheck {
    pub span: Span,
    pub above: Expr,
    pub retries: Option<Expr>,
    pub message: Option<Text>,
    pub has_faults: bool,
}

/// `attempts N with picture, then without NAME, …, else skip`.
#[derive(Clone, Debug)]
pub(crate) struct Attempts {
    pub span: Span,
    pub count: Expr,
    /// Where `with picture` stands, if it does.
    pub with_picture: Option<Span>,
    pub relaxed: Vec<Ident>,
    /// Where `else skip` stands, if it does.
    pub else_skip: Option<Span>,
}

/// `check NAME { … } else "…"`.
#[derive(Clone, Debug)]
pub(crate) struct Check {
    pub span: Span,
    pub name: Ident,
    pub when: Option<Expr>,
    /// None where the condition does not fit.
    pub condition: Option<Expr>,
    pub message: Option<Text>,
    pub has_faults: bool,
}
