//! The fields of the action: what each kind of choice is in the emitted code.

use super::dialect::Dialect;
use super::names;
use crate::error::EmitError;
use fab_program::units::Dimension;
use fab_program::{ActionField, Choices, Program};
use serde::Serialize;

/// A field of the action, as the templates write it.
#[derive(Serialize)]
pub(super) struct Field<'p> {
    #[serde(skip)]
    pub declared: &'p ActionField,
    /// Its name, escaped.
    name: String,
    /// The field of the action.
    pub identifier: String,
    /// The name of its table of choices.
    pub table: String,
    #[serde(flatten)]
    kind: Kind,
    /// Whether it is a direction, which the previous action must provide.
    is_direction: bool,
}

/// What a kind of choice is in the emitted code.
#[derive(Serialize)]
struct Kind {
    /// The type of a value.
    value_type: &'static str,
    /// What a value is.
    value_doc: &'static str,
    /// The type of a row of the table, in Rust.
    row_type: &'static str,
    /// What the table lists.
    table_doc: String,
    /// The rows of the table.
    rows: Vec<String>,
    /// One of the values.
    example: String,
}

/// Names the fields and writes their tables.
pub(super) fn fields<'p>(
    program: &'p Program,
    dialect: &Dialect,
) -> Result<Vec<Field<'p>>, EmitError> {
    let is_direction = |field: &ActionField| matches!(field.choices, Choices::Directions { .. });
    let identifiers = names::identifiers(program.actions.iter().map(|field| {
        let unit = if is_direction(field) { "_deg" } else { "" };
        format!("{}{unit}", field.name)
    }));
    // Tables are constants, so their names must differ in capitals too.
    let tables = identifiers
        .iter()
        .map(|name| format!("CHOICES_{}", name.to_ascii_uppercase()));
    let tables = names::identifiers(tables);
    let named = program.actions.iter().zip(identifiers).zip(tables);
    let field = |((declared, identifier), table): ((&'p ActionField, _), _)| {
        Ok(Field {
            declared,
            name: (dialect.escaped)(&declared.name),
            identifier,
            table,
            kind: kind(&declared.choices, dialect)?,
            is_direction: is_direction(declared),
        })
    };
    named.map(field).collect()
}

/// Writes what a kind of choice is in a language.
fn kind(choices: &Choices, dialect: &Dialect) -> Result<Kind, EmitError> {
    let texts = |texts: &[String]| texts.iter().map(|it| dialect.text(it)).collect();
    let pixel = |names: &[String], table_doc: &str| Kind {
        value_type: dialect.pixel_type,
        value_doc: "a pixel",
        row_type: "&str",
        table_doc: table_doc.to_owned(),
        rows: texts(names),
        example: dialect.pair("120", "40"),
    };
    Ok(match choices {
        Choices::Points { keypoints } => pixel(keypoints, "the keypoints whose points it may be"),
        Choices::Region { mask } => pixel(
            std::slice::from_ref(mask),
            "the mask whose pixels it may be",
        ),
        Choices::Words { choices } => {
            let rows: Vec<String> = texts(choices);
            Kind {
                value_type: dialect.word_type,
                value_doc: "a word",
                row_type: "&str",
                table_doc: "the words that it may be".to_owned(),
                example: rows.first().cloned().unwrap_or_default(),
                rows,
            }
        }
        Choices::Directions { choices } => {
            let row = |[right, down]: [f64; 2]| {
                Ok(dialect.pair(&names::number(right)?, &names::number(down)?))
            };
            let rows = choices.iter().map(|it| (it.deg, row(it.vector)));
            numbers(
                dialect,
                "degrees counter-clockwise from the picture's right, below 360",
                "(f64, [f64; 2])",
                "degrees, and the same as a vector, right and down".to_owned(),
                rows,
            )?
        }
        Choices::Lengths { unit, choices } => {
            let si = if unit.dimension == Dimension::Speed {
                "metres per second"
            } else {
                "metres"
            };
            let rows = choices.iter().map(|it| (it.value, names::number(it.m)));
            let table_doc = format!("{}, and {si}", unit.doc);
            numbers(dialect, unit.doc, "(f64, f64)", table_doc, rows)?
        }
    })
}

/// Writes a kind of choice whose values are numbers, each with its meaning.
fn numbers(
    dialect: &Dialect,
    value_doc: &'static str,
    row_type: &'static str,
    table_doc: String,
    choices: impl Iterator<Item = (f64, Result<String, EmitError>)>,
) -> Result<Kind, EmitError> {
    let mut rows = Vec::new();
    let mut example = None;
    for (value, meaning) in choices {
        let value = names::number(value)?;
        rows.push(format!("({value}, {})", meaning?));
        example.get_or_insert(value);
    }
    Ok(Kind {
        value_type: dialect.number_type,
        value_doc,
        row_type,
        table_doc,
        rows,
        example: example.unwrap_or_default(),
    })
}
