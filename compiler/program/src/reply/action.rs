//! Reads an action: one value for each field.
//!
//! For each field, an answer states a set of values. One value is read. None, two different ones, or one that cannot be
//! read are refused, and the message names what was found. No correction is interpreted.

use super::aside::{self, Standing, standing};
use super::claim::{Claim, Claimed, Reader};
use super::data;
use super::names::Names;
use super::phrases;
use super::point;
use super::reading::{Malformed, Reading, Stated, bounded, quoted, with_marks};
use super::statements;
use super::structured;
use crate::data::actions::{ActionField, Proposal, Value};
use crate::data::program::Program;
use crate::pointing::{Notation, Pointing};
use crate::space;
use std::ops::Range;

/// Reads every field of the action, with points in pixels of the camera's picture.
///
/// Fails if a field is missing, unreadable or has two different values, or if the answer is longer than
/// [`super::MAX_REPLY_BYTES`].
pub fn read_action(program: &Program, reply: &str) -> Result<Reading<Proposal>, Malformed> {
    read_action_in(program, &Notation::pixels_of(&program.camera), reply)
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
    let standing = standing(reply);
    let reader = Reader {
        fields: actions,
        names: Names::of(actions),
        edge_m,
        notation,
    };
    if let Some(reading) = structured(&reader, reply, &standing) {
        return Ok(reading);
    }
    let claims = claims(&reader, &standing.text);
    let refused = |field: &ActionField, why: &str, stated| Malformed {
        field: field.name.clone(),
        message: complaint(why, actions, field, notation),
        stated,
    };
    if let (true, Some(first)) = (standing.is_cut_off, actions.first()) {
        let why = "Your answer ends inside of its thoughts.";
        return Err(refused(first, why, Vec::new()));
    }
    let mut proposal = Proposal::default();
    let (mut repairs, mut stated, mut wrong) = (Vec::new(), Vec::new(), None);
    for (index, declared) in actions.iter().enumerate() {
        let field = Field {
            declared,
            reply,
            notation,
        };
        let own = claims.iter().filter(|claim| claim.field == index);
        match field.value(&own.collect::<Vec<_>>()) {
            Ok((value, span, own)) => {
                stated.push(Stated::new(&declared.name, reply, span, &own));
                repairs.extend(own);
                proposal.fields.push((declared.name.clone(), value));
            }
            Err(why) => {
                wrong.get_or_insert((declared, why));
            }
        }
    }
    // An offered word may be such a phrase.
    let is_word = |it: &&Claim| matches!(it.claimed, Claimed::Value(Value::Word(_), _));
    let values = claims.iter().filter(is_word).map(|it| it.span.clone());
    let said = phrases::unusable(&aside::blanked(&standing.text, values));
    // In other frames, coordinates are.
    let said = said.filter(|said| *said != "normalized" || notation.is_native());
    let unusable = said.and_then(|said| {
        let why = format!("Your answer cannot be used: it says `{said}`.");
        Some((actions.first()?, why))
    });
    match wrong.or(unusable) {
        Some((declared, why)) => Err(refused(declared, &why, stated)),
        None => Ok(Reading {
            value: proposal,
            repairs,
            stated,
            asides: standing.asides,
        }),
    }
}

/// Reads an answer to the schema, in which each value is exactly as the schema writes it.
fn structured(reader: &Reader<'_>, reply: &str, standing: &Standing) -> Option<Reading<Proposal>> {
    let keys: Vec<&str> = reader.fields.iter().map(|it| it.name.as_str()).collect();
    let rest = if standing.is_cut_off {
        reply
    } else {
        &standing.text
    };
    let members = structured::members(reply, &keys);
    let members = members.or_else(|| structured::members(rest, &keys))?;
    let mut proposal = Proposal::default();
    let mut stated = Vec::new();
    for (index, member) in members.iter().enumerate() {
        let Claimed::Value(value, _) = statements::whole(reader, index, &member.text) else {
            return None;
        };
        let field = &reader.fields[index];
        if member.text != reader.notation.stated_value(field, &value) {
            return None;
        }
        let span = member.span.clone();
        stated.push(Stated::new(&field.name, reply, span, &[]));
        proposal.fields.push((field.name.clone(), value));
    }
    Some(Reading {
        value: proposal,
        repairs: Vec::new(),
        stated,
        asides: standing.asides.clone(),
    })
}

/// Returns everything that an answer states, in order.
fn claims(reader: &Reader<'_>, text: &str) -> Vec<Claim> {
    let mut claims = Vec::new();
    let objects = data::objects(reader, text, &mut claims);
    let text = aside::blanked(text, objects);
    let tables = data::tables(reader, &text, &mut claims);
    let text = aside::blanked(&text, tables);
    claims.extend(statements::statements(reader, &text));
    claims.sort_by_key(|claim| claim.span.start);
    claims
}

