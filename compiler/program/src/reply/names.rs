//! Finds where an answer names the fields of an action.
//!
//! In: the fields and the tokens of an answer. Out: each mention, in order. A name inside a longer one (`angle` in
//! `Tip angle`) belongs to the longer one.

use super::cursor::Cursor;
use super::lexer::{self, Gap, Token};
use super::quantity;
use super::words;
use crate::data::actions::{ActionField, Choices};

/// How a field is mentioned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// By its name.
    Name,
    /// By a verb: `grasp` for `pick`.
    Verb,
    /// By a verb that needs `to` before the point: `move it to`.
    VerbTo,
    /// By a verb after `be`: `should be grasped at`.
    Passive,
    /// By a word for both points, `pull the corner at`, `my choice is`, where there is no field `place`.
    VerbAt,
    /// The same after `be`: `should be pulled`.
    PassiveAt,
}

/// A place where a field is named.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mention {
    /// The field, by its index.
    pub field: usize,
    pub form: Form,
    /// Its first token.
    pub at: usize,
    /// The token after it.
    pub end: usize,
}

/// Words for the fields `pick` and `place`.
const VERBS: [(&str, &[&str], Form); 8] = [
    (
        "pick",
        &[
            "picking", "picks", "grasp", "grasps", "grasping", "grab", "grabs", "grabbing",
            "pickup", "pinch", "pinches", "seize", "seizes", "catch", "snatch", "clutch", "clamp",
            "pluck",
        ],
        Form::Verb,
    ),
    (
        "place",
        &[
            "placing",
            "places",
            "put",
            "puts",
            "putting",
            "drop",
            "drops",
            "dropping",
            "release",
            "releases",
            "releasing",
            "lay",
            "lays",
            "laying",
            "deposit",
            "deposits",
        ],
        Form::Verb,
    ),
    (
        "place",
        &[
            "move", "moves", "moving", "drag", "drags", "dragging", "bring", "brings", "bringing",
            "carry", "carries", "fold", "folds", "folding", "pull",
        ],
        Form::VerbTo,
    ),
    ("pick", &["choice"], Form::VerbAt),
    (
        "pick",
        &["picked", "grasped", "grabbed", "gripped", "pinched"],
        Form::Passive,
    ),
    (
        "place",
        &["placed", "dropped", "released", "put"],
        Form::Passive,
    ),
    (
        "pick",
        &[
            "pull", "pulls", "pulling", "drag", "drags", "dragging", "move", "moves", "moving",
        ],
        Form::VerbAt,
    ),
    ("pick", &["pulled", "dragged", "moved"], Form::PassiveAt),
];

/// The same of two words, `take hold of the cloth at`, `let go of it at`: the first one's forms, and the second one.
const PAIRS: [(&str, &[&str], &str); 2] = [
    ("pick", &["take", "takes", "taking", "get"], "hold"),
    ("place", &["let", "lets", "letting"], "go"),
];

/// Other labels that models give to a field, read only where its value follows: `Target: (30, 40)`.
///
/// The first word is a field's name, or the kind of which there is one field.
const LABELS: [(&str, &[&str]); 4] = [
    (
        "pick",
        &[
            "from",
            "source",
            "start",
            "pick up",
            "take",
            "take from",
            "take hold at",
            "grip at",
            "begin",
            "begin at",
            "start at",
            "pick up location",
            "where to pick",
            "where to pinch",
            "where to grasp",
        ],
    ),
    (
        "place",
        &[
            "to",
            "target",
            "destination",
            "end",
            "drop off",
            "put down",
            "put to",
            "let go",
            "let go at",
            "goes to",
            "end at",
            "finish",
            "finish at",
            "drop off location",
            "where to place",
        ],
    ),
    (
        "angle",
        &[
            "angle",
            "direction",
            "pull direction",
            "pull angle",
            "approach angle",
            "heading",
            "dir",
            "which way",
            "towards",
        ],
    ),
    (
        "length",
        &[
            "pull length",
            "pull distance",
            "travel distance",
            "dist",
            "how far",
        ],
    ),
];

