//! Finds the parts of an answer that state nothing: thoughts, quotations, struck-out text, comments.
//!
//! In: an answer. Out: the same text with blanks there, each byte in its place, and what was set aside.

use super::ways;
use super::wordlist::{self, words};
use std::ops::Range;

/// Why a part of an answer states nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aside {
    /// `<think>…</think>` and its like.
    Thought,
    /// `> …`
    Quotation,
    /// `~~…~~`
    StruckOut,
    /// `<example>…</example>`, `<rejected>…</rejected>`, `Option A: …`
    Example,
    /// `- [ ] 45 deg`
    Unticked,
    /// `<!-- … -->`
    Comment,
    /// `<|im_end|>` and other marks of a chat format; the `>` of a quotation that is the answer.
    Mark,
}

/// Tags around what states nothing.
const TAGS: &[(&[&str], Aside)] = &[
    (
        words!(
            "think thinking thought thoughts reasoning reason rationale scratchpad reflection analysis observation
            plan explanation internal summary"
        ),
        Aside::Thought,
    ),
    (words!("quote blockquote"), Aside::Quotation),
    (words!("example examples rejected format"), Aside::Example),
    (words!("del s strike"), Aside::StruckOut),
];

/// The longest tag, bytes.
const MAX_TAG: usize = 80;

/// An answer whose asides are blank.
pub(super) struct Cleared {
    /// The answer, of the same length; asides are blanks.
    pub text: String,
    /// What was set aside, in order.
    pub asides: Vec<(Range<usize>, Aside)>,
    /// Whether a thought never ends, so that the answer is missing.
    pub is_cut_off: bool,
}

/// Sets aside what states nothing.
pub(super) fn clear(reply: &str) -> Cleared {
    let mut asides = Vec::new();
    let is_cut_off = tagged(reply, &mut asides);
    quoted(reply, &mut asides);
    struck(reply, &mut asides);
    introduced(reply, &mut asides);
    asides.sort_by_key(|(span, _)| (span.start, std::cmp::Reverse(span.end)));
    let spans: Vec<Range<usize>> = asides.iter().map(|(span, _)| span.clone()).collect();
    Cleared {
        text: blanked(reply, &spans),
        asides,
        is_cut_off,
    }
}

/// Replaces parts of a text by blanks; line breaks stay.
///
/// - `spans`: in the order of where they begin.
pub(super) fn blanked(text: &str, spans: &[Range<usize>]) -> String {
    let mut kept = String::with_capacity(text.len());
    for span in spans {
        if span.end <= kept.len() {
            continue;
        }
        kept.push_str(&text[kept.len()..span.start.max(kept.len())]);
        let blank = |byte: u8| if byte == b'\n' { '\n' } else { ' ' };
        kept.extend(text[kept.len()..span.end].bytes().map(blank));
    }
    kept.push_str(&text[kept.len()..]);
    kept
}

/// Finds tagged parts; returns whether the last one never ends.
fn tagged(reply: &str, asides: &mut Vec<(Range<usize>, Aside)>) -> bool {
    let mut open: Option<(usize, &str, Aside, usize)> = None;
    let mut at = 0;
    while let Some(found) = reply[at..].find(['<', '◁', '[']) {
        at += found;
        if open.is_none() && reply[at..].starts_with("<!--") {
            let end = reply[at..]
                .find("-->")
                .map_or(reply.len(), |length| at + length + 3);
            asides.push((at..end, Aside::Comment));
            at = end;
            continue;
        }
        let Some((name, is_closing, end)) = tag(reply, at) else {
            at += reply[at..].chars().next().map_or(1, char::len_utf8);
            continue;
        };
        if let Some(mark) = name.strip_prefix('|') {
            let (mark, next) = (
                mark.trim_matches('|').to_ascii_lowercase(),
                reply[end..].trim_start(),
            );
            let is_thought = |word: &str| next.starts_with(word);
            match open {
                None if mark == "channel"
                    && (is_thought("analysis") || is_thought("commentary")) =>
                {
                    open = Some((at, "channel", Aside::Thought, 1));
                }
                Some((begin, "channel", kind, _)) if mark == "channel" || mark == "start" => {
                    asides.push((begin..at, kind));
                    open = None;
                    continue;
                }
                None => {
                    let role = next.len()
                        - next
                            .trim_start_matches(|it: char| it.is_ascii_lowercase())
                            .len();
                    let names_role = matches!(
                        mark.as_str(),
                        "channel" | "start" | "start_header_id" | "im_start"
                    );
                    let skipped = reply[end..].len() - next.len() + role;
                    let length = if names_role { end + skipped } else { end };
                    asides.push((at..length, Aside::Mark));
                    at = length;
                    continue;
                }
                Some(_) => {}
            }
            at = end;
            continue;
        }
        let kind = TAGS.iter().find_map(|(tags, kind)| {
            let tag = tags.iter().find(|tag| name.eq_ignore_ascii_case(tag))?;
            Some((*tag, *kind))
        });
        match (open, kind) {
            (None, Some((tag, kind))) if !is_closing => open = Some((at, tag, kind, 1)),
            // The server had begun the thought already.
            (None, Some((_, Aside::Thought))) => asides.push((0..end, Aside::Thought)),
            (Some((begin, tag, kind, depth)), Some((other, _))) if tag == other => {
                let depth = if is_closing { depth - 1 } else { depth + 1 };
                open = Some((begin, tag, kind, depth));
                if depth == 0 {
                    asides.push((begin..end, kind));
                    open = None;
                }
            }
            _ => {}
        }
        at = end;
    }
    // `<s>` that never ends is the mark of a chat format.
    let unended = open.filter(|(_, _, kind, _)| *kind == Aside::Thought);
    asides.extend(unended.map(|(begin, _, kind, _)| (begin..reply.len(), kind)));
    unended.is_some()
}

