//! Reads a text that follows given words, such as `Instructions:`.
//!
//! The words stand at the start of a line, in a heading, in a tag, or as a key of an object. Two different texts are
//! refused, as two values of a field are.

use super::aside::{self, standing};
use super::lexer::{self, Gap, Kind, TAG_END, Token};
use super::object::{self, Node, Shape};
use super::phrases;
use super::reading::{MAX_TEXT_CHARS, Malformed, Reading, Stated, bounded, quoted};
use super::schema;
use super::structured;
use std::ops::Range;

/// A text that was found.
struct Found {
    value: String,
    span: Range<usize>,
    repairs: Vec<String>,
    /// Whether it is the first of several items below the words.
    is_list: bool,
}

/// Reads the text between `before` and `after`; if `after` is empty, up to the end of the paragraph, or to the sentence
/// that ends with a line.
///
/// Fails if `before` is not found, if nothing follows it, if two texts contradict each other, or if the text is
/// longer than [`MAX_TEXT_CHARS`].
pub fn read_text(before: &str, after: &str, reply: &str) -> Result<Reading<String>, Malformed> {
    bounded(before, reply)?;
    let standing = standing(reply);
    let found = match standing.is_cut_off {
        true => Err("Your answer ends inside of its thoughts.".to_owned()),
        false => texts(&standing.text, before, after).and_then(|found| one(found, before)),
    };
    match found {
        Ok(found) => Ok(Reading {
            stated: vec![Stated::new(before, reply, found.span, &found.repairs)],
            value: found.value,
            repairs: found.repairs,
            asides: standing.asides,
        }),
        Err(why) => Err(Malformed {
            field: before.to_owned(),
            message: format!(
                "{why} Answer again with one line in exactly this format:\n{before} …{after}"
            ),
            stated: Vec::new(),
        }),
    }
}

/// Returns every text that an answer states.
fn texts(text: &str, before: &str, after: &str) -> Result<Vec<Found>, String> {
    if let Some(members) = structured::members(text, &[&schema::text_key(before)]) {
        let found = members.into_iter().map(|member| Found {
            value: unlabelled(&member.text, before),
            span: member.span,
            repairs: Vec::new(),
            is_list: false,
        });
        return Ok(found.collect());
    }
    if let Some(said) = phrases::unusable(text) {
        return Err(format!("Your answer cannot be used: it says `{said}`."));
    }
    let (mut found, mut spans) = (Vec::new(), Vec::new());
    for node in object::objects(text) {
        let n_found = found.len();
        members(&node, before, &mut found);
        spans.extend((found.len() > n_found).then_some(node.span));
    }
    let text = aside::blanked(text, spans);
    found.extend(below_labels(&text, before, after));
    Ok(found)
}

/// Returns the one text that was found, or what is wrong with the answer.
fn one(mut found: Vec<Found>, before: &str) -> Result<Found, String> {
    let is_named = !found.is_empty();
    found.retain(|it| !is_placeholder(&it.value));
    let Some(first) = found.first() else {
        return Err(match is_named {
            true => format!("Nothing follows \"{before}\" in your answer."),
            false => format!("Your answer has no line that begins with \"{before}\"."),
        });
    };
    let n_chars = first.value.chars().count();
    if let Some(other) = found.iter().find(|it| it.value != first.value) {
        let (first, other) = (quoted(&first.value), quoted(&other.value));
        Err(format!(
            "Your answer has two different texts after \"{before}\", `{first}` and `{other}`."
        ))
    } else if found.iter().any(|it| it.is_list) {
        Err(format!(
            "Your answer lists several texts below \"{before}\"."
        ))
    } else if first.value.ends_with(['?', '？']) {
        Err(format!(
            "What follows \"{before}\" in your answer is a question."
        ))
    } else if n_chars > MAX_TEXT_CHARS {
        Err(format!(
            "The text of your answer has {n_chars} characters; at most {MAX_TEXT_CHARS} are read."
        ))
    } else {
        Ok(found.swap_remove(0))
    }
}

