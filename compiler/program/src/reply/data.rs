//! Reads objects and tables: JSON as models write it, tool calls, `{"point_2d": [10, 20], "label": "pick"}`, rows of cells.
//!
//! In: a text and what is named in it. Out: claims, and the parts of the text that were read as data.

use super::claim::{Claim, Claimed, Reader};
use super::lexer;
use super::names::Key;
use super::object::{self, Member, Node, Shape};
use super::point;
use super::statements::whole;
use crate::data::actions::Value;
use std::ops::Range;

/// Keys whose text says which field an object is about.
const LABELS: &str = "label name field type";

/// Keys of an object that hold its value.
const VALUES: &str = "value point point_2d xy coordinates position deg";

/// Reads the objects of a text that name a field; returns where they stand.
pub(super) fn objects(
    reader: &Reader<'_>,
    text: &str,
    claims: &mut Vec<Claim>,
) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    for node in object::objects(text) {
        let n_claims = claims.len();
        members(reader, &node, claims);
        spans.extend((claims.len() > n_claims).then_some(node.span));
    }
    spans
}

/// Returns a value that is no list and no object, as text.
fn text(node: &Node) -> Option<&str> {
    match &node.shape {
        Shape::Text(text) | Shape::Bare(text) => Some(text),
        Shape::List(_) | Shape::Object(_) => None,
    }
}

fn members(reader: &Reader<'_>, node: &Node, claims: &mut Vec<Claim>) {
    let members_of = match &node.shape {
        Shape::List(items) => {
            items.iter().for_each(|item| members(reader, item, claims));
            return;
        }
        Shape::Text(_) | Shape::Bare(_) => return,
        Shape::Object(members) => members,
    };
    // `pick point, top right`
    let labels = members_of
        .iter()
        .filter(|it| lexer::is_any(&it.key, LABELS));
    let named = { labels }.find_map(|label| {
        let label = text(&label.value)?;
        Some(reader.names.key(label.split(',').next()?)?.0)
    });
    let value = members_of.iter().find(|it| lexer::is_any(&it.key, VALUES));
    if let (Some(field), Some(value)) = (named, value) {
        claims.push(Claim::data(
            field,
            node.span.clone(),
            typed(reader, field, &value.value),
        ));
        return;
    }
    for member in members_of {
        let key = reader.names.key(&member.key);
        let Some(field) = key
            .map(|it| it.0)
            .or_else(|| reader.names.within(&member.key))
        else {
            members(reader, &member.value, claims);
            continue;
        };
        let axis = key.and_then(|it| it.1);
        let claimed = match axis {
            Some(axis) => coordinate(&member.value).map(|it| Claimed::Axis(axis, it)),
            None => Some(typed(reader, field, &member.value)),
        };
        let claimed = claimed.unwrap_or(Claimed::Unreadable);
        // `pick_reason` is about the field and does not state it; `pick_2` with a point does.
        if key.is_some() || !matches!(claimed, Claimed::Unreadable) {
            let mut claim = Claim::data(field, member.at..member.value.span.end, claimed);
            claim.is_own = key.is_some();
            claims.push(claim);
        }
    }
}

fn coordinate(node: &Node) -> Option<f64> {
    text(node)?.trim().parse().ok()
}

/// Reads the value of a member as a value of a field.
fn typed(reader: &Reader<'_>, field: usize, node: &Node) -> Claimed {
    let is_point = reader.fields[field].is_point();
    let joined = match &node.shape {
        Shape::Text(text) | Shape::Bare(text) => Some(text.clone()),
        Shape::List(items) => match &items[..] {
            [one] => return typed(reader, field, one),
            [x, y] if is_point => { text(x).zip(text(y)) }.map(|(x, y)| format!("[{x}, {y}]")),
            _ => None,
        },
        Shape::Object(members) => {
            let of = |keys: &str| {
                let mut found = members.iter().filter(|it| lexer::is_any(&it.key, keys));
                found.next().filter(|_| found.next().is_none())
            };
            let with = |value: &Member, unit: &str| Some(format!("{} {unit}", text(&value.value)?));
            if is_point && let (Some(x), Some(y)) = (of("x"), of("y")) {
                let point = coordinate(&x.value).zip(coordinate(&y.value));
                let point = point.and_then(|(x, y)| point::at(x, y, reader.notation));
                return point.map_or(Claimed::Unreadable, |(point, note)| {
                    Claimed::Value(Value::Point(point), note)
                });
            }
            match (of(VALUES), of("unit"), &members[..]) {
                (Some(value), Some(unit), _) => text(&unit.value).and_then(|it| with(value, it)),
                (Some(value), None, _) => return typed(reader, field, &value.value),
                // `{"edge": 0.5}`
                (None, None, [only]) if !is_point => with(only, &only.key),
                (None, None, [only]) => return typed(reader, field, &only.value),
                _ => None,
            }
        }
    };
    joined.map_or(Claimed::Unreadable, |text| whole(reader, field, &text))
}

