//! The sections of a task: one row each.

use serde::Serialize;

/// Which tasks must have a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RequiredIn {
    /// Needed to run. A task without it compiles as a base, with a note (F0408) unless other tasks extend it.
    ByEachTask,
    /// Needed to run. If only such a section is missing, it is an error (F0407); most tasks inherit it.
    ByARun,
    /// No task.
    Never,
}

/// What happens to a section when a task extends another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Merges {
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
    pub needed: RequiredIn,
    /// What happens to it when a task extends another.
    pub merges: Merges,
    /// Its meaning in one line, for the reference and `fabc vocabulary`.
    pub doc: &'static str,
}

const fn row(
    word: &'static str,
    form: &'static str,
    needed: RequiredIn,
    merges: Merges,
    doc: &'static str,
) -> Section {
    Section {
        word,
        form,
        needed,
        merges,
        doc,
    }
}

/// Every section, in the order of the reference.
pub(crate) const SECTIONS: &[Section] = &[
    row(
        "about",
        "about \"TEXT\"",
        RequiredIn::Never,
        Merges::Never,
        "what the task is for, in one line, shown by `fabc check`; no model sees it, and it does not change the program's hash",
    ),
    row(
        "const",
        "const NAME = QUANTITY",
        RequiredIn::Never,
        Merges::ByName,
        "a quantity with a name",
    ),
    row(
        "cloth",
        "cloth grid(55, 44)",
        RequiredIn::ByEachTask,
        Merges::Whole,
        "how large the cloth is, and how it lies",
    ),
    row(
        "camera",
        "camera top_down(height: L, fov: ANGLE, image: N px)",
        RequiredIn::ByARun,
        Merges::Whole,
        "where the camera is, and what it sees",
    ),
    row(
        "picker",
        "picker put_down",
        RequiredIn::Never,
        Merges::Whole,
        "how the cloth is carried and released",
    ),
    row(
        "goal",
        "goal MEASURE < LIMIT",
        RequiredIn::Never,
        Merges::Whole,
        "what counts as done",
    ),
    row(
        "horizon",
        "horizon N",
        RequiredIn::Never,
        Merges::Whole,
        "the most actions of a rollout; without it, as many as the subgoals show",
    ),
    row(
        "subgoals",
        "subgoals { demonstrate { fold A -> B } }",
        RequiredIn::ByEachTask,
        Merges::Whole,
        "the pictures that show what to do, step by step",
    ),
    row(
        "experts",
        "experts NAME",
        RequiredIn::Never,
        Merges::Whole,
        "which fold sequences count as right; without it, the demonstration",
    ),
    row(
        "demos",
        "demos STAGE from \"FILE\"",
        RequiredIn::Never,
        Merges::Whole,
        "which demonstrations a stage's model is shown",
    ),
    row(
        "keypoints",
        "keypoints { NAME = EXTRACTOR(…) }",
        RequiredIn::ByARun,
        Merges::ByName,
        "what is found in each picture",
    ),
    row(
        "annotate",
        "annotate { NAME = MARK(…) }",
        RequiredIn::Never,
        Merges::Whole,
        "what is drawn on the camera's picture",
    ),
    row(
        "actions",
        "actions { FIELD: one of CHOICE, … }",
        RequiredIn::ByARun,
        Merges::Whole,
        "what an answer may choose",
    ),
    row(
        "component",
        "component NAME when CONDITION \"TEXT\"",
        RequiredIn::Never,
        Merges::ByName,
        "a text with a name, which stages say",
    ),
    row(
        "override",
        "override component NAME \"TEXT\", override check NAME { … }",
        RequiredIn::Never,
        Merges::Changes,
        "replaces an inherited component or check",
    ),
    row(
        "without",
        "without component NAME, without check NAME",
        RequiredIn::Never,
        Merges::Changes,
        "leaves out an inherited component or check",
    ),
    row(
        "stage",
        "stage NAME { model … say … read … }",
        RequiredIn::ByEachTask,
        Merges::ByName,
        "one question to a model",
    ),
    row(
        "verify",
        "verify { check NAME { CONDITION } else \"TEXT\" }",
        RequiredIn::Never,
        Merges::Whole,
        "which answers are rejected, and the messages to the model",
    ),
    row(
        "variant",
        "variant NAME { SECTIONS }",
        RequiredIn::Never,
        Merges::ByName,
        "the task with some sections changed",
    ),
    row(
        "ablate",
        "ablate COMPONENT, …",
        RequiredIn::Never,
        Merges::ByName,
        "a variant without each of these components",
    ),
    row(
        "test",
        "test \"WHAT\" { given … reply … expect … }",
        RequiredIn::Never,
        Merges::Never,
        "the expected result of an answer",
    ),
];