/// Returns whether a key is the words before the text, whatever decorates them: `## **Instruction**` is `Instructions:`.
fn is_label(key: &str, before: &str) -> bool {
    let stem = |text: &str| {
        let letters = text.chars().filter(|letter| letter.is_alphanumeric());
        let letters: String = letters.flat_map(char::to_lowercase).collect();
        letters.trim_end_matches('s').to_owned()
    };
    !stem(before).is_empty() && stem(key) == stem(before)
}

fn members(node: &Node, before: &str, found: &mut Vec<Found>) {
    match &node.shape {
        Shape::List(items) => items.iter().for_each(|item| members(item, before, found)),
        Shape::Object(members_of) => {
            for member in members_of {
                if !is_label(&member.key, before) {
                    members(&member.value, before, found);
                } else {
                    let value = match &member.value.shape {
                        Shape::Text(text) | Shape::Bare(text) => unlabelled(text, before),
                        _ => String::new(),
                    };
                    let key = quoted(&member.key);
                    found.push(Found {
                        repairs: vec![format!("read the member `{key}` of an object")],
                        span: member.at..member.value.span.end,
                        value,
                        is_list: false,
                    });
                }
            }
        }
        Shape::Text(_) | Shape::Bare(_) => {}
    }
}

/// Finds the texts behind or below labels.
fn below_labels(text: &str, before: &str, after: &str) -> Vec<Found> {
    let tokens = lexer::tokens(text);
    let mut words = lexer::tokens(before);
    let n_signs = { words.iter().rev() }.take_while(|it| matches!(it.kind, Kind::Sign(_)));
    words.truncate(words.len() - n_signs.count());
    let label = Label {
        needs_sign: words.len() < lexer::tokens(before).len(),
        words,
        closing: lexer::tokens(after),
        text,
    };
    let found = (0..tokens.len()).filter_map(|at| {
        let start = label.end(&tokens, at)?;
        label.paragraph(&tokens, at, start)
    });
    found.collect()
}

/// The words around a text.
struct Label<'t> {
    /// Those before it, without the sign at their end.
    words: Vec<Token<'t>>,
    needs_sign: bool,
    /// Those after it, with their signs.
    closing: Vec<Token<'t>>,
    /// The answer.
    text: &'t str,
}

