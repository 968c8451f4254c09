//! Reads what an answer states as data: objects and tables.
//!
//! In: an answer without its asides. Out: claims, and the text with these parts blank, for the reader of sentences.

use super::claim::{Claim, Claimed};
use super::cursor::Cursor;
use super::lexer::{self, Kind, Token};
use super::names;
use super::object::{self, Node, Shape};
use super::point;
use super::quantity::{self, AnswerUnit};
use super::sentences::Reader;
use super::value::Clarity;
use super::wordlist::{is_any, words};
use crate::data::actions::Choices;
use crate::units::UNITS;
use std::borrow::Cow;
use std::ops::Range;

/// Keys of objects that hold an action.
const CONTAINERS: &[&str] = words!(
    "action actions answer answers result results output outputs response arguments args parameters params input inputs
    function function_call functioncall tool tool_call tool_calls toolcall tool_input decision move final final_answer
    finalanswer content json data next_action step steps values fields"
);

/// Keys whose value is the name of a field.
const LABELS: [&str; 7] = ["label", "name", "role", "field", "type", "action", "kind"];

/// Keys whose text is a thought: it may say anything.
const NO_REMARKS: [&str; 9] = [
    "thinking",
    "observation",
    "scratchpad",
    "thought",
    "thoughts",
    "reasoning",
    "analysis",
    "draft",
    "example",
];

/// Keys of explanations.
const REASONS: [&str; 7] = [
    "reason",
    "reasons",
    "reasoning",
    "analysis",
    "explanation",
    "rationale",
    "justification",
];

/// The longest tag, bytes.
const MAX_TAG: usize = 200;

/// Keys inside a field's value that hold the value itself.
const VALUES: &[&str] = words!(
    "length distance direction value point point_2d points coordinates coordinate coords position location pixel pixels
    xy number mark id index choice answer angle magnitude"
);

/// Heads of the column that holds the values of a table.
const VALUE_HEADS: &[&str] = words!(
    "value choice answer chosen coordinates coordinate pixel point position selection selected decision final location"
);

/// Heads of tables that compare what could be chosen.
const COMPARING: &[&str] = words!(
    "candidate candidates option options idea rejected rank score alternative verdict considered previous"
);

/// Heads of tables in which an answer thinks; cells that cannot be read give way to the asked form below them.
const WEIGHING: &[&str] =
    words!("question step finding observation aspect consideration thought check note");

/// The most strings inside one another that are objects themselves.
const MAX_STRINGS: usize = 3;

/// Reads the objects of a text; returns where those are that state a field.
pub(super) fn objects(
    reader: &Reader<'_>,
    objects: Vec<Node>,
    claims: &mut Vec<Claim>,
) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    for node in objects {
        let n_claims = claims.len();
        members(reader, &node, node.span.clone(), 0, claims);
        if claims.len() > n_claims {
            spans.push(node.span);
        }
    }
    spans
}

/// What objects say beside the fields, as sentences.
#[derive(Default)]
pub(super) struct Beside {
    /// `"unit": "percent"`, `// dummy`
    pub said: String,
    /// `"reasoning": "The corner is free."`
    pub thought: String,
    /// What of both explains the answer.
    pub reasons: String,
}

/// Returns what the objects of a text say beside the fields.
///
/// - `is_field`: whether a key names a field, so that its member is no remark.
pub(super) fn beside(text: &str, objects: &[Node], is_field: &dyn Fn(&str) -> bool) -> Beside {
    let mut beside = Beside::default();
    for node in objects {
        for line in text[node.span.clone()].lines() {
            if let Some((_, comment)) = line.split_once("//") {
                beside.said.push_str(&format!("// {comment}\n\n"));
            }
        }
        aside_members(is_field, node, 0, &mut beside);
    }
    beside
}

fn bare(node: &Node) -> Option<&str> {
    match &node.shape {
        Shape::Bare(text) => Some(text),
        _ => None,
    }
}

