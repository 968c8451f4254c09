//! Finds where an answer labels a field: `Pick Point =`, `**Direction (deg):**`, `<parameter=pick>`.
//!
//! In: the fields and the tokens of an answer. Out: the label at a token, if there is one. A name inside a longer one
//! (`angle` in `Tip angle`) belongs to the longer one.

use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, TAG_END, Token};
use crate::data::actions::{ActionField, Choices};

/// Words that may follow a field's name, by its kind.
const POINT_NOUNS: &str =
    "point points position location coord coords coordinate coordinates pixel xy";
const ANGLE_NOUNS: &str = "angle value deg degrees";
const LENGTH_NOUNS: &str = "length value fraction";
const WORD_NOUNS: &str = "strength type value force";

/// The most tokens of a remark in brackets between a name and its sign, `(x, y)`.
const MAX_REMARK: usize = 14;

/// The names of an action's fields.
pub(super) struct Names {
    names: Vec<Name>,
}

/// A field, by its index, and `x` or `y` if one coordinate is named.
pub(super) type Key = (usize, Option<char>);

struct Name {
    field: usize,
    words: Vec<String>,
    /// Nouns that may follow it, and its own unit.
    nouns: String,
    is_point: bool,
}

/// A label, and what follows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label {
    /// The field, by its index.
    pub field: usize,
    /// `x` or `y` if it labels one coordinate: `pick_x`.
    pub axis: Option<char>,
    /// The token after it.
    pub end: usize,
    /// Whether the sign is the asked form's, `=`, or an arrow.
    pub is_exact: bool,
}

impl Names {
    pub fn of(fields: &[ActionField]) -> Names {
        let mut names = Vec::new();
        for (field, declared) in fields.iter().enumerate() {
            let nouns = match declared.choices {
                Choices::Points { .. } | Choices::Region { .. } => POINT_NOUNS.to_owned(),
                Choices::Directions { .. } => ANGLE_NOUNS.to_owned(),
                Choices::Lengths { unit, .. } => {
                    let words: Vec<&str> = unit.words().collect();
                    format!("{LENGTH_NOUNS} {}", words.join(" ").replace('/', " "))
                }
                Choices::Words { .. } => WORD_NOUNS.to_owned(),
            };
            let words = declared.name.split('_').filter(|word| !word.is_empty());
            names.push(Name {
                field,
                words: words.map(str::to_owned).collect(),
                nouns,
                is_point: declared.is_point(),
            });
        }
        names.sort_by_key(|name| std::cmp::Reverse(name.words.len()));
        Names { names }
    }

    /// Returns the field that a text names, and the coordinate: `pick_x`, `Pick Point`.
    pub fn key(&self, key: &str) -> Option<Key> {
        let tokens = lexer::tokens(key);
        let mut cursor = Cursor::at(&tokens, 0);
        let (name, axis) = self.name(&mut cursor)?;
        skip_remark(&mut cursor, name);
        cursor.rest().is_empty().then_some((name.field, axis))
    }

    /// Returns the field whose name is among a key's words: `alternative_pick`, `pick_2`.
    pub fn within(&self, key: &str) -> Option<usize> {
        let tokens = lexer::tokens(key);
        (0..tokens.len()).find_map(|at| {
            let name = self.name(&mut Cursor::at(&tokens, at))?.0;
            Some(name.field)
        })
    }

