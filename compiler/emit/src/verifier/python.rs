//! The Python module; it needs only the standard library.

use super::dialect::Dialect;
use super::fields;
use super::layout::Code;
use super::names::{python_escaped, python_text};
use super::outline::Outline;
use fab_program::{Check, Choices};
use std::fmt::Write;

pub(super) const DIALECT: Dialect = Dialect {
    private: "_",
    may_miss: "",
    pair: ["(", ")"],
    not: ["not (", ")"],
    and: "and",
    or: "or",
    has_last: "facts.last is not None",
    step: "float(facts.step)",
    text: python_text,
};

/// Writes the module.
pub(super) fn module(outline: &Outline<'_>) -> String {
    let kept = |check: &Check| outline.is_kept(check);
    let parts = [
        header(outline),
        TYPES.to_owned(),
        action_and_last(outline),
        entry("verify", ENTRY_DOC, "_CHECKS"),
        entry("verify_relaxed", &relaxed_doc(outline), "_CHECKS_RELAXED"),
        tables(outline),
        checks(outline),
        helpers(outline),
        [
            list(outline, "_CHECKS", |_| true),
            list(outline, "_CHECKS_RELAXED", kept),
        ]
        .join("\n"),
    ];
    let parts: Vec<&str> = parts.iter().map(|part| part.trim_end()).collect();
    parts.join("\n\n\n") + "\n"
}

fn header(outline: &Outline<'_>) -> String {
    let imports: String = [("whole", "import math\n"), ("pixel", "import operator\n")]
        .iter()
        .filter(|(helper, _)| outline.helpers.contains(helper))
        .map(|(_, import)| *import)
        .collect();
    format!(
        "\
\"\"\"Verifier of the task `{title}`: says which proposed actions may run.

Made by fabc {compiler} from the program {hash}; make it again instead of editing it.
It needs the standard library of Python 3.8 alone. Give it a scene, an object with the methods of
`Scene`, and judge each action that a model proposes:

    action = Action({example})
    refused_by = verify(scene, 1, None, action)

`refused_by` is None where the action may run, else the name of the first check that fails: ask the
model again. `Missing` is raised where the scene lacks what a check needs.

Points are pixels of the task's camera picture, (column, row) from the top left.
\"\"\"

{imports}from dataclasses import dataclass
from typing import Optional, Sequence, Tuple",
        title = python_escaped(&outline.program.title()),
        compiler = python_escaped(&outline.program.compiler),
        hash = outline.program.hash(),
        example = outline
            .example("=")
            .replace('\\', "\\\\")
            .replace("\"\"\"", "\\\"\"\""),
    )
}

const TYPES: &str = "\
class Missing(LookupError):
    \"\"\"A keypoint, a mask or the action before this one is needed and not there.

    `name` says which.
    \"\"\"

    def __init__(self, name: str):
        super().__init__(f\"`{name}` is not known here\")
        self.name = name


class Scene:
    \"\"\"What the camera shows; any object with these methods will do.\"\"\"

    def points(self, keypoint: str) -> Optional[Sequence[Tuple[int, int]]]:
        \"\"\"Returns the points of a keypoint, one for a point; None for a name without points.\"\"\"
        raise NotImplementedError

    def distance_px(self, region: str, point: Tuple[int, int]) -> Optional[float]:
        \"\"\"Returns the distance to the nearest pixel of a mask or box, 0 in it; None for an empty one.\"\"\"
        raise NotImplementedError

    def area_px(self, mask: str) -> Optional[float]:
        \"\"\"Returns the number of a mask's pixels; None for an unknown name.\"\"\"
        raise NotImplementedError";

const ENTRY_DOC: &str = "\
Judges an action: whether its fields were offered, then the task's checks in order.

    `step` is the step of the rollout, from 1; `last` is the action before this one, or None.
    Returns None where the action may run, else the name of the first check that fails.";

fn relaxed_doc(outline: &Outline<'_>) -> String {
    format!(
        "Judges an action less strictly, for when no answer passed `verify`: {}.",
        outline.left_out(python_escaped)
    )
}

fn action_and_last(outline: &Outline<'_>) -> String {
    let mut action = String::new();
    for field in &outline.fields {
        let kind = match &field.declared.choices {
            Choices::Points { .. } | Choices::Region { .. } => "Tuple[int, int]",
            Choices::Directions { .. } | Choices::Lengths { .. } => "float",
            Choices::Words { .. } => "str",
        };
        let _ = write!(
            action,
            "    # Field `{}`: {}.\n    {}: {kind}\n",
            python_escaped(&field.declared.name),
            fields::value_words(&field.declared.choices),
            field.identifier
        );
    }
    let mut last = String::new();
    for field in outline.directions() {
        let _ = write!(
            last,
            "    # Its {}, degrees; one of the offered ones, else it counts as missing.\n    {}: float\n",
            python_escaped(&field.declared.name),
            field.identifier
        );
    }
    format!(
        "\
@dataclass(frozen=True)
class Action:
    \"\"\"A proposed action.\"\"\"

{action}

@dataclass(frozen=True)
class Last:
    \"\"\"The action before this one, as it was carried out.\"\"\"

    # The pixel that was picked.
    pick: Tuple[int, int]
    # The pixel that it was placed on.
    place: Tuple[int, int]
{last}

@dataclass(frozen=True)
class _Facts:
    scene: Scene
    step: int
    last: Optional[Last]
    action: Action


def _first_failing(facts, checks):
    for name, holds in checks:
        if not holds(facts):
            return name
    return None"
    )
}

fn entry(function: &str, doc: &str, checks: &str) -> String {
    format!(
        "\
def {function}(
    scene: Scene, step: int, last: Optional[Last], action: Action
) -> Optional[str]:
    \"\"\"{doc}\"\"\"
    return _first_failing(_Facts(scene, step, last, action), {checks})"
    )
}

fn tables(outline: &Outline<'_>) -> String {
    let mut tables = Vec::new();
    for field in &outline.fields {
        let rows: String = field
            .rows
            .iter()
            .map(|row| format!("    {row},\n"))
            .collect();
        tables.push(format!(
            "# Field `{}`: {}.\n_{} = (\n{rows})",
            python_escaped(&field.declared.name),
            fields::table_words(&field.declared.choices),
            field.table
        ));
    }
    tables.join("\n\n")
}

fn checks(outline: &Outline<'_>) -> String {
    let returned = |code: &Code| format!("    return {}", code.print(11, 4));
    let mut functions = vec![format!(
        "# Check `offered`: each field is one of the offered values.\ndef _offered(facts):\n{}",
        returned(&outline.offered)
    )];
    for it in &outline.checks {
        let mut body = String::new();
        if let Some(when) = &it.when {
            let when = when.print(13, 4);
            let _ = write!(body, "    if not ({when}):\n        return True\n");
        }
        body.push_str(&returned(&it.holds));
        functions.push(format!(
            "# Check `{}`.\ndef _{}(facts):\n{body}",
            python_escaped(&it.check.name),
            it.function
        ));
    }
    functions.join("\n\n\n")
}

fn helpers(outline: &Outline<'_>) -> String {
    outline.called(|helper| helper.python).join("\n\n")
}

fn list(outline: &Outline<'_>, name: &str, is_asked: impl Fn(&Check) -> bool) -> String {
    let mut checks = String::new();
    for it in outline.checks.iter().filter(|it| is_asked(it.check)) {
        let _ = writeln!(
            checks,
            "    ({}, _{}),",
            python_text(&it.check.name),
            it.function
        );
    }
    format!("{name} = (\n    (\"offered\", _offered),\n{checks})")
}