fn aside_members(is_field: &dyn Fn(&str) -> bool, node: &Node, depth: usize, beside: &mut Beside) {
    let Shape::Object(found) = &node.shape else {
        return;
    };
    let mut sides = [None, None];
    for object::Member { key, value, .. } in found {
        if is_field(key) {
            continue;
        }
        // `"example": true` is one.
        let is_reason = is_any(key, &NO_REMARKS) && bare(value) != Some("true");
        let explains = is_any(key, &REASONS);
        if explains {
            let listed = match &value.shape {
                Shape::List(items) => &items[..],
                _ => std::slice::from_ref(value),
            };
            for item in listed {
                if let Shape::Text(text) = &item.shape {
                    let text = text.trim_end_matches('.');
                    beside.reasons.push_str(&format!("{text}.\n\n"));
                }
            }
        }
        match &value.shape {
            Shape::Object(inner) if depth < MAX_STRINGS => {
                let known = beside.reasons.len();
                aside_members(is_field, value, depth + 1, beside);
                // The reasons of another action: `"alternative": {"pick": …}`.
                if !is_any(key, CONTAINERS) && inner.iter().any(|it| is_field(&it.key)) {
                    beside.reasons.truncate(known);
                }
            }
            // `"image_size": [1000, 1000]`
            Shape::List(items)
                if !items.is_empty() && items.iter().all(|it| bare(it).is_some()) =>
            {
                let numbers: Vec<&str> = items.iter().filter_map(bare).collect();
                let key = key.replace('_', " ").to_lowercase();
                let numbers = numbers.join(" x ");
                beside.said.push_str(&format!("{key}: {numbers}\n\n"));
            }
            // `"warnings": ["do not execute"]`
            Shape::List(items) => {
                for item in items {
                    if let Shape::Text(text) = &item.shape {
                        let into = if is_reason {
                            &mut beside.thought
                        } else {
                            &mut beside.said
                        };
                        into.push_str(&format!("{text}\n\n"));
                    }
                }
            }
            Shape::Text(text) | Shape::Bare(text) if is_reason => {
                beside.thought.push_str(&format!("{text}.\n\n"));
            }
            Shape::Text(text) | Shape::Bare(text) => {
                let key = key.replace('_', " ");
                let (key, text) = (key.to_lowercase(), text.replace('_', " "));
                for (side, name) in sides.iter_mut().zip(["width", "height"]) {
                    if key == name || key == format!("image {name}") {
                        *side = Some(text.clone());
                    }
                }
                beside.said.push_str(&format!("{key}: {text}\n\n"));
            }
            _ => {}
        }
    }
    if let [Some(width), Some(height)] = sides {
        beside
            .said
            .push_str(&format!("the image is {width} x {height}\n\n"));
    }
}

/// Reads the members of an object, and of the objects that may hold an action inside it.
fn members(
    reader: &Reader<'_>,
    node: &Node,
    span: Range<usize>,
    depth: usize,
    claims: &mut Vec<Claim>,
) {
    let spanned = |node: &Node| {
        if depth == 0 {
            node.span.clone()
        } else {
            span.clone()
        }
    };
    match &node.shape {
        Shape::List(items) => {
            for item in items {
                members(reader, item, spanned(item), depth, claims);
            }
        }
        Shape::Object(found) => {
            // `{"point_2d": [54, 171], "label": "pick point"}`
            let holds_action = found.iter().any(|member| {
                matches!(member.value.shape, Shape::Object(_)) && is_any(&member.key, CONTAINERS)
            });
            let labels = found.iter().filter(|_| !holds_action);
            let label = labels
                .into_iter()
                .find_map(|member| match &member.value.shape {
                    Shape::Text(text) if is_any(&member.key, &LABELS) => Some(text),
                    _ => None,
                });
            let labelled = label.and_then(|label| named(reader, label));
            if let Some(field) = labelled {
                // Models that write such objects count y first, in thousandths.
                let counts_other = reader.notation.is_native()
                    && found.iter().any(|member| {
                        member.key == "point" && matches!(member.value.shape, Shape::List(_))
                    });
                let claimed = match written(node) {
                    Some(_) if counts_other => {
                        Claimed::Bad("either of its two numbers can be x".to_owned())
                    }
                    Some((text, hint)) => reader.whole(field, &text, hint, Clarity::Assigned),
                    None => Claimed::Nothing,
                };
                claims.push(Claim::new(field, spanned(node), claimed));
            }
            let moved = moved(reader, found);
            for (
                object::Member {
                    key: written,
                    at,
                    value,
                },
                moved,
            ) in found.iter().zip(moved)
            {
                let key = written;
                let is_own = { reader.fields.iter() }.any(|it| it.name.eq_ignore_ascii_case(key));
                let key = &*if is_own { key.into() } else { numbered(key) };
                let label = lexer::tokens(key);
                let moved = moved.map(|field| (field, &[][..]));
                let own = names::labelled(reader.fields, &label).or(moved);
                if let Some((field, rest)) = own.filter(|(field, _)| labelled != Some(*field)) {
                    let span = spanned(value);
                    let begin = if depth == 0 { *at } else { span.start };
                    claims.extend(member(reader, field, rest, value, begin..span.end));
                } else if labelled.is_none() && is_any(written, CONTAINERS) {
                    match &value.shape {
                        Shape::Text(text) if depth < MAX_STRINGS => {
                            if let Some(inner) = object::whole(text) {
                                members(reader, &inner, spanned(value), depth + 1, claims);
                            } else {
                                claims.extend(reader.sentences(text, Some(spanned(value))));
                            }
                        }
                        _ => members(reader, value, spanned(value), depth, claims),
                    }
                }
            }
        }
        Shape::Text(_) | Shape::Bare(_) => {}
    }
}

