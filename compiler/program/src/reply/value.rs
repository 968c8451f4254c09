//! Reads the value of a field and everything around it, to the end of its clause.
//!
//! In: the tokens after a field's name. Out: the value, or why there is none. What is not understood makes the field
//! unreadable: `45 deg clockwise`, `(10, 20) + 5`, `soft or firm` state no value.

use super::choice::{Expected, Resolved, resolve};
use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, Token};
use super::point::{self, Brackets, PointFound};
use super::quantity::{self, AnswerUnit, Parsed, Quantity};
use super::reading::quoted;
use super::wordlist::{PLACES, words};
use super::words::{self, Offered};
use crate::data::actions::{Choices, Value};
use crate::pointing::Notation;
use crate::space;
use crate::units::{Dimension, LengthUnit, UNITS};
use std::ops::Range;

/// What was found where a value is expected.
pub(super) enum Found {
    /// A value, and how it was read if that is not obvious.
    Value(Value, Option<String>),
    /// Something that is not a value, and why not.
    Bad(String),
    /// Words that do not begin with a value, and the reason why they are not one.
    Prose(String),
    /// The value is called wrong.
    Rejected,
    /// Something else.
    Nothing,
}

/// How clearly a value is announced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Clarity {
    /// `pick (10, 20)`: other words may stand there.
    Spoken,
    /// `Pick Point = (10, 20)`: what follows is the value.
    Assigned,
}

/// What is needed to read a value.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub expected: Expected<'a>,
    pub notation: &'a Notation,
    /// The answer.
    pub whole: &'a str,
    pub clarity: Clarity,
    /// Whether the clause ends because another field is named.
    pub ends_at_name: bool,
}

/// Words before a value that do not change it.
const LEADING: &[&str] = words!(
    "the a an about approximately approx around roughly exactly precisely of be is angle direction distance length
    value simply set equal my choice choose"
);

/// Words that describe a point or lead to it.
const DESCRIBING: &[&str] = words!(
    "the a an at on in of is as its it this that to onto from up point points pixel position location coordinates
    coordinate coords corner corners edge center centre central middle midpoint keypoint spot top bottom left right
    upper lower far cloth cloth's fabric fabric's towel image side outer tip flap layer folded orange pink red blue
    green black purple white yellow marked detected visible gripper with by target here located which northwest"
);

/// Verbs after a point that describe what lies there: `(10, 20) appears to be the tip`.
const SHOWING: &[&str] = words!(
    "appears seems looks sits lies forms belongs protrudes sticks marks has shows remains rests stands represents"
);

/// The most words before a point that describe it.
const MAX_DESCRIPTION: usize = 20;

/// The same in running text.
const MAX_SPOKEN_DESCRIPTION: usize = 10;

/// Why a value is not read that another number follows.
pub(super) const SEVERAL_NUMBERS: &str = "it contains more than one number";

/// Words in running text that begin another thought.
const SUBORDINATING: &[&str] = words!(
    "so that because since while when until whose are has have stays stay keep keeping lies will should such would
    covers leaves i we you"
);

/// Words that make the point after them another one, or none.
pub(super) const RELATING: &[&str] = words!(
    "near nearby beside between opposite beyond past around toward towards away above below under beneath next adjacent
    not no never than or and half halfway but considered previous previously last old earlier would could might may if
    wrong then except outside over mirror mirrored midway partway third thirds quarter quarters fraction percent inside before after was were left-over avoid along"
);

/// Words that must not stand directly before a point, because they make it another one.
const RELATIVE: [&str; 5] = ["of", "with", "by", "far", "middle"];

/// Words that begin an explanation.
const EXPLAINING: &[&str] = words!(
    "because since as so which where while for this that it i due giving making matching corresponding based given in
    on at the is to being chosen near with see my here a an when considering using"
);

/// Words that tell what an assigned value does: `0.25 edge keeps it near`.
const TELLING: &[&str] = words!(
    "keeps brings takes carries reaches avoids stays suffices gives leads lands puts sets ends unfolds opens moves fits works"
);

/// Words that change or doubt what stands before them, wherever they stand in its clause.
const ALTERING: &[&str] = words!(
    "mean meant twice times repeated repeat each per impossible unclear wait instead rather correction sorry
    alternatively maybe perhaps possibly unless shifted offset plus minus scaled multiplied unsure guess either
    otherwise else clockwise cw nope oops"
);

/// Words that change what stands before them if they follow at once.
const TURNING: &[&str] = words!(
    "doubled halved or not no but then and times divided more less if from below above beyond further longer shorter
    towards than max min"
);

/// Words after a value that say what it would do if it were chosen.
pub(super) const CONDITIONAL: &[&str] =
    words!("would could might may isn't wouldn't can cannot can't won't was");

/// Words that call the value before them wrong.
const REJECTING: [&str; 8] = [
    "wrong",
    "rejected",
    "refused",
    "incorrect",
    "invalid",
    "discarded",
    "mistake",
    "mistaken",
];

/// Words that link a value to the next field.
const LINKS: &[&str] = words!(
    "followed after before once when having while moving and then to with at in by a an the its i i'll will should for
    it move drag my pull using over along use choose cloth fold"
);

/// Words in place of a value.
const PLACEHOLDERS: &[&str] = words!("x n na none null nil unknown tbd undefined value your");

/// Reads the value that a clause states.
pub(super) fn read<'t>(cursor: &mut Cursor<'_, 't>, context: &Context<'_>) -> Found {
    let mut ahead = *cursor;
    skip_rejected(&mut ahead, context);
    let found = match context.expected.field.is_point() {
        true => at_point(&mut ahead, context),
        false => at_value(&mut ahead, context),
    };
    let (value, note) = match found {
        Found::Value(value, note) => (value, note),
        other => {
            let start = *cursor;
            let found = match other {
                Found::Bad(_) | Found::Prose(_) => result(cursor, context, start),
                _ => None,
            };
            return found.unwrap_or_else(|| demoted(other, context));
        }
    };
    let end = ahead;
    let clause = Cursor::at(clause_of(&ahead), ahead.at);
    let is_whole = clause.tokens.len() == ahead.tokens.len();
    let calls_wrong = clause.rest().iter().any(|token| token.is_any(&REJECTING));
    // `the pick point (180, 45) I gave was an estimate`
    let mut given = clause;
    given.eat_any(&["that", "which"]);
    let is_given = given.eat_word("i")
        && given.eat_any(&[
            "gave", "stated", "named", "sent", "proposed", "wrote", "chose",
        ]);
    given.skip(&["before", "earlier", "first", "previously"], &[]);
    let is_past = is_given && given.eat_any(&["was", "were"]) && {
        given.skip(&["only", "just", "an", "a"], &[]);
        given.eat_any(&[
            "estimate",
            "guess",
            "estimated",
            "wrong",
            "off",
            "mistaken",
            "not",
        ])
    };
    if calls_wrong || is_past {
        return Found::Rejected;
    }
    let context = Context {
        ends_at_name: context.ends_at_name && is_whole,
        ..*context
    };
    match tail(clause, &context, &value, 0) {
        Ok(()) => {
            *cursor = end;
            Found::Value(value, note)
        }
        Err(why) => {
            let start = *cursor;
            result(cursor, &context, start).unwrap_or_else(|| demoted(Found::Bad(why), &context))
        }
    }
}

