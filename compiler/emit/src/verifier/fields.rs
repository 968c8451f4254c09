//! The fields of the action: their identifiers and tables of choices.

use super::dialect::Dialect;
use super::layout::Code;
use super::names;
use crate::error::EmitError;
use fab_program::units::Dimension;
use fab_program::{ActionField, Choices, Program};

/// A field of the action, and its names in the code.
pub(super) struct Field<'p> {
    pub declared: &'p ActionField,
    /// The field of the action.
    pub identifier: String,
    /// The name of its table of choices.
    pub table: String,
    /// The rows of the table.
    pub rows: Vec<String>,
    /// One of its values.
    pub example: String,
}

/// Names the fields and writes their tables.
pub(super) fn fields<'p>(
    program: &'p Program,
    dialect: &Dialect,
) -> Result<Vec<Field<'p>>, EmitError> {
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

/// Writes the choices of a field, and one value of it.
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

/// Describes the choices of a field.
pub(super) fn table_words(choices: &Choices) -> String {
    match choices {
        Choices::Points { .. } => "the keypoints whose points it may be".to_owned(),
        Choices::Region { .. } => "the mask whose pixels it may be".to_owned(),
        Choices::Words { .. } => "the words that it may be".to_owned(),
        Choices::Directions { .. } => {
            "degrees, and the same as a vector, right and down".to_owned()
        }
        Choices::Lengths { unit, .. } => match unit.dimension {
            Dimension::Speed => format!("{}, and metres per second", unit.doc),
            _ => format!("{}, and metres", unit.doc),
        },
    }
}

/// Describes the value of a field.
pub(super) fn value_words(choices: &Choices) -> String {
    match choices {
        Choices::Points { .. } | Choices::Region { .. } => "a pixel".to_owned(),
        Choices::Directions { .. } => {
            "degrees counter-clockwise from the picture's right, below 360".to_owned()
        }
        Choices::Lengths { unit, .. } => unit.doc.to_owned(),
        Choices::Words { .. } => "a word".to_owned(),
    }
}