/// Words that may follow the name of a field that is a point.
pub(super) const POINT_NOUNS: [&str; 8] = [
    "point",
    "pixel",
    "position",
    "location",
    "coordinates",
    "coordinate",
    "coords",
    "pt",
];

/// Words that may follow the name of any other field.
pub(super) const NOUNS: [&str; 6] = ["angle", "value", "choice", "length", "type", "magnitude"];

/// Returns whether a field is a direction that may lead to every side of the picture.
pub(super) fn is_compass(field: &ActionField) -> bool {
    match &field.choices {
        Choices::Directions { choices } => [0.0, 90.0, 180.0, 270.0]
            .iter()
            .all(|deg| choices.iter().any(|choice| choice.deg == *deg)),
        _ => false,
    }
}

/// Returns each mention of a field, in the order of the answer.
pub(super) fn mentions(fields: &[ActionField], tokens: &[Token<'_>]) -> Vec<Mention> {
    let names: Vec<Vec<Token<'_>>> = fields
        .iter()
        .map(|field| lexer::tokens(&field.name))
        .collect();
    let mut found: Vec<Mention> = Vec::new();
    let mut labels: Vec<usize> = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let mut longest: Option<Mention> = None;
        let mut equal: Vec<Mention> = Vec::new();
        for (field, name) in names.iter().enumerate() {
            let mut cursor = Cursor::at(tokens, at);
            if !words::eat(&mut cursor, name)
                || is_part(tokens, at, cursor.at)
                || is_qualifier(tokens, cursor.at)
            {
                continue;
            }
            // `Direction Point` is the point of that name, where both are fields.
            let mut claimed = cursor.at;
            if fields[field].is_point() && cursor.eat_word("point") {
                claimed = cursor.at;
            }
            let mention = Mention {
                field,
                form: Form::Name,
                at,
                end: at + name_length(name, tokens, at),
            };
            match longest {
                Some(known) if claimed_end(fields, tokens, &known) > claimed => {}
                Some(known) if claimed_end(fields, tokens, &known) == claimed => {
                    equal.push(mention)
                }
                _ => {
                    longest = Some(mention);
                    equal.clear();
                }
            }
        }
        if longest.is_none() {
            let label =
                other_label(fields, tokens, at).or_else(|| misspelt(fields, &names, tokens, at));
            labels.extend(label.map(|mention| mention.at));
            longest = label.or_else(|| verb(fields, tokens, at));
        }
        match longest {
            Some(mention) => {
                let end = claimed_end(fields, tokens, &mention);
                found.push(mention);
                // Fields that are named alike are kept, for the proof to find.
                found.extend(equal);
                at = end.max(at + 1);
            }
            None => at += 1,
        }
    }
    // `From: (10, 20)` may tell of a crease where the field has its own line.
    let is_other = |mention: &Mention| labels.binary_search(&mention.at).is_ok();
    let mut is_named = vec![false; fields.len()];
    for mention in found
        .iter()
        .filter(|it| it.form == Form::Name && !is_other(it))
    {
        is_named[mention.field] = true;
    }
    found.retain(|mention| !(is_other(mention) && is_named[mention.field]));
    found
}

fn name_length(name: &[Token<'_>], tokens: &[Token<'_>], at: usize) -> usize {
    let mut cursor = Cursor::at(tokens, at);
    words::eat(&mut cursor, name);
    cursor.at - at
}