/// A field, and the answer that states it.
struct Field<'a> {
    declared: &'a ActionField,
    reply: &'a str,
    notation: &'a Notation,
}

/// A value, how it was read if that is not obvious, and where it stands.
type Found<'a> = (Value, Option<&'a String>, Range<usize>);

impl Field<'_> {
    /// Returns the one value that an answer states, where, and how it deviates from the asked form.
    fn value(&self, claims: &[&Claim]) -> Result<(Value, Range<usize>, Vec<String>), String> {
        let noun = noun(self.declared);
        let text = |claim: &Claim| quoted(self.reply.get(claim.span.clone()).unwrap_or_default());
        let find = |is: fn(&Claimed) -> bool| claims.iter().find(|claim| is(&claim.claimed));
        if let Some(claim) = find(|it| matches!(it, Claimed::Unreadable)) {
            return Err(format!(
                "The {noun} of your answer cannot be read: `{}`.",
                text(claim)
            ));
        }
        let is_own = claims
            .iter()
            .any(|claim| claim.is_own && !matches!(claim.claimed, Claimed::Vague));
        let mut found: Vec<Found<'_>> = claims
            .iter()
            .filter_map(|claim| match &claim.claimed {
                Claimed::Value(value, note) => {
                    Some((value.clone(), note.as_ref(), claim.span.clone()))
                }
                _ => None,
            })
            .collect();
        found.extend(self.joined(claims)?);
        let Some((value, note, span)) = found.first().filter(|_| is_own) else {
            return Err(match find(|it| matches!(it, Claimed::Vague)) {
                Some(claim) => format!(
                    "Your answer states no {noun} that can be read: `{}`.",
                    text(claim)
                ),
                None => format!("Your answer states no {noun}."),
            });
        };
        let written = self.notation.stated_value(self.declared, value);
        if let Some((other, ..)) = found.iter().find(|(other, ..)| other != value) {
            let values = match self.declared.is_point() {
                true => format!("{noun}s"),
                false => format!("values for the {noun}"),
            };
            return Err(format!(
                "Your answer states two different {values}, {written} and {}. State only the one that you choose.",
                self.notation.stated_value(self.declared, other)
            ));
        }
        let said = &self.reply[with_marks(self.reply, span.clone())];
        let repair = match note {
            Some(note) => Some(format!("{}: {note}", self.declared.name)),
            None if self.reply[span.clone()] == space::statement(self.declared, &written) => None,
            None => Some(format!("read `{}` as the {noun} {written}", quoted(said))),
        };
        Ok((value.clone(), span.clone(), repair.into_iter().collect()))
    }

    /// Joins the coordinates of a point that are stated apart: `pick_x = 10`, `pick_y = 20`.
    fn joined(&self, claims: &[&Claim]) -> Result<Option<Found<'_>>, String> {
        let of = |wanted: char| -> Vec<(f64, &Range<usize>)> {
            let own = claims.iter().filter(|claim| claim.is_own);
            own.filter_map(|claim| match claim.claimed {
                Claimed::Axis(axis, value) if axis == wanted => Some((value, &claim.span)),
                _ => None,
            })
            .collect()
        };
        let is_one = |axis: &[(f64, &Range<usize>)]| axis.iter().all(|it| it.0 == axis[0].0);
        match (&of('x')[..], &of('y')[..]) {
            ([], []) => Ok(None),
            (xs @ [x, ..], ys @ [y, ..])
                if is_one(xs) && is_one(ys) && !self.notation.is_of_marks() =>
            {
                let span = x.1.start.min(y.1.start)..x.1.end.max(y.1.end);
                let point = point::at(x.0, y.0, self.notation);
                Ok(point.map(|(point, _)| (Value::Point(point), None, span)))
            }
            _ => Err(format!(
                "The coordinates of your answer's {} are not one point.",
                noun(self.declared)
            )),
        }
    }
}

/// Returns a field's name in messages: `pick point`, `direction`.
fn noun(field: &ActionField) -> String {
    let name = space::spoken(field);
    match field.is_point() {
        true => format!("{name} point"),
        false => name,
    }
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
    let mut with = Vec::new();
    with.extend((n_points > 0).then_some(points));
    with.extend((n_points < actions.len()).then_some("one of the values between the bars"));
    let with = with.join(" and ");
    let counted = if notation.is_native() || n_points == 0 {
        String::new()
    } else {
        format!(" A point is written {}.", pointing.phrase())
    };
    format!(
        "{why}{choose}{counted} Answer again and state the action in exactly this format, with {with}:\n{}",
        space::format_with(pointing.form(), actions)
    )
}
