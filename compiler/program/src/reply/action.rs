//! Reads an action: one value for each field.
//!
//! For each field, an answer states a set of values. One value is read. None, or two different ones, are refused, and
//! the message names both. What an answer takes back, with words such as `no wait`, counts only if nothing replaces it.

use super::chosen;
use super::claim::{Claim, Claimed};
use super::claims::{self, Claims};
use super::corners;
use super::point::{self, PointFound};
use super::reading::{Malformed, Reading, Stated, bounded, quoted, with_marks};
use super::sentences::Reader;
use super::words;
use crate::data::actions::Proposal;
use crate::data::actions::{ActionField, Choices, Value};
use crate::data::program::Program;
use crate::pointing::{Notation, Pointing};
use crate::space;
use std::ops::Range;

/// Reads every field of the action, with points in pixels of the camera's picture.
///
/// Fails if a field is missing or has two different values, or if the answer is longer than
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
    let reader = Reader {
        fields: actions,
        edge_m,
        notation,
    };
    let found = claims::of(&reader, reply);
    let mut proposal = Proposal {
        fields: Vec::with_capacity(actions.len()),
    };
    let (mut repairs, mut stated, mut unreadable) = (Vec::new(), Vec::new(), None);
    for (index, declared) in actions.iter().enumerate() {
        let field = Field {
            index,
            declared,
            reply,
            notation,
        };
        let taken = match field.value(&found) {
            Ok(taken) => taken,
            Err(why) => {
                unreadable.get_or_insert((declared, why));
                continue;
            }
        };
        repairs.extend(taken.repairs.iter().cloned());
        stated.push(Stated::new(
            &declared.name,
            reply,
            taken.span,
            taken.repairs,
        ));
        proposal.fields.push((declared.name.clone(), taken.value));
    }
    if let Some((declared, why)) =
        unreadable.or_else(|| contradicted(actions, &found, &proposal, reply, notation))
    {
        return Err(Malformed {
            field: declared.name.clone(),
            message: complaint(&why, actions, declared, notation),
            stated,
        });
    }
    if let (Some(why), Some(first)) = (found.doubt, actions.first()) {
        let why = format!("Your answer cannot be used: {why}.");
        return Err(Malformed {
            field: first.name.clone(),
            message: complaint(&why, actions, first, notation),
            stated,
        });
    }
    Ok(Reading {
        value: proposal,
        repairs,
        stated,
        asides: found.cleared.asides,
    })
}

