//! The Rust module; it needs only `core` and does not allocate.

use super::dialect::Dialect;
use super::fields;
use super::layout::Code;
use super::names::rust_text;
use super::outline::Outline;
use fab_program::{Check, Choices};
use std::fmt::Write;

pub(super) const DIALECT: Dialect = Dialect {
    private: "",
    may_miss: "?",
    pair: ["[", "]"],
    not: ["!(", ")"],
    and: "&&",
    or: "||",
    has_last: "facts.last.is_some()",
    step: "f64::from(facts.step)",
    text: rust_text,
};

/// Writes the module.
pub(super) fn module(outline: &Outline<'_>) -> String {
    let parts = [
        header(outline),
        TYPES.to_owned(),
        action_and_last(outline),
        entry(outline, "verify", ENTRY_DOC, |_| true),
        entry(outline, "verify_relaxed", &relaxed_doc(outline), |check| {
            outline.is_kept(check)
        }),
        tables(outline),
        checks(outline),
        helpers(outline),
    ];
    let parts: Vec<&str> = parts.iter().map(|part| part.trim_end()).collect();
    parts.join("\n\n") + "\n"
}

fn header(outline: &Outline<'_>) -> String {
    let title = outline.program.title().escape_default().to_string();
    let example = outline.example(": ");
    format!(
        "\
//! Verifier of the task `{title}`: says which proposed actions may run.
//!
//! Made by fabc {compiler} from the program {hash}; make it again instead of editing it.
//! It needs `core` alone, allocates nothing and never panics. Implement [`Scene`] for what the camera
//! shows, and judge each action that a model proposes:
//!
//! ```ignore
//! let action = Action {{ {example} }};
//! match verify(&scene, 1, None, &action) {{
//!     Ok(()) => {{}} // it may run
//!     Err(Refusal::Check(name)) => {{}} // the first check that fails; ask the model again
//!     Err(Refusal::Missing(name)) => {{}} // the scene lacks what a check needs
//! }}
//! ```
//!
//! Points are pixels of the task's camera picture, `[column, row]` from the top left.
// Nobody calls all of it, and the names and numbers are the task's own.
#![allow(dead_code, non_snake_case, unused_parens, clippy::all)]",
        compiler = outline.program.compiler.escape_default(),
        hash = outline.program.hash(),
    )
}

const TYPES: &str = "\
/// What the camera shows.
pub trait Scene {
    /// Returns the points of a keypoint, one for a point; `None` for a name without points.
    fn points(&self, keypoint: &str) -> Option<&[[i32; 2]]>;

    /// Returns the distance from `point` to the nearest pixel of a mask or box, pixels, 0 in it; `None`
    /// for an unknown name or an empty mask.
    fn distance_px(&self, region: &str, point: [i32; 2]) -> Option<f64>;

    /// Returns the number of a mask's pixels; `None` for an unknown name.
    fn area_px(&self, mask: &str) -> Option<f64>;
}

/// Why an action may not run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The first check that fails; `offered` where a field is none of the offered values.
    Check(&'static str),
    /// A check needs this keypoint, this mask or the action before this one, and it is not there.
    Missing(&'static str),
}";

const ENTRY_DOC: &str = "\
/// Judges an action: whether its fields were offered, then the task's checks in order.
///
/// - `step`: which step of the rollout this is, from 1.
/// - `last`: the action before this one, where there is one.";

fn relaxed_doc(outline: &Outline<'_>) -> String {
    let left_out = outline.left_out(|name| name.escape_default().to_string());
    format!("/// Judges an action less strictly, for when no answer passed [`verify`]: {left_out}.")
}

/// Returns the lifetime that an action with words needs.
fn lifetime(outline: &Outline<'_>, name: &str) -> String {
    let has_words = outline
        .fields
        .iter()
        .any(|field| matches!(field.declared.choices, Choices::Words { .. }));
    if has_words {
        format!("<'{name}>")
    } else {
        String::new()
    }
}

fn action_and_last(outline: &Outline<'_>) -> String {
    let mut action = String::new();
    for field in &outline.fields {
        let name = field.declared.name.escape_default();
        let what = fields::value_words(&field.declared.choices);
        let kind = match &field.declared.choices {
            Choices::Points { .. } | Choices::Region { .. } => "[i32; 2]",
            Choices::Directions { .. } | Choices::Lengths { .. } => "f64",
            Choices::Words { .. } => "&'a str",
        };
        let _ = write!(
            action,
            "    /// Field `{name}`: {what}.\n    pub {}: {kind},\n",
            field.identifier
        );
    }
    let mut last = String::new();
    for field in outline.directions() {
        let _ = write!(
            last,
            "    /// Its {}, degrees; one of the offered ones, else it counts as missing.\n    pub {}: f64,\n",
            field.declared.name.escape_default(),
            field.identifier
        );
    }
    format!(
        "\
/// A proposed action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Action{lifetime} {{
{action}}}

/// The action before this one, as it was carried out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Last {{
    /// The pixel that was picked.
    pub pick: [i32; 2],
    /// The pixel that it was placed on.
    pub place: [i32; 2],
{last}}}