/// Writes the number of a key behind it: `place2` and `second_place` as `place 2`.
fn numbered(key: &str) -> Cow<'_, str> {
    let lower = key.to_ascii_lowercase();
    let second = ["second", "other"].into_iter().find_map(|word| {
        let name = lower
            .strip_prefix(word)?
            .trim_start_matches(['_', ' ', '-']);
        (!name.is_empty()).then(|| format!("{name} 2"))
    });
    let name = key.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let is_joined = name.len() < key.len() && name.ends_with(char::is_alphabetic);
    match second {
        Some(second) => second.into(),
        None if is_joined => format!("{name} {}", &key[name.len()..]).into(),
        None => key.into(),
    }
}

/// Returns the points that `from` and `to` mean, for each member of an object that has both.
fn moved(reader: &Reader<'_>, found: &[object::Member]) -> Vec<Option<usize>> {
    let meant = |member: &object::Member| {
        let tokens = lexer::tokens(&member.key);
        let mut cursor = Cursor::new(&tokens);
        let field = names::eat_label(reader.fields, &mut cursor)?;
        (cursor.rest().is_empty() && reader.fields[field].is_point()).then_some(field)
    };
    let mut fields: Vec<Option<usize>> = found.iter().map(meant).collect();
    let mut named = fields.iter().flatten();
    let first = named.next().copied();
    if named.all(|it| Some(*it) == first) {
        fields.fill(None);
    }
    fields
}

/// Words in the description of a label that make its point no statement, or count it otherwise.
const NO_LABEL: &[&str] = words!(
    "not no rejected refused wrong old previous example alternative candidate optional unused second other y x"
);

