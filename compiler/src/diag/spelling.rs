//! Decides whether an edit only spells something differently.
//!
//! In: a text, a piece of it, and what replaces the piece. Out: whether every number, name and text stays, and no token is joined with its
//! neighbour. Only the line of the edit is read, so the work does not grow with the file.

use super::diagnostic::{Diagnostic, Edit};
use fab_grammar::{Sources, Span};
use fab_program::units::UNITS;

/// The words of the language that others write as signs, or that are written for one.
const CONNECTIVES: [&str; 4] = ["and", "or", "not", "to"];

/// The quotes that can enclose a text: the opening and the closing one.
const QUOTES: [(char, char); 8] = [
    ('"', '"'),
    ('\'', '\''),
    ('“', '”'),
    ('„', '”'),
    ('„', '“'),
    ('‟', '”'),
    ('«', '»'),
    ('‘', '’'),
];

/// Makes every edit likely that is more than another spelling.
pub(crate) fn keep_spellings_only(diagnostics: &mut [Diagnostic], sources: &Sources) {
    for diagnostic in diagnostics.iter_mut().filter(|it| it.is_certain()) {
        let text = |edit: &Edit| sources.get(edit.span.file).text.as_str();
        let keeps = |edit: &Edit| keeps_content(text(edit), edit.span, &edit.replacement);
        if !diagnostic.edits.iter().all(keeps) {
            diagnostic.make_likely();
        }
    }
}

/// Returns whether an edit keeps every number, name and text.
pub(crate) fn keeps_content(text: &str, span: Span, replacement: &str) -> bool {
    let place = Place::of(text, span);
    let (old, new) = (place.old, replacement.trim());
    if is_number_edit(&place, replacement) {
        return true;
    }
    if place.splits_a_token() || place.joins(replacement) {
        return false;
    }
    if old.starts_with(is_quote) || new.starts_with('"') {
        return is_quoting(&place, new);
    }
    match new {
        "" => is_sign(old) && place.is_at_an_end(),
        "#" => is_sign(old) && place.begins_a_remark(),
        _ if is_unit(old, new) => true,
        _ => is_connective(old) && is_connective(new) && keeps_order(old, new),
    }
}

/// An edit in its line.
struct Place<'t> {
    /// The line before it.
    before: &'t str,
    /// What it replaces.
    old: &'t str,
    /// The line after it.
    after: &'t str,
}

