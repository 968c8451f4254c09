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
    const fn needed(self, needed: RequiredFor) -> Section {
        Section { needed, ..self }
    }

    const fn merges(self, merges: Inheritance) -> Section {
        Section { merges, ..self }
    }

    const fn called(self, calls: fn() -> Vec<&'static Signature>) -> Section {
        Section { calls, ..self }
    }
}

fn signatures<Make>(rows: &'static [Call<Make>]) -> Vec<&'static Signature> {
    rows.iter().map(|row| &row.signature).collect()
}

/// Returns the row of a section that no task needs, is replaced whole, and whose value is no call.
const fn row(word: &'static str, form: &'static str, doc: &'static str) -> Section {
    Section {
        word,
        form,
        needed: RequiredFor::Never,
        merges: Inheritance::Whole,
        doc,
        calls: Vec::new,
    }
}

/// Returns how the section that begins with a word is inherited.
pub(crate) fn inheritance(word: &str) -> Inheritance {
    let row = SECTIONS.iter().find(|row| row.word == word);
    row.map_or(Inheritance::Never, |row| row.merges)
}

/// Every section, in the order of the reference.
pub(crate) const SECTIONS: &[Section] = &[
    row(
        "about",
        "about \"TEXT\"",
        "what the task is for, in one line, shown by `fabc check`; no model sees it, and it \
         does not change the program's hash",
    )
    .merges(Inheritance::Never),
    row("const", "const NAME = QUANTITY", "a quantity with a name").merges(Inheritance::ByName),
    row(
        "cloth",
        "cloth grid(55, 44)",
        "how large the cloth is, and how it lies",
    )
    .needed(RequiredFor::RunnableTask)
    .called(|| signatures(CLOTHS)),
    row(
        "camera",
        "camera top_down(height: L, fov: ANGLE, image: N px)",
        "where the camera is, and what it sees",
    )
    .needed(RequiredFor::Run)
    .called(|| signatures(CAMERAS)),
    row(
        "picker",
        "picker put_down",
        "how the cloth is carried and released",
    )
    .called(|| signatures(PICKERS)),
    row("goal", "goal MEASURE < LIMIT", "what counts as done"),
    row(
        "horizon",
        "horizon N",
        "the most actions of a rollout; without it, as many as the subgoals show",
    ),
    row(
        "subgoals",
        "subgoals { demonstrate { fold A -> B } }",
        "the pictures that show what to do, step by step",
    )
    .needed(RequiredFor::RunnableTask),
    row(
        "experts",
        "experts NAME",
        "which fold sequences count as right; without it, the demonstration",
    ),
    row(
        "demos",
        "demos STAGE from \"FILE\"",
        "which demonstrations a stage's model is shown",
    ),
    row(
        "keypoints",
        "keypoints { NAME = EXTRACTOR(…) }",
        "what is found in each picture",
    )
    .needed(RequiredFor::Run)
    .merges(Inheritance::ByName),
    row(
        "annotate",
        "annotate { NAME = MARK(…) }",
        "what is drawn on the camera's picture",
    ),
    row(
        "actions",
        "actions { FIELD: one of CHOICE, … }",
        "what an answer may choose",
    )
    .needed(RequiredFor::Run),
    row(
        "component",
        "component NAME when CONDITION \"TEXT\"",
        "a text with a name, which stages say",
    )
    .merges(Inheritance::ByName),
    row(
        "override",
        "override component NAME \"TEXT\", override check NAME { … }",
        "replaces an inherited component or check",
    )
    .merges(Inheritance::Changes),
    row(
        "without",
        "without component NAME, without check NAME, without variant NAME",
        "leaves out an inherited component, check or variant",
    )
    .merges(Inheritance::Changes),
    row(
        "stage",
        "stage NAME { model … say … read … }",
        "one question to a model",
    )
    .needed(RequiredFor::RunnableTask)
    .merges(Inheritance::ByName),
    row(
        "rehearse",
        "rehearse STAGE { twin(…) choose most MEASURE trust overlap > N }",
        "tries a stage's answers on a simulated twin of the cloth before the world moves",
    ),
    row(
        "say",
        "say NAME in STAGE after NAME, say NAME in STAGE before NAME",
        "adds a component to what an inherited stage says",
    )
    .merges(Inheritance::Changes),
    row(
        "verify",
        "verify { check NAME { CONDITION } else \"TEXT\" }",
        "which answers are rejected, and the messages to the model",
    ),
    row(
        "check",
        "check NAME { CONDITION } else \"TEXT\"",
        "adds a check to an inherited `verify`",
    )
    .merges(Inheritance::ByName),
    row(
        "variant",
        "variant NAME { SECTIONS }",
        "the task with some sections changed",
    )
    .merges(Inheritance::ByName),
    row(
        "ablate",
        "ablate COMPONENT, …",
        "a variant without each of these components",
    )
    .merges(Inheritance::ByName),
    row(
        "test",
        "test \"WHAT\" { given … reply … expect … }",
        "the expected result of an answer",
    )
    .merges(Inheritance::Never),
];
