//! Reads what sentences state about each field.
//!
//! In: a text without its asides, objects and tables. Out: claims, each with a value, or with the reason why the words
//! are not one. A sentence that negates, doubts or asks claims nothing.

use super::choice::Expected;
use super::claim::{Claim, Claimed, Named};
use super::corners;
use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, Token};
use super::names::{self, Form, Mention};
use super::point::{self, Brackets, PointFound};
use super::quantity::{self, AnswerUnit};
use super::sizes;
use super::value::{self, Clarity, Context, Found};
use super::wordlist::{PLACES, UNREAL, words};
use super::words;
use crate::data::actions::{ActionField, Choices, Value};
use crate::pointing::Notation;
use std::ops::Range;

/// The most words between a value and what is said of its effect.
const MAX_EFFECT: usize = 8;

/// Verbs that move a cloth, perhaps too far.
const MOVING: &[&str] = words!("takes pulls drags carries brings moves lifts puts");

/// Verbs for what a fitting value does not do.
const HARMING: &[&str] = words!("slips slip tears crushes loses lose");

/// What begins another clause.
const JOINING: &[&str] = words!("and but while whereas so because");

/// Verbs that move what is picked, in the answer's direction.
const CARRYING: &[&str] = words!(
    "pull pulls pulled carry carries carried drag drags dragged draw draws drawn move moves moved bring brings brought"
);

/// What is needed to read an answer.
pub(super) struct Reader<'a> {
    pub fields: &'a [ActionField],
    /// The cloth's longer side, metres.
    pub edge_m: f64,
    /// How the scene's points are written.
    pub notation: &'a Notation,
}

/// Words before a name, in its sentence, that make it no statement of the answer.
const DENYING: &[&str] = words!(
    "case not don't don’t didn't isn't won't wouldn't shouldn't can't cannot never avoid avoiding no nor neither
    previous previously last old earlier former initial initially example e.g. rejected refused wrong incorrect
    instead than considered considering candidate candidates alternative alternatives alternatively otherwise option options choices if
    unless could might may maybe perhaps possible possibly unlike was were wanted template tempting without ❌ ✗ rather human ideally"
);

/// Words between a name and its sign that change nothing.
const QUALIFYING: &[&str] = words!(
    "that i recommend propose suggest choose chose chosen selected have i've identified for this step action would use
    final pixel in image on the cloth of my we move robot gripper fold first next pixels here should used
    pull movement motion"
);

/// Words after `is` that say that a value is not chosen.
const UNFIT: &[&str] = words!(
    "unnecessary reserved excessive overkill too not never risky unsuitable unneeded needless inappropriate insufficient
    inadequate likely bound prone apt weak"
);

/// The most tokens from a point to `this is the pick point`.
const MAX_POINTED: usize = 40;

/// The most tokens after a name that may state the field.
const MAX_CLAUSE: usize = 400;

/// The most tokens between a name and a remark that names it again.
const MAX_REMARK: usize = 16;

/// The most tokens of a sentence that moves something.
const MAX_MOTION: usize = 30;

/// Verbs after a name that tell what another value did.
const TELLING: &[&str] = words!(
    "lost slipped slips tears tore creases creased leaves left failed fails damages crushes drops dropped"
);

/// Verbs before a direction in which something already lies.
const LYING: &[&str] = words!(
    "points pointing faces facing lies lying extends extending sticks sticking stretches stretching"
);

/// The most words of a field's name in another language.
const MAX_TRANSLATION: usize = 3;

/// The most words between `must end up` and its point.
const MAX_LANDING: usize = 14;

/// The most words between a verb and `from`.
const MAX_CARRIED: usize = 8;

/// The most tokens before a name that may deny it.
const MAX_BEFORE: usize = 60;

impl Reader<'_> {
    /// Returns what the sentences of a text state.
    ///
    /// - `span`: where the text stands, if it is not the answer itself.
    pub fn sentences(&self, text: &str, span: Option<Range<usize>>) -> Vec<Claim> {
        let tokens = lexer::tokens(text);
        let mentions = names::mentions(self.fields, &tokens);
        let sentences = Sentences {
            reader: self,
            text,
            tokens: &tokens,
            mentions: &mentions,
        };
        let found = (0..mentions.len()).filter_map(|index| sentences.claim(index));
        found
            .chain(sentences.motions())
            .chain(sentences.taken())
            .chain(sentences.pulls())
            .chain(sentences.courses())
            .chain(sentences.corners())
            .chain(sentences.sizes())
            .chain(sentences.judgements())
            .chain(sentences.carries())
            .chain(sentences.landings())
            .map(|claim| Claim {
                span: span.clone().unwrap_or(claim.span),
                ..claim
            })
            .collect()
    }

    /// Reads a text that states one field's value and nothing else.
    pub fn whole(
        &self,
        field: usize,
        text: &str,
        hint: Option<AnswerUnit>,
        clarity: Clarity,
    ) -> Claimed {
        let tokens = lexer::tokens(text);
        let context = self.context(field, text, hint, clarity);
        match value::read(&mut Cursor::new(&tokens), &context) {
            Found::Value(value, note) => Claimed::Value(value, note),
            Found::Bad(why) | Found::Prose(why) => Claimed::Bad(why),
            Found::Nothing | Found::Rejected => Claimed::Nothing,
        }
    }

    pub(super) fn context<'a>(
        &'a self,
        field: usize,
        whole: &'a str,
        hint: Option<AnswerUnit>,
        clarity: Clarity,
    ) -> Context<'a> {
        Context {
            expected: Expected {
                field: &self.fields[field],
                edge_m: self.edge_m,
                hint,
            },
            notation: self.notation,
            whole,
            clarity,
            ends_at_name: false,
        }
    }
}

fn is_length(field: &ActionField) -> bool {
    matches!(field.choices, Choices::Lengths { .. })
}

fn is_angle(field: &ActionField) -> bool {
    matches!(field.choices, Choices::Directions { .. })
}

/// The sentences of a text, with the fields that they mention.
struct Sentences<'a> {
    reader: &'a Reader<'a>,
    text: &'a str,
    tokens: &'a [Token<'a>],
    mentions: &'a [Mention],
}

/// What stands between a name and its value.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    /// `=`, `:`, `->`
    Assigns,
    /// `is`, `will be`, `-`
    Says,
    None,
}