/// Reads the tables of a text whose heading names fields, or whose rows begin with a field; returns where they stand.
pub(super) fn tables(
    reader: &Reader<'_>,
    text: &str,
    claims: &mut Vec<Claim>,
) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    let mut heading: Option<Vec<Option<Key>>> = None;
    let mut at = 0;
    let is_ruler = |line: &str| {
        line.contains("--")
            && line.contains('|')
            && line.chars().all(|it| "|-: \t\r\n".contains(it))
    };
    let mut lines = text.split_inclusive('\n').peekable();
    while let Some(line) = lines.next() {
        let start = at;
        at += line.len();
        let begins = lines.peek().is_some_and(|next| is_ruler(next));
        let goes_on = heading.is_some() && line.contains('|');
        if !line.trim_start().starts_with('|') && !begins && !goes_on {
            heading = None;
            continue;
        }
        if is_ruler(line) {
            continue;
        }
        let cells = cells(line, start);
        let field = |cell: &Range<usize>| {
            let key = text[cell.clone()].trim_matches(['*', '`', '_', ' ', ':']);
            reader.names.key(key)
        };
        let fields: Vec<_> = cells.iter().map(field).collect();
        let mut claim = |(field, axis): Key, from: usize, cell: &Range<usize>| {
            let value = &text[cell.clone()];
            let claimed = match axis {
                Some(axis) => value.parse().ok().map(|it| Claimed::Axis(axis, it)),
                None => Some(whole(reader, field, value)),
            };
            // A row may be about something else that a field is named after.
            let is_read = |it: &Claimed| !matches!(it, Claimed::Unreadable);
            let claimed = claimed.filter(is_read).unwrap_or(Claimed::Vague);
            claims.push(Claim::data(field, from..cell.end, claimed));
        };
        if fields.iter().flatten().count() > 1 {
            heading = Some(fields.clone());
        } else if let Some(heading) = heading.as_ref().filter(|it| it.len() == cells.len()) {
            for (field, cell) in heading.iter().zip(&cells) {
                if let Some(field) = field {
                    claim(*field, cell.start, cell);
                }
            }
        } else if let (Some(Some(field)), Some(value)) = (fields.first(), cells.get(1)) {
            let is_point = reader.fields[field.0].is_point();
            let is_number = |cell: &Range<usize>| text[cell.clone()].parse::<f64>().is_ok();
            if is_point && cells.len() > 2 && cells[1..3].iter().all(is_number) {
                claim((field.0, Some('x')), cells[0].start, value);
                claim((field.0, Some('y')), cells[0].start, &cells[2]);
            } else {
                // `| pick | lower left | (41, 167) |`
                for cell in &cells[1..] {
                    claim(*field, cells[0].start, cell);
                }
            }
        } else {
            continue;
        }
        spans.push(start..at);
    }
    spans
}

/// Returns where the cells of a row stand, without blanks around them.
fn cells(line: &str, start: usize) -> Vec<Range<usize>> {
    let row = line.trim_end().trim_end_matches('|');
    let mut at = start;
    let mut found = Vec::new();
    for cell in row.split('|') {
        let lead = cell.len() - cell.trim_start().len();
        let length = cell.trim().len();
        found.push(at + lead..at + lead + length);
        at += cell.len() + 1;
    }
    if row.trim_start().starts_with('|') {
        found.remove(0);
    }
    found
}