/// Returns a tag's name, whether it closes, and where it ends.
fn tag(reply: &str, at: usize) -> Option<(&str, bool, usize)> {
    let close = match reply[at..].chars().next()? {
        '<' => '>',
        '[' => ']',
        _ => '▷',
    };
    let open = at + reply[at..].chars().next()?.len_utf8();
    let mut most = reply.len().min(open + MAX_TAG);
    while !reply.is_char_boundary(most) {
        most -= 1;
    }
    let inside = &reply[open..most];
    let length = inside.find([close, '\n'])?;
    let end = open + length + close.len_utf8();
    if !inside[length..].starts_with(close) {
        return None;
    }
    let inside = &inside[..length];
    let name = inside.trim_start_matches('/');
    let is_closing = name.len() < inside.len();
    let length = name
        .find(|letter: char| !(letter.is_alphanumeric() || letter == '|' || letter == '_'))
        .unwrap_or(name.len());
    // Other words in square brackets are headings and placeholders.
    let is_whole = close != ']' || name == "THINK";
    (length > 0 && is_whole).then_some((&name[..length], is_closing, end))
}

/// What introduces the answer; a quotation below it is no quotation.
const MINE: [&str; 8] = [
    "my answer",
    "my answer is",
    "here is my answer",
    "here's my answer",
    "final answer",
    "my final answer",
    "here is my final answer",
    "here is the answer",
];

fn quoted(reply: &str, asides: &mut Vec<(Range<usize>, Aside)>) {
    let mut at = 0;
    let mut is_mine = false;
    let are_weighed = ways::are_weighed(reply);
    for line in reply.split_inclusive('\n') {
        let trimmed = line.trim_start();
        let is_unticked = trimmed
            .trim_start_matches(['-', '*', '+', '>', ' '])
            .starts_with("[ ]");
        let is_quotation = trimmed.starts_with('>');
        if !is_quotation && !trimmed.is_empty() {
            let bare = trimmed.trim_end().trim_end_matches(['*', '_', '`', ' ']);
            let said = last_sentence(bare).trim_matches(['*', '_', '#', ' ', ':']);
            let said = said.to_lowercase().replace('’', "'");
            is_mine = bare.ends_with(':') && MINE.contains(&&*said);
        }
        if are_weighed && ways::is_way(trimmed) {
            asides.push((at..at + line.trim_end().len(), Aside::Example));
        } else if is_quotation && is_mine && !is_unticked {
            let bare = trimmed.trim_start_matches(['>', ' ']);
            let mark = at + line.len() - trimmed.len();
            asides.push((mark..at + line.len() - bare.len(), Aside::Mark));
        } else if is_quotation && !is_mine {
            asides.push((at..at + line.trim_end().len(), Aside::Quotation));
        } else if is_unticked {
            asides.push((at..at + line.trim_end().len(), Aside::Unticked));
        }
        at += line.len();
    }
}

/// Words of a line that introduces what is no answer.
const INTRODUCING: &[&str] = words!(
    "example examples e.g e.g. rejected refused previous earlier wrong old former alternatives alternative candidates
    considered such sample illustration template placeholder discarded hypothetical instance"
);