impl<'a> Sentences<'a> {
    fn field(&self, mention: Mention) -> &'a ActionField {
        &self.reader.fields[mention.field]
    }

    /// Returns a claim that stands in these tokens.
    fn claim_in(&self, field: usize, tokens: Range<usize>, claimed: Claimed) -> Claim {
        let span = self.tokens[tokens.start].at..self.tokens[tokens.end - 1].end();
        Claim::new(field, span, claimed)
    }

    /// Reads what is stated about the field of a mention.
    fn claim(&self, index: usize) -> Option<Claim> {
        let mention = self.mentions[index];
        let field = self.field(mention);
        let is_point = field.is_point();
        if let Some(claim) = self.pair(index) {
            return Some(claim);
        }
        let limit = self.limit(index);
        let mut cursor = Cursor::at(&self.tokens[..limit], mention.end);
        if cursor.peek().is_some_and(|token| token.gap >= Gap::Item)
            && !self.is_alone(index, mention.end)
        {
            return None;
        }
        if mention.form == Form::Name {
            names::skip_nouns(&mut cursor, field);
        } else {
            cursor.eat_word("up");
        }
        let named = cursor.at;
        if self.is_remark_above(mention, named) {
            return None;
        }
        let mut hint = None;
        if is_point {
            if let Some(order) = point::echo(&mut cursor)
                && order != self.reader.notation.order()
            {
                return Some(self.claim_in(
                    mention.field,
                    mention.at..cursor.at,
                    Claimed::Bad("its coordinates are in another order".to_owned()),
                ));
            }
        } else {
            hint = self.hint(&mut cursor);
        }
        if cursor.is_joined() && !value::ends_sentence(self.tokens, cursor.at) {
            cursor.eat_sign('.');
        }
        self.skip_translation(&mut cursor);
        self.skip_wrap(&mut cursor, mention);
        let axis_at = cursor;
        // `<pick x="10" y="20"/>` and `<pick>(10, 20)</pick>`
        let is_tag = mention.at > 0
            && (self.tokens[mention.at - 1].is_sign('<') || self.is_attribute(mention));
        if is_tag
            && is_point
            && let Some(claim) = self.tagged_axes(mention, cursor)
        {
            return Some(claim);
        }
        if is_tag && hint.is_none() {
            hint = unit_attribute(&mut cursor);
        }
        let mut sign = if is_tag {
            tag_sign(&mut cursor)
        } else if is_point && self.is_row(mention, cursor) {
            cursor.at += 1;
            Sign::Assigns
        } else {
            sign(&mut cursor)
        };
        if sign == Sign::None && mention.form == Form::Name {
            sign = self.qualified(&mut cursor, mention);
        }
        let is_alone = sign == Sign::None && self.is_alone(index, cursor.at);
        let clarity = if sign == Sign::None && !is_alone {
            Clarity::Spoken
        } else {
            Clarity::Assigned
        };
        if self.is_denied(mention.at, clarity, is_alone || sign == Sign::Assigns)
            || (clarity == Clarity::Spoken && self.describes(mention))
        {
            return None;
        }
        if mention.form == Form::VerbTo && sign != Sign::None {
            return None;
        }
        if sign == Sign::None
            && !is_alone
            && let Some(claim) = self.before(index).or_else(|| self.pointed_at(mention))
        {
            return Some(claim);
        }
        if is_point && let Some(claim) = self.axis(mention, axis_at) {
            return Some(claim);
        }
        if sign == Sign::None
            && cursor.at == mention.end
            && cursor.is_joined()
            && !is_bracket(&cursor)
        {
            return None;
        }
        let hedged = sign == Sign::None && hedge(&mut cursor);
        let start = cursor.at;
        // A new line may begin the value only if nothing else does.
        let begins = cursor.peek().map_or(Gap::Block, |token| token.gap);
        if sign == Sign::None && !is_alone && begins >= Gap::Item {
            return None;
        }
        if begins >= Gap::Line && self.begins_statement(start) {
            return None;
        }
        // `Speed: 200 was used in the previous step`
        let was = (start + 1..start + 3).find(|at| {
            self.tokens
                .get(*at)
                .is_some_and(|it| it.is_any(&["was", "were"]))
        });
        // `About the grip: soft would lose the cloth`
        let is_number = self
            .tokens
            .get(start)
            .is_some_and(|it| it.kind == Kind::Number);
        // `Grip: A very firm one would leave marks`
        let is_article = self
            .tokens
            .get(start)
            .is_some_and(|it| it.is_any(&["a", "an", "the"]));
        let n_ahead = 1 + usize::from(is_number) + 3 * usize::from(is_article);
        let words = self.tokens[start..limit].iter().skip(1);
        let is_supposed = words
            .take(n_ahead)
            .any(|it| it.is_any(&["would", "could", "might"]) && it.gap < Gap::Line);
        if is_supposed || was.is_some_and(|at| self.is_weighed(mention.at, at)) {
            return None;
        }
        let mut context = self.reader.context(mention.field, self.text, hint, clarity);
        context.ends_at_name = self
            .tokens
            .get(limit)
            .is_some_and(|next| next.gap < Gap::Line);
        // `**Distance:**` above a list of distances, each with where it leads
        let heads_list =
            !self.field(mention).is_point() && cursor.peek().is_some_and(|it| it.gap >= Gap::Line);
        if heads_list {
            let listed = self.listed(start..limit, &context);
            if listed.windows(2).any(|pair| pair[0].value != pair[1].value) {
                let why = "it lists several values".to_owned();
                let span = mention.at..start + 1;
                return Some(self.claim_in(mention.field, span, Claimed::Prose(why, listed)));
            }
        }
        let found = value::read(&mut cursor, &context);
        let is_firm = sign == Sign::Assigns && mention.form == Form::Name;
        let claimed = match found {
            Found::Value(value, _) if hedged => Claimed::Hedge(value),
            Found::Value(value, note) => Claimed::Value(value, note),
            Found::Bad(why) if is_firm && !(heads_list && why == value::SEVERAL_NUMBERS) => {
                Claimed::Bad(why)
            }
            Found::Bad(why) | Found::Prose(why) if is_firm => {
                match value::named(cursor, &context) {
                    Some(named) => Claimed::Prose(
                        why,
                        named
                            .into_iter()
                            .map(|(value, is_worded)| Named { value, is_worded })
                            .collect(),
                    ),
                    None => Claimed::Unclear(why),
                }
            }
            Found::Bad(_) | Found::Prose(_) | Found::Rejected | Found::Nothing => Claimed::Nothing,
        };
        if matches!(claimed, Claimed::Nothing) {
            return if clarity == Clarity::Assigned {
                self.before(index)
            } else {
                None
            };
        }
        if mention.form == Form::VerbTo && !self.is_moved_to(named, cursor.at) {
            return None;
        }
        // `A short pull puts it at about (10, 20)` tells where it leads.
        let leads = |token: &Token<'_>| {
            token.is_any(&["to", "onto", "toward", "towards", "until"])
                || token.is_any(&["puts", "ends", "lands", "leaves"])
        };
        if matches!(mention.form, Form::VerbAt | Form::PassiveAt)
            && self.tokens[named..cursor.at].iter().any(leads)
        {
            return None;
        }
        // `Moving (182, 41) would fold the wrong corner.`
        let is_supposed = mention.form != Form::Name
            && cursor
                .peek()
                .is_some_and(|next| next.is_any(value::CONDITIONAL));
        let is_weighed = clarity == Clarity::Spoken && self.is_weighed(mention.at, cursor.at);
        if is_supposed || is_weighed || self.asks(cursor.at, clarity) {
            return None;
        }
        let last = cursor.at.max(start + 1).min(limit) - 1;
        let end = self.tokens[last.max(mention.at)].end();
        Some(Claim::new(
            mention.field,
            self.tokens[mention.at].at..end,
            claimed,
        ))
    }

    /// Returns the values that begin the items of a list: `- 10 mm: too short ↵ - 62.5 mm: opens it`.
    fn listed(&self, clause: Range<usize>, context: &value::Context<'_>) -> Vec<Named> {
        let tokens = &self.tokens[..clause.end];
        let mut values = Vec::new();
        let mut item = Some(clause.start).filter(|at| tokens[*at].gap == Gap::Item);
        while let Some(at) = item {
            if let Some((value, _)) = value::bare(&mut Cursor::at(tokens, at), context) {
                values.push(Named {
                    value,
                    is_worded: false,
                });
            }
            let next = (at + 1..tokens.len()).find(|at| tokens[*at].gap >= Gap::Item);
            item = next.filter(|at| tokens[*at].gap == Gap::Item);
        }
        values
    }

    /// Returns whether a name only explains what is before it, above a list or a line: `Let go at the center (place):`.
    fn is_remark_above(&self, mention: Mention, end: usize) -> bool {
        let [.., before, open] = &self.tokens[..mention.at] else {
            return false;
        };
        let [close, colon, next, ..] = &self.tokens[end.min(self.tokens.len())..] else {
            return false;
        };
        before.kind == Kind::Word
            && open.is_sign('(')
            && open.gap < Gap::Line
            && close.is_sign(')')
            && colon.is_sign(':')
            && next.gap >= Gap::Line
    }

    /// Reads the point before `so this is the pick point` or `which is the pick point`, in the same sentence or the one before.
    fn pointed_at(&self, mention: Mention) -> Option<Claim> {
        if mention.form != Form::Name || !self.field(mention).is_point() {
            return None;
        }
        let mut end = mention.at;
        while end > 0 && self.tokens[end - 1].is_any(&["the", "my", "our"]) {
            end -= 1;
        }
        let [.., this, is] = &self.tokens[..end] else {
            return None;
        };
        if !(this.is_any(&["this", "that", "which"]) && is.is("is")) {
            return None;
        }
        let end = end - 2;
        let mut start = self.sentence(end).start;
        let begins = self.tokens[start..end]
            .iter()
            .all(|it| it.is_any(&["so", "hence", "thus"]));
        if begins && start > 0 && self.tokens[start].gap < Gap::Item {
            start = self.sentence(start - 1).start;
        }
        let context = self
            .reader
            .context(mention.field, self.text, None, Clarity::Spoken);
        let (begin, (value, note)) = (start.max(end.saturating_sub(MAX_POINTED))..end)
            .rev()
            .find_map(|begin| {
                let mut cursor = Cursor::at(&self.tokens[..end], begin);
                Some((begin, value::bare(&mut cursor, &context)?))
            })?;
        let is_denied = |at| self.is_denied(at, Clarity::Spoken, false);
        if is_denied(begin) || is_denied(mention.at) || self.is_weighed(begin, mention.end) {
            return None;
        }
        let claimed = Claimed::Value(value, note);
        Some(self.claim_in(mention.field, begin..mention.end, claimed))
    }

    /// Returns whether a tag's attribute names the field: `<parameter name="pick">`, `<parameter=pick>`.
    fn is_attribute(&self, mention: Mention) -> bool {
        let [.., first, open, key, equals] = &self.tokens[..mention.at] else {
            return false;
        };
        let mut behind = Cursor::at(self.tokens, mention.end);
        names::skip_nouns(&mut behind, self.field(mention));
        behind.eat_signs(&['"', '\'']);
        let closes = behind.eat_sign('>');
        let keys = ["name", "key", "id", "field", "param"];
        let names = first.is_sign('<') && key.is_any(&keys);
        let is_parameter = open.is_sign('<') && key.is_any(&["parameter", "param", "argument"]);
        (names || is_parameter) && equals.is_sign('=') && closes
    }

    /// Returns whether a line is the row `pick,65,77` of a table without lines between its columns.
    fn is_row(&self, mention: Mention, cursor: Cursor<'_, '_>) -> bool {
        let is_first = mention.at == 0 || self.tokens[mention.at].gap >= Gap::Line;
        let ends = cursor.ahead(4).is_none_or(|next| next.gap >= Gap::Line);
        let cells = cursor.rest().iter().take(4).map(|token| token.kind);
        let comma = Kind::Sign(',');
        is_first && ends && cells.eq([comma, Kind::Number, comma, Kind::Number])
    }

    /// Reads `pick → place: (71, 178) → (149, 66)`, for either field.
    fn pair(&self, index: usize) -> Option<Claim> {
        let mention = self.mentions[index];
        let joins = |at: usize| {
            self.tokens.get(at).is_some_and(|token| {
                token.is_any(&["and", "to"])
                    || matches!(token.kind, Kind::Sign('→' | '/' | ',' | '-' | '–' | '&'))
            })
        };
        let follows = |first: &Mention, second: &Mention| {
            let is_pair = first.form == Form::Name
                && second.form == Form::Name
                && first.field != second.field
                && (first.end + 1..first.end + 4).contains(&second.at)
                && self.tokens[first.end + 1..second.at]
                    .iter()
                    .all(|token| token.is_any(&["the", "and", "point"]));
            is_pair
                && (joins(first.end) || self.tokens[first.end].is("point"))
                && self.field(*first).is_point()
                && self.field(*second).is_point()
        };
        let next = self
            .mentions
            .get(index + 1)
            .filter(|next| follows(&mention, next));
        let last = index
            .checked_sub(1)
            .map(|index| self.mentions[index])
            .filter(|last| follows(last, &mention));
        let (second, is_first) = match (next, last) {
            (Some(next), None) => (*next, true),
            (None, Some(_)) => (mention, false),
            _ => return None,
        };
        let mut cursor = Cursor::at(self.tokens, second.end);
        cursor.eat_any(&["point", "points", "positions"]);
        let is_denied = self.is_denied(
            if is_first {
                mention.at
            } else {
                self.mentions[index - 1].at
            },
            Clarity::Assigned,
            false,
        );
        let is_stated = cursor.eat_signs(&['=', ':']).is_some() || cursor.eat_any(&["are", "is"]);
        if is_denied || !is_stated {
            return None;
        }
        let start = cursor.at;
        let PointFound::Pixel(first, _) =
            point::read(&mut cursor, self.reader.notation, Brackets::Needed)
        else {
            return None;
        };
        if !joins(cursor.at) {
            return None;
        }
        cursor.at += 1;
        let PointFound::Pixel(other, _) =
            point::read(&mut cursor, self.reader.notation, Brackets::Needed)
        else {
            return None;
        };
        let end = cursor.at;
        cursor.eat_sign(',');
        cursor.eat_word("respectively");
        let is_last = cursor.peek().is_none_or(|next| {
            next.gap >= Gap::Line || value::ends_sentence(self.tokens, cursor.at)
        });
        let claimed = Claimed::Value(Value::Point(if is_first { first } else { other }), None);
        is_last.then_some(self.claim_in(mention.field, start..end, claimed))
    }

    /// Skips the name in another language: `Pick point / Greifpunkt =`.
    fn skip_translation(&self, cursor: &mut Cursor<'_, '_>) {
        let start = *cursor;
        let is_named = |at: usize| {
            self.mentions
                .binary_search_by_key(&at, |mention| mention.at)
                .is_ok()
        };
        let mut is_words = cursor.eat_sign('/');
        let begin = cursor.at;
        while is_words
            && cursor.at < begin + MAX_TRANSLATION
            && cursor
                .peek()
                .is_some_and(|word| word.kind == Kind::Word && word.gap < Gap::Line)
        {
            is_words = !is_named(cursor.at);
            cursor.at += 1;
        }
        let is_sign = |token: &Token<'_>| matches!(token.kind, Kind::Sign('=' | ':'));
        if !(is_words && cursor.at > begin && cursor.peek().is_some_and(is_sign)) {
            *cursor = start;
        }
    }

    /// Skips the end of what wraps a name: `P_{pick}`, `(pick)`.
    fn skip_wrap(&self, cursor: &mut Cursor<'_, '_>, mention: Mention) {
        let before = mention.at.checked_sub(1).map(|at| self.tokens[at].kind);
        match before {
            Some(Kind::Sign('{')) => cursor.eat_sign('}'),
            Some(Kind::Sign('[')) => cursor.eat_sign(']'),
            Some(Kind::Sign('(')) => cursor.eat_sign(')'),
            _ => false,
        };
    }

    /// Skips words and a remark in brackets between a name and its sign: `Pick point that I choose is`.
    fn qualified(&self, cursor: &mut Cursor<'_, '_>, mention: Mention) -> Sign {
        let start = *cursor;
        if cursor.eat_sign('(') {
            // `(row, column)` is another order than the one asked for.
            while cursor.peek().is_some_and(|token| {
                token.kind == Kind::Word
                    && !token.is_any(&["row", "column", "y", "v", "normalized", "normalised"])
                    || matches!(token.kind, Kind::Sign('-' | ','))
            }) {
                cursor.at += 1;
            }
            if !cursor.eat_sign(')') {
                *cursor = start;
            }
        }
        for _ in 0..6 {
            let is_short_id = cursor.peek().is_some_and(|token| {
                token.kind == Kind::Word
                    && token.text.len() <= 3
                    && token.text.contains(|letter: char| letter.is_ascii_digit())
            });
            // A point's noun with two letters exchanged is a slip.
            let is_slip = self.field(mention).is_point()
                && cursor.peek().is_some_and(|token| {
                    token.is_any(&["piont", "pont", "poin", "ponit", "poit", "piint"])
                });
            if is_short_id || is_slip {
                cursor.at += 1;
            } else if cursor.peek().is_none_or(|token| token.gap >= Gap::Line)
                || !cursor.eat_any(QUALIFYING)
            {
                break;
            }
        }
        let found = if cursor.at > start.at {
            sign(cursor)
        } else {
            Sign::None
        };
        if found == Sign::None {
            *cursor = start;
        }
        found
    }

    /// Reads `<x>145</x><y>88</y>` after `<pick>`.
    fn tagged_axes(&self, mention: Mention, cursor: Cursor<'_, '_>) -> Option<Claim> {
        let mut cursor = Cursor::at(self.tokens, cursor.at);
        cursor.eat_sign('>').then_some(())?;
        let mut one = |name: &str| {
            let opens = cursor.eat_sign('<') && cursor.eat_word(name) && cursor.eat_sign('>');
            let number = point::number(&mut cursor).filter(|_| opens)?;
            cursor
                .eat_sign(lexer::TAG_END)
                .then_some((number, cursor.at))
        };
        let ((x, _), (y, end)) = (one("x")?, one("y")?);
        let PointFound::Pixel(pixel, note) = point::at(x, y, self.reader.notation) else {
            return None;
        };
        Some(self.claim_in(
            mention.field,
            mention.at..end,
            Claimed::Value(Value::Point(pixel), note),
        ))
    }

    /// Returns where the text that may state a mentioned field ends: where another field is named, or its tag ends.
    fn limit(&self, index: usize) -> usize {
        let mention = self.mentions[index];
        let has_words = matches!(self.field(mention).choices, Choices::Words { .. });
        let most = self.tokens.len().min(mention.end + MAX_CLAUSE);
        // Each token is counted once, however many verbs stand in a bracket.
        let (mut seen, mut depth, mut is_broken) = (mention.end, 0_usize, false);
        let named = self.mentions[index + 1..]
            .iter()
            .skip_while(|next| next.at <= mention.at)
            .take_while(|next| next.at < most)
            .find(|next| {
                while seen < next.at {
                    let token = &self.tokens[seen];
                    is_broken |= token.gap >= Gap::Line;
                    match token.kind {
                        Kind::Sign('(') => depth += 1,
                        Kind::Sign(')') => depth = depth.saturating_sub(1),
                        _ => {}
                    }
                    seen += 1;
                }
                // `Grip = soft (a firm grip could tear it)`
                let is_remark = has_words
                    && next.at < mention.end + MAX_REMARK
                    && next.field == mention.field
                    && next.form == Form::Name
                    && self.tokens.get(next.end).is_some_and(|verb| {
                        verb.gap < Gap::Line
                            && verb.kind == Kind::Word
                            && !verb.is_any(&["is", "for", "with", "at", "of", "and", "or", "as"])
                    });
                // `Release height = 0 mm (do not drop it)`
                let is_beside = next.form != Form::Name && depth > 0 && !is_broken;
                // `Speed = 500 mm/s for the lift, 100 mm/s after it`
                let is_noun = next.form == Form::Name
                    && self.tokens[next.at - 1].is("the")
                    && self.tokens[next.at].gap < Gap::Line
                    && self
                        .tokens
                        .get(next.end)
                        .is_some_and(|sign| matches!(sign.kind, Kind::Sign(',' | ';' | '.')));
                !is_remark && !is_beside && !is_noun
            });
        let next = named.map_or(most, |next| next.at);
        let end = (mention.end..next).find(|at| self.tokens[*at].is_sign(lexer::TAG_END));
        end.map_or(next, |at| at + 1)
    }

    /// Returns whether the line at a token begins with a statement of its own.
    fn begins_statement(&self, at: usize) -> bool {
        self.mentions
            .binary_search_by_key(&at, |mention| mention.at)
            .is_ok()
    }

    /// Returns whether a mention stands alone on its line, as a heading.
    fn is_alone(&self, index: usize, end: usize) -> bool {
        let mention = self.mentions[index];
        mention.form == Form::Name
            && self.tokens[mention.at].gap >= Gap::Line
            && self
                .tokens
                .get(end)
                .is_some_and(|next| next.gap >= Gap::Line)
    }

    /// Reads the unit next to a field's name, `(degrees)`, `[mm]`, `in deg`; otherwise the cursor does not move.
    fn hint(&self, cursor: &mut Cursor<'_, '_>) -> Option<AnswerUnit> {
        let start = *cursor;
        let open = cursor.eat_signs(&['(', '[']);
        cursor.eat_word("in");
        let found = quantity::unit(cursor);
        let is_closed = match open {
            Some('(') => cursor.eat_sign(')'),
            Some(_) => cursor.eat_sign(']'),
            None => true,
        };
        let is_beside = matches!(
            cursor.peek().map(|token| token.kind),
            Some(Kind::Sign('=' | ':' | '→' | '|'))
        ) || cursor.peek().is_some_and(|token| token.is("is"));
        if found.is_none() || !is_closed || !is_beside {
            *cursor = start;
            return None;
        }
        found
    }

    /// Returns whether the sentence before a mention negates it, doubts it or makes it one about something else.
    fn is_denied(&self, at: usize, clarity: Clarity, is_firm: bool) -> bool {
        let mut index = at;
        while index > at.saturating_sub(MAX_BEFORE) {
            let gap = self.tokens[index].gap;
            if gap >= Gap::Item || (gap == Gap::Line && (is_firm || clarity == Clarity::Assigned)) {
                return false;
            }
            index -= 1;
            if value::ends_sentence(self.tokens, index) {
                return false;
            }
            let token = &self.tokens[index];
            if matches!(token.kind, Kind::Sign(';' | '❌' | '✗' | '✘' | '🚫')) {
                return !token.is_sign(';');
            }
            let is_correction = token.is("no")
                && self
                    .tokens
                    .get(index + 1)
                    .is_some_and(|next| next.is_sign(',') || next.is("wait"));
            // `Pick (1, 2), not (3, 4), and place …`: what is denied there is another value.
            let is_other = !token.is_any(&["if", "unless", "example", "e.g."])
                && (index + 1..at).any(|between| {
                    self.tokens[between].is_sign(',') || self.tokens[between].is("but")
                })
                && self.mentions.first().is_some_and(|first| first.at < index);
            // `not 270 deg, which would pull against the fold`
            let is_supposed = token.is("would")
                && index + 3 >= at
                && self.tokens[..index]
                    .last()
                    .is_some_and(|it| it.is_any(&["which", "left", "right", "other", "one"]));
            // `we can repeat with 62.5 mm`
            let is_later = token.is("repeat")
                && self.tokens[..index]
                    .last()
                    .is_some_and(|it| it.is_any(&["can", "could", "then"]));
            // `the midpoint of pick and place is (20, 30)`
            let is_between = token.is_any(&["midpoint", "midway", "halfway"])
                && self.tokens[index + 1].is_any(&["of", "between"]);
            // `Option A: corner (10, 20)`
            let labels = token.is("option") && {
                let behind = &self.tokens[index + 1..at];
                matches!(behind, [label, sign, ..] if label.text.len() == 1 && sign.is_sign(':'))
            };
            let is_proposed = is_supposed
                || is_between
                || is_later
                || token.is("you")
                    && self.tokens[index + 1..at].iter().take(3).any(|next| {
                        next.is_any(&[
                            "proposed",
                            "suggested",
                            "said",
                            "mentioned",
                            "asked",
                            "gave",
                            "showed",
                            "wrote",
                            "wanted",
                            "want",
                        ])
                    });
            if is_proposed || (token.is_any(DENYING) && !labels && !is_correction && !is_other) {
                return true;
            }
        }
        false
    }

    /// Returns whether a direction describes how something lies: `the flap points in the direction 225 deg`.
    fn describes(&self, mention: Mention) -> bool {
        let before = &self.tokens[mention.at.saturating_sub(4)..mention.at];
        self.is_direction(mention)
            && before.iter().any(|token| token.is_any(LYING))
            && before.iter().any(|token| token.is("in"))
            && !before
                .iter()
                .any(|token| token.is_sign(',') || token.gap >= Gap::Line)
    }

    /// Returns whether the sentence at a token ends with a question mark; what is assigned ends with its line.
    fn asks(&self, at: usize, clarity: Clarity) -> bool {
        for (index, token) in self.tokens.iter().enumerate().skip(at).take(60) {
            let is_next_line = clarity == Clarity::Assigned && token.gap >= Gap::Line;
            if token.gap >= Gap::Item || is_next_line {
                return false;
            }
            if token.is_sign('?') {
                return true;
            }
            if value::ends_sentence(self.tokens, index) {
                return false;
            }
        }
        false
    }

    /// Returns whether the sentence tells what a value did in an earlier try, or would do: `with a firm grip it could
    /// slip`.
    ///
    /// - `at`, `end`: where the statement begins and ends.
    fn is_weighed(&self, at: usize, end: usize) -> bool {
        let Range { start, end: last } = self.sentence(at);
        let rest = &self.tokens[end.min(last)..last];
        let is_supposed = self.tokens[start].is_any(&["with", "under"])
            && rest
                .iter()
                .any(|token| token.is_any(&["would", "could", "might", "may", "can"]));
        let is_earlier = rest
            .iter()
            .any(|token| token.is_any(&["previously", "earlier"]))
            || rest.windows(2).any(|pair| {
                pair[0].is_any(&["last", "previous"])
                    && pair[1].is_any(&[
                        "time",
                        "try",
                        "attempt",
                        "round",
                        "step",
                        "reply",
                        "answer",
                        "response",
                        "proposal",
                        "suggestion",
                        "message",
                    ])
            });
        // `pick (30, 40) instead of what I said earlier`
        let is_set_against = rest
            .iter()
            .any(|token| token.is_any(&["instead", "rather", "not", "than", "unlike"]));
        is_supposed || is_earlier && !is_set_against
    }

    /// Returns whether `to` leads to the point that ends at a token.
    fn is_moved_to(&self, start: usize, end: usize) -> bool {
        let words = &self.tokens[start..end];
        let to = words
            .iter()
            .rposition(|token| token.is_any(&["to", "onto"]));
        let from = words.iter().any(|token| token.is("from"));
        let opens = words
            .iter()
            .position(|token| matches!(token.kind, Kind::Sign('(' | '[')));
        !from && to.zip(opens).is_some_and(|(to, open)| to < open)
    }

    /// Returns pick and place of `drag the cloth from (50, 50) to (170, 170)`.
    fn carries(&self) -> Vec<Claim> {
        let (Some(pick), Some(place)) = (self.point_field("pick"), self.point_field("place"))
        else {
            return Vec::new();
        };
        let verbs = self
            .mentions
            .iter()
            .filter(|mention| mention.form == Form::VerbTo);
        let found = verbs.filter_map(|verb| {
            let begin = (verb.end..self.tokens.len().min(verb.end + MAX_CARRIED))
                .find(|at| self.tokens[*at].is("from"))?;
            let inside = &self.tokens[verb.at..=begin];
            let is_one_clause = inside[1..].iter().all(|token| {
                token.kind == Kind::Word && token.gap < Gap::Item && !token.is_any(DENYING)
            });
            if !is_one_clause || self.is_denied(verb.at, Clarity::Spoken, false) {
                return None;
            }
            let mut cursor = Cursor::at(self.tokens, begin + 1);
            let mut point = || {
                let start = cursor.at;
                match point::read(&mut cursor, self.reader.notation, Brackets::Needed) {
                    PointFound::Pixel(point, _) => {
                        let span = self.tokens[start].at..self.tokens[cursor.at - 1].end();
                        Some((cursor.eat_any(&["to", "onto"]), span, point))
                    }
                    _ => None,
                }
            };
            let (leads, from, picked) = point()?;
            let (_, to, placed) = point().filter(|_| leads)?;
            let ends = cursor.peek().is_none_or(|next| {
                next.gap >= Gap::Line || value::ends_sentence(self.tokens, cursor.at)
            });
            let claim = |field, span, point| {
                Claim::new(field, span, Claimed::Value(Value::Point(point), None))
            };
            let is_stated = ends && !self.asks(begin, Clarity::Spoken);
            is_stated.then(|| [claim(pick, from, picked), claim(place, to, placed)])
        });
        found.flatten().collect()
    }

    /// Returns the points at which something has to end: `the corner must end up exactly on the one at (10, 20)`.
    fn landings(&self) -> Vec<Claim> {
        let Some(place) = self.point_field("place") else {
            return Vec::new();
        };
        let found = (0..self.tokens.len()).filter_map(|at| {
            let mut cursor = Cursor::at(self.tokens, at);
            let ends = ["end up", "come to lie", "let go", "land"];
            let opens = ["opens at", "opens over", "lets go of it at", "lets go at"];
            let before = self.tokens[..at].last()?;
            let needs = before.is_any(&["must", "should", "to"]);
            // `The lower left corner, (10, 20), goes to the center, (30, 40).`
            let is_corner = before.is_any(&["corner", "tip", "flap"]) || before.is_sign(',');
            // `carries that corner across the cloth, and opens at (30, 40)`
            let is_gripper = before.is_any(&["gripper", "fingers"])
                || before.is_any(&["and", "then"])
                    && self.tokens[self.sentence(at).start..at].iter().any(|it| {
                        it.is_any(&["gripper", "fingers", "robot", "arm", "carries", "i"])
                    });
            let lands = needs && ends.iter().any(|words| cursor.eat_words(words))
                || is_gripper && opens.iter().any(|words| cursor.eat_words(words))
                || is_corner && cursor.eat_words("goes to");
            if !lands {
                return None;
            }
            let sentence = self.sentence(at);
            let is_unreal = self.tokens[sentence.start..at]
                .iter()
                .any(|it| it.is_any(UNREAL));
            if is_unreal {
                return None;
            }
            let words = { cursor.rest().iter() }.take(MAX_LANDING).take_while(|it| {
                let is_part = it.kind == Kind::Word || it.is_sign(',');
                let is_other = it.is_any(value::RELATING) && !it.is("over")
                    || it.is_any(&["and", "so", "short"]);
                is_part && !it.is_any(UNREAL) && !is_other
            });
            cursor.at += words.count();
            let begin = cursor.at;
            match point::read(&mut cursor, self.reader.notation, Brackets::Needed) {
                PointFound::Pixel(point, _) if begin < sentence.end => {
                    let claimed = Claimed::OneOf(vec![Value::Point(point)]);
                    Some(self.claim_in(place, at..cursor.at, claimed))
                }
                _ => None,
            }
        });
        found.collect()
    }

    /// Returns the lengths by which something is moved, without a field's name: `moving it by 1 edge`.
    fn motions(&self) -> Vec<Claim> {
        let mut claims = Vec::new();
        let Some(field) = names::only(self.reader.fields, is_length) else {
            return claims;
        };
        for at in 0..self.tokens.len() {
            let is_noun =
                at > 0 && self.tokens[at - 1].is_any(&["the", "a", "this", "each", "that", "one"]);
            let is_passive = at > 0
                && self.tokens[at - 1].is("be")
                && !self.tokens[..at - 1]
                    .last()
                    .is_some_and(|it| it.is_any(&["can", "cannot"]))
                && self.tokens[at].is_any(&["moved", "dragged", "pulled", "shifted"]);
            let is_active = self.tokens[at].is_any(&[
                "move", "moves", "moving", "drag", "drags", "dragging", "pull", "pulls", "pulling",
                "shift", "shifting", "carry", "carries",
            ]);
            if !(is_active || is_passive) || is_noun {
                continue;
            }
            let end = (at..self.tokens.len().min(at + MAX_MOTION)).find(|index| {
                *index > at
                    && (self.tokens[*index].gap >= Gap::Item
                        || self
                            .mentions
                            .binary_search_by_key(index, |it| it.at)
                            .is_ok_and(|found| !self.is_direction(self.mentions[found])))
                    || value::ends_sentence(self.tokens, *index)
            });
            let inside = &self.tokens[..end.unwrap_or(self.tokens.len().min(at + MAX_MOTION))];
            let context = self.reader.context(field, self.text, None, Clarity::Spoken);
            let found = (at + 1..inside.len()).find_map(|begin| {
                let mut cursor = Cursor::at(inside, begin);
                let joined = inside[begin - 1]
                    .is_any(&["by", "it", "cloth", "corner", "for", "over"])
                    || inside[begin - 1].is_any(&["just", "only"])
                        && (begin == at + 2 || inside[begin - 2].is_any(&["by", "it"]))
                    || inside[begin - 1].is("of")
                        && inside[begin - 2]
                            .is_any(&["pull", "move", "distance", "length", "drag"])
                    || begin == at + 1;
                let (value, note) = value::bare(&mut cursor, &context).filter(|_| joined)?;
                let is_part = inside[begin..cursor.at]
                    .iter()
                    .any(|token| token.is_sign('%') || token.is("percent"));
                if is_part {
                    return None;
                }
                Some((begin, cursor.at, value, note))
            });
            let Some((begin, end, value, note)) = found else {
                continue;
            };
            // `a pull of 10 mm is all that is needed`
            let suffices = { self.tokens[end..].iter().take(2) }
                .any(|token| token.is_any(&["all", "enough"]))
                || Cursor::at(self.tokens, end).eat_words("and no more");
            let is_doubted = !suffices && { self.tokens[end..].iter().take(4) }
                .take_while(|it| !it.is_sign('.'))
                .any(|token| {
                    token.is_any(&[
                        "would", "could", "might", "may", "is", "was", "less", "more", "or",
                        "wouldn't", "won't", "couldn't", "doesn't",
                    ])
                });
            if is_doubted
                || self.is_denied(at, Clarity::Spoken, false)
                || self.is_denied(begin, Clarity::Spoken, false)
            {
                continue;
            }
            claims.push(self.claim_in(field, at..end, Claimed::Value(value, note)));
        }
        claims
    }

    /// Returns the lengths, angles and pick points that the author says it takes: `so I take 0.75 edge`.
    fn taken(&self) -> Vec<Claim> {
        let fields: Vec<usize> = [is_length, is_angle]
            .into_iter()
            .filter_map(|is_kind| names::only(self.reader.fields, is_kind))
            .collect();
        let pick = self.point_field("pick");
        let claims = (1..self.tokens.len()).filter_map(|at| {
            let takes = self.tokens[at - 1].is_any(&["i", "we"])
                && self.tokens[at].is_any(&["take", "choose", "chose", "use", "select"])
                || self.tokens[at - 1].is_any(&["go", "going", "opt"])
                    && self.tokens[at].is_any(&["with", "for"]);
            if !takes {
                return None;
            }
            let sentence = self.sentence(at);
            let mut cursor = Cursor::at(&self.tokens[..sentence.end], at + 1);
            cursor.skip(&["the", "a", "an", "about"], &[]);
            // `I use 10 mm, and keep the long pull for later`
            let clause_end = self.tokens[at..sentence.end]
                .iter()
                .position(|it| it.is_sign(',') || it.is_sign(';'));
            // `It may go far, so I take 0.75 edge`
            let so = self.tokens[sentence.start..at]
                .windows(2)
                .rposition(|pair| pair[0].is_sign(',') && pair[1].is_any(&["so", "therefore"]));
            let begin = sentence.start + so.unwrap_or(0);
            let clause = begin..clause_end.map_or(sentence.end, |end| at + end);
            let is_unreal = self.tokens[clause].iter().any(|it| it.is_any(UNREAL))
                || self.tokens[sentence]
                    .iter()
                    .any(|it| it.is_any(&["if", "unless", "when", "before", "after"]));
            if !quantity::begins(cursor) || is_unreal || self.is_denied(at, Clarity::Spoken, false)
            {
                return None;
            }
            // `so I chose (41, 41)` and `I take (111, 111) as the center` may tell of the place.
            let tells_of_place = self.tokens[self.sentence(at)].iter().any(|it| {
                it.is_any(&[
                    "as", "place", "put", "release", "target", "center", "centre",
                ])
            });
            let pick = pick.filter(|_| self.tokens[at].is("take") && !tells_of_place);
            fields.iter().copied().chain(pick).find_map(|field| {
                let context = self.reader.context(field, self.text, None, Clarity::Spoken);
                let mut behind = cursor;
                let Found::Value(value, note) = value::read(&mut behind, &context) else {
                    return None;
                };
                Some(self.claim_in(field, at..behind.at, Claimed::Value(value, note)))
            })
        });
        claims.collect()
    }

    /// Returns the angles at which something is moved, without a field's name: `pull it down (270 deg)`.
    fn pulls(&self) -> Vec<Claim> {
        let Some(field) = names::only(self.reader.fields, is_angle) else {
            return Vec::new();
        };
        let context = self.reader.context(field, self.text, None, Clarity::Spoken);
        let found = (0..self.tokens.len()).filter_map(|at| {
            let is_noun =
                at > 0 && self.tokens[at - 1].is_any(&["the", "a", "this", "each", "that", "one"]);
            if is_noun || !self.tokens[at].is_any(&["move", "drag", "pull", "pulling", "dragging"])
            {
                return None;
            }
            let last = self.tokens.len().min(at + MAX_MOTION);
            let end = (at + 1..last).find(|index| {
                self.tokens[*index].gap >= Gap::Item || value::ends_sentence(self.tokens, *index)
            });
            let begin = (at + 1..end.unwrap_or(last))
                .find(|begin| quantity::degrees(&self.tokens[*begin..]))?;
            let first = self.mentions.partition_point(|mention| mention.at < at);
            let names_field = self.mentions[first..]
                .iter()
                .take_while(|mention| mention.at < begin)
                .any(|mention| mention.form == Form::Name);
            let mut cursor = Cursor::at(
                &self.tokens[..self.tokens.len().min(begin + MAX_CLAUSE)],
                begin,
            );
            let is_denied = self.is_denied(at, Clarity::Spoken, false)
                || self.is_denied(begin, Clarity::Spoken, false);
            if names_field || is_denied || self.asks(begin, Clarity::Spoken) {
                return None;
            }
            let claimed = match value::read(&mut cursor, &context) {
                Found::Value(value, _) if !self.agrees_with_side(begin, &value) => Claimed::Torn,
                Found::Value(value, note) => Claimed::Value(value, note),
                _ => return None,
            };
            Some(self.claim_in(field, at..cursor.at, claimed))
        });
        found.collect()
    }

    /// Returns the directions in words in which something is said to be moved: `carry it down and to the left`.
    fn courses(&self) -> Vec<Claim> {
        let Some(field) = names::only(self.reader.fields, names::is_compass) else {
            return Vec::new();
        };
        let mut claims = Vec::new();
        let is_unreal: Vec<bool> = self.tokens.iter().map(|it| it.is_any(UNREAL)).collect();
        for at in 0..self.tokens.len() {
            let is_noun = at > 0
                && self.tokens[at].is_any(&["pull", "move", "drag", "carry"])
                && self.tokens[at - 1].is_any(&["the", "a", "this", "each", "that", "one"]);
            // `The upper rim is pulled down in its middle` describes the cloth.
            let is_state = at > 0
                && self.tokens[at].is_any(&["pulled", "dragged", "drawn"])
                && self.tokens[at - 1].is_any(&["is", "are"])
                && self.tokens[..at - 1].last().is_some_and(|it| {
                    it.is_any(&["rim", "hem", "edge", "border", "side", "middle"])
                });
            // `The corner has to go down and to the left`
            let goes = at > 0
                && self.tokens[at].is_any(&["go", "travel"])
                && self.tokens[at - 1].is_any(&["to", "must", "should"]);
            if is_noun || is_state || !(goes || self.tokens[at].is_any(CARRYING)) {
                continue;
            }
            let sentence = self.sentence(at);
            // `upward, which is where the flat cloth's edge would be`
            let adds = |it: &usize| {
                self.tokens[*it].is_sign(',')
                    && Cursor::at(self.tokens, it + 1).eat_words("which is where")
            };
            let end = (at..sentence.end).find(adds).unwrap_or(sentence.end);
            if is_unreal[sentence.start..end].contains(&true) {
                continue;
            }
            let course = (at + 1..sentence.end.min(at + MAX_CARRIED)).find_map(|begin| {
                let leads = self.tokens[begin].is_any(&[
                    "to",
                    "toward",
                    "towards",
                    "up",
                    "upward",
                    "upwards",
                    "down",
                    "downward",
                    "downwards",
                    "diagonally",
                    "straight",
                    "directly",
                ]);
                let mut cursor = Cursor::at(&self.tokens[..sentence.end], begin);
                let deg = words::side(&mut cursor).filter(|_| leads)?;
                // `pull it up to the left corner`
                let mut behind = cursor;
                behind.skip(&["to", "toward", "towards", "the"], &[]);
                behind.eat_any(&["left", "right", "upper", "lower", "top", "bottom"]);
                let is_object = [cursor, behind]
                    .iter()
                    .any(|it| it.peek().is_some_and(|next| next.is_any(PLACES)));
                (!is_object).then_some((deg, cursor.at))
            });
            if let Some((deg, end)) = course {
                claims.push(self.claim_in(field, at..end, Claimed::Course(deg)));
            }
        }
        claims
    }

    /// Returns which lengths and words an answer says it takes by their size: `the shortest pull`.
    fn sizes(&self) -> Vec<Claim> {
        let is_words = |field: &ActionField| matches!(field.choices, Choices::Words { .. });
        let fields = [
            names::only(self.reader.fields, is_length),
            names::only(self.reader.fields, is_words),
        ];
        let mut claims = Vec::new();
        let parts = value::sentences(self.tokens).flat_map(|it| sizes::parts(self.tokens, it));
        for part in parts {
            if let [Some(length), _] = fields {
                claims.extend(self.bounded(part.clone(), length));
            }
            let is_unreal = self.tokens[part.clone()]
                .iter()
                .any(|it| it.is_any(UNREAL) || it.is_any(&["too", "rule", "rules"]));
            if is_unreal {
                continue;
            }
            if let [Some(length), _] = fields {
                claims.extend(self.sufficing(part.clone(), length));
            }
            for index in fields.into_iter().flatten() {
                let field = (index, &self.reader.fields[index]);
                claims.extend(sizes::of_part(self.tokens, part.clone(), field));
            }
        }
        claims
    }

    /// Returns the lengths within what is said to be the most: `no more than 0.25 edge may be used here`.
    fn bounded(&self, part: Range<usize>, field: usize) -> Option<Claim> {
        const MOST: [&str; 5] = [
            "no more than",
            "not more than",
            "at most",
            "not exceed",
            "limited to",
        ];
        let context = self.reader.context(field, self.text, None, Clarity::Spoken);
        let words = &self.tokens[..part.end];
        let (begin, mut cursor) = part.clone().find_map(|at| {
            let mut cursor = Cursor::at(words, at);
            MOST.iter()
                .any(|most| cursor.eat_words(most))
                .then_some((at, cursor))
        })?;
        let (value, _) = value::bare(&mut cursor, &context)?;
        let others = words[part.start..begin].iter().chain(cursor.rest());
        // At another point, or of another cloth, another length may be the most.
        let is_elsewhere = { others }.any(|it| {
            let is_modal = it.is_any(&["may", "cannot", "must", "can't"]);
            it.kind == Kind::Number
                || it.is_any(UNREAL) && !is_modal
                || it.is_any(&["for", "with", "on"])
        });
        let (Choices::Lengths { choices, .. }, Value::Length { length: most }) =
            (&self.reader.fields[field].choices, &value)
        else {
            return None;
        };
        let is_size = { cursor.rest().iter().take(2) }
            .any(|it| it.is_any(&["wide", "long", "high", "away", "apart", "thick"]));
        let is_moved = words[part.start..].iter().any(|it| {
            it.is_any(&[
                "distance", "pull", "pulls", "pulled", "move", "moved", "drag", "dragged", "go",
            ]) || it.is_any(&["travel", "used", "allowed", "safe", "possible", "permitted"])
        });
        if is_elsewhere
            || is_size
            || !is_moved
            || !choices.iter().any(|choice| choice.value == *most)
        {
            return None;
        }
        let within = choices.iter().filter(|choice| choice.value <= *most);
        let within = within.map(|choice| Value::Length {
            length: choice.value,
        });
        Some(self.claim_in(field, begin..cursor.at, Claimed::OneOf(within.collect())))
    }

    /// Returns the lengths that are said to be enough: `a tenth of an edge is all that is allowed`.
    fn sufficing(&self, part: Range<usize>, field: usize) -> Vec<Claim> {
        // `for a single layer 0.25 edge is enough`
        let is_elsewhere = self.tokens[part.start].is_any(&["for", "with", "on"])
            || self.tokens[part.clone()].iter().any(|it| it.is("other"));
        if is_elsewhere {
            return Vec::new();
        }
        let context = self.reader.context(field, self.text, None, Clarity::Spoken);
        let words = &self.tokens[..part.end];
        let found = part.filter_map(|at| {
            let mut cursor = Cursor::at(words, at);
            let is_part = words[at].is_any(&["a", "one", "half", "three", "the", "full"]);
            if !is_part && !quantity::begins(cursor) {
                return None;
            }
            let (value, _) = value::bare(&mut cursor, &context)?;
            let end = cursor.at;
            let goes = words[..at]
                .last()
                .is_some_and(|it| it.is_any(&["go", "goes", "travel", "travels"]));
            let is_said = cursor.eat_any(&["is", "will", "should"]) && {
                cursor.skip(&["be", "just", "quite", "really", "about", "the"], &[]);
                cursor.eat_any(&[
                    "all",
                    "enough",
                    "sufficient",
                    "plenty",
                    "right",
                    "appropriate",
                ]) || cursor.eat_words("maximum here")
            } || cursor.eat_any(&["suffices"]);
            // `30 mm is enough clearance`
            let is_alone = cursor.peek().is_none_or(|next| {
                next.kind != Kind::Word
                    || next.is_any(&["here", "for", "to", "that", "that's", "in", "as"])
            });
            let is_offered = match (&self.reader.fields[field].choices, &value) {
                (Choices::Lengths { choices, .. }, Value::Length { length }) => {
                    choices.iter().any(|choice| choice.value == *length)
                }
                _ => false,
            };
            (is_offered && (goes || is_said && is_alone))
                .then(|| self.claim_in(field, at..end, Claimed::OneOf(vec![value])))
        });
        found.collect()
    }

    /// Returns which corners are said to be picked and where they are put: `the lower left corner is picked`.
    fn corners(&self) -> Vec<Claim> {
        let Some(pick) = self.point_field("pick") else {
            return Vec::new();
        };
        let fields = (pick, self.point_field("place"));
        let mut claims = Vec::new();
        for sentence in value::sentences(self.tokens) {
            // `…, then it is put down` tells of the same motion.
            let is_unreal = |till: usize| {
                sentence.clone().any(|at| {
                    let it = &self.tokens[at];
                    // `and lays it on the opposite corner`
                    let is_corner = it.is("opposite")
                        && self.tokens[..at].last().is_some_and(|last| last.is("the"))
                        && self
                            .tokens
                            .get(at + 1)
                            .is_some_and(|next| next.is("corner"));
                    let next = self.tokens.get(at + 1);
                    let is_later_step =
                        it.is_any(&["second", "third"]) && next.is_some_and(|next| next.is("step"));
                    // `the one that has to be folded next`
                    let is_turn = it.is("next")
                        && self.tokens[..at].last().is_some_and(|last| {
                            last.is_any(&["is", "folded", "picked", "moved", "taken"])
                        });
                    // `I would take the lower left corner`
                    let is_mine = it.is("would")
                        && self.tokens[..at]
                            .last()
                            .is_some_and(|last| last.is_any(&["i", "we"]))
                        && !self.tokens[at..sentence.end]
                            .iter()
                            .any(|it| it.is_any(&["but", "however", "yet"]));
                    (is_later_step || it.is_any(UNREAL))
                        && !is_corner
                        && !is_mine
                        && !is_turn
                        && (it.at < till || !it.is_any(&["then", "next", "after", "itself"]))
                })
            };
            let found =
                corners::of_sentence(self.tokens, sentence.clone(), fields, self.reader.notation);
            let end = found.iter().map(|claim| claim.span.end).max();
            let is_denied = found.first().is_some_and(|claim| {
                let at = self
                    .tokens
                    .partition_point(|token| token.at < claim.span.start);
                self.is_denied(at, Clarity::Spoken, false)
            });
            if !is_denied && !end.is_some_and(is_unreal) {
                claims.extend(found);
            }
        }
        claims
    }

    /// Returns the index of a field that is a point.
    fn point_field(&self, name: &str) -> Option<usize> {
        let mut fields = self.reader.fields.iter();
        fields.position(|field| field.name == name && field.is_point())
    }

    /// Returns where the sentence of a token begins and ends; a line ends it.
    fn sentence(&self, at: usize) -> Range<usize> {
        let least = at.saturating_sub(MAX_BEFORE);
        let begin = (least..at)
            .rev()
            .find(|index| {
                self.tokens[index + 1].gap >= Gap::Line || value::ends_sentence(self.tokens, *index)
            })
            .map_or(least, |index| index + 1);
        let most = self.tokens.len().min(at + MAX_BEFORE);
        let end = (at..most).find(|index| {
            value::ends_sentence(self.tokens, *index)
                || self
                    .tokens
                    .get(index + 1)
                    .is_some_and(|next| next.gap >= Gap::Line)
        });
        begin..end.map_or(most, |end| end + 1)
    }

    /// Returns whether a direction in words just before an angle, `down (270 deg)`, is the same one.
    fn agrees_with_side(&self, angle: usize, value: &Value) -> bool {
        let Value::Direction { deg } = value else {
            return true;
        };
        (angle.saturating_sub(6)..angle).all(|at| {
            let mut cursor = Cursor::at(&self.tokens[..angle], at);
            let Some(side) = words::side(&mut cursor) else {
                return true;
            };
            let is_beside = cursor.rest().iter().all(|token| {
                matches!(token.kind, Kind::Sign('(' | ',' | '-' | '–' | '='))
                    || token.is_any(&["at", "by", "in", "that", "is", "i.e.", "so", "exactly"])
            });
            // `up and to the left`: the last word alone is only a part of it.
            let is_part = at > 0
                && (self.tokens[at - 1].is_sign('-')
                    || self.tokens[at - 1]
                        .is_any(&["and", "the", "to", "upper", "lower", "top", "bottom"]));
            !is_beside || is_part || side == *deg
        })
    }

    fn is_direction(&self, mention: Mention) -> bool {
        matches!(self.field(mention).choices, Choices::Directions { .. })
    }

    /// Returns the values that are called unfit: `so 0.75 edge is too far`.
    fn judgements(&self) -> Vec<Claim> {
        let is_unfit = |at: usize| {
            let mut cursor = Cursor::at(self.tokens, at);
            if cursor.eat_any(&["exceeds", "overshoots", "violates"]) {
                return true;
            }
            // `90 deg takes the cloth off the table`, `with a soft grip the hem slips`
            let clause = cursor.rest().iter().take(MAX_EFFECT);
            let clause = clause.take_while(|it| {
                it.kind == Kind::Word && it.gap < Gap::Line && !it.is_any(JOINING)
            });
            let (mut moves, mut harms, mut denies) = (false, false, false);
            for word in clause {
                harms |=
                    word.is_any(HARMING) || moves && word.is_any(&["off", "outside", "beyond"]);
                moves |= word.is_any(MOVING);
                denies |= word.is_any(&[
                    "not", "no", "nor", "neither", "never", "without", "would", "could", "might",
                    "may",
                ]);
            }
            if harms && !denies {
                return true;
            }
            let is_verb = cursor.eat_any(&["is", "was", "would", "seems", "looks"]);
            cursor.skip(
                &[
                    "be",
                    "therefore",
                    "clearly",
                    "simply",
                    "probably",
                    "still",
                    "a",
                    "bit",
                ],
                &[','],
            );
            is_verb
                && (cursor.eat_any(&[
                    "too",
                    "wrong",
                    "invalid",
                    "incorrect",
                    "impossible",
                    "excessive",
                ]) || cursor.eat_word("not")
                    && cursor.eat_any(&[
                        "valid", "allowed", "possible", "correct", "right", "suitable", "offered",
                    ]))
        };
        let mut claims = Vec::new();
        for end in (1..self.tokens.len()).filter(|at| is_unfit(*at)) {
            let tokens = &self.tokens[..end];
            for field in 0..self.reader.fields.len() {
                let context = self.reader.context(field, self.text, None, Clarity::Spoken);
                let found = (end.saturating_sub(12)..end).find_map(|begin| {
                    let mut cursor = Cursor::at(tokens, begin);
                    let (value, _) = value::bare(&mut cursor, &context)?;
                    (cursor.at == end).then_some((begin, value))
                });
                let Some((begin, value)) = found else {
                    continue;
                };
                if !self.is_denied(begin, Clarity::Spoken, false) {
                    claims.push(self.claim_in(field, begin..end, Claimed::Unfit(value)));
                }
            }
        }
        claims
    }

    /// Reads `pick_x = 40`.
    fn axis(&self, mention: Mention, mut cursor: Cursor<'_, '_>) -> Option<Claim> {
        let start = cursor;
        let axis = point::single_axis(&cursor)?;
        if matches!(
            point::read(&mut cursor, self.reader.notation, Brackets::Optional),
            PointFound::Pixel(..)
        ) {
            return None;
        }
        cursor = start;
        cursor.at += 1;
        cursor.eat_any(&["coordinate", "position", "value"]);
        cursor.eat_signs(&[':', '=', '→'])?;
        let claimed = match point::number(&mut cursor) {
            Some(number) => {
                cursor.eat_any(&["px", "pixels"]);
                let ends = cursor.peek().is_none_or(|next| {
                    next.gap >= Gap::Line
                        || matches!(
                            next.kind,
                            Kind::Sign(',' | ';' | ')' | '}' | ']' | '|' | '#' | '.' | '⊣')
                        )
                        || next.is("and")
                });
                if ends {
                    Claimed::Axis(axis, number)
                } else {
                    Claimed::Bad("its coordinate is not one number".to_owned())
                }
            }
            None => return None,
        };
        Some(self.claim_in(mention.field, mention.at..cursor.at, claimed))
    }

    /// Reads a value that stands before the name: `(10, 20) is the pick point`, `a soft grip`.
    fn before(&self, index: usize) -> Option<Claim> {
        let mention = self.mentions[index];
        // `(33, 190) is to be picked up`
        let is_picked = matches!(mention.form, Form::Passive | Form::PassiveAt)
            && !self.tokens[mention.end..]
                .iter()
                .take(2)
                .any(|next| next.is_any(&["at", "to", "on", "onto", "from", "in"]));
        if !(mention.form == Form::Name || is_picked) || self.tokens[mention.at].gap >= Gap::Line {
            return None;
        }
        let mut end = mention.at;
        let mut joined = false;
        while end > 0 {
            let token = &self.tokens[end - 1];
            let is_open = matches!(token.kind, Kind::Sign('(' | '[' | '<'));
            let joins = token.is_any(&[
                "as", "is", "for", "becomes", "be", "to", "will", "should", "must",
            ]) || matches!(token.kind, Kind::Sign('→' | '=' | ':'));
            // `The corner, at (182, 182), is picked up`
            let closes = token.is_sign(',')
                && self.tokens[end].is("is")
                && (is_picked || self.field(mention).is_point());
            if !(is_open
                || joins
                || closes
                || token.is_any(&["the", "my", "a", "our", "chosen", "best", "final"]))
                || token.gap >= Gap::Line
            {
                break;
            }
            joined |= is_open || joins || closes;
            end -= 1;
        }
        let field = self.field(mention);
        if end == 0 || (!joined && field.is_point()) {
            return None;
        }
        let begin = (end.saturating_sub(12)..end).find(|begin| {
            let inside = &self.tokens[..end];
            let mut cursor = Cursor::at(inside, *begin);
            let is_start = *begin == 0
                || self.tokens[*begin].gap > Gap::None
                || !self.tokens[*begin - 1].is_sign('-');
            let context = self
                .reader
                .context(mention.field, self.text, None, Clarity::Spoken);
            is_start && value::bare(&mut cursor, &context).is_some() && cursor.at == end
        })?;
        // What follows another field's name belongs to that field.
        let owner = self.mentions[..index]
            .iter()
            .rev()
            .take(8)
            .find(|other| other.at < begin && other.field != mention.field);
        let is_owned = owner.is_some_and(|other| {
            let is_same_line = self.tokens[other.at + 1..=begin]
                .iter()
                .all(|token| token.gap < Gap::Line);
            let is_apart = (other.end..begin).any(|at| {
                let token = &self.tokens[at];
                token.is_sign(',')
                    || token.is_sign(';')
                    || token.is("and")
                    || value::ends_sentence(self.tokens, at)
            });
            is_same_line && !is_apart
        });
        if is_owned
            || self.is_denied(begin, Clarity::Spoken, false)
            || self.is_weighed(begin, mention.end)
            || self.asks(mention.end, Clarity::Spoken)
        {
            return None;
        }
        let preceding = begin.checked_sub(1).map(|at| &self.tokens[at]);
        // `from the center (350, 345) to the pick point`, `it would slip out of a soft grip`
        let words = self.tokens[begin.saturating_sub(4)..begin].iter().rev();
        let words: Vec<_> = words.take_while(|it| it.kind == Kind::Word).collect();
        let has = |wanted: &[&str]| words.iter().any(|it| it.is_any(wanted));
        let is_way = self.tokens[end..mention.at].iter().any(|it| it.is("to"));
        let is_from = is_way && has(&["from"]) || has(&["out"]) && has(&["slip", "slips", "slid"]);
        if is_from {
            return None;
        }
        if preceding.is_some_and(|token| {
            token.is_any(&[
                "or", "of", "from", "very", "too", "less", "more", "hardly", "than", "near",
                "between",
            ]) || matches!(token.kind, Kind::Sign('+' | '-' | '*' | '/' | '±' | '≈'))
        }) && self.tokens[begin].gap < Gap::Item
        {
            return None;
        }
        // `A firm grip would crease it.`, `A very firm grip is reserved for leather.`
        let after = &self.tokens[mention.end..];
        let judged = after.iter().take(4).take_while(|next| next.gap < Gap::Line);
        let is_judged = judged.enumerate().any(|(at, next)| {
            (at == 0 && (next.is_any(value::CONDITIONAL) || next.is_any(TELLING)))
                || (at > 0 && next.is_any(UNFIT))
        });
        let is_even = preceding.is_some_and(|token| token.is_any(&["with", "a"]))
            && self.tokens[..begin]
                .iter()
                .rev()
                .take(3)
                .any(|token| token.is("even"));
        if is_judged || is_even {
            return None;
        }
        let context = self
            .reader
            .context(mention.field, self.text, None, Clarity::Spoken);
        let mut cursor = Cursor::at(&self.tokens[..end], begin);
        let (value, note) = value::bare(&mut cursor, &context)?;
        // `having left the direction open`
        let is_worded = matches!(field.choices, Choices::Directions { .. })
            && self.tokens[begin..end]
                .iter()
                .all(|token| token.kind == Kind::Word);
        if is_worded && !joined {
            return None;
        }
        Some(self.claim_in(
            mention.field,
            begin..mention.end,
            Claimed::Value(value, note),
        ))
    }
}