/// Returns the field that a label names, if it names nothing else; what follows a comma or stands in brackets describes it.
fn named(reader: &Reader<'_>, label: &str) -> Option<usize> {
    let label = lexer::tokens(label);
    let (field, rest) = names::labelled(reader.fields, &label)?;
    let is_described = |it: &Token<'_>| it.is_sign(',') || it.is_sign('(');
    let is_denied = rest.iter().any(|it| it.is_any(NO_LABEL));
    (rest.first().is_none_or(is_described) && !is_denied).then_some(field)
}

/// Reads tags such as `<point x="151" y="178" alt="pick point">`; returns where they are.
pub(super) fn tagged_points(
    reader: &Reader<'_>,
    text: &str,
    claims: &mut Vec<Claim>,
) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    for (start, _) in text.match_indices("<point") {
        let Some(length) = text.as_bytes()[start..]
            .iter()
            .take(MAX_TAG)
            .position(|byte| *byte == b'>')
        else {
            continue;
        };
        let attributes: Vec<(&str, &str)> = text[start..start + length]
            .split_terminator(['"', '\''])
            .collect::<Vec<_>>()
            .chunks_exact(2)
            .map(|pair| {
                (
                    pair[0]
                        .trim_start_matches("<point")
                        .trim()
                        .trim_end_matches('='),
                    pair[1],
                )
            })
            .collect();
        let get = |names: &[&str]| {
            attributes
                .iter()
                .find(|(name, _)| names.contains(name))
                .map(|(_, value)| *value)
        };
        let label =
            get(&["alt", "label", "name", "id", "type"]).and_then(|label| named(reader, label));
        // Models that write such tags with decimals count in percent.
        let counts_other = reader.notation.is_native()
            && [get(&["x", "x1"]), get(&["y", "y1"])]
                .iter()
                .flatten()
                .any(|number| number.contains('.'));
        if label.is_none() && counts_other {
            spans.push(start..start + length + 1);
        }
        if let (Some(field), Some(x), Some(y)) = (label, get(&["x", "x1"]), get(&["y", "y1"])) {
            let claimed = match counts_other {
                true => Claimed::Bad("its tag counts in percent of the picture".to_owned()),
                false => reader.whole(field, &format!("(x: {x}, y: {y})"), None, Clarity::Assigned),
            };
            let mut end = start + length + 1;
            if let Some(rest) = text[end..].find("</point>").filter(|rest| *rest < MAX_TAG) {
                end += rest + "</point>".len();
            }
            claims.push(Claim::new(field, start..end, claimed));
            spans.push(start..end);
        }
    }
    spans
}