fn claimed_end(fields: &[ActionField], tokens: &[Token<'_>], mention: &Mention) -> usize {
    let mut cursor = Cursor::at(tokens, mention.end);
    if fields[mention.field].is_point() {
        cursor.eat_word("point");
    }
    cursor.at
}

/// Returns whether these tokens are only a part of a longer word: `non-grip`.
fn is_part(tokens: &[Token<'_>], at: usize, end: usize) -> bool {
    let joins = |index: usize| {
        tokens
            .get(index)
            .is_some_and(|token| token.is_sign('-') && token.gap == Gap::None)
            && tokens
                .get(index + 1)
                .is_some_and(|token| token.gap == Gap::None && token.kind == lexer::Kind::Word)
    };
    let follows = tokens.get(end).is_some_and(|next| next.is_sign('-'))
        && joins(end)
        && !tokens
            .get(end + 1)
            .is_some_and(|next| next.is_any(&POINT_NOUNS) || next.is_any(&["x", "y", "and"]));
    (at >= 2 && joins(at - 1) && tokens[at].gap == Gap::None && !tokens[at - 2].is("and"))
        || follows
}

/// Returns whether a name only qualifies the word after it: `Grip.SOFT`.
fn is_qualifier(tokens: &[Token<'_>], end: usize) -> bool {
    let is_point = tokens
        .get(end)
        .is_some_and(|next| next.is_sign('.') && next.gap == Gap::None);
    is_point
        && tokens.get(end + 1).is_some_and(|next| {
            next.gap == Gap::None
                && next.kind == lexer::Kind::Word
                && !next.is_any(&["x", "y", "u", "v"])
        })
}

/// Returns the field that a line's label means by another name, if its sign and a number follow.
fn other_label(fields: &[ActionField], tokens: &[Token<'_>], at: usize) -> Option<Mention> {
    if tokens[at].gap < Gap::Line {
        return None;
    }
    let mut cursor = Cursor::at(tokens, at);
    let field = eat_label(fields, &mut cursor)?;
    let end = cursor.at;
    skip_nouns(&mut cursor, &fields[field]);
    let is_signed = cursor.eat_signs(&[':', '=']).is_some();
    (is_signed && quantity::begins(cursor)).then_some(Mention {
        field,
        form: Form::Name,
        at,
        end,
    })
}

/// Returns the field whose name begins a line with a slip in one of its words, if its sign follows: `Tip Angel = `.
fn misspelt(
    fields: &[ActionField],
    names: &[Vec<Token<'_>>],
    tokens: &[Token<'_>],
    at: usize,
) -> Option<Mention> {
    if tokens[at].gap < Gap::Line {
        return None;
    }
    (0..fields.len()).find_map(|field| {
        let end = at + names[field].len();
        let written = tokens.get(at..end)?.iter().zip(&names[field]);
        let mut n_slips = 0;
        for (word, meant) in written {
            if !word.is(meant.text) {
                n_slips += 1;
                if !is_slip(&word.text.to_lowercase(), meant.text) {
                    return None;
                }
            }
        }
        let mut cursor = Cursor::at(tokens, end);
        skip_nouns(&mut cursor, &fields[field]);
        let is_signed = cursor.eat_signs(&[':', '=']).is_some();
        (n_slips == 1 && is_signed).then_some(Mention {
            field,
            form: Form::Name,
            at,
            end,
        })
    })
}

/// The fewest letters of a word of which one may be wrong.
const MIN_SLIP: usize = 5;

/// Returns whether one letter of a word is missing, added, changed, or exchanged with the next one.
fn is_slip(word: &str, meant: &str) -> bool {
    meant.chars().count() >= MIN_SLIP && strsim::osa_distance(word, meant) == 1
}

/// Moves past one of [`LABELS`], and returns its field.
pub(super) fn eat_label(fields: &[ActionField], cursor: &mut Cursor<'_, '_>) -> Option<usize> {
    let start = *cursor;
    LABELS.iter().find_map(|(means, labels)| {
        let longest = labels
            .iter()
            .filter_map(|label| {
                let mut ahead = start;
                words::eat(&mut ahead, &lexer::tokens(label)).then_some(ahead.at)
            })
            .max()?;
        let field = match *means {
            "angle" => only(fields, |it| {
                matches!(it.choices, Choices::Directions { .. })
            }),
            "length" => only(fields, |it| {
                matches!(it.choices, Choices::Lengths { .. }) && it.name == "distance"
            }),
            name => only(fields, |it| it.name == name && it.is_point()),
        }?;
        cursor.at = longest;
        Some(field)
    })
}

/// Returns the index of the only field of a kind.
pub(super) fn only(
    fields: &[ActionField],
    is_wanted: impl Fn(&ActionField) -> bool,
) -> Option<usize> {
    let mut found = (0..fields.len()).filter(|field| is_wanted(&fields[*field]));
    found.next().filter(|_| found.next().is_none())
}

fn verb(fields: &[ActionField], tokens: &[Token<'_>], at: usize) -> Option<Mention> {
    // `for the first fold`
    let is_noun = at > 0
        && tokens[at - 1].is_any(&[
            "the", "a", "this", "that", "each", "every", "first", "second", "third", "next",
            "last", "has", "have", "had",
        ]);
    if is_noun {
        return None;
    }
    // `which puts the crease at (10, 20)`
    let is_effect = at > 0
        && tokens[at - 1].is_any(&["which", "that", "this"])
        && tokens[at].is_any(&[
            "puts", "drops", "releases", "moves", "brings", "drags", "pulls",
        ]);
    if is_effect {
        return None;
    }
    let is_passive = at > 0 && tokens[at - 1].is_any(&["be", "is"]);
    let has = |wanted: &str| {
        fields
            .iter()
            .position(|field| field.name == wanted && field.is_point())
    };
    let pair = PAIRS
        .iter()
        .find(|(_, verbs, behind)| at > 0 && tokens[at].is(behind) && tokens[at - 1].is_any(verbs));
    // `It lets go once the line from (10, 20) is vertical.`
    let is_time = tokens.get(at + 1).is_some_and(|next| {
        next.is_any(&["once", "when", "after", "until", "from", "before", "as"])
    });
    if let Some(field) = pair.filter(|_| !is_time).and_then(|(name, ..)| has(name)) {
        return Some(Mention {
            field,
            form: Form::Verb,
            at,
            end: at + 1,
        });
    }
    let (name, _, form) = VERBS.iter().find(|(name, verbs, form)| {
        let is_shared = matches!(form, Form::VerbAt | Form::PassiveAt);
        tokens[at].is_any(verbs)
            && matches!(form, Form::Passive | Form::PassiveAt) == is_passive
            && has(name).is_some()
            && !(is_shared && has("place").is_some())
    })?;
    Some(Mention {
        field: has(name)?,
        form: *form,
        at,
        end: at + 1,
    })
}

/// Returns the field that a label names, and the tokens after its name and noun.
pub(super) fn labelled<'a, 't>(
    fields: &[ActionField],
    label: &'a [Token<'t>],
) -> Option<(usize, &'a [Token<'t>])> {
    let mut cursor = Cursor::new(label);
    cursor.skip(&["the", "my", "final", "chosen", "selected"], &[]);
    let mention = mentions(fields, &label[cursor.at..]).into_iter().next()?;
    if mention.at != 0 || mention.form != Form::Name {
        return None;
    }
    cursor.at += mention.end;
    skip_nouns(&mut cursor, &fields[mention.field]);
    Some((mention.field, cursor.rest()))
}

/// Skips nouns after a field's name.
pub(super) fn skip_nouns(cursor: &mut Cursor<'_, '_>, field: &ActionField) {
    let nouns = if field.is_point() {
        &POINT_NOUNS[..]
    } else {
        &NOUNS
    };
    loop {
        let before = *cursor;
        cursor.eat_sign('-');
        if !cursor.eat_any(nouns) {
            *cursor = before;
            return;
        }
    }
}