/// Words of a line that introduces the answer, whatever else it says.
const ANSWERING: &[&str] = words!(
    "correct correction correcting actually final therefore choose chosen corrected revised new updated instead better
    unlike not"
);

/// Finds the paragraph or code block after a line such as `For example:`.
fn introduced(reply: &str, asides: &mut Vec<(Range<usize>, Aside)>) {
    let mut lines: Vec<(usize, &str)> = Vec::new();
    let mut at = 0;
    for line in reply.split_inclusive('\n') {
        lines.push((at, line.trim()));
        at += line.len();
    }
    let mut index = 0;
    while index < lines.len() {
        let line = lines[index].1;
        index += 1;
        if !introduces(line) {
            continue;
        }
        while lines.get(index).is_some_and(|(_, line)| line.is_empty()) {
            index += 1;
        }
        let Some((start, first)) = lines.get(index).copied() else {
            return;
        };
        let is_fence = first.starts_with("```");
        let mut end = start;
        let begun = index;
        while let Some((at, line)) = lines.get(index).copied() {
            let is_last = if is_fence {
                index > begun && line.starts_with("```")
            } else {
                line.is_empty()
                    || (index > begun && line.ends_with(':'))
                    || line.starts_with('#')
                    || says(line, ANSWERING)
            };
            if is_last && !is_fence {
                break;
            }
            end = at + line.len();
            index += 1;
            if is_last {
                break;
            }
        }
        asides.push((start..end.max(start), Aside::Example));
    }
}

/// Returns whether a line introduces something that is no answer.
fn introduces(line: &str) -> bool {
    let bare = line.trim_end_matches(['*', '_', '`', ' ', ')']);
    let bare = last_sentence(bare);
    let ends = [
        ":",
        "：",
        "e.g.",
        "e.g",
        "for example",
        "for example,",
        "for instance",
        "such as",
    ];
    let first = bare.trim_start_matches(['*', '_', ' ']);
    let forbids = ["none of", "do not", "don't", "don’t", "never", "neither of"];
    if bare.ends_with([':', '：'])
        && forbids.iter().any(|words| {
            first
                .get(..words.len())
                .is_some_and(|begin| begin.eq_ignore_ascii_case(words))
        })
    {
        return true;
    }
    // What somebody else said, or what was right at another time.
    let theirs = [
        "you proposed",
        "you suggested",
        "you wrote",
        "you answered",
        "other model",
        "another model",
        "last image",
        "last picture",
        "last step",
        "last action",
        "annotators",
        "perception module",
    ];
    if first.to_lowercase().starts_with("as in ") {
        return false;
    }
    if bare.ends_with([':', '：'])
        && theirs
            .iter()
            .any(|words| first.to_lowercase().contains(words))
    {
        return true;
    }
    let begins = line.starts_with('#');
    (begins || ends.iter().any(|end| bare.to_lowercase().ends_with(end)))
        && says(bare, INTRODUCING)
        && !says(bare, ANSWERING)
}

/// Returns the last sentence of a line.
fn last_sentence(line: &str) -> &str {
    let mut ends = line.match_indices(['.', '!', '?']).filter(|(at, _)| {
        let (before, after) = (&line[..*at], &line[at + 1..]);
        // `e.g. this`
        let letters = before.len() - before.trim_end_matches(char::is_alphabetic).len();
        (letters > 1 || before.ends_with(')')) && after.starts_with(' ')
    });
    ends.next_back().map_or(line, |(at, _)| &line[at + 1..])
}

fn says(line: &str, words: &[&str]) -> bool {
    line.split(|letter: char| !(letter.is_alphanumeric() || letter == '.'))
        .any(|found| wordlist::is_any(found, words))
}

fn struck(reply: &str, asides: &mut Vec<(Range<usize>, Aside)>) {
    let mut marks = reply.match_indices("~~").map(|(at, _)| at).peekable();
    let mut last = 0;
    while let Some(open) = marks.next() {
        let is_fence = reply[open..].starts_with("~~~") || reply[..open].ends_with('~');
        if open < last || is_fence {
            continue;
        }
        let Some(close) = marks.peek().copied() else {
            return;
        };
        if !reply[open..close].contains("\n\n") {
            asides.push((open..close + 2, Aside::StruckOut));
            last = close + 2;
            marks.next();
        }
    }
}
