//! `verifier.rs` and `verifier.py`: the checks of a program as code of two languages.
//!
//! What they come to is defined by [`crate::verify`] and [`fab_program::eval`]; the code does the same additions,
//! multiplications and comparisons in the same order, evaluates the parts of a condition until it is decided, and finds the
//! same keypoints missing. Only a direction of the action before this one that is none of the offered ones
//! differs: it is missing here, since turning it into a vector would need trigonometry.

mod expression;
mod layout;
mod names;
mod python;
mod python_helpers;
mod rust;
mod rust_helpers;

use super::EmitError;
use expression::{Dialect, Lowering};
use fab_program::{ActionField, Check, Choices, Program};
use layout::Code;
use std::collections::BTreeSet;

/// Writes the Rust module.
pub(super) fn rust(program: &Program) -> Result<String, EmitError> {
    Ok(rust::module(&Outline::of(program, &rust::DIALECT)?))
}

/// Writes the Python module.
pub(super) fn python(program: &Program) -> Result<String, EmitError> {
    Ok(python::module(&Outline::of(program, &python::DIALECT)?))
}

/// A verifier, in the words of one language but not yet in its form.
struct Outline<'p> {
    program: &'p Program,
    fields: Vec<Field<'p>>,
    /// Whether each field is one of the offered values.
    offered: Code,
    checks: Vec<CheckOutline<'p>>,
    /// Names of the helper functions that the code calls.
    helpers: BTreeSet<&'static str>,
}

/// A field of the action and what it is called in the code.
struct Field<'p> {
    declared: &'p ActionField,
    /// The field of the action.
    identifier: String,
    /// The table of what it may be.
    table: String,
    /// The rows of the table.
    rows: Vec<String>,
    /// A value that it may have.
    example: String,
}

/// One check.
struct CheckOutline<'p> {
    check: &'p Check,
    /// The function that asks it.
    function: String,
    when: Option<Code>,
    holds: Code,
}

impl<'p> Outline<'p> {
    /// Returns the texts of the helper functions that the code calls.
    fn called(&self, table: &[(&str, &'static str)]) -> Vec<&'static str> {
        let is_called = |(name, _): &&(&str, &'static str)| self.helpers.contains(name);
        table
            .iter()
            .filter(is_called)
            .map(|(_, text)| *text)
            .collect()
    }

    fn of(program: &'p Program, dialect: &'static Dialect) -> Result<Outline<'p>, EmitError> {
        let fields = fields(program, dialect)?;
        let mut lowering = Lowering {
            dialect,
            fields: &fields,
            helpers: BTreeSet::new(),
        };
        let offered = lowering.offered();
        let functions = names::identifiers(
            program
                .verify
                .checks
                .iter()
                .map(|check| format!("check_{}", check.name)),
        );
        let mut checks = Vec::with_capacity(functions.len());
        for (check, function) in program.verify.checks.iter().zip(functions) {
            checks.push(CheckOutline {
                check,
                function,
                when: check
                    .when
                    .as_ref()
                    .map(|when| lowering.condition(when))
                    .transpose()?,
                holds: lowering.condition(&check.holds)?,
            });
        }
        let helpers = with_dependencies(lowering.helpers);
        Ok(Outline {
            program,
            fields,
            offered,
            checks,
            helpers,
        })
    }

    /// Returns whether a check is asked where the task's `then without` is in force.
    fn is_kept(&self, check: &Check) -> bool {
        !self.program.verify.relaxed.contains(&check.name)
    }

    /// Names the checks that are left out where the task's `then without` is in force.
    fn left_out(&self, escaped: impl Fn(&str) -> String) -> String {
        let names: Vec<String> = self
            .checks
            .iter()
            .filter(|it| !self.is_kept(it.check))
            .map(|it| format!("`{}`", escaped(&it.check.name)))
            .collect();
        if names.is_empty() {
            "this task leaves out none".to_owned()
        } else {
            format!("without {}", names.join(", "))
        }
    }

    /// Writes the values of an action, as an example.
    fn example(&self, between: &str) -> String {
        let values: Vec<String> = self
            .fields
            .iter()
            .map(|field| format!("{}{between}{}", field.identifier, field.example))
            .collect();
        values.join(", ")
    }

    /// Returns the fields that are directions, which the action before this one is asked for.
    fn directions(&self) -> impl Iterator<Item = &Field<'p>> {
        let is_direction =
            |field: &&Field<'p>| matches!(field.declared.choices, Choices::Directions { .. });
        self.fields.iter().filter(is_direction)
    }
}

fn fields<'p>(program: &'p Program, dialect: &Dialect) -> Result<Vec<Field<'p>>, EmitError> {
    let identifiers = names::identifiers(program.actions.iter().map(|field| {
        let unit = match field.choices {
            Choices::Directions { .. } => "_deg",
            _ => "",
        };
        format!("{}{unit}", field.name)
    }));
    // Tables are constants, so their names must differ in capitals too.
    let tables = names::identifiers(
        identifiers
            .iter()
            .map(|name| format!("CHOICES_{}", name.to_ascii_uppercase())),
    );
    let mut fields = Vec::with_capacity(identifiers.len());
    for ((declared, identifier), table) in program.actions.iter().zip(identifiers).zip(tables) {
        let (rows, example) = rows(&declared.choices, dialect)?;
        fields.push(Field {
            declared,
            identifier,
            table,
            rows,
            example,
        });
    }
    Ok(fields)
}