/// Returns the point that is on the other side of the other point than all the words for it.
fn contradicted<'a>(
    actions: &'a [ActionField],
    found: &Claims,
    proposal: &Proposal,
    reply: &str,
    notation: &Notation,
) -> Option<(&'a ActionField, String)> {
    let ends = [("pick", "place"), ("place", "pick")];
    ends.into_iter().find_map(|(name, other)| {
        let index = actions.iter().position(|field| field.name == name)?;
        let (own, other) = (proposal.get(name)?, proposal.get(other)?);
        let mut sides = found.claims.iter().filter_map(|claim| match claim.claimed {
            Claimed::Side(deg) if claim.field == index => Some((deg, claim)),
            _ => None,
        });
        let first = sides.clone().next()?.1;
        if !sides.all(|(deg, _)| corners::contradicts(deg, own, other)) {
            return None;
        }
        let declared = &actions[index];
        let why = format!(
            "Your answer says `{}`, but its {} {} is not there, seen from its {}.",
            quoted(reply.get(first.span.clone()).unwrap_or_default()),
            noun(declared),
            notation.stated_value(declared, own),
            notation.stated_value(declared, other)
        );
        Some((declared, why))
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

/// A field, and the answer that states it.
struct Field<'a> {
    index: usize,
    declared: &'a ActionField,
    reply: &'a str,
    notation: &'a Notation,
}

/// The value of a field.
struct Taken {
    value: Value,
    span: Range<usize>,
    repairs: Vec<String>,
}

/// A value, how it was read if that is not obvious, and where it stands.
type Statement = (Value, Option<String>, Range<usize>);

impl Field<'_> {
    /// Returns the one value that an answer states.
    fn value(&self, found: &Claims) -> Result<Taken, String> {
        let noun = noun(self.declared);
        let mut claims: Vec<&Claim> = found
            .claims
            .iter()
            .filter(|claim| claim.field == self.index)
            .collect();
        let mut repairs = Vec::new();
        if !self.agree(&claims)
            && let Some(turn) = found
                .turns
                .iter()
                .rev()
                .find(|turn| claims.last().is_some_and(|claim| claim.span.start > **turn))
            && claims[0].span.start < *turn
        {
            claims.retain(|claim| claim.span.start > *turn);
            repairs.push(format!("left out the {noun} that the answer takes back"));
        }
        if let Some(exact) = claims.iter().rposition(|claim| self.is_exact(claim)) {
            // `Grip: between soft and firm I was undecided`, above the value in the asked form.
            let n_claims = claims.len();
            let mut at = 0;
            claims.retain(|claim| {
                at += 1;
                at > exact || !claim.claimed.is_unclear()
            });
            if claims.len() < n_claims {
                repairs.push(format!(
                    "left out what is not clear above the {noun} in the asked form"
                ));
            }
        }
        if let Some(why) = claims.iter().find_map(|claim| match &claim.claimed {
            Claimed::Bad(why) | Claimed::Unclear(why) => Some(why.as_str()),
            Claimed::Torn => Some("its words and its angle differ"),
            _ => None,
        }) {
            return Err(format!("The {noun} of your answer cannot be used: {why}."));
        }
        if found.cleared.is_cut_off {
            return Err(format!(
                "Your answer ends inside of its thoughts, so that its {noun} is missing."
            ));
        }
        let stated = self.stated(&claims)?;
        let stated = match stated.is_empty() {
            true => self.course(&claims),
            false => stated,
        };
        let prose = claims.iter().find_map(|claim| match &claim.claimed {
            Claimed::Prose(why, named) => {
                let tells = |(value, ..): &Statement| named.iter().all(|it| it.may_mean(value));
                (stated.is_empty() || !stated.iter().all(tells)).then_some(why)
            }
            _ => None,
        });
        if let Some(why) = prose {
            return Err(format!("The {noun} of your answer cannot be used: {why}."));
        }
        let Some((value, note, span)) = stated.first() else {
            return Err(format!("Your answer states no {noun}."));
        };
        let written = self.notation.stated_value(self.declared, value);
        if let Some((other, ..)) = stated.iter().find(|(other, ..)| other != value) {
            return Err(format!(
                "Your answer states two different {}, {written} and {}. State only the one that you choose.",
                plural(self.declared),
                self.notation.stated_value(self.declared, other)
            ));
        }
        // Thinking aloud before the answer is no doubt; after it, it is.
        if let Some(other) = claims.iter().find_map(|claim| match &claim.claimed {
            Claimed::Hedge(other) if other != value && claim.span.start > span.start => Some(other),
            _ => None,
        }) {
            let other = self.notation.stated_value(self.declared, other);
            return Err(format!(
                "Your answer leaves two {} open, {written} and {other}. State only the one that you choose.",
                plural(self.declared)
            ));
        }
        let is_unfit = claims.iter().any(|claim| {
            matches!(&claim.claimed, Claimed::Unfit(unfit) if unfit == value)
                && claim.span.start > span.start
        });
        if is_unfit {
            return Err(format!(
                "Your answer calls its own {noun}, {written}, unfit."
            ));
        }
        let last_turn = found.turns.iter().rfind(|turn| **turn < span.start);
        let is_taken_back = |claim: &Claim| last_turn.is_some_and(|turn| claim.span.start < *turn);
        // `carry it down and to the left` is no 45 deg, and `the shortest pull` not the longest.
        let (chosen, said): (Vec<&Claim>, Vec<&Claim>) = claims
            .iter()
            .copied()
            .filter(|claim| !is_taken_back(claim))
            .partition(|claim| matches!(claim.claimed, Claimed::Chosen(_)));
        let said = said
            .into_iter()
            .filter(|claim| matches!(claim.claimed, Claimed::Course(_) | Claimed::OneOf(_)));
        for words in [said.collect(), chosen] {
            self.agree_with(value, &words, &written)?;
        }
        let text = self.reply.get(span.clone()).unwrap_or_default();
        if let (Value::Point(_), Some(taken)) = (value, note) {
            repairs.push(format!("{}: {taken}", self.declared.name));
        } else if text != space::statement(self.declared, &written) {
            let taking = note.as_ref().map(|note| format!(", taking {note}"));
            repairs.push(format!(
                "read `{}` as the {noun} {written}{}",
                quoted(&self.reply[with_marks(self.reply, span.clone())]),
                taking.unwrap_or_default()
            ));
        }
        Ok(Taken {
            value: value.clone(),
            span: span.clone(),
            repairs,
        })
    }

    /// Fails if all that an answer says of its value in its own words excludes it.
    fn agree_with(&self, value: &Value, said: &[&Claim], written: &str) -> Result<(), String> {
        let differs = |claim: &&Claim| match (&claim.claimed, value) {
            (Claimed::Course(course), Value::Direction { deg }) => {
                words::apart_deg(*course, *deg) >= 90.0
            }
            (Claimed::OneOf(values), value) => !values.contains(value),
            (Claimed::Chosen(values), value) => {
                !values.iter().any(|it| chosen::may_mean(it, value))
            }
            _ => false,
        };
        let Some(first) = said.first().filter(|_| said.iter().all(differs)) else {
            return Ok(());
        };
        let noun = noun(self.declared);
        let said = self.reply.get(first.span.clone()).unwrap_or_default();
        Err(match said.is_empty() {
            true => format!("The reasons of your answer contradict its {noun}, {written}."),
            false => format!(
                "Your answer says both `{}` and {written}. State only the {noun} that you choose.",
                quoted(said)
            ),
        })
    }

    /// Returns whether a claim has the asked form, `Grip = soft`, on a line of its own, and is no alternative.
    fn is_exact(&self, claim: &Claim) -> bool {
        let Claimed::Value(value, None) = &claim.claimed else {
            return false;
        };
        let mark = [' ', '\t', '*', '`'];
        let above = self.reply[..claim.span.start].trim_end_matches(mark);
        let below = self.reply[claim.span.end..].trim_start_matches(mark);
        let has_own_line = (above.is_empty() || above.ends_with('\n'))
            && (below.is_empty() || below.starts_with(['\n', '\r']));
        let is_other = |above: &str| {
            let letters = above
                .trim_end()
                .bytes()
                .rev()
                .take_while(|it| !it.is_ascii_whitespace());
            let word: Vec<u8> = letters
                .filter(u8::is_ascii_alphabetic)
                .map(|it| it.to_ascii_lowercase())
                .take(16)
                .collect();
            [b"ro".as_slice(), b"esiwrehto", b"ylevitanretla"].contains(&word.as_slice())
        };
        if !has_own_line || is_other(above) {
            return false;
        }
        let written = self.notation.stated_value(self.declared, value);
        let text = self.reply.get(claim.span.clone()).unwrap_or_default();
        text.eq_ignore_ascii_case(&space::statement(self.declared, &written))
    }

    /// Returns the direction in which something is moved, where only words state it: `pull it up and to the right`.
    fn course(&self, claims: &[&Claim]) -> Vec<Statement> {
        let Choices::Directions { choices } = &self.declared.choices else {
            return Vec::new();
        };
        let courses = claims.iter().filter_map(|claim| match claim.claimed {
            Claimed::Course(deg) => Some((deg, claim.span.clone())),
            _ => None,
        });
        courses
            .filter(|(deg, _)| choices.iter().any(|choice| choice.deg == *deg))
            .map(|(deg, span)| (Value::Direction { deg }, None, span))
            .collect()
    }

    /// Returns whether all claims state the same value.
    fn agree(&self, claims: &[&Claim]) -> bool {
        let is_bad = |claim: &&Claim| {
            matches!(
                claim.claimed,
                Claimed::Bad(_) | Claimed::Unclear(_) | Claimed::Torn | Claimed::Prose(..)
            )
        };
        !claims.iter().any(is_bad)
            && self
                .stated(claims)
                .is_ok_and(|stated| stated.windows(2).all(|pair| pair[0].0 == pair[1].0))
    }

    /// Returns the values that claims state; coordinates that were stated one by one make one point.
    fn stated(&self, claims: &[&Claim]) -> Result<Vec<Statement>, String> {
        let noun = noun(self.declared);
        let mut stated = Vec::new();
        let mut axes: [Option<(f64, Range<usize>)>; 2] = [None, None];
        for claim in claims {
            match &claim.claimed {
                Claimed::Value(value, note) => {
                    stated.push((value.clone(), note.clone(), claim.span.clone()))
                }
                Claimed::Axis(name, number) => {
                    let axis = &mut axes[usize::from(*name == 'y')];
                    if let Some((other, _)) = axis.as_ref().filter(|(other, _)| other != number) {
                        return Err(format!(
                            "Your answer states two different {name} coordinates of the {noun}, {other} and {number}."
                        ));
                    }
                    axis.get_or_insert((*number, claim.span.clone()));
                }
                Claimed::Bad(_)
                | Claimed::Unclear(_)
                | Claimed::Torn
                | Claimed::Prose(..)
                | Claimed::Course(_)
                | Claimed::Side(_)
                | Claimed::OneOf(_)
                | Claimed::Chosen(_)
                | Claimed::Unfit(_)
                | Claimed::Hedge(_)
                | Claimed::Nothing => {}
            }
        }
        match axes {
            [Some((x, first)), Some((y, last))] => match point::at(x, y, self.notation) {
                PointFound::Pixel(point, note) => {
                    let span = first.start.min(last.start)..first.end.max(last.end);
                    stated.push((Value::Point(point), note, span));
                }
                PointFound::Bad(why) => {
                    return Err(format!("The {noun} of your answer cannot be used: {why}."));
                }
                PointFound::Nothing => {}
            },
            [None, None] => {}
            _ => {
                return Err(format!(
                    "Your answer states only one coordinate of the {noun}."
                ));
            }
        }
        Ok(stated)
    }
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