impl<'t> Place<'t> {
    fn of(text: &'t str, span: Span) -> Place<'t> {
        let is_end = |character| character == '\n' || character == '\r';
        let (before, after) = (&text[..span.start], &text[span.end..]);
        Place {
            before: before.rsplit(is_end).next().unwrap_or_default(),
            old: &text[span.range()],
            after: after.split(is_end).next().unwrap_or_default(),
        }
    }

    /// Returns whether the replaced piece begins or ends within a token, such as the `=` of `:=`.
    fn splits_a_token(&self) -> bool {
        let starts = touch(self.before, self.old, is_one_token);
        // A unit directly follows its number.
        let is_unit = self.before.ends_with(|last: char| last.is_ascii_digit())
            && !self.old.starts_with(|first: char| first.is_ascii_digit());
        (starts && !is_unit) || touch(self.old, self.after, is_one_token)
    }

    /// Returns whether the replacement would become one token with what is beside it.
    fn joins(&self, replacement: &str) -> bool {
        if replacement.is_empty() {
            return touch(self.before, self.after, is_one_token);
        }
        let is_unit = self.before.ends_with(|last: char| last.is_ascii_digit())
            && replacement.starts_with(char::is_alphabetic)
            && !CONNECTIVES.contains(&replacement.trim());
        (touch(self.before, replacement, is_one_token) && !is_unit)
            || touch(replacement, self.after, is_one_token)
    }

    /// Returns whether no other part of a list can follow: at the end of the line, or before a closing bracket.
    fn is_at_an_end(&self) -> bool {
        let rest = self.after.trim_start();
        rest.is_empty() || rest.starts_with(['#', '}', ')'])
    }

    /// Returns whether the rest of the line is a remark: on a line of its own, or words that no value has.
    ///
    /// `3 // 2` divides, and `near // far` may; `near // too near, see the paper` does not.
    fn begins_a_remark(&self) -> bool {
        let is_prose =
            |character: char| character.is_alphabetic() || " \t,.;:'-".contains(character);
        let rest = self.after.trim();
        let is_apart = self.before.ends_with([' ', '\t']);
        self.before.trim().is_empty()
            || (is_apart && rest.contains(' ') && rest.chars().all(is_prose))
    }

    /// Returns whether a quote without a partner is before or after the text: it may belong to it, as in `'don't'`.
    fn has_single(&self, quotes: [char; 2]) -> bool {
        let is_odd = |text: &str| !text.matches(quotes).count().is_multiple_of(2);
        is_odd(self.before) || is_odd(self.after)
    }
}

/// Returns whether both characters at the seam of two texts satisfy `is_one`.
fn touch(left: &str, right: &str, is_one: fn(char, char) -> bool) -> bool {
    match (left.chars().next_back(), right.chars().next()) {
        (Some(last), Some(first)) => is_one(last, first),
        _ => false,
    }
}

/// Returns whether two neighbouring characters belong to one token.
fn is_one_token(left: char, right: char) -> bool {
    let is_word = |character: char| character.is_alphanumeric() || character == '_';
    match (left, right) {
        // Signs that may stand before any value, so they are tokens of their own.
        (_, '-') => matches!(left, '-' | '<'),
        (_, '!') => left == '!',
        _ if is_word(left) && is_word(right) => true,
        _ if is_quote(left) && is_quote(right) => true,
        _ if is_quote(left) || is_quote(right) => is_word(left) || is_word(right),
        ('.' | ',', digit) | (digit, '.' | ',') if digit.is_ascii_digit() => true,
        ('.', '.') => true,
        _ => is_operator(left) && is_operator(right),
    }
}

fn is_operator(character: char) -> bool {
    "<>=!:&|/*+-%^~→⇒–—≤≥≠".contains(character)
}

fn is_quote(character: char) -> bool {
    "\"'“”„‟«»‘’".contains(character)
}

fn is_sign(text: &str) -> bool {
    !text.is_empty()
        && text
            .chars()
            .all(|character| is_operator(character) || ",;".contains(character))
}

fn is_connective(text: &str) -> bool {
    is_sign(text) || CONNECTIVES.contains(&text)
}

/// Returns whether a comparison still has its larger side on the same side.
fn keeps_order(old: &str, new: &str) -> bool {
    let is_below = |sign: &str| sign.contains(['<', '≤']);
    let is_above = |sign: &str| sign.contains(['>', '≥']) && sign != "->";
    let is_ordered = |sign: &str| is_below(sign) || is_above(sign);
    // `=>` is an arrow of another kind as often as a comparison.
    new == "->"
        || !is_ordered(new)
        || (is_below(old), is_above(old)) == (is_below(new), is_above(new))
}

fn is_unit(old: &str, new: &str) -> bool {
    UNITS
        .iter()
        .any(|unit| unit.name == new && unit.spellings.contains(&old))
}

/// Returns whether only the quotes of a text change, and nothing beside it could be a part of it.
fn is_quoting(place: &Place<'_>, new: &str) -> bool {
    if place.old.starts_with(['"', '“', '”', '„', '‟', '«', '»'])
        && let Some(body) = long_body(place.old)
    {
        return new == format!("\"\"\"{body}\"\"\"") && !body.contains("\"\"\"");
    }
    let Some(new) = new
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'))
    else {
        return false;
    };
    // A `"` would end the text, and a `\` or `{{` means something only between the right quotes.
    if new.contains(['"', '\\', '\n']) || new.contains("{{") {
        return false;
    }
    // A name becomes a word.
    if new == place.old {
        return true;
    }
    QUOTES.iter().any(|(open, close)| {
        let body = place.old.strip_prefix(*open);
        let body = body.and_then(|rest| rest.strip_suffix(*close));
        body == Some(new) && !new.contains([*open, *close]) && !place.has_single([*open, *close])
    })
}

/// Returns what is between three quotes and three quotes.
fn long_body(text: &str) -> Option<&str> {
    let is_double = |character: &char| is_quote(*character) && !"'‘’".contains(*character);
    let triple = |end: &str| end.chars().count() == 3 && end.chars().all(|it| is_double(&it));
    let start = text.char_indices().nth(3)?.0;
    let end = text.char_indices().rev().nth(2)?.0;
    (start <= end && triple(&text[..start]) && triple(&text[end..])).then(|| &text[start..end])
}

/// Returns whether an edit writes the same number differently: `.5` as `0.5`, `1_000` as `1000`.
fn is_number_edit(place: &Place<'_>, replacement: &str) -> bool {
    let is_part = |character: char| character.is_alphanumeric() || "_.,".contains(character);
    let before = place.before.trim_end_matches(is_part).len();
    let head = &place.before[before..];
    let tail = place
        .after
        .split(|it| !is_part(it))
        .next()
        .unwrap_or_default();
    if !(place.old.chars().all(is_part) && replacement.chars().all(is_part)) {
        return false;
    }
    let old = format!("{head}{}{tail}", place.old);
    let new = format!("{head}{replacement}{tail}");
    let digits = |text: &str| text.chars().take_while(|it| is_digit_or(*it)).count();
    // What follows the digits is the unit, which stays.
    let (old, old_unit) = old.split_at(digits(&old));
    let (new, new_unit) = new.split_at(digits(&new));
    let (old, old_comma) = (old.trim_end_matches(','), old.ends_with(','));
    let (new, new_comma) = (new.trim_end_matches(','), new.ends_with(','));
    old != new
        && (old_unit, old_comma) == (new_unit, new_comma)
        && plain_number(old).is_some_and(|value| Some(value) == plain_number(new))
}

fn is_digit_or(character: char) -> bool {
    character.is_ascii_digit() || "_.,".contains(character)
}

/// Returns a number in the language's own spelling; `None` if a reader may take it for several.
fn plain_number(text: &str) -> Option<String> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let are_digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    let mut groups = whole.split('_');
    let first = groups.next().filter(|first| are_digits(first))?;
    let rest: Vec<&str> = groups.collect();
    let are_thousands = rest
        .iter()
        .all(|group| group.len() == 3 && are_digits(group));
    let is_led = rest.is_empty() || (1..=3).contains(&first.len());
    if !(are_thousands && is_led && are_digits(fraction)) || fraction.is_empty() {
        return None;
    }
    let whole = if whole.is_empty() { "0" } else { whole };
    Some(format!("{}.{fraction}", whole.replace('_', "")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fab_grammar::FileId;

    /// Lines with an edit `[[old|new]]`, and whether it only spells something differently.
    const EDITS: &[(&str, bool)] = &[
        ("a > 1px[[&&| and ]]b > 1px", true),
        ("near[[&&|and]]distance(a, b)", false),
        ("near [[&&|and]]& far", false),
        ("[[!|not ]](a > b)", true),
        ("a [[!|not ]]= b", false),
        ("a[[!|not ]]b", false),
        ("a :[[=|:]] b", false),
        ("a [[:|=]]= b", false),
        ("a [[:=|=]] b", true),
        ("f(a [[=|:]] -1)", true),
        ("a [[=>|->]] b", true),
        ("a [[to|->]] b", true),
        ("a [[≤|<=]] b", true),
        ("a [[>|<]] b", false),
        ("a [[>=|<=]] b", false),
        ("pick[[;|]] place", false),
        ("pick[[;|]]place", false),
        ("horizon 2[[;|]] # two", true),
        ("f(a, b[[,|]])", true),
        ("[[//|#]] 2 steps", true),
        ("20 [[//|#]] 2", false),
        ("near [[//|#]] far", false),
        ("near[[//|#]]too near, in pixels", false),
        ("20px [[//|#]] too near, in pixels", true),
        ("45[[°|deg]]", true),
        ("45[[°|deg]]C", false),
        ("45 [[degrees|deg]], 90deg", true),
        ("45 [[degrees|rad]]", false),
        ("[[top_left|back_left]]", false),
        ("quality: [[|0]].04", true),
        ("0.0[[|0]].4", false),
        ("1..[[|0]].4", false),
        ("last[[|0]].4", false),
        ("1[[,|.]]000mm", false),
        ("0[[,|.]]5", false),
        ("1[[_000|000]]", true),
        ("1[[_000|000]]mm, 3", true),
        ("1[[_0|0]]", false),
        ("1000[[_000|000]]", false),
        ("x1[[_000|000]]", false),
        ("[['near'|\"near\"]]", true),
        ("[['near'|\"far\"]]", false),
        ("[['don'|\"don\"]]t go'", false),
        ("[['the dogs'|\"the dogs\"]] bowl'", false),
        ("one of [['soft'|\"soft\"]], 'firm'", true),
        ("[[''|\"\"]]'", false),
        ("[['a \"b\" c'|\"a \"b\" c\"]]", false),
        ("[['a\\b'|\"a\\b\"]]", false),
        ("[[“it’s”|\"it’s\"]]", true),
        ("[[“near|\"near\"]]", false),
        ("[[‘it’s’|\"it’s\"]]", false),
        ("[[“““a \"b\"”””|\"\"\"a \"b\"\"\"\"]]", true),
        ("grip == [[soft|\"soft\"]]", true),
        ("grip == [[soft|\"firm\"]]", false),
    ];

    #[test]
    fn an_edit_keeps_numbers_names_texts_and_tokens() {
        for (line, kept) in EDITS {
            let (before, rest) = line.split_once("[[").expect(line);
            let (edit, after) = rest.split_once("]]").expect(line);
            let (old, new) = edit.split_once('|').expect(line);
            let text = format!("{before}{old}{after}");
            let span = Span::new(FileId::FIRST, before.len()..before.len() + old.len());
            assert_eq!(keeps_content(&text, span, new), *kept, "{line}");
        }
    }
}