fn is_bracket(cursor: &Cursor<'_, '_>) -> bool {
    cursor
        .peek()
        .is_some_and(|token| matches!(token.kind, Kind::Sign('(' | '[' | '{' | '<' | '>')))
}

/// Skips words such as `might as well be`.
fn hedge(cursor: &mut Cursor<'_, '_>) -> bool {
    let start = *cursor;
    let is_hedge = cursor.eat_any(&["might", "may", "could", "can"]);
    cursor.skip(&["as", "well", "also", "just", "equally", "possibly"], &[]);
    let is_whole = is_hedge && cursor.eat_any(&["be", "sit", "lie"]);
    if !is_whole {
        *cursor = start;
    }
    is_whole
}

/// Skips the sign after a field's name.
fn sign(cursor: &mut Cursor<'_, '_>) -> Sign {
    if cursor.eat_signs(&['=', ':', '→', '≈']).is_some() {
        cursor.eat_signs(&['=', ':', '→', '>']);
        return Sign::Assigns;
    }
    if cursor.peek().is_some_and(|token| token.is_sign('|')) {
        cursor.at += 1;
        return Sign::Assigns;
    }
    let at = *cursor;
    if cursor.eat_word("at") && cursor.peek().is_some_and(|next| next.kind == Kind::Number) {
        return Sign::Says;
    }
    *cursor = at;
    for words in [
        "should be at",
        "will be at",
        "would be at",
        "is at",
        "should be",
        "will be",
        "would be",
        "has to be",
        "must be",
        "needs to be",
        "equals",
        "is set to",
        "set to",
        "is",
    ] {
        if cursor.eat_words(words) {
            cursor.eat_signs(&[':', '=']);
            return Sign::Says;
        }
    }
    let dash = *cursor;
    if cursor.eat_signs(&['–', '-']).is_some()
        && cursor.peek().is_some_and(|next| next.gap == Gap::Space)
        && !dash.is_joined()
    {
        return Sign::Says;
    }
    *cursor = dash;
    Sign::None
}

/// Reads `unit="deg"` in an opening tag.
fn unit_attribute(cursor: &mut Cursor<'_, '_>) -> Option<AnswerUnit> {
    let start = *cursor;
    let has_key = cursor.eat_any(&["unit", "units"]) && cursor.eat_sign('=');
    let unit = if has_key {
        quantity::unit(cursor)
    } else {
        None
    };
    if unit.is_none() {
        *cursor = start;
    }
    unit
}

/// Skips the end of an opening tag; attributes state the value themselves.
fn tag_sign(cursor: &mut Cursor<'_, '_>) -> Sign {
    if cursor.eat_sign('>') {
        return Sign::Assigns;
    }
    let attributes = *cursor;
    if cursor.eat_any(&["value", "point", "coordinates", "position"]) && cursor.eat_sign('=') {
        return Sign::Assigns;
    }
    *cursor = attributes;
    Sign::Assigns
}