/// Skips what an assigned value is chosen from or set against: `not (1, 2) but`, `of 0 and 45 deg I choose`.
fn skip_rejected(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) {
    if context.clarity != Clarity::Assigned {
        return;
    }
    let mut ahead = *cursor;
    if ahead.eat_word("not") && bare(&mut ahead, context).is_some() {
        ahead.eat_sign(',');
        if ahead.eat_word("but") {
            *cursor = ahead;
        }
        return;
    }
    if !cursor
        .peek()
        .is_some_and(|first| first.is_any(&["of", "among", "out", "from"]))
    {
        return;
    }
    let clause = clause_of(cursor);
    let chosen = (cursor.at..clause.len().saturating_sub(1)).find(|at| {
        clause[*at].is("i")
            && clause[at + 1].is_any(&["choose", "chose", "pick", "picked", "take", "select"])
    });
    if let Some(at) = chosen {
        cursor.at = at + 2;
    }
}

/// Reads the value after the last `=` of a calculation, `360 deg - 45 deg = 315 deg`, or of `(x, y) = (10, 20)`.
fn result(
    cursor: &mut Cursor<'_, '_>,
    context: &Context<'_>,
    start: Cursor<'_, '_>,
) -> Option<Found> {
    let clause = clause_of(&Cursor::at(start.tokens, start.at + 1));
    let last = (start.at + 1..clause.len())
        .rfind(|at| matches!(clause[*at].kind, Kind::Sign('=' | '≈')))?;
    let is_point = context.expected.field.is_point();
    let is_calculation = clause[start.at..last].iter().all(|token| match token.kind {
        Kind::Number => true,
        Kind::Sign(',') => is_point,
        Kind::Sign(sign) => "+-*/()°%=≈".contains(sign),
        Kind::Word => UNITS
            .iter()
            .any(|unit| unit.words().any(|word| token.is(word))),
    });
    let mut echoed = start;
    let is_echo = point::echo(&mut echoed) == Some(context.notation.order()) && echoed.at == last;
    let operates = clause[start.at + 1..last]
        .iter()
        .any(|token| matches!(token.kind, Kind::Sign('+' | '-' | '*' | '/')));
    if !(is_echo && is_point || is_calculation && operates) {
        return None;
    }
    let mut ahead = Cursor::at(clause, last + 1);
    let found = match is_point {
        true => at_point(&mut ahead, context),
        false => at_value(&mut ahead, context),
    };
    match found {
        Found::Value(value, note) if tail(ahead, context, &value, 1).is_ok() => {
            cursor.at = ahead.at;
            let calculated = "the result of its calculation".to_owned();
            Some(Found::Value(
                value,
                note.or((!is_echo).then_some(calculated)),
            ))
        }
        _ => None,
    }
}

/// In running text, what cannot be read states nothing.
fn demoted(found: Found, context: &Context<'_>) -> Found {
    match found {
        Found::Bad(_) | Found::Prose(_) if context.clarity == Clarity::Spoken => Found::Nothing,
        found => found,
    }
}

/// Returns the tokens up to the end of the value's clause: its sentence or its line.
fn clause_of<'a, 't>(cursor: &Cursor<'a, 't>) -> &'a [Token<'t>] {
    let tokens = cursor.tokens;
    for (index, token) in tokens.iter().enumerate().skip(cursor.at) {
        let goes_on = token.is_any(&["or", "plus", "minus", "times"])
            || matches!(token.kind, Kind::Sign('+' | '*' | '/' | '→' | '±'));
        if token.gap >= Gap::Item || (token.gap == Gap::Line && !goes_on) {
            return &tokens[..index];
        }
        if ends_sentence(tokens, index) {
            return &tokens[..index];
        }
    }
    tokens
}

/// The most tokens of a sentence; what is longer is cut, so that a reader that goes through it for each token stays linear.
const MAX_SENTENCE: usize = 60;