/// Writes what a field may be, and one value of it.
fn rows(choices: &Choices, dialect: &Dialect) -> Result<(Vec<String>, String), EmitError> {
    let texts = |texts: &[String]| texts.iter().map(|it| (dialect.text)(it)).collect();
    let mut rows: Vec<String> = Vec::new();
    let mut example = None;
    match choices {
        Choices::Points { .. } | Choices::Region { .. } => {
            let pixel = Code::group(
                dialect.pair[0],
                ["120", "40"].map(Code::text),
                dialect.pair[1],
            );
            let names = match choices {
                Choices::Points { keypoints } => texts(keypoints),
                Choices::Region { mask } => texts(std::slice::from_ref(mask)),
                _ => Vec::new(),
            };
            return Ok((names, pixel.print(0, 0)));
        }
        Choices::Words { choices } => {
            rows = texts(choices);
            example = rows.first().cloned();
        }
        Choices::Directions { choices } => {
            let [open, close] = dialect.pair;
            for choice in choices {
                let deg = names::number(choice.deg)?;
                let [right, down] = choice.vector.map(names::number);
                rows.push(format!("({deg}, {open}{}, {}{close})", right?, down?));
                example.get_or_insert(deg);
            }
        }
        Choices::Lengths { choices, .. } => {
            for choice in choices {
                let value = names::number(choice.value)?;
                rows.push(format!("({value}, {})", names::number(choice.m)?));
                example.get_or_insert(value);
            }
        }
    }
    Ok((rows, example.unwrap_or_default()))
}

/// Says what a field may be.
fn table_words(choices: &Choices) -> String {
    match choices {
        Choices::Points { .. } => "the keypoints whose points it may be".to_owned(),
        Choices::Region { .. } => "the mask whose pixels it may be".to_owned(),
        Choices::Words { .. } => "the words that it may be".to_owned(),
        Choices::Directions { .. } => {
            "degrees, and the same as a vector, right and down".to_owned()
        }
        Choices::Lengths { unit, .. } => format!("{}, and metres", unit.doc),
    }
}

/// Says what the value of a field is.
fn value_words(choices: &Choices) -> String {
    match choices {
        Choices::Points { .. } | Choices::Region { .. } => "a pixel".to_owned(),
        Choices::Directions { .. } => {
            "degrees counter-clockwise from the picture's right, below 360".to_owned()
        }
        Choices::Lengths { unit, .. } => unit.doc.to_owned(),
        Choices::Words { .. } => "a word".to_owned(),
    }
}

/// Which helpers call which, callers first. `points` and `pixel` are Python's alone.
const CALLS: [(&str, &[&str]); 10] = [
    ("is_point", &["points", "pixel"]),
    ("is_inside", &["pixel"]),
    ("keypoint", &["points", "at"]),
    ("count", &["points"]),
    ("at", &["pixel"]),
    ("angle_less", &["angle_sides"]),
    ("angle_at_most", &["angle_sides"]),
    ("angle_greater", &["angle_sides"]),
    ("angle_at_least", &["angle_sides"]),
    ("distance_px", &["whole"]),
];

fn with_dependencies(mut helpers: BTreeSet<&'static str>) -> BTreeSet<&'static str> {
    for (helper, calls) in CALLS {
        if helpers.contains(helper) {
            helpers.extend(calls);
        }
    }
    helpers
}