/// Reads one member whose key names a field; `rest` follows the name in the key: an axis, a unit.
fn member(
    reader: &Reader<'_>,
    field: usize,
    rest: &[lexer::Token<'_>],
    value: &Node,
    span: Range<usize>,
) -> Option<Claim> {
    let mut rest = Cursor::new(rest);
    rest.eat_any(&["in"]);
    let is_angle = matches!(reader.fields[field].choices, Choices::Directions { .. });
    if is_angle && rest.eat_any(&["clockwise", "cw"]) {
        let claimed = Claimed::Bad("it is counted clockwise".to_owned());
        return Some(Claim::new(field, span, claimed));
    }
    if is_angle {
        rest.eat_any(&["counterclockwise", "anticlockwise", "ccw"]);
    }
    // `"place_1": [10, 20], "place_2": [30, 40]`
    if let [number] = rest.rest()
        && number.kind == Kind::Number
    {
        if number.text == "1" {
            return self::member(reader, field, &[], value, span);
        }
        let claimed = Claimed::Bad(format!(
            "a value with the number {} stands beside it",
            number.text
        ));
        return Some(Claim::new(field, span, claimed));
    }
    if rest.rest().len() == 1
        && let Some(axis) = point::single_axis(&rest)
        && reader.fields[field].is_point()
    {
        let text = written(value).map(|(text, _)| text)?;
        let number = point::number(&mut Cursor::new(&lexer::tokens(&text)));
        let claimed = match number {
            Some(number) => Claimed::Axis(axis, number),
            None => Claimed::Bad(format!(
                "`{}` is no coordinate",
                super::reading::quoted(&text)
            )),
        };
        return Some(Claim::new(field, span, claimed));
    }
    let hint = quantity::unit(&mut rest);
    let is_pixels = rest.eat_any(&["px", "pixels", "xy"]);
    if is_pixels && !reader.fields[field].is_point() {
        let claimed = Claimed::Bad("it is given in pixels".to_owned());
        return Some(Claim::new(field, span, claimed));
    }
    // `"direction_in_words": "to the left"`
    let is_worded = rest.eat_any(&["words", "word", "text", "label", "name", "description"]);
    if !rest.rest().is_empty() && !is_pixels {
        return None;
    }
    let claimed = match written(value) {
        None => Claimed::Bad("its value is an object that is not understood".to_owned()),
        Some((text, inner)) => reader.whole(field, &text, hint.or(inner), Clarity::Assigned),
    };
    match claimed {
        Claimed::Nothing => None,
        Claimed::Bad(_) if is_worded => None,
        claimed => Some(Claim::new(field, span, claimed)),
    }
}

/// Writes a member's value as a sentence would state it, with the unit that its key names.
fn written(node: &Node) -> Option<(String, Option<AnswerUnit>)> {
    match &node.shape {
        Shape::Text(text) | Shape::Bare(text) => Some((text.clone(), None)),
        Shape::List(items) => match items.as_slice() {
            [one] => written(one),
            items => {
                let parts: Option<Vec<String>> = items
                    .iter()
                    .map(|item| written(item).map(|(text, _)| text))
                    .collect();
                Some((format!("[{}]", parts?.join(", ")), None))
            }
        },
        Shape::Object(found) => {
            let get = |wanted: &str| {
                found
                    .iter()
                    .find(|member| member.key.eq_ignore_ascii_case(wanted))
                    .map(|member| &member.value)
            };
            let axes = [["x", "y"], ["u", "v"], ["col", "row"], ["column", "row"]];
            for [x, y] in axes {
                if let (Some(x), Some(y)) = (get(x), get(y)) {
                    let ((x, _), (y, _)) = (written(x)?, written(y)?);
                    return Some((format!("(x: {x}, y: {y})"), None));
                }
            }
            let unit_named = |key: &str| {
                UNITS
                    .iter()
                    .find(|unit| unit.words().any(|word| key.eq_ignore_ascii_case(word)))
            };
            let is_value =
                |it: &&object::Member| is_any(&it.key, VALUES) || unit_named(&it.key).is_some();
            // `"pixels": 56` beside `"value": 0.25, "unit": "edge"` says the same of the picture.
            let is_beside = |it: &&object::Member| {
                let is_number = bare(&it.value).is_some();
                is_any(&it.key, &["px", "pixels"]) && is_number && get("unit").is_some()
            };
            let mut values: Vec<&object::Member> = found.iter().filter(is_value).collect();
            if values.len() > 1 {
                values.retain(|it| !is_beside(it));
            }
            let [object::Member { key, value, .. }] = values[..] else {
                return None;
            };
            let (text, inner) = written(value)?;
            let unit = ["unit", "units"]
                .iter()
                .find_map(|key| get(key))
                .and_then(written);
            let text = match unit {
                Some((unit, _)) if !is_any(&unit, &["px", "pixel", "pixels"]) => {
                    format!("{text} {unit}")
                }
                _ => text,
            };
            Some((text, unit_named(key).map(AnswerUnit::Of).or(inner)))
        }
    }
}

/// Reads the tables of a text, whose rows or columns are named like fields; returns where they are.
pub(super) fn tables(
    reader: &Reader<'_>,
    text: &str,
    claims: &mut Vec<Claim>,
) -> Vec<Range<usize>> {
    let mut blocks: Vec<Vec<Range<usize>>> = Vec::new();
    let mut at = 0;
    let mut is_open = false;
    for line in text.split_inclusive('\n') {
        let trimmed = line.trim();
        let inside = trimmed.strip_prefix(BARS).unwrap_or_default();
        let is_row = inside.len() > 1 && inside.contains(BARS);
        if is_row {
            if !is_open {
                blocks.push(Vec::new());
            }
            if let Some(block) = blocks.last_mut() {
                block.push(at..at + line.len());
            }
        }
        is_open = is_row;
        at += line.len();
    }
    let mut spans = Vec::new();
    spans.extend(comma_rows(reader, text, claims));
    for block in blocks {
        let rows: Vec<Vec<Range<usize>>> =
            block.iter().map(|line| cells(text, line.clone())).collect();
        table(reader, text, &rows, claims);
        spans.extend(block);
    }
    spans.sort_by_key(|span| span.start);
    spans
}

/// Reads `pick_x,pick_y` above `40,150`: values below the names of fields, with commas between.
fn comma_rows(reader: &Reader<'_>, text: &str, claims: &mut Vec<Claim>) -> Option<Range<usize>> {
    let mut lines: Vec<Range<usize>> = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        lines.push(at..at + line.trim_end().len());
        at += line.len();
    }
    for pair in lines.windows(2) {
        let [head, row] = pair else { continue };
        let cells = |line: &Range<usize>| -> Vec<Range<usize>> {
            let mut start = line.start;
            let parts = text[line.clone()].split(',').map(|part| {
                let cell = start..start + part.len();
                start = cell.end + 1;
                cell
            });
            parts.collect()
        };
        // Most lines have no comma, and those that name a field are short.
        if head.len() > 200 || !text[head.clone()].contains(',') {
            continue;
        }
        let (names, values) = (cells(head), cells(row));
        let named: Option<Vec<_>> = names
            .iter()
            .map(|cell| column(reader, &text[cell.clone()]))
            .collect();
        let Some(named) = named.filter(|_| names.len() == values.len()) else {
            continue;
        };
        for ((field, axis, hint), cell) in named.into_iter().zip(&values) {
            claims.extend(of_cell(reader, text, field, axis, hint, cell));
        }
        return Some(row.clone());
    }
    None
}