/// What is known when an action is judged; a task need not ask for all of it.
#[allow(dead_code)]
struct Facts<'a> {{
    scene: &'a dyn Scene,
    step: u32,
    last: Option<&'a Last>,
    action: &'a Action{lifetime},
}}

/// A check's name, and whether it holds.
type Check = (&'static str, fn(&Facts<'_>) -> Result<bool, Refusal>);

fn first_failing(facts: &Facts<'_>, checks: &[Check]) -> Result<(), Refusal> {{
    for (name, holds) in checks {{
        if !holds(facts)? {{
            return Err(Refusal::Check(*name));
        }}
    }}
    Ok(())
}}",
        lifetime = lifetime(outline, "a"),
    )
}

fn entry(
    outline: &Outline<'_>,
    function: &str,
    doc: &str,
    is_asked: impl Fn(&Check) -> bool,
) -> String {
    let mut checks = String::new();
    for it in outline.checks.iter().filter(|it| is_asked(it.check)) {
        let name = rust_text(&it.check.name);
        let _ = writeln!(checks, "        ({name}, {}),", it.function);
    }
    format!(
        "\
{doc}
pub fn {function}(
    scene: &dyn Scene,
    step: u32,
    last: Option<&Last>,
    action: &Action{lifetime},
) -> Result<(), Refusal> {{
    let checks: &[Check] = &[
        (\"offered\", offered),
{checks}    ];
    let facts = Facts {{
        scene,
        step,
        last,
        action,
    }};
    first_failing(&facts, checks)
}}",
        lifetime = lifetime(outline, "_"),
    )
}

fn tables(outline: &Outline<'_>) -> String {
    let mut tables = Vec::new();
    for field in &outline.fields {
        let kind = match &field.declared.choices {
            Choices::Points { .. } | Choices::Region { .. } | Choices::Words { .. } => "&str",
            Choices::Directions { .. } => "(f64, [f64; 2])",
            Choices::Lengths { .. } => "(f64, f64)",
        };
        let rows: String = field
            .rows
            .iter()
            .map(|row| format!("    {row},\n"))
            .collect();
        tables.push(format!(
            "/// Field `{}`: {}.\nconst {}: &[{kind}] = &[\n{rows}];",
            field.declared.name.escape_default(),
            fields::table_words(&field.declared.choices),
            field.table
        ));
    }
    tables.join("\n\n")
}

fn checks(outline: &Outline<'_>) -> String {
    let function = |doc: String, name: &str, body: String| {
        let facts = if body.contains("facts") {
            "facts"
        } else {
            "_facts"
        };
        format!("{doc}\nfn {name}({facts}: &Facts<'_>) -> Result<bool, Refusal> {{\n{body}}}")
    };
    let ok = |code: &Code| format!("    Ok({})\n", code.print(8, 4));
    let mut functions = vec![function(
        "/// Check `offered`: each field is one of the offered values.".to_owned(),
        "offered",
        ok(&outline.offered),
    )];
    for it in &outline.checks {
        let mut body = String::new();
        if let Some(when) = &it.when {
            let when = when.print(10, 4);
            let _ = write!(
                body,
                "    if !({when}) {{\n        return Ok(true);\n    }}\n"
            );
        }
        body.push_str(&ok(&it.holds));
        let doc = format!("/// Check `{}`.", it.check.name.escape_default());
        functions.push(function(doc, &it.function, body));
    }
    functions.join("\n\n")
}

fn helpers(outline: &Outline<'_>) -> String {
    outline.called(|helper| helper.rust).join("\n")
}