    /// Returns the label that begins at a token.
    pub fn label(&self, tokens: &[Token<'_>], at: usize) -> Option<Label> {
        let first = tokens.get(at)?;
        if first.kind == Kind::Tag {
            let (field, axis) = self.key(tag_name(first.text))?;
            return Some(Label {
                field,
                axis,
                // The point of `<point x="61.5" y="40.6" alt="pick point">` is in the tag itself.
                end: at + usize::from(!first.text.starts_with("point")),
                is_exact: true,
            });
        }
        let is_inside = at.checked_sub(1).is_some_and(|before| {
            first.gap == Gap::None
                && matches!(
                    tokens[before].kind,
                    Kind::Word | Kind::Number | Kind::Sign('-')
                )
        });
        if is_inside {
            return None;
        }
        let mut cursor = Cursor::at(tokens, at);
        let (name, axis) = self.name(&mut cursor)?;
        skip_remark(&mut cursor, name);
        let is_alone =
            first.gap >= Gap::Item && cursor.peek().is_some_and(|next| next.gap >= Gap::Line);
        let behind = cursor.at;
        let has_sign = is_alone || sign(&mut cursor);
        // `Pick Point = (x, y) = (10, 20)`
        let mut repeated = cursor;
        skip_remark(&mut repeated, name);
        if has_sign && repeated.at > cursor.at && sign(&mut repeated) {
            cursor = repeated;
        }
        if !has_sign && !is(&mut cursor) {
            return None;
        }
        let is_exact = tokens[behind..cursor.at]
            .iter()
            .any(|it| it.is_sign('=') || it.is_sign('→') || it.is_sign(TAG_END));
        Some(Label {
            field: name.field,
            axis,
            end: cursor.at,
            is_exact,
        })
    }

    /// Reads the longest name with its nouns, and moves past it.
    fn name(&self, cursor: &mut Cursor<'_, '_>) -> Option<(&Name, Option<char>)> {
        let first = cursor.peek().filter(|it| it.kind == Kind::Word)?;
        self.names.iter().find_map(|name| {
            if !first.is_any(&name.words[0]) {
                return None;
            }
            let mut ahead = *cursor;
            let joins = |ahead: &mut Cursor<'_, '_>| {
                let _ = ahead.at > cursor.at
                    && ahead.is_joined()
                    && ahead.eat_signs(&['-', '.']).is_some();
                ahead.peek().is_some_and(|it| it.gap < Gap::Line)
            };
            let mut words = name.words.iter();
            if !words
                .all(|word| (ahead.at == cursor.at || joins(&mut ahead)) && ahead.eat_any(word))
            {
                return None;
            }
            let _ = (0..MAX_REMARK).all(|_| joins(&mut ahead) && ahead.eat_any(&name.nouns));
            let mut axis = None;
            if name.is_point && joins(&mut ahead) {
                axis = ['x', 'y']
                    .into_iter()
                    .find(|it| ahead.eat_any(it.encode_utf8(&mut [0; 4])));
            }
            *cursor = ahead;
            Some((name, axis))
        })
    }
}

/// Returns the name in a tag: `pick` of `parameter=pick`, `arg name="pick"` and `pick`.
fn tag_name(inside: &str) -> &str {
    let is_mark = |letter: char| matches!(letter, '"' | '\'' | ' ' | '/');
    match inside.rsplit_once('=') {
        Some((_, name)) => name.trim_matches(is_mark),
        None => inside.trim_end_matches(is_mark),
    }
}

/// Skips `(x, y)`, `[mm]` and the like after a name; what may change a value is not skipped.
fn skip_remark(cursor: &mut Cursor<'_, '_>, name: &Name) {
    /// What may change a value, if it is not the field's own unit.
    const CHANGING: &str =
        "clockwise not old previous alternative wrong % rad radians percent mm cm m edge edges";
    let mut ahead = *cursor;
    let Some(open) = ahead.eat_signs(&['(', '[']) else {
        return;
    };
    let mut inside = ahead.rest().iter().take(MAX_REMARK);
    let Some(length) = inside.position(|it| it.is_sign(super::point::closing(open))) else {
        return;
    };
    let inside = &ahead.rest()[..length];
    let changes = |it: &Token<'_>| {
        matches!(it.kind, Kind::Number | Kind::Tag)
            || it.gap >= Gap::Line
            || (lexer::is_any(it.text, CHANGING) && !it.is_any(&name.nouns))
    };
    let mut axes = inside
        .iter()
        .filter(|it| it.is_any("x u col column y v row"));
    let is_swapped = name.is_point && axes.next().is_some_and(|it| it.is_any("y v row"));
    if !is_swapped && !inside.iter().any(changes) {
        cursor.at = ahead.at + length + 1;
    }
}

/// Skips the sign between a name and its value.
fn sign(cursor: &mut Cursor<'_, '_>) -> bool {
    let start = *cursor;
    // `<arg_key>pick</arg_key><arg_value>`
    let is_value = |it: &Token<'_>| it.kind == Kind::Tag && !it.text.starts_with("point");
    if cursor.eat_sign(TAG_END) && cursor.peek().is_some_and(is_value) {
        cursor.at += 1;
        return true;
    }
    *cursor = start;
    while cursor.peek().is_some_and(|it| it.gap < Gap::Line)
        && cursor.eat_signs(&['=', ':', '→', '≈']).is_some()
    {}
    if cursor.at > start.at {
        return true;
    }
    let is_apart = |cursor: &Cursor<'_, '_>| cursor.peek().is_some_and(|it| it.gap >= Gap::Space);
    if is_apart(cursor) && cursor.eat_signs(&['-', '–']).is_some() && is_apart(cursor) {
        return true;
    }
    *cursor = start;
    false
}

/// Skips `is`, `is at`.
fn is(cursor: &mut Cursor<'_, '_>) -> bool {
    let found = cursor.eat_any("is");
    cursor.eat_any("at");
    found && !cursor.peek().is_some_and(|it| it.is_any("not"))
}