/// What stands between the cells of a table.
const BARS: [char; 2] = ['|', '｜'];

/// Returns the places of a row's cells.
fn cells(text: &str, line: Range<usize>) -> Vec<Range<usize>> {
    let row = text[line.clone()].trim_end();
    let indent = row.len() - row.trim_start().len();
    let row = row.trim_start();
    let mut cells = Vec::new();
    let mut bars = row
        .char_indices()
        .filter(|(_, letter)| BARS.contains(letter));
    let mut start = bars.next().map_or(0, |(at, bar)| at + bar.len_utf8());
    for (at, bar) in bars {
        cells.push(line.start + indent + start..line.start + indent + at);
        start = at + bar.len_utf8();
    }
    if start < row.len() {
        cells.push(line.start + indent + start..line.start + indent + row.len());
    }
    cells
}

/// Returns the field that the head of a column or row names, with its axis and unit: `pick_x`, `Distance (mm)`.
fn column(reader: &Reader<'_>, head: &str) -> Option<(usize, Option<char>, Option<AnswerUnit>)> {
    let label = lexer::tokens(head);
    let (field, rest) = names::labelled(reader.fields, &label)?;
    let mut rest = Cursor::new(rest);
    let axis = point::single_axis(&rest);
    rest.at += usize::from(axis.is_some());
    let open = rest.eat_sign('(') || rest.eat_sign('[');
    rest.eat_any(&["in"]);
    let hint = quantity::unit(&mut rest);
    rest.skip(&["x", "y", "px", "pixels"], &[',']);
    let is_closed = !open || rest.eat_signs(&[')', ']']).is_some();
    (is_closed && rest.rest().is_empty()).then_some((field, axis, hint))
}

