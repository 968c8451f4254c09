//! Reads an action: one value for each field.
//!
//! An answer is searched for statements such as `Pick Point = (x, y)`, the requested format. Other forms are
//! understood too: Markdown, JSON, other brackets, words in between. Statements differ in how firm they are. Loose
//! ones count only if there is no firmer one, and all that count must agree.

use super::finding::Clarity;
use super::names::{Mention, named};
use super::reading::{Malformed, Reading, bounded, quoted};
use super::statement::{Scale, Statement, statement_at};
use crate::data::actions::Proposal;
use crate::data::actions::{ActionField, Value};
use crate::data::program::Program;
use crate::pointing::{Notation, Pointing};
use crate::space;

/// Reads every field of the action, with points in pixels of the camera's picture.
///
/// Fails if a field is missing or has two different values, or if the answer is longer than
/// [`super::MAX_REPLY_BYTES`].
pub fn read_action(program: &Program, reply: &str) -> Result<Reading<Proposal>, Malformed> {
    read_action_in(program, &Notation::pixels(), reply)
}

/// Reads every field of the action, with points written as in this scene.
///
/// Fails as [`read_action`] does.
pub fn read_action_in(
    program: &Program,
    notation: &Notation,
    reply: &str,
) -> Result<Reading<Proposal>, Malformed> {
    read_fields(&program.actions, program.cloth.edge_m(), notation, reply)
}

/// Reads every field of an action, as [`read_action_in`] does; `edge_m` is the cloth's longer side, metres.
pub fn read_fields(
    actions: &[ActionField],
    edge_m: f64,
    notation: &Notation,
    reply: &str,
) -> Result<Reading<Proposal>, Malformed> {
    bounded("action", reply)?;
    let places = named(actions, reply);
    let mut proposal = Proposal {
        fields: Vec::with_capacity(actions.len()),
    };
    let mut repairs = Vec::new();
    for (declared, places) in actions.iter().zip(&places) {
        let scale = Scale { edge_m, notation };
        let found = field(scale, declared, reply, places).map_err(|why| Malformed {
            field: declared.name.clone(),
            message: complaint(&why, actions, declared, notation),
        })?;
        repairs.extend(found.repairs);
        proposal.fields.push((declared.name.clone(), found.value));
    }
    Ok(Reading {
        value: proposal,
        repairs,
    })
}

fn complaint(
    why: &str,
    actions: &[ActionField],
    field: &ActionField,
    notation: &Notation,
) -> String {
    let choose = if field.is_point() {
        String::new()
    } else {
        format!(
            " Choose one of these: {}.",
            notation.shortened(field, &space::declared(field))
        )
    };
    let n_points = actions.iter().filter(|field| field.is_point()).count();
    let pointing = notation.pointing();
    let points = match pointing {
        Pointing::Frame(_) => "numbers for x and y",
        Pointing::Marks(_) => "the number of a listed point",
    };
    let with = if n_points == actions.len() {
        format!(", with {points}")
    } else if n_points > 0 {
        format!(", with {points} and one of the values between the bars")
    } else {
        ", with one of the values between the bars".to_owned()
    };
    let counted = if notation.is_native() || n_points == 0 {
        String::new()
    } else {
        format!(" A point is written {}.", pointing.phrase())
    };
    format!(
        "{why}{choose}{counted} Answer again and state the action in exactly this format{with}:\n{}",
        space::format_with(pointing.form(), actions)
    )
}

fn field(
    scale: Scale<'_>,
    declared: &ActionField,
    reply: &str,
    places: &[Mention],
) -> Result<Reading<Value>, String> {
    let noun = noun(declared);
    let mut statements: Vec<Statement<'_>> = Vec::new();
    let mut bad: Option<String> = None;
    for named in places {
        match statement_at(scale, declared, reply, *named) {
            Some(Ok(statement)) => statements.push(statement),
            Some(Err(why)) => {
                bad.get_or_insert(why);
            }
            None => {}
        }
    }
    // A firm statement that cannot be used casts doubt on the loose ones too.
    let is_firm = |statement: &Statement<'_>| statement.firmness > Clarity::Loose;
    if bad.is_some() || statements.iter().any(is_firm) {
        statements.retain(is_firm);
    }
    statements.sort_by_key(|statement| std::cmp::Reverse(statement.firmness));
    let Some(first) = statements.first() else {
        return Err(match bad {
            Some(why) => format!("The {noun} of your answer cannot be used: {why}."),
            None => format!("Your answer states no {noun}."),
        });
    };
    let notation = scale.notation;
    let written = notation.stated_value(declared, &first.value);
    if let Some(other) = statements
        .iter()
        .find(|statement| statement.value != first.value)
    {
        return Err(format!(
            "Your answer states two different {}, {written} and {}. State only the one that you choose.",
            plural(declared),
            notation.stated_value(declared, &other.value)
        ));
    }
    let mut repairs = Vec::new();
    if let (Value::Point(_), Some(taken)) = (&first.value, &first.note) {
        repairs.push(format!("{}: {taken}", declared.name));
    } else if first.text != space::statement(declared, &written) {
        let taking = first.note.as_ref().map(|note| format!(", taking {note}"));
        repairs.push(format!(
            "read `{}` as the {noun} {written}{}",
            quoted(first.text),
            taking.unwrap_or_default()
        ));
    }
    Ok(Reading {
        value: first.value.clone(),
        repairs,
    })
}

/// Returns the noun for a field's value in a sentence.
fn noun(field: &ActionField) -> String {
    let name = space::spoken(field);
    if field.is_point() {
        format!("{name} point")
    } else {
        name
    }
}

fn plural(field: &ActionField) -> String {
    let name = space::spoken(field);
    if field.is_point() {
        format!("{name} points")
    } else {
        format!("values for the {name}")
    }
}