impl Label<'_> {
    /// Returns the token behind the label that begins at a token: at the start of a line, in a tag or in a cell.
    fn end(&self, tokens: &[Token<'_>], at: usize) -> Option<usize> {
        let first = tokens.get(at)?;
        let before = at.checked_sub(1).map(|at| &tokens[at]);
        let is_wrapped = before.is_some_and(|it| it.kind == Kind::Tag);
        if first.kind == Kind::Tag && self.words.len() == 1 {
            return is_label(first.text.rsplit('=').next()?, self.words[0].text).then_some(at + 1);
        }
        if self.words.is_empty() || (first.gap < Gap::Line && !is_wrapped) {
            return None;
        }
        let last = self.words.len() - 1;
        let is_same = |(index, word): (usize, &Token<'_>)| {
            let token = tokens.get(at + index)?;
            let is_line = index == 0 || token.gap < Gap::Line;
            let is_word = match index == last {
                true => is_label(token.text, word.text),
                false => token.text.eq_ignore_ascii_case(word.text),
            };
            (is_line && is_word).then_some(())
        };
        let all: Option<()> = self.words.iter().enumerate().map(is_same).collect();
        all?;
        let end = at + last + 1;
        let next = tokens.get(end)?;
        let is_sign = matches!(next.kind, Kind::Sign(':' | '=' | '-' | '–'));
        let is_heading = first.gap >= Gap::Block && next.gap >= Gap::Line;
        match (is_sign, self.needs_sign && !is_heading) {
            (true, _) => Some(end + 1),
            (false, true) => None,
            (false, false) => Some(end),
        }
    }

    /// Reads the paragraph behind a label, from its start to the closing words.
    fn paragraph(&self, tokens: &[Token<'_>], label: usize, start: usize) -> Option<Found> {
        let first = tokens.get(start)?;
        let is_list = self.is_item(first);
        let (mut end, mut n_items, mut is_closed) = (start, usize::from(is_list), false);
        for (at, token) in tokens.iter().enumerate().skip(start) {
            is_closed = self.closes(tokens, at);
            let is_new = at > start && token.gap >= Gap::Line;
            // A sentence ends its paragraph where the line does, unless a list goes on.
            let is_done = self.closing.is_empty()
                && at > start
                && matches!(tokens[at - 1].kind, Kind::Sign('.' | '!'));
            let is_item = self.is_item(token);
            let ends_here = match is_item {
                true => !is_list,
                false => token.gap >= Gap::Block || is_done,
            };
            let ends = ends_here || self.end(tokens, at).is_some() || begins_other(&tokens[at..]);
            let is_mark = token.kind == Kind::Tag || token.is_sign(TAG_END) || token.is_sign('|');
            // A form to fill in: `Fold the <corner> to the <target>.`
            let is_word = |it: &Token<'_>| it.kind == Kind::Word && it.gap < Gap::Line;
            let next = tokens.get(at + 1);
            if !is_new && token.kind == Kind::Tag && next.is_some_and(is_word) {
                return None;
            }
            if is_closed || is_mark || (is_new && ends) {
                break;
            }
            n_items += usize::from(is_new && is_item);
            end = at + 1;
        }
        let may_end = matches!(
            self.closing.last().map(|it| it.kind),
            None | Some(Kind::Sign(':'))
        );
        if !is_closed && !may_end {
            return None;
        }
        let end = match end > start {
            true => tokens[end - 1].end(),
            false => first.at,
        };
        // A string that never ends was cut off.
        let is_string = self.text[..first.at].ends_with('"');
        if is_string && !self.text[end..].contains('"') {
            return None;
        }
        Some(Found {
            value: plain(&self.text[first.at..end]),
            repairs: Vec::new(),
            is_list: n_items > 1,
            span: tokens[label].at..end,
        })
    }

    /// Returns whether a token is the first one behind the mark of a list.
    fn is_item(&self, token: &Token<'_>) -> bool {
        let mark = || {
            self.text[..token.at]
                .lines()
                .next_back()?
                .trim()
                .chars()
                .last()
        };
        token.gap >= Gap::Item && mark().is_some_and(|it| "-+•.)*".contains(it))
    }

    fn closes(&self, tokens: &[Token<'_>], at: usize) -> bool {
        let is_same = |(index, word): (usize, &Token<'_>)| {
            let token = tokens.get(at + index);
            token.is_some_and(|it| it.text.eq_ignore_ascii_case(word.text))
        };
        !self.closing.is_empty() && self.closing.iter().enumerate().all(is_same)
    }
}

/// Returns whether another section begins: `Explanation: …`.
fn begins_other(tokens: &[Token<'_>]) -> bool {
    const MAX_WORDS: usize = 3;
    let is_word = |it: &&Token<'_>| it.kind == Kind::Word;
    let n_words = tokens.iter().take(MAX_WORDS).take_while(is_word).count();
    let is_capital = tokens[0].text.starts_with(char::is_uppercase);
    is_capital && tokens.get(n_words).is_some_and(|it| it.is_sign(':'))
}

/// Returns the text of a member, without the words before it that it may repeat.
fn unlabelled(text: &str, before: &str) -> String {
    let text = plain(text);
    match text.get(..before.len()) {
        Some(label) if label.eq_ignore_ascii_case(before) => text[before.len()..].trim().to_owned(),
        _ => text,
    }
}

/// Returns a text on one line, without emphasis, up to the first tag: a control token is no part of it.
fn plain(text: &str) -> String {
    let tokens = lexer::tokens(text);
    let tag = tokens
        .iter()
        .find(|it| it.kind == Kind::Tag || it.is_sign(TAG_END));
    let end = tag.map_or(text.len(), |tag| {
        text[..tag.at + 1].rfind('<').unwrap_or(tag.at)
    });
    let words: Vec<&str> = text[..end].split_whitespace().collect();
    let line = words.join(" ").replace("__", "").replace(['*', '`'], "");
    let line = line.trim_start_matches(['>', '-', ' ']);
    line.trim_matches(['"', '“', '”', '\'', '_', ' '])
        .to_owned()
}

fn is_placeholder(text: &str) -> bool {
    let bare = text.trim_matches(|letter: char| "<>[](){}.… ".contains(letter));
    let bare = bare.to_lowercase();
    ["", "n/a", "none", "null"].contains(&&*bare)
        || (text.len() > bare.len() && bare.starts_with("your "))
}