fn table(reader: &Reader<'_>, text: &str, rows: &[Vec<Range<usize>>], claims: &mut Vec<Claim>) {
    let is_ruler = |row: &Vec<Range<usize>>| {
        row.iter().all(|cell| {
            let cell = text[cell.clone()].trim();
            !cell.is_empty()
                && cell
                    .chars()
                    .all(|letter| matches!(letter, '-' | ':' | ' ' | '–' | '—'))
        })
    };
    let named = |cell: &Range<usize>| column(reader, &text[cell.clone()]);
    let has_ruler = rows.get(1).is_some_and(is_ruler);
    let head: &[Range<usize>] = if has_ruler { &rows[0] } else { &[] };
    let says = |cell: &Range<usize>, words: &[&str]| {
        lexer::tokens(&text[cell.clone()])
            .iter()
            .any(|token| token.is_any(words))
    };
    if head.iter().any(|cell| says(cell, COMPARING)) {
        return;
    }
    let data: Vec<&Vec<Range<usize>>> = rows
        .iter()
        .skip(2 * usize::from(has_ruler))
        .filter(|row| !is_ruler(row))
        .collect();
    let columns: Vec<_> = head.iter().map(named).collect();
    // Rows `x` and `y` below columns `pick` and `place`.
    let row_axis = |row: &[Range<usize>]| {
        let label = lexer::tokens(&text[row.first()?.clone()]);
        point::single_axis(&Cursor::new(&label)).filter(|_| label.len() == 1)
    };
    let names_rows = data
        .iter()
        .any(|row| row.first().is_some_and(|cell| named(cell).is_some()));
    if columns.iter().any(Option::is_some)
        && !names_rows
        && !data.is_empty()
        && columns.iter().skip(1).any(Option::is_some)
    {
        let compares = data.len() > 1;
        for row in data {
            for (cell, column) in row.iter().zip(&columns) {
                if let Some((field, axis, hint)) = column {
                    let axis = axis
                        .or(row_axis(row))
                        .filter(|_| reader.fields[*field].is_point());
                    let mut claim = of_cell(reader, text, *field, axis, *hint, cell);
                    // Where candidates stand one a row, cells that cannot be read give way to the asked form below.
                    if let Some(claim) = claim.as_mut().filter(|_| compares)
                        && let Claimed::Bad(why) = &claim.claimed
                    {
                        claim.claimed = Claimed::Unclear(why.clone());
                    }
                    claims.extend(claim);
                }
            }
        }
        return;
    }
    let value_columns: Vec<usize> = (0..head.len())
        .filter(|at| says(&head[*at], VALUE_HEADS) && named(&head[*at]).is_none())
        .collect();
    let axis_column = |axis: &str| {
        head.iter().position(|cell| {
            lexer::tokens(&text[cell.clone()])
                .first()
                .is_some_and(|token| token.is(axis))
        })
    };
    let axes = axis_column("x").zip(axis_column("y"));
    for row in rows.iter().filter(|row| !is_ruler(row)) {
        let index = usize::from(
            row.first()
                .is_some_and(|cell| text[cell.clone()].trim().parse::<u32>().is_ok()),
        );
        let Some((field, axis, hint)) = row.get(index).and_then(named) else {
            continue;
        };
        if let Some((x, y)) = axes
            && let (Some(x), Some(y)) = (row.get(x), row.get(y))
        {
            let pair = format!(
                "(x: {}, y: {})",
                text[x.clone()].trim(),
                text[y.clone()].trim()
            );
            let claimed = reader.whole(field, &pair, None, Clarity::Assigned);
            claims.push(Claim::new(field, x.start..y.end, claimed));
            continue;
        }
        let read: Vec<Option<Claim>> = row
            .iter()
            .map(|cell| of_cell(reader, text, field, axis, hint, cell))
            .collect();
        let is_value = |at: &usize| {
            let claim = read.get(*at).and_then(Option::as_ref);
            claim.is_some_and(|it| matches!(it.claimed, Claimed::Value(..)))
        };
        // Of `Position` and `Pixel`, one may hold words.
        let mut columns = value_columns.iter().copied().filter(|at| *at > index);
        let first = { columns.clone() }
            .find(is_value)
            .or_else(|| columns.next());
        let first = first.unwrap_or(index + 1);
        let weighs = head.iter().any(|cell| says(cell, WEIGHING));
        for (at, cell) in row.iter().enumerate().skip(index + 1) {
            // Other columns explain, unless they state a value too.
            if at == first || (is_value(&at) && value_columns.is_empty()) {
                let mut claim = of_cell(reader, text, field, axis, hint, cell);
                if let Some(claim) = claim.as_mut().filter(|_| weighs)
                    && let Claimed::Bad(why) = &claim.claimed
                {
                    claim.claimed = Claimed::Unclear(why.clone());
                }
                claims.extend(claim);
            }
        }
    }
}

fn of_cell(
    reader: &Reader<'_>,
    text: &str,
    field: usize,
    axis: Option<char>,
    hint: Option<AnswerUnit>,
    cell: &Range<usize>,
) -> Option<Claim> {
    let inside = text[cell.clone()].trim();
    let span = cell.clone();
    let claimed = match axis {
        Some(axis) => match point::number(&mut Cursor::new(&lexer::tokens(inside))) {
            Some(number) => Claimed::Axis(axis, number),
            None => return None,
        },
        None => reader.whole(field, inside, hint, Clarity::Assigned),
    };
    match claimed {
        Claimed::Nothing => None,
        claimed => Some(Claim::new(field, span, claimed)),
    }
}