/// Returns where each sentence stands, as indices of tokens; a line ends it.
pub(super) fn sentences(tokens: &[Token<'_>]) -> impl Iterator<Item = Range<usize>> {
    let mut begin = 0;
    (0..tokens.len()).filter_map(move |at| {
        let next = tokens.get(at + 1);
        let ends = ends_sentence(tokens, at)
            || next.is_none_or(|next| next.gap >= Gap::Line)
            || at + 1 - begin == MAX_SENTENCE;
        ends.then(|| std::mem::replace(&mut begin, at + 1)..at + 1)
    })
}

/// Returns whether a sentence ends with this token.
pub(super) fn ends_sentence(tokens: &[Token<'_>], index: usize) -> bool {
    // `, 2. Distance`
    let numbers_item = index > 1
        && tokens[index - 1].kind == Kind::Number
        && tokens[index - 1].text.len() < 3
        && (tokens[index - 2].is_sign(',') || tokens[index - 2].is_sign(';'));
    if numbers_item {
        return false;
    }
    let is_far = tokens
        .get(index + 1)
        .is_none_or(|next| next.gap > Gap::None);
    match tokens[index].kind {
        Kind::Sign('.' | '!' | '?') => is_far,
        Kind::Sign(sign) => sign == lexer::TAG_END,
        _ => false,
    }
}

fn at_point(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) -> Found {
    let is_assigned = context.clarity == Clarity::Assigned;
    let brackets = if is_assigned {
        Brackets::Optional
    } else {
        Brackets::Needed
    };
    cursor.skip(&["exactly", "precisely", "be"], &['≈', '=', ':']);
    let start = *cursor;
    let mut found = point::read(cursor, context.notation, brackets);
    if matches!(found, PointFound::Nothing) {
        let is_relative = skip_description(cursor, context.clarity);
        // `To find the place points, let us go through the corners:` above a list
        let heads_list = !is_assigned && cursor.peek().is_some_and(|next| next.gap >= Gap::Item);
        if cursor.at > start.at && !heads_list {
            found = point::read(cursor, context.notation, Brackets::Needed);
            if is_relative && !matches!(found, PointFound::Nothing) {
                return Found::Bad("its point is described by another one".to_owned());
            }
        }
    }
    match found {
        PointFound::Pixel(point, note) => Found::Value(Value::Point(point), note),
        PointFound::Bad(why) => Found::Bad(why),
        // `Pick Point = (x, y)`, the format
        PointFound::Nothing if is_format(start) => Found::Nothing,
        PointFound::Nothing => {
            let clause = clause_of(&start);
            let has_number = clause[start.at.min(clause.len())..]
                .iter()
                .any(|token| token.kind == Kind::Number);
            if has_number && is_assigned {
                Found::Prose(format!("`{}` is not understood", line(start, context)))
            } else {
                Found::Nothing
            }
        }
    }
}

/// Returns whether only the format is repeated, `(x, y)`, and no value follows it.
fn is_format(mut cursor: Cursor<'_, '_>) -> bool {
    point::echo(&mut cursor).is_some() && !cursor.peek().is_some_and(|next| next.is_sign('='))
}

/// The tokens of `(x, y)`.
pub(super) const POINT_TOKENS: usize = 5;

/// Skips words that describe a point; returns whether the last ones make the point after them another one.
fn skip_description(cursor: &mut Cursor<'_, '_>, clarity: Clarity) -> bool {
    let mut is_relative = false;
    let start = cursor.at;
    while let Some(token) = cursor.peek() {
        let is_joint = matches!(token.kind, Kind::Sign('-' | ',' | ':' | '=' | '→' | '–'));
        let is_paragraph = cursor.at > 0 && token.gap >= Gap::Item;
        // A word only describes the point that follows, unless it changes which point is meant or begins a new thought.
        let most = if clarity == Clarity::Assigned {
            MAX_DESCRIPTION
        } else {
            MAX_SPOKEN_DESCRIPTION
        };
        // `the best pick on this side, as (482, 310) is a fold`, `a short pull as (482, 310) lies on it`
        let is_apart = cursor.at > 0 && cursor.tokens[cursor.at - 1].is_sign(',');
        let tells = { cursor.ahead(POINT_TOKENS + 1) }
            .is_some_and(|verb| verb.is_any(&["lies", "is", "sits", "has", "would", "belongs"]));
        let is_reason = token.is("as")
            && (is_apart || tells)
            && cursor.ahead(1).is_some_and(|next| next.kind != Kind::Word);
        let is_other = token.kind == Kind::Word
            && cursor.at - start < most
            && !(clarity == Clarity::Spoken && token.is_any(SUBORDINATING))
            && ![RELATING, ALTERING, &REJECTING, REFRAMING]
                .iter()
                .any(|words| token.is_any(words));
        // `corner 4, (41, 182)`
        let numbers_corner = token.kind == Kind::Number
            && cursor.at > start
            && cursor.tokens[cursor.at - 1].is_any(&["corner", "keypoint", "vertex"])
            && token.text.len() <= 2;
        if is_paragraph
            || is_reason
            || !(is_joint || is_other || numbers_corner || token.is_any(DESCRIBING))
        {
            break;
        }
        let is_article = token.is_any(&["the", "a", "point", "pixel"]);
        if !is_article {
            let last = cursor.at.checked_sub(1).map(|at| &cursor.tokens[at]);
            let to_side =
                last.is_some_and(|last| last.is("the")) && token.is_any(&["left", "right"]);
            is_relative = token.is_any(&RELATIVE)
                || (to_side && cursor.ahead(1).is_some_and(|next| next.is("of")));
        }
        cursor.at += 1;
    }
    is_relative
}

/// Reads a value that is not a point, with the words and brackets around it.
fn at_value(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) -> Found {
    let is_assigned = context.clarity == Clarity::Assigned;
    let start = *cursor;
    let begins_word = |cursor: &Cursor<'_, '_>| match &context.expected.field.choices {
        Choices::Words { choices } => !matches!(
            words::offered(&mut { *cursor }, choices, context.whole),
            Offered::Nothing
        ),
        _ => false,
    };
    if let Some(chosen) = after_echo(start, context) {
        *cursor = chosen;
        return at_value(cursor, context);
    }
    if let Some(chosen) = marked_in_echo(start, context) {
        eat_echo(cursor, context);
        return Found::Value(chosen, None);
    }
    let mut echo = start;
    if eat_echo(&mut echo, context) || (is_placeholder(start) && !begins_word(&start)) {
        return Found::Nothing;
    }
    // `grip=Grip.SOFT`
    let qualified = cursor
        .peek()
        .is_some_and(|token| token.kind == Kind::Word && is_own_name(token, context))
        && cursor
            .ahead(1)
            .is_some_and(|point| point.is_sign('.') && point.gap == Gap::None);
    cursor.at += 2 * usize::from(qualified);
    if !begins_word(cursor) {
        cursor.skip(LEADING, &['≈', '=', ':', '→']);
    }
    let mut expected = context.expected;
    let mut open = None;
    let mut found = single(cursor, &expected, context);
    if matches!(found, Found::Nothing) {
        open = cursor.eat_signs(&['(', '[', '{', '<']);
        if let Some('{') = open {
            let unit = quantity::unit(cursor);
            let is_key = unit.is_some()
                || cursor.eat_any(&[
                    "value",
                    "angle",
                    "length",
                    "word",
                    "choice",
                    "distance",
                    "direction",
                ]);
            if is_key && cursor.eat_sign(':') {
                expected.hint = unit.or(expected.hint);
            }
        }
        if open.is_none() && is_assigned && remark_begins(cursor) {
            cursor.at += 1;
            open = cursor.eat_signs(&['(']);
        }
        if open.is_some() {
            cursor.skip(LEADING, &['≈', '=']);
            found = single(cursor, &expected, context);
        }
    }
    match found {
        Found::Nothing => {}
        Found::Value(value, note) => {
            if let Some(open) = open {
                let unit = quantity::unit(cursor);
                if unit.is_some() || !cursor.eat_sign(point::closing(open)) {
                    return Found::Bad(
                        "more than one value stands between its brackets".to_owned(),
                    );
                }
            }
            return Found::Value(value, note);
        }
        other => return other,
    }
    let clause = clause_of(&start);
    let rest = &clause[start.at.min(clause.len())..];
    let states_words = match &context.expected.field.choices {
        Choices::Words { choices } => {
            let n_words = rest.iter().filter(|token| token.kind == Kind::Word).count();
            let has_offered = (0..rest.len()).any(|at| {
                let mut ahead = Cursor::at(rest, at);
                !matches!(
                    words::offered(&mut ahead, choices, context.whole),
                    Offered::Nothing
                )
            });
            has_offered || (1..=3).contains(&n_words)
        }
        Choices::Directions { .. } => (0..rest.len()).any(|at| {
            let one = [rest[at]];
            words::side(&mut Cursor::new(&one)).is_some()
                || quantity::unit(&mut Cursor::at(rest, at)).is_some()
        }),
        _ => (0..rest.len()).any(|at| quantity::unit(&mut Cursor::at(rest, at)).is_some()),
    };
    let has_number = rest.iter().any(|token| token.kind == Kind::Number);
    if is_assigned && (states_words || has_number) {
        return Found::Prose(format!("`{}` is none of its choices", line(start, context)));
    }
    Found::Nothing
}

/// Returns the values that prose names, and whether each is a direction in words; None if other
/// words may change one of them.
pub(super) fn named(cursor: Cursor<'_, '_>, context: &Context<'_>) -> Option<Vec<(Value, bool)>> {
    const CHANGING: &[&str] =
        words!("opposite or between either not however but actually reversed other");
    let clause = clause_of(&cursor);
    let is_plain = !matches!(context.expected.field.choices, Choices::Words { .. })
        && !clause[cursor.at.min(clause.len())..]
            .iter()
            .any(|token| token.is_any(ALTERING) || token.is_any(CHANGING));
    let spoken = Context {
        clarity: Clarity::Spoken,
        ..*context
    };
    let mut found = Vec::new();
    let mut ahead = Cursor::at(clause, cursor.at);
    while let Some(token) = ahead.peek() {
        match bare(&mut ahead, &spoken) {
            Some((value, _)) => {
                // `A half-edge pull would carry it too far`
                let is_weighed = ahead
                    .rest()
                    .iter()
                    .take(2)
                    .any(|next| next.is_any(CONDITIONAL));
                if !is_weighed {
                    found.push((value, token.kind == Kind::Word));
                }
            }
            None => ahead.at += 1,
        }
    }
    (is_plain || found.is_empty()).then_some(found)
}

/// Returns whether one word stands before a value in brackets and does not change it: `vertical (90 deg)`.
fn remark_begins(cursor: &Cursor<'_, '_>) -> bool {
    let changes = [RELATING, ALTERING, TURNING, &REJECTING];
    cursor.peek().is_some_and(|word| {
        word.kind == Kind::Word && !changes.iter().any(|words| word.is_any(words))
    }) && cursor.ahead(1).is_some_and(|next| next.is_sign('('))
        && cursor.ahead(3).is_none_or(|next| !next.is_sign(','))
}

/// Returns whether a word is a part of the field's name.
fn is_own_name(token: &Token<'_>, context: &Context<'_>) -> bool {
    context
        .expected
        .field
        .name
        .split('_')
        .any(|part| token.is(part))
}

/// Returns the line at the cursor, shortened.
fn line(cursor: Cursor<'_, '_>, context: &Context<'_>) -> String {
    let clause = clause_of(&cursor);
    let end = Cursor::at(clause, clause.len());
    quoted(end.text_in(cursor.at, context.whole))
}

/// Moves past all choices as the format lists them.
fn eat_echo(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let values = space::declared(context.expected.field);
    values.len() > 1
        && values.iter().enumerate().all(|(index, value)| {
            let text = space::text(context.expected.field, value);
            let links =
                index == 0 || cursor.eat_signs(&['|', ',', '/']).is_some() || cursor.eat_word("or");
            links && words::eat(cursor, &lexer::tokens(&text))
        })
}

/// Returns the only choice that is in bold where all are listed: `0 deg | **45 deg** | 90 deg`.
fn marked_in_echo(mut cursor: Cursor<'_, '_>, context: &Context<'_>) -> Option<Value> {
    let mut echo = cursor;
    let is_whole =
        eat_echo(&mut echo, context) && echo.peek().is_none_or(|next| next.gap >= Gap::Line);
    if !is_whole {
        return None;
    }
    let mut marked = space::declared(context.expected.field)
        .into_iter()
        .filter(|value| {
            let _ = cursor.eat_signs(&['|', ',', '/']).is_some() || cursor.eat_word("or");
            let start = cursor.at;
            let text = space::text(context.expected.field, value);
            words::eat(&mut cursor, &lexer::tokens(&text));
            let [first, last] = [start, cursor.at - 1].map(|at| cursor.tokens[at]);
            let is_bold = |mark| {
                context.whole[..first.at].ends_with(mark)
                    && context.whole[last.end()..].starts_with(mark)
            };
            is_bold("**") || is_bold("__")
        });
    marked.next().filter(|_| marked.next().is_none())
}

/// Returns where the choice stands after the list of all choices: `0 deg | 45 deg | 90 deg → 45 deg`.
fn after_echo<'a, 't>(mut cursor: Cursor<'a, 't>, context: &Context<'_>) -> Option<Cursor<'a, 't>> {
    let leads = eat_echo(&mut cursor, context) && cursor.eat_signs(&['→', '=', ':']).is_some();
    let is_same_line = cursor.peek().is_some_and(|next| next.gap < Gap::Line);
    (leads && is_same_line).then_some(cursor)
}

/// Returns whether something stands in place of a value: `…`, `<angle>`, `N/A`, `null`.
fn is_placeholder(cursor: Cursor<'_, '_>) -> bool {
    let clause = clause_of(&cursor);
    let rest = &clause[cursor.at.min(clause.len())..];
    let is_open = rest
        .first()
        .is_some_and(|token| matches!(token.kind, Kind::Sign('<' | '[' | '…' | '?')));
    let is_word = rest.first().is_some_and(|token| token.is_any(PLACEHOLDERS));
    let has_number = rest.iter().any(|token| token.kind == Kind::Number);
    let is_word = is_word && (rest.len() <= 3 || rest[0].is("your"));
    !has_number
        && rest.len() <= 8
        && (is_word
            || (is_open
                && rest.iter().any(|it| {
                    it.is_any(&[
                        "angle",
                        "value",
                        "direction",
                        "distance",
                        "choice",
                        "your",
                        "one",
                    ])
                }))
            || rest.first().is_some_and(|token| token.is_sign('…')))
}

/// Reads one value and ignores what follows it.
fn single(cursor: &mut Cursor<'_, '_>, expected: &Expected<'_>, context: &Context<'_>) -> Found {
    let start = *cursor;
    if let Choices::Words { choices } = &expected.field.choices {
        return match words::offered(cursor, choices, context.whole) {
            Offered::One(word) => Found::Value(Value::Word(word.to_owned()), None),
            Offered::Several(one, other) => Found::Bad(format!("it can be `{one}` or `{other}`")),
            Offered::Nothing => Found::Nothing,
        };
    }
    let text = |cursor: &Cursor<'_, '_>| quoted(cursor.text_in(start.at, context.whole));
    match quantity::read(cursor) {
        Parsed::Quantity(_) if is_choice_of_two(&cursor.tokens[start.at..cursor.at], expected) => {
            Found::Bad(format!("`{}` is two of its choices", text(cursor)))
        }
        Parsed::Quantity(quantity)
            if quantity.unit.is_none() && is_product_in_pixels(start, *cursor, context) =>
        {
            Found::Prose(format!("`{}` is a length in pixels", text(cursor)))
        }
        Parsed::Quantity(quantity) => {
            let is_bare = !quantity.times_pi && quantity.unit.is_none() && expected.hint.is_none();
            if is_bare && context.clarity == Clarity::Spoken {
                *cursor = start;
                return Found::Nothing;
            }
            let text = text(cursor);
            match resolve(expected, quantity, &text) {
                Ok((value, note)) => Found::Value(value, note),
                Err(why) => Found::Bad(why),
            }
        }
        Parsed::Bad(why) => Found::Bad(why),
        Parsed::Nothing => match side(cursor, expected) {
            Some(Ok((value, _))) => {
                let note = format!("`{}` as a direction in the picture", text(cursor));
                Found::Value(value, Some(note))
            }
            Some(Err(why)) => Found::Bad(why),
            None => Found::Nothing,
        },
    }
}

/// Returns whether a slash stands between two numbers that are offered: `0.25/0.5 edge`.
fn is_choice_of_two(tokens: &[Token<'_>], expected: &Expected<'_>) -> bool {
    let number =
        |token: &Token<'_>| (token.kind == Kind::Number).then(|| token.text.parse().ok())?;
    let offered = |number: f64| match &expected.field.choices {
        Choices::Directions { choices } => choices.iter().any(|choice| choice.deg == number),
        Choices::Lengths { choices, .. } => choices.iter().any(|choice| choice.value == number),
        _ => false,
    };
    let mut numbers = tokens.iter().filter_map(number);
    let divides = tokens.iter().any(|token| token.is_sign('/'));
    divides
        && match (numbers.next(), numbers.next()) {
            (Some(one), Some(other)) => one != other && offered(one) && offered(other),
            _ => false,
        }
}

/// Reads a direction in words.
fn side(cursor: &mut Cursor<'_, '_>, expected: &Expected<'_>) -> Option<Result<Resolved, String>> {
    let Choices::Directions { choices } = &expected.field.choices else {
        return None;
    };
    let start = *cursor;
    let deg = words::side(cursor)?;
    // `Direction: the upper right area is empty`
    if cursor
        .peek()
        .is_some_and(|next| next.is_any(&["area", "region", "quadrant"]))
    {
        *cursor = start;
        return None;
    }
    if choices.iter().any(|choice| choice.deg == deg) {
        Some(Ok((Value::Direction { deg }, None)))
    } else {
        Some(Err("its words are none of its choices".to_owned()))
    }
}

/// Reads what follows a value up to the end of its clause; fails if something there may change the value.
fn tail(
    mut cursor: Cursor<'_, '_>,
    context: &Context<'_>,
    value: &Value,
    depth: usize,
) -> Result<(), String> {
    let mut is_apart = false;
    loop {
        if cursor.rest().is_empty() || (context.ends_at_name && links(cursor)) {
            return Ok(());
        }
        own_words(&mut cursor, context);
        let Some(token) = cursor.peek() else {
            return Ok(());
        };
        let before = cursor;
        match token.kind {
            Kind::Sign('(' | '[' | '{') => bracket(&mut cursor, context, value, depth)?,
            Kind::Sign(')' | ']' | '}' | '>' | '|') if cursor.rest().len() == 1 => return Ok(()),
            Kind::Sign(')' | ']' | '}' | '>' | '"') => cursor.at += 1,
            Kind::Sign('|') if cursor.ahead(1).is_some_and(|next| next.kind == Kind::Word) => {
                cursor.at += 1;
                is_apart = !restated(&mut cursor, context, value)?;
                continue;
            }
            Kind::Sign('→')
                if cursor.ahead(1).is_some_and(|next| {
                    next.is_any(&["the", "it", "this", "so", "moves", "i.e."])
                }) =>
            {
                cursor.at += 1;
                return explanation(cursor, context, value, true);
            }
            // `(111, 111) ← the center`
            Kind::Sign('←') if cursor.ahead(1).is_some_and(|next| next.kind == Kind::Word) => {
                cursor.at += 1;
                return explanation(cursor, context, value, true);
            }
            // `0.5 edge ← 111 px`
            Kind::Sign('←')
                if cursor
                    .ahead(1)
                    .is_some_and(|next| next.kind == Kind::Number) =>
            {
                cursor.at += 1;
                if !in_pixels(&mut cursor, context) {
                    return Err(goes_on(before, context));
                }
            }
            // `(10, 20) → top corner`
            Kind::Sign('→') if context.expected.field.is_point() && only_words_follow(cursor) => {
                cursor.at += 1;
                return explanation(cursor, context, value, true);
            }
            // `0.25 edge → about (10, 20), which is on the table`
            Kind::Sign('→') if eat_point_behind(&mut cursor, context) => {
                return explanation(cursor, context, value, true);
            }
            // `(10, 20)  // top right corner`
            Kind::Sign('/') if is_comment(&cursor) => {
                cursor.at += 2;
                is_apart = true;
                continue;
            }
            Kind::Sign('=' | '≈' | '/' | '|' | '→') => {
                cursor.at += 1;
                restated(&mut cursor, context, value)?
                    .then_some(())
                    .ok_or_else(|| goes_on(before, context))?;
            }
            Kind::Sign('.') if token.gap == Gap::None && cursor.rest().len() == 1 => return Ok(()),
            // `<pick>10, 20</pick>`
            Kind::Sign(lexer::TAG_END) if closes_own_tag(token, context) => return Ok(()),
            Kind::Sign(',' | ';' | ':' | '–' | '#') => {
                cursor.at += 1;
                is_apart = true;
                continue;
            }
            Kind::Sign('-') => {
                cursor.at += 1;
                let is_dash =
                    token.gap > Gap::None && cursor.peek().is_none_or(|next| next.gap > Gap::None);
                if !is_dash && !quantity::begins(cursor) {
                    return Err(goes_on(before, context));
                }
                is_apart = true;
                continue;
            }
            Kind::Word if is_joined_word(&cursor) => return Err(goes_on(before, context)),
            // `Pick Point = (10, 20) and` above the next field
            Kind::Word if token.is("and") && cursor.rest().len() == 1 => {
                let below = &context.whole[token.end()..];
                return begins_field(below)
                    .then_some(())
                    .ok_or_else(|| goes_on(before, context));
            }
            Kind::Word
                if names_side(&cursor, context) && restated(&mut cursor, context, value)? => {}
            Kind::Word => {
                let says_same =
                    cursor.eat_any(&["i.e.", "aka", "equals", "meaning", "equivalently"])
                        || cursor.eat_words("that is")
                        || cursor.eat_words("which is")
                        || cursor.eat_words("equal to")
                        || cursor.eat_words("equivalent to")
                        || cursor.eat_words("same as")
                        || cursor.eat_words("corresponding to")
                        || cursor.eat_words("which equals")
                        || cursor.eat_words("or equivalently");
                if excluded(&mut cursor, context, value) {
                    continue;
                }
                // `Oops, that is too fast. Speed = 100 mm/s instead; …`
                let is_last = cursor
                    .ahead(1)
                    .is_none_or(|next| matches!(next.kind, Kind::Sign('.' | ';' | ',')));
                if is_last && cursor.eat_word("instead") {
                    continue;
                }
                if of_other_kind(&mut cursor, context) {
                    is_apart = true;
                    continue;
                }
                let is_or = !says_same && cursor.eat_word("or");
                cursor.eat_sign(',');
                if (says_same || is_or || is_apart) && restated(&mut cursor, context, value)? {
                    is_apart = false;
                    continue;
                }
                return explanation(before, context, value, is_apart || says_same);
            }
            _ if is_apart && (quantity::begins(cursor) || point_begins(cursor, context)) => {
                if !restated(&mut cursor, context, value)? {
                    return Err(SEVERAL_NUMBERS.to_owned());
                }
            }
            // `↗ 45 deg`
            _ if is_angle(&cursor, context) && restated(&mut cursor, context, value)? => {}
            _ => return Err(goes_on(before, context)),
        }
        is_apart = false;
    }
}

/// Returns whether the next line names a field and gives it a value: `**Place Point** = `.
fn begins_field(below: &str) -> bool {
    let marks = |it: char| it.is_whitespace() || it.is_ascii_digit() || "*_`-.".contains(it);
    let line = below.trim_start_matches(marks);
    let line = line.lines().next().unwrap_or_default();
    let name = line.split_once(['=', ':']).map(|(name, _)| name);
    name.is_some_and(|name| {
        let words = name.split_whitespace().count();
        let is_plain = |it: char| it.is_alphabetic() || " *_`".contains(it);
        (1..=3).contains(&words) && name.chars().all(is_plain)
    })
}

/// What makes a comment more than a description: `// placeholder`, `// swap if needed`.
const REMARKING: &[&str] =
    words!("placeholder todo example sample change swap half double y check or not");

/// Returns whether a comment begins: two slashes, blanks, and words that only describe.
fn is_comment(cursor: &Cursor<'_, '_>) -> bool {
    let [slash, word] = [1, 2].map(|at| cursor.ahead(at));
    slash.is_some_and(|it| it.is_sign('/') && it.gap == Gap::None)
        && word.is_some_and(|it| it.kind == Kind::Word && it.gap == Gap::Space)
        && !cursor.rest().iter().any(|it| it.is_any(REMARKING))
}

/// Returns whether only words follow an arrow.
fn only_words_follow(cursor: Cursor<'_, '_>) -> bool {
    let behind = &cursor.rest()[1..];
    !behind.is_empty() && behind.iter().all(|it| it.kind == Kind::Word)
}

/// Skips an arrow from a length to the point where it ends.
fn eat_point_behind(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let mut ahead = *cursor;
    ahead.at += 1;
    ahead.skip(ABOUT, &['≈']);
    let is_length = matches!(context.expected.field.choices, Choices::Lengths { .. });
    let is_point = is_length
        && matches!(
            point::read(&mut ahead, context.notation, Brackets::Needed),
            PointFound::Pixel(..)
        );
    if is_point {
        *cursor = ahead;
    }
    is_point
}

/// Returns whether a closing tag has a part of the field's name.
fn closes_own_tag(tag: &Token<'_>, context: &Context<'_>) -> bool {
    let parts = tag.text.split(|letter: char| !letter.is_alphanumeric());
    let own = context.expected.field.name.split('_');
    { parts }.any(|part| !part.is_empty() && own.clone().any(|own| part.eq_ignore_ascii_case(own)))
}

/// Skips a quantity of another field: `by 0.5 edge` after a direction, `at 45 deg` after a length.
fn of_other_kind(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let mut ahead = *cursor;
    let leads = ahead.eat_any(&["by", "for", "over", "and", "at"]);
    let Parsed::Quantity(Quantity {
        unit: Some(AnswerUnit::Of(unit)),
        ..
    }) = quantity::read(&mut ahead)
    else {
        return false;
    };
    let is_angle = unit.dimension == Dimension::Angle;
    let is_other = match context.expected.field.choices {
        Choices::Directions { .. } => !is_angle,
        Choices::Lengths { .. } => is_angle,
        _ => false,
    };
    if leads && is_other {
        *cursor = ahead;
    }
    leads && is_other
}

/// Words that prefer what a remark speaks of.
const PREFERRING: &[&str] = words!(
    "better best preferable preferred ideal safer correct right should must fine work works good"
);

/// Skips another value to the end of its remark, if it says what that would do: `a firm grip could tear it`.
fn dismissed(cursor: &mut Cursor<'_, '_>, context: &Context<'_>, value: &Value) -> bool {
    let start = *cursor;
    cursor.skip(&["a", "an", "the"], &[]);
    let other = bare(cursor, context);
    own_words(cursor, context);
    let is_conditional = tells_of_word(*cursor, context)
        || cursor.eat_any(CONDITIONAL)
        || cursor.eat_words("is not")
        || cursor.eat_words("is too")
        || cursor.eat_words("is unnecessary");
    let is_other = other.is_some_and(|(other, _)| other != *value);
    let rest = cursor.rest();
    let is_plain = || {
        // `90 deg would stretch the right part`
        let is_side = |at: usize| {
            matches!(context.expected.field.choices, Choices::Directions { .. }) && {
                rest[at + 1..].iter().take(2)
            }
            .any(|next| next.is_any(PLACES))
        };
        let changes = |at: usize| {
            rest[at].is_any(ALTERING) || rest[at].is_any(PREFERRING) || {
                bare(&mut Cursor::at(rest, at), context).is_some()
            }
        };
        (0..rest.len()).all(|at| is_side(at) || !changes(at))
    };
    if !(is_other && is_conditional && is_plain()) {
        *cursor = start;
        return false;
    }
    cursor.at = cursor.tokens.len();
    true
}

/// Skips another value that is said not to be the answer: `not 0 deg`, `instead of (112, 112)`.
fn excluded(cursor: &mut Cursor<'_, '_>, context: &Context<'_>, value: &Value) -> bool {
    let start = *cursor;
    if dismissed(cursor, context, value) {
        return true;
    }
    cursor.eat_word("and");
    let excludes = [
        "instead of",
        "rather than",
        "as opposed to",
        "not",
        "unlike",
    ]
    .iter()
    .any(|words| cursor.eat_words(words));
    let assigned = Context {
        clarity: Clarity::Assigned,
        ..*context
    };
    cursor.skip(&["the", "a", "at"], &[]);
    let other = if excludes {
        bare(cursor, &assigned)
    } else {
        None
    };
    let is_other = other.is_some_and(|(other, _)| other != *value);
    let ends = cursor
        .peek()
        .is_none_or(|next| next.kind != Kind::Word || next.is_any(EXPLAINING));
    if !is_other || !ends {
        *cursor = start;
    }
    is_other && ends
}

/// Returns whether a direction in words or a number is next, where a direction is expected.
fn is_angle(cursor: &Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let is_number = cursor
        .peek()
        .is_some_and(|token| token.kind == Kind::Number);
    names_side(cursor, context)
        || (is_number && matches!(context.expected.field.choices, Choices::Directions { .. }))
}

/// Returns whether a direction in words is next, `45 deg down`.
fn names_side(cursor: &Cursor<'_, '_>, context: &Context<'_>) -> bool {
    matches!(context.expected.field.choices, Choices::Directions { .. })
        && words::side(&mut { *cursor }).is_some()
}

fn is_joined_word(cursor: &Cursor<'_, '_>) -> bool {
    let previous = cursor.at.checked_sub(1).map(|at| cursor.tokens[at].kind);
    cursor.is_joined() && matches!(previous, Some(Kind::Word | Kind::Number))
}

fn point_begins(cursor: Cursor<'_, '_>, context: &Context<'_>) -> bool {
    !matches!(
        point::read(&mut { cursor }, context.notation, Brackets::Needed),
        PointFound::Nothing
    )
}

fn goes_on(cursor: Cursor<'_, '_>, context: &Context<'_>) -> String {
    format!(
        "`{}` after its value is not understood",
        line(cursor, context)
    )
}

/// Returns whether only words that lead to the next field are left.
fn links(cursor: Cursor<'_, '_>) -> bool {
    // `and a firm [grip]`
    let rest = cursor.rest();
    let leads = rest
        .first()
        .is_some_and(|token| token.is_any(&["and", "with"]) || token.is_sign(','));
    let is_plain = |token: &Token<'_>| match token.kind {
        Kind::Word => {
            let one = [*token];
            token.is_any(&["and", "with"])
                || !(token.is_any(TURNING)
                    || token.is_any(ALTERING)
                    || token.is_any(&["i.e.", "aka"]))
                    && words::side(&mut Cursor::new(&one)).is_none()
        }
        // `, 2. Distance`
        Kind::Number => token.text.len() <= 2,
        Kind::Sign(sign) => ",.)({}<".contains(sign),
    };
    if leads && rest.len() <= 6 && rest.iter().all(is_plain) {
        return true;
    }
    cursor.rest().iter().all(|token| {
        token.is_any(LINKS)
            || matches!(
                token.kind,
                Kind::Sign(
                    '→' | ','
                        | ';'
                        | '-'
                        | '–'
                        | '<'
                        | '.'
                        | '|'
                        | '('
                        | ')'
                        | ':'
                        | '/'
                        | '}'
                        | '{'
                        | ']'
                        | '['
                )
            )
    })
}

/// Skips words that belong to a value of this kind and do not change it.
fn own_words(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) {
    match &context.expected.field.choices {
        Choices::Directions { .. } => {
            let start = *cursor;
            cursor.eat_word("measured");
            let open = cursor.eat_sign('(');
            let sense = cursor.eat_any(&[
                "counterclockwise",
                "ccw",
                "anticlockwise",
                "counter-clockwise",
            ]) || [("counter", "clockwise"), ("anti", "clockwise")]
                .iter()
                .any(|(first, second)| {
                    let mut ahead = *cursor;
                    let is_there = ahead.eat_word(first) && {
                        ahead.eat_sign('-');
                        ahead.eat_word(second)
                    };
                    if is_there {
                        *cursor = ahead;
                    }
                    is_there
                });
            if !sense {
                *cursor = start;
            } else {
                let behind = *cursor;
                if cursor.eat_word("from") {
                    cursor.skip(
                        &[
                            "the",
                            "image's",
                            "positive",
                            "image",
                            "picture's",
                            "horizontal",
                        ],
                        &['+'],
                    );
                    let is_right = cursor.eat_any(&["right", "x"]);
                    cursor.eat_sign('-');
                    cursor.eat_any(&["axis", "side"]);
                    if !is_right {
                        *cursor = behind;
                    }
                }
                if open && !cursor.eat_sign(')') {
                    *cursor = start;
                }
            }
            cursor.skip(&["direction", "angle"], &[]);
            // `straight up from the center`
            let behind = *cursor;
            cursor.eat_word("away");
            let is_from = cursor.eat_word("from");
            cursor.skip(&["the", "cloth's", "its"], &[]);
            let is_center = cursor.eat_any(&["center", "centre", "middle"]);
            let is_point = matches!(
                point::read(cursor, context.notation, Brackets::Needed),
                PointFound::Pixel(..)
            );
            if !(is_from && (is_center || is_point)) {
                *cursor = behind;
            }
        }
        Choices::Lengths { .. } => cursor.skip(&["long", "distance", "length"], &[]),
        Choices::Words { .. } => {
            let name = &context.expected.field.name;
            cursor.skip(
                &[
                    name.as_str(),
                    "one",
                    "setting",
                    "option",
                    "touch",
                    "hold",
                    "grasp",
                    "pinch",
                    "pressure",
                ],
                &[],
            );
        }
        Choices::Points { .. } | Choices::Region { .. } => {
            cursor.skip(&["px", "pixels", "pixel"], &[])
        }
    }
}

/// Words before a number that is rounded.
const ABOUT: &[&str] = words!("approximately about roughly around approx circa nearly");

/// How far off a length may be that is called rounded.
const ROUNDED: f64 = 0.01;

/// Reads the value once more; fails if it is another one. Returns whether there was one.
fn restated(
    cursor: &mut Cursor<'_, '_>,
    context: &Context<'_>,
    value: &Value,
) -> Result<bool, String> {
    let start = *cursor;
    let mut is_rounded = cursor
        .at
        .checked_sub(1)
        .is_some_and(|at| cursor.tokens[at].is_any(ABOUT) || cursor.tokens[at].is_sign('≈'));
    let assigned = Context {
        clarity: Clarity::Assigned,
        ..*context
    };
    let found = if context.expected.field.is_point() {
        let brackets = if context.notation.is_of_marks() {
            Brackets::Optional
        } else {
            Brackets::Needed
        };
        match point::read(cursor, context.notation, brackets) {
            PointFound::Pixel(point, _) => Found::Value(Value::Point(point), None),
            PointFound::Bad(why) => Found::Bad(why),
            PointFound::Nothing => Found::Nothing,
        }
    } else {
        let before = cursor.at;
        cursor.skip(ABOUT, &['≈', '=']);
        is_rounded |= cursor.at > before;
        cursor.eat_word("the");
        if in_pixels(cursor, context) {
            return Ok(true);
        }
        is_rounded |= is_in_other_unit(*cursor, context);
        single(cursor, &context.expected, &assigned)
    };
    match found {
        Found::Value(other, _) if other == *value => Ok(true),
        Found::Value(Value::Length { length: other }, _)
            if is_rounded
                && matches!(value, Value::Length { length } if (other - length).abs() < ROUNDED * length) =>
        {
            Ok(true)
        }
        Found::Value(other, _) => Err(format!(
            "it has both {} and {}",
            context.notation.stated_value(context.expected.field, value),
            context
                .notation
                .stated_value(context.expected.field, &other)
        )),
        Found::Bad(why) | Found::Prose(why) => Err(why),
        Found::Nothing | Found::Rejected => {
            *cursor = start;
            if quantity::begins(*cursor) {
                return Err(SEVERAL_NUMBERS.to_owned());
            }
            Ok(false)
        }
    }
}

/// Returns whether a length in another unit than the choices is next; it may be rounded: `0.25 edge (64 mm)`.
fn is_in_other_unit(mut cursor: Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let Choices::Lengths { unit: own, .. } = &context.expected.field.choices else {
        return false;
    };
    match quantity::read(&mut cursor) {
        Parsed::Quantity(Quantity {
            unit: Some(AnswerUnit::Of(unit)),
            ..
        }) => LengthUnit::of(unit).is_some_and(|unit| unit != *own),
        _ => false,
    }
}

/// Skips `111 px` where a length is expected: what the value is in the picture.
fn in_pixels(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let mut ahead = *cursor;
    let is_there = matches!(context.expected.field.choices, Choices::Lengths { .. })
        && ahead.eat_number().is_some()
        && ahead.eat_any(&["px", "pixels", "pixel"]);
    if is_there {
        *cursor = ahead;
    }
    is_there
}

/// Returns whether a product was read whose result is in pixels: `0.25 × 222 = 56 px`.
fn is_product_in_pixels(start: Cursor<'_, '_>, end: Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let (factors, mut result) = (&end.tokens[start.at..end.at], end);
    factors.iter().any(|token| token.is_sign('*'))
        && result.eat_signs(&['=', '≈']).is_some()
        && in_pixels(&mut result, context)
}

/// Returns whether a remark describes an angle from another side, `45 deg to the left of straight up`.
fn relates(mut cursor: Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let is_angle = matches!(context.expected.field.choices, Choices::Directions { .. });
    is_angle
        && bare(&mut cursor, context).is_some()
        && (cursor.eat_words("to the left of")
            || cursor.eat_words("to the right of")
            || cursor.eat_any(&["above", "below", "off", "past"]))
}

/// Reads a remark in brackets: the same value, or words.
fn bracket(
    cursor: &mut Cursor<'_, '_>,
    context: &Context<'_>,
    value: &Value,
    depth: usize,
) -> Result<(), String> {
    let before = *cursor;
    let (mut open, mut end) = (0_usize, cursor.at);
    for (index, token) in cursor.tokens.iter().enumerate().skip(cursor.at) {
        match token.kind {
            Kind::Sign('(' | '[' | '{') => open += 1,
            Kind::Sign(')' | ']' | '}') => open = open.saturating_sub(1),
            _ => {}
        }
        end = index;
        if open == 0 {
            break;
        }
    }
    if open > 0 || depth > 2 {
        return Err(goes_on(before, context));
    }
    let inside = Cursor::at(&cursor.tokens[..end], cursor.at + 1);
    cursor.at = end + 1;
    // `(10, 20) (30, 40)`
    if point_begins(before, context) && context.expected.field.is_point() {
        return restated(&mut { before }, context, value).map(|_| ());
    }
    let context = Context {
        ends_at_name: false,
        ..*context
    };
    if dismissed(&mut { inside }, &context, value) {
        return Ok(());
    }
    let mut again = inside;
    again.skip(
        &[
            "i.e.",
            "that",
            "is",
            "or",
            "about",
            "approximately",
            "roughly",
        ],
        &['=', '≈', ','],
    );
    if relates(again, &context) {
        return Ok(());
    }
    if restated(&mut again, &context, value)? {
        return tail(again, &context, value, depth + 1);
    }
    if inside.rest().is_empty() {
        return Ok(());
    }
    let mut inside = inside;
    if excluded(&mut inside, &context, value) && inside.rest().is_empty() {
        return Ok(());
    }
    explanation(inside, &context, value, true)
}

/// Words for what happens after a point is picked.
const MOVING: &[&str] = words!("move fold drag pull bring lift carry push slide");

/// Verbs for what the gripper does besides.
const HOLDING: &[&str] = words!("holds grips pinches grasps lifts carries closes releases");

/// Words that place a point in another frame or picture.
const REFRAMING: &[&str] = words!(
    "measured counted grid cell tile normalized normalised relative fraction fractions percent mm cm origin enlarged
    cropped crop"
);

/// Returns whether a sentence says something about an offered word, so that it is a reason and no choice: `a firm grip`
/// before `could leave marks`.
fn tells_of_word(mut behind: Cursor<'_, '_>, context: &Context<'_>) -> bool {
    let start = behind.at;
    own_words(&mut behind, context);
    let names_field = behind.at > start;
    matches!(context.expected.field.choices, Choices::Words { .. })
        && names_field
        && behind.peek().is_some_and(|next| {
            next.kind == Kind::Word && !next.is_any(GOVERNING) && !next.is_any(ALTERING)
        })
}

/// Words after a value that say when or for what it is chosen.
const GOVERNING: &[&str] = words!(
    "for when on at with then and or if instead is while during once after before to until as later from in near where"
);

/// Returns whether an explanation adds another value: `60 deg for one and 90 deg for the other`.
fn states_other(cursor: Cursor<'_, '_>, context: &Context<'_>, value: &Value) -> bool {
    let spoken = Context {
        clarity: Clarity::Spoken,
        ..*context
    };
    let mut ahead = cursor;
    // `since 0 deg and 45 deg lead past it`
    let is_reason = cursor
        .peek()
        .is_some_and(|first| first.is_any(&["because", "since"]));
    while let Some(token) = ahead.peek() {
        let goes_on = token.is_any(&["then", "or", "to", "through", "until"])
            || token.is("and") && !is_reason;
        let adds = goes_on || matches!(token.kind, Kind::Sign(',' | ';'));
        ahead.at += 1;
        let mut other = ahead;
        other.skip(&["then", "a", "the", "also"], &[]);
        // In an explanation, `to the left` describes the picture as often as the direction.
        let is_worded = matches!(context.expected.field.choices, Choices::Directions { .. })
            && !quantity::begins(other);
        let found = bare(&mut other, &spoken);
        // `30 mm clears it; 100 mm would raise half the cloth`
        let is_weighed = !goes_on && other.peek().is_some_and(|next| next.is_any(CONDITIONAL));
        // `takes it to (491, 247), 173 px from the middle`
        let is_place = !goes_on
            && other
                .peek()
                .is_some_and(|next| next.is_any(&["from", "away"]));
        if adds
            && !is_weighed
            && !is_place
            && !is_worded
            && (goes_on || !tells_of_word(other, context))
            && found.is_some_and(|(found, _)| found != *value)
        {
            return true;
        }
    }
    false
}

/// Returns whether an explanation says which other point a point is: `which is the corner at (344, 245)`.
fn is_another_point(mut cursor: Cursor<'_, '_>, context: &Context<'_>, value: &Value) -> bool {
    const IDENTIFYING: &[&str] = words!(
        "i.e. namely which that is it the its this a corner point vertex tip end middle upper lower top bottom left right
        back front far near outer leftmost rightmost topmost lowest highest listed marked at"
    );
    let spoken = Context {
        clarity: Clarity::Spoken,
        ..*context
    };
    cursor.skip(IDENTIFYING, &[',']);
    bare(&mut cursor, &spoken).is_some_and(|(found, _)| found != *value)
        && cursor.peek().is_none_or(|next| next.kind != Kind::Word)
}

/// Reads an explanation to the end of the clause; fails if it changes the value, or is none.
///
/// - `is_apart`: whether a comma, a dash or a bracket sets it apart.
fn explanation(
    cursor: Cursor<'_, '_>,
    context: &Context<'_>,
    value: &Value,
    is_apart: bool,
) -> Result<(), String> {
    let Some(first) = cursor.peek() else {
        return Ok(());
    };
    let rest = cursor.rest();
    let failed = || Err(goes_on(cursor, context));
    let is_counter = |index: usize| {
        index > 0
            && rest[..index]
                .iter()
                .rev()
                .take(2)
                .any(|token| token.is_any(&["counter", "anti"]))
    };
    // `slow, the fabric would flutter otherwise`
    let modal = rest
        .iter()
        .position(|token| token.is_any(&["would", "could", "might", "may", "will", "can"]));
    let is_reason = |index: usize| {
        let is_apart = index > 0
            && rest[index - 1].is_sign(',')
            && !rest[index..].iter().any(|token| token.kind == Kind::Number);
        let is_otherwise = rest[index].is_any(&["otherwise", "else"]);
        is_otherwise && (is_apart || modal.is_some_and(|at| at < index))
    };
    let alters = rest.iter().enumerate().any(|(index, token)| {
        (token.is_any(ALTERING) || token.is_sign('±')) && !is_counter(index) && !is_reason(index)
    });
    let is_point = context.expected.field.is_point();
    // `pick (10, 20) and fold it up`
    let goes_further =
        is_point && first.is("and") && rest.get(1).is_some_and(|next| next.is_any(MOVING));
    if goes_further {
        return Ok(());
    }
    // `with a distance of 10 mm, and holds the cloth`
    let is_quantity = is_point
        || matches!(
            context.expected.field.choices,
            Choices::Lengths { .. } | Choices::Directions { .. }
        );
    let holds = is_quantity
        && first.is("and")
        && rest.get(1).is_some_and(|next| next.is_any(HOLDING))
        && !rest.iter().any(|token| token.kind == Kind::Number);
    if holds {
        return explanation(
            Cursor::at(cursor.tokens, cursor.at + 1),
            context,
            value,
            true,
        );
    }
    if is_point
        && (rest.iter().any(|token| token.is_any(REFRAMING))
            || is_another_point(cursor, context, value))
    {
        return failed();
    }
    // `0 deg (measured from north)`
    let is_direction = matches!(context.expected.field.choices, Choices::Directions { .. });
    let counts_from = rest.windows(2).any(|pair| {
        pair[0].is("from")
            && pair[1].is_any(&["north", "south", "west", "up", "down", "top", "vertical"])
    });
    if is_direction && counts_from {
        return failed();
    }
    // `0.75 edge in total, over two pulls`
    let sums = first.is("in")
        && rest
            .get(1)
            .is_some_and(|next| next.is_any(&["total", "all", "sum"]));
    if alters || sums || first.is_any(TURNING) || states_other(cursor, context, value) {
        return failed();
    }
    // `90 deg is not possible`
    let is_judged = first.is_any(&[
        "is", "isn't", "was", "would", "seems", "looks", "might", "may", "could",
    ]);
    if is_judged
        && !is_apart
        && rest
            .iter()
            .any(|token| token.is_any(&["not", "isn't", "too", "wouldn't", "work"]))
    {
        return failed();
    }
    let starts = first.is_any(EXPLAINING)
        || (context.clarity == Clarity::Assigned && first.is_any(TELLING))
        || (is_point && first.is_any(SHOWING))
        || (is_point && first.is_any(DESCRIBING) && !first.is_any(&["left", "right", "up"]));
    if is_apart {
        return Ok(());
    }
    let names_side = |index: usize| {
        rest.get(index)
            .is_some_and(|token| token.is_any(&["left", "right", "up", "down", "top", "bottom"]))
    };
    let moves = !is_apart && first.is("to") && (names_side(1) || names_side(2));
    let as_field =
        first.is_any(&["from", "to", "at", "of"]) && quantity::begins(Cursor::at(rest, 1));
    if !starts || moves || as_field {
        return failed();
    }
    Ok(())
}

/// Reads a value alone, as running text states it; a number needs its unit.
pub(super) fn bare(
    cursor: &mut Cursor<'_, '_>,
    context: &Context<'_>,
) -> Option<(Value, Option<String>)> {
    let found = if context.expected.field.is_point() {
        match point::read(cursor, context.notation, Brackets::Needed) {
            PointFound::Pixel(point, note) => Found::Value(Value::Point(point), note),
            _ => Found::Nothing,
        }
    } else {
        single(cursor, &context.expected, context)
    };
    match found {
        Found::Value(value, note) => Some((value, note)),
        _ => None,
    }
}
