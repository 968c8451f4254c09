//! The sections of a task: one row each.

use super::calls::{CAMERAS, CLOTHS, PICKERS};
use fab_program::vocabulary::{Call, Signature};
use serde::Serialize;

/// What needs a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RequiredFor {
    /// Each task that can run. A task without it compiles as a base, with a note (F0408) unless other tasks extend it.
    #[serde(rename = "by_each_task")]
    RunnableTask,
    /// A run. If only such a section is missing, it is an error (F0407); most tasks inherit it.
    #[serde(rename = "by_a_run")]
    Run,
    /// No task.
    Never,
}

/// What happens to a section when a task extends another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Inheritance {
    /// The whole section is replaced.
    Whole,
    /// Parts are replaced and added by name.
    ByName,
    /// It changes inherited parts.
    Changes,
    /// It is not inherited.
    Never,
}

/// A section of a task.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Section {
    /// The word that it begins with.
    pub word: &'static str,
    /// How it is written.
    pub form: &'static str,
    /// Which tasks must have it.
    pub needed: RequiredFor,
    /// What happens to it when a task extends another.
    pub merges: Inheritance,
    /// Its meaning in one line, for the reference and `fabc vocabulary`.
    pub doc: &'static str,
    /// Lists the forms of the call that is its value; none if its value is no call.
    #[serde(skip)]
    pub calls: fn() -> Vec<&'static Signature>,
}

impl Section {
    /// Returns the same section, whose value is one of these calls.
    const fn called(self, calls: fn() -> Vec<&'static Signature>) -> Section {
        Section { calls, ..self }
    }
}

fn signatures<Make>(rows: &'static [Call<Make>]) -> Vec<&'static Signature> {
    rows.iter().map(|row| &row.signature).collect()
}

const fn row(
    word: &'static str,
    form: &'static str,
    needed: RequiredFor,
    merges: Inheritance,
    doc: &'static str,
) -> Section {
    Section {
        word,
        form,
        needed,
        merges,
        doc,
        calls: Vec::new,
    }
}

/// Every section, in the order of the reference.
pub(crate) const SECTIONS: &[Section] = &[
    row(
        "about",
        "about \"TEXT\"",
        RequiredFor::Never,
        Inheritance::Never,
        "what the task is for, in one line, shown by `fabc check`; no model sees it, and it does not change the program's hash",
    ),
    row(
        "const",
        "const NAME = QUANTITY",
        RequiredFor::Never,
        Inheritance::ByName,
        "a quantity with a name",
    ),
    row(
        "cloth",
        "cloth grid(55, 44)",
        RequiredFor::RunnableTask,
        Inheritance::Whole,
        "how large the cloth is, and how it lies",
    )
    .called(|| signatures(CLOTHS)),
    row(
        "camera",
        "camera top_down(height: L, fov: ANGLE, image: N px)",
        RequiredFor::Run,
        Inheritance::Whole,
        "where the camera is, and what it sees",
    )
    .called(|| signatures(CAMERAS)),
    row(
        "picker",
        "picker put_down",
        RequiredFor::Never,
        Inheritance::Whole,
        "how the cloth is carried and released",
    )
    .called(|| signatures(PICKERS)),
    row(
        "goal",
        "goal MEASURE < LIMIT",
        RequiredFor::Never,
        Inheritance::Whole,
        "what counts as done",
    ),
    row(
        "horizon",
        "horizon N",
        RequiredFor::Never,
        Inheritance::Whole,
        "the most actions of a rollout; without it, as many as the subgoals show",
    ),
    row(
        "subgoals",
        "subgoals { demonstrate { fold A -> B } }",
        RequiredFor::RunnableTask,
        Inheritance::Whole,
        "the pictures that show what to do, step by step",
    ),
    row(
        "experts",
        "experts NAME",
        RequiredFor::Never,
        Inheritance::Whole,
        "which fold sequences count as right; without it, the demonstration",
    ),
    row(
        "demos",
        "demos STAGE from \"FILE\"",
        RequiredFor::Never,
        Inheritance::Whole,
        "which demonstrations a stage's model is shown",
    ),
    row(
        "keypoints",
        "keypoints { NAME = EXTRACTOR(…) }",
        RequiredFor::Run,
        Inheritance::ByName,
        "what is found in each picture",
    ),
    row(
        "annotate",
        "annotate { NAME = MARK(…) }",
        RequiredFor::Never,
        Inheritance::Whole,
        "what is drawn on the camera's picture",
    ),
    row(
        "actions",
        "actions { FIELD: one of CHOICE, … }",
        RequiredFor::Run,
        Inheritance::Whole,
        "what an answer may choose",
    ),
    row(
        "component",
        "component NAME when CONDITION \"TEXT\"",
        RequiredFor::Never,
        Inheritance::ByName,
        "a text with a name, which stages say",
    ),
    row(
        "override",
        "override component NAME \"TEXT\", override check NAME { … }",
        RequiredFor::Never,
        Inheritance::Changes,
        "replaces an inherited component or check",
    ),
    row(
        "without",
        "without component NAME, without check NAME, without variant NAME",
        RequiredFor::Never,
        Inheritance::Changes,
        "leaves out an inherited component, check or variant",
    ),
    row(
        "stage",
        "stage NAME { model … say … read … }",
        RequiredFor::RunnableTask,
        Inheritance::ByName,
        "one question to a model",
    ),
    row(
        "rehearse",
        "rehearse STAGE { twin(…) choose most MEASURE trust overlap > N }",
        RequiredFor::Never,
        Inheritance::Whole,
        "tries a stage's answers on a simulated twin of the cloth before the world moves",
    ),
    row(
        "say",
        "say NAME in STAGE after NAME, say NAME in STAGE before NAME",
        RequiredFor::Never,
        Inheritance::Changes,
        "adds a component to what an inherited stage says",
    ),
    row(
        "verify",
        "verify { check NAME { CONDITION } else \"TEXT\" }",
        RequiredFor::Never,
        Inheritance::Whole,
        "which answers are rejected, and the messages to the model",
    ),
    row(
        "check",
        "check NAME { CONDITION } else \"TEXT\"",
        RequiredFor::Never,
        Inheritance::ByName,
        "adds a check to an inherited `verify`",
    ),
    row(
        "variant",
        "variant NAME { SECTIONS }",
        RequiredFor::Never,
        Inheritance::ByName,
        "the task with some sections changed",
    ),
    row(
        "ablate",
        "ablate COMPONENT, …",
        RequiredFor::Never,
        Inheritance::ByName,
        "a variant without each of these components",
    ),
    row(
        "test",
        "test \"WHAT\" { given … reply … expect … }",
        RequiredFor::Never,
        Inheritance::Never,
        "the expected result of an answer",
    ),
];
