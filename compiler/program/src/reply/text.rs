//! Reads a text that follows given words, such as `Instructions:`.
//!
//! The words stand at the start of a line, in a heading, in a tag, in a table or as a key of an object. Two different
//! texts are refused, as two values of a field are.

use super::around;
use super::aside;
use super::corners;
use super::data;
use super::doubt::{Place, Prose};
use super::lexer;
use super::object::{self, Node, Shape};
use super::reading::{MAX_TEXT_CHARS, Malformed, Reading, Stated, bounded, quoted};
use super::remarks;
use super::wordlist::words;
use std::ops::Range;

/// Texts in place of one.
const PLACEHOLDERS: [&str; 12] = [
    "",
    "…",
    "...",
    "n/a",
    "na",
    "none",
    "null",
    "tbd",
    "unknown",
    "your instructions here",
    "your text here",
    "text",
];

/// Words in front of a text inside a line that make it no statement.
const DENYING: &[&str] = words!(
    "your following these those given sample example e.g. format template not instead previous previously earlier wrote
    rejected refused wrong old draft asked"
);

/// Keys whose member may hold the answer.
const ANSWERS: &[&str] = words!("answer response output result text content final message");

/// The most bytes of a text; one character has at most four.
const MAX_LENGTH: usize = 4 * MAX_TEXT_CHARS;

/// The most words of a heading of a table.
const MAX_HEADING: usize = 3;

/// The most texts that are compared.
const MAX_FOUND: usize = 50;

/// A text that was found.
struct Found {
    value: String,
    span: Range<usize>,
    repairs: Vec<String>,
    /// Whether it is the first of several items below the words.
    is_list: bool,
}

/// Reads the text between `before` and `after`; if `after` is empty, up to the end of the line.
///
/// Fails if `before` is not found, if nothing follows it, if two texts contradict each other, or if the text is
/// longer than [`MAX_TEXT_CHARS`].
pub fn read_text(before: &str, after: &str, reply: &str) -> Result<Reading<String>, Malformed> {
    let wrong = |why: String| Malformed {
        field: before.to_owned(),
        message: format!(
            "{why} Answer again with one line in exactly this format:\n{before} …{after}"
        ),
        stated: Vec::new(),
    };
    bounded(before, reply)?;
    let cleared = aside::clear(reply);
    let mut found = Vec::new();
    let mut objects = Vec::new();
    for node in object::objects(&cleared.text) {
        members(&node, before, after, &mut found);
        for (text, span) in strings(&node) {
            let lines = lines(text);
            let stated = [
                at_line_starts(&lines, before, after),
                within_lines(&lines, before, after),
            ];
            found.extend(stated.into_iter().flatten().map(|it| Found {
                span: span.clone(),
                ..it
            }));
        }
        objects.push(node.span);
    }
    let text = aside::blanked(&cleared.text, &objects);
    let lines = lines(&text);
    found.extend(at_line_starts(&lines, before, after));
    found.extend(within_lines(&lines, before, after));
    let is_named = !found.is_empty();
    found.retain(|it| !is_placeholder(&it.value));
    if cleared.is_cut_off {
        return Err(wrong("Your answer ends inside of its thoughts.".to_owned()));
    }
    let first = found.iter().map(|it| it.span.start).min();
    let first = first.and_then(|at| cleared.text.get(..at));
    let line = first.map(|above| above.rfind('\n').map_or(0, |at| at + 1));
    let heading = line.and_then(|at| {
        around::heading(
            &cleared.text,
            &cleared.asides,
            &lexer::tokens(&cleared.text),
            at,
        )
    });
    if heading.is_some() {
        return Err(wrong(
            "The line above your text says that it is no answer.".to_owned(),
        ));
    }
    if found.iter().any(|it| it.is_list) {
        let why = format!("Your answer lists several texts below \"{before}\".");
        return Err(wrong(why));
    }
    if let Some(why) = found
        .iter()
        .find_map(|it| unusable(&it.value, is_last(reply, it)))
    {
        return Err(wrong(why));
    }
    // Each text ends where a line or an object does, so what follows the first holds what follows the others.
    let rest = found.iter().map(|it| it.span.end).min();
    let rest = rest.and_then(|at| reply.get(at..));
    if rest.is_some_and(takes_back) || found.iter().any(|it| takes_back(&it.value)) {
        return Err(wrong("Your answer takes back its text.".to_owned()));
    }
    if let Some(why) = doubt(&cleared.text, before, after, &found) {
        return Err(wrong(format!("Your answer cannot be used: {why}.")));
    }
    let Some(first) = found.first() else {
        return Err(wrong(match is_named {
            true => format!("Nothing follows \"{before}\" in your answer."),
            false => format!("Your answer has no line that begins with \"{before}\"."),
        }));
    };
    if let Some(other) = found.iter().find(|other| other.value != first.value) {
        return Err(wrong(format!(
            "Your answer has two different lines that begin with \"{before}\": `{}` and `{}`.",
            quoted(&first.value),
            quoted(&other.value)
        )));
    }
    let spans: Vec<Range<usize>> = found.iter().map(|it| it.span.clone()).collect();
    if corners::differ(&first.value, &aside::blanked(&cleared.text, &spans)) {
        return Err(wrong(format!(
            "Your explanation speaks of another corner than `{}`.",
            quoted(&first.value)
        )));
    }
    let length = first.value.chars().count();
    if length > MAX_TEXT_CHARS {
        return Err(wrong(format!(
            "The text after \"{before}\" has {length} characters; at most {MAX_TEXT_CHARS} are accepted."
        )));
    }
    let first = found.swap_remove(0);
    let mut repairs = first.repairs;
    repairs.dedup();
    let stated = Stated::new(before, reply, first.span, repairs.clone());
    Ok(Reading {
        value: first.value,
        repairs,
        stated: vec![stated],
        asides: cleared.asides,
    })
}

/// Returns why an answer puts its texts in doubt: in what stands before the first, after the last, or beside them.
///
/// - `after`: what the prompt asks for after the text, `Explanation:`. What follows it is no lone remark, however short.
fn doubt(text: &str, label: &str, after: &str, found: &[Found]) -> Option<&'static str> {
    let first = found.iter().map(|it| it.span.start).min()?;
    let last = found.iter().map(|it| it.span.end).max()?;
    let objects = object::objects(text);
    let spans: Vec<Range<usize>> = objects.iter().map(|it| it.span.clone()).collect();
    let plain = aside::blanked(text, &spans);
    let around = |part: Option<&str>, place| {
        let part = part.unwrap_or_default();
        let tokens = lexer::tokens(part);
        // In a table, the next cell is that of the explanation.
        let is_asked = place == Place::After
            && (part.trim_start().starts_with('|')
                || !letters(after).is_empty() && letters(part).starts_with(&letters(after)));
        let doubted = match is_asked {
            true => remarks::doubt_in(&tokens, None, place, Prose::Explanation),
            false => remarks::doubt(&tokens, None, place),
        };
        doubted.or_else(|| remarks::of_text(&tokens, place))
    };
    let is_field = |key: &str| is_label(key, label) || ANSWERS.contains(&&*letters(key));
    around(plain.get(..first), Place::Before)
        .or_else(|| around(plain.get(last..), Place::After))
        .or_else(|| remarks::doubt_beside(&data::beside(text, &objects, &is_field)))
}

/// Returns whether a key of an object is the words before a text.
fn is_label(key: &str, before: &str) -> bool {
    let (key, wanted) = (letters(key), letters(before));
    key == wanted
        || key.strip_suffix('s') == Some(&wanted)
        || wanted.strip_suffix('s') == Some(&key)
}

/// Returns only the letters and digits of a label, in lower case.
fn letters(text: &str) -> String {
    let kept = text.chars().filter(|letter| letter.is_alphanumeric());
    kept.flat_map(char::to_lowercase).collect()
}

/// Reads the members of an object whose keys are the words.
fn members(node: &Node, before: &str, after: &str, found: &mut Vec<Found>) {
    match &node.shape {
        Shape::List(items) => items
            .iter()
            .for_each(|item| members(item, before, after, found)),
        Shape::Object(members_of) => {
            for object::Member { key, value, .. } in members_of {
                let (is_label, key) = (is_label(key, before), letters(key));
                let is_aside = [
                    "example",
                    "examples",
                    "rejected",
                    "previous",
                    "draft",
                    "thought",
                    "thoughts",
                    "reasoning",
                ]
                .contains(&&*key);
                match &value.shape {
                    Shape::Text(text) if is_label => {
                        let mut repairs = vec![format!("took the member `{key}` of an object")];
                        let value_text = cut(
                            &text.split_whitespace().collect::<Vec<_>>().join(" "),
                            after,
                            &mut repairs,
                        );
                        found.push(Found {
                            value: value_text,
                            span: value.span.clone(),
                            repairs,
                            is_list: false,
                        });
                    }
                    Shape::Bare(text) if is_label => {
                        found.push(Found {
                            value: text.clone(),
                            span: value.span.clone(),
                            repairs: Vec::new(),
                            is_list: false,
                        });
                    }
                    Shape::Object(_) | Shape::List(_) if !is_aside => {
                        members(value, before, after, found)
                    }
                    _ => {}
                }
            }
        }
        Shape::Text(_) | Shape::Bare(_) => {}
    }
}

/// Returns the strings of an object that may hold the answer.
fn strings(node: &Node) -> Vec<(&str, Range<usize>)> {
    match &node.shape {
        Shape::Text(text) => vec![(text, node.span.clone())],
        Shape::List(items) => items.iter().flat_map(strings).collect(),
        Shape::Object(members) => {
            let answers = members
                .iter()
                .filter(|member| ANSWERS.contains(&&*letters(&member.key)));
            answers.flat_map(|member| strings(&member.value)).collect()
        }
        Shape::Bare(_) => Vec::new(),
    }
}

/// The longest remark in brackets between the words before a text and their sign, bytes.
const MAX_REMARK: usize = 40;

/// Returns each line and where it begins.
fn lines(text: &str) -> Vec<(usize, &str)> {
    let mut at = 0;
    let with_start = text.split_inclusive('\n').map(|line| {
        let start = at;
        at += line.len();
        (start, line.trim_end())
    });
    with_start.collect()
}

fn at_line_starts(lines: &[(usize, &str)], before: &str, after: &str) -> Vec<Found> {
    let mut found = Vec::new();
    for (index, (start, line)) in lines.iter().enumerate() {
        let label = skip_marks(line);
        let Some((length, is_exact)) = eat_words(&line[label..], before) else {
            continue;
        };
        let mut repairs = Vec::new();
        let marks = line[..label].trim();
        if !marks.is_empty() {
            repairs.push(format!("passed over `{}` before `{before}`", quoted(marks)));
        }
        if !is_exact {
            repairs.push(format!(
                "read `{}` as `{before}`",
                quoted(&line[label..label + length])
            ));
        }
        let mut text = line[label + length..].trim().to_owned();
        text.truncate(before_tag(&text).len());
        // In a table, the text ends where its cell does.
        let is_cell = line[..label].contains('|');
        if let Some(at) = text.find('|').filter(|_| is_cell) {
            text.truncate(at);
        }
        let is_alone =
            is_cell && (!has_letters(&text) || line[label..label + length].contains('|'));
        let below = is_alone.then(|| column(lines, index, label)).flatten();
        if let Some(cells) = below {
            repairs.push(format!("took the cell below `{before}`"));
            found.push(Found {
                value: cut(cells.first, after, &mut repairs),
                span: start + label..cells.end,
                repairs,
                is_list: cells.is_several,
            });
            continue;
        }
        let mut last = index;
        let mut is_list = false;
        let mut begun = has_letters(&text);
        for (next, (_, following)) in lines.iter().enumerate().skip(index + 1) {
            let is_empty = !has_letters(following);
            if begun
                && (is_empty
                    || text.len() > MAX_LENGTH
                    || ends_sentence(&text)
                    || begins_something(following))
            {
                break;
            }
            if is_empty {
                continue;
            }
            if !begun {
                let is_heading = following.starts_with('#')
                    && following.split_whitespace().count() <= 1 + MAX_HEADING;
                if is_labelled(following) || is_heading {
                    break;
                }
                repairs.push(format!("took the line below `{before}`"));
            }
            let marks = if begun { 0 } else { skip_marks(following) };
            let is_item = |line: &str| {
                line.trim_start()
                    .starts_with(|first: char| first.is_ascii_digit() || "-•*+|".contains(first))
                    && skip_marks(line) > 0
            };
            let several = !begun
                && is_item(following)
                && lines[next + 1..]
                    .iter()
                    .take_while(|(_, line)| has_letters(line))
                    .any(|(_, line)| is_item(line));
            is_list |= several;
            let piece = following[marks..].trim();
            text = format!("{text} {}", before_tag(piece)).trim().to_owned();
            (last, begun) = (next, true);
        }
        if last > index && !repairs.iter().any(|it| it.starts_with("took the line")) {
            repairs.push("joined the lines of the text".to_owned());
        }
        let value = cut(&text, after, &mut repairs);
        let end = lines[last].0 + lines[last].1.len();
        found.push(Found {
            value,
            span: start + label..end,
            repairs,
            is_list,
        });
    }
    found
}

/// The cells of a table below one of its headings.
struct Cells<'a> {
    first: &'a str,
    /// Where the first cell ends, bytes.
    end: usize,
    is_several: bool,
}

/// Returns the cells below a heading of a table, if a line of dashes stands below its row and a text below that.
///
/// - `heading`: the row of the headings.
/// - `label`: where the heading begins in it, bytes.
fn column<'a>(lines: &[(usize, &'a str)], heading: usize, label: usize) -> Option<Cells<'a>> {
    let number = lines[heading].1[..label].matches('|').count();
    let dashes = lines.get(heading + 1)?.1;
    let is_rule = |letter: char| matches!(letter, '|' | '-' | ':' | ' ');
    if !(dashes.contains('-') && dashes.chars().all(is_rule)) {
        return None;
    }
    let rows = lines[heading + 2..].iter();
    let mut rows = rows.take_while(|(_, line)| line.trim_start().starts_with('|'));
    let (start, row) = rows.next()?;
    let first = row.split('|').nth(number)?;
    // Some write the text into the first row: `| Instructions | Unfold it. |`, and below it `| Explanation | … |`.
    if first.split_whitespace().count() <= MAX_HEADING || is_labelled(first) {
        return None;
    }
    let before: usize = row.split('|').take(number).map(|cell| cell.len() + 1).sum();
    let in_column = |row: &str| row.split('|').nth(number).is_some_and(has_letters);
    Some(Cells {
        first,
        end: start + before + first.len(),
        is_several: rows.take(MAX_FOUND).any(|(_, row)| in_column(row)),
    })
}

/// Returns a text up to where a tag closes, `</answer>` or `<|im_end|>`.
fn before_tag(text: &str) -> &str {
    let ends = ["</", "<|"].iter().filter_map(|end| text.find(end));
    &text[..ends.min().unwrap_or(text.len())]
}

fn has_letters(text: &str) -> bool {
    text.contains(char::is_alphanumeric) || text.contains('…') || text.contains("...")
}

fn ends_sentence(text: &str) -> bool {
    text.trim_end_matches(decorates)
        .ends_with(['.', '!', '?', '。', '…', '|', '}'])
}

/// Returns whether a line begins something else than the continuation of a sentence.
fn begins_something(line: &str) -> bool {
    let trimmed = line.trim_start();
    skip_marks(line) > line.len() - trimmed.len() || trimmed.starts_with("</") || is_labelled(line)
}

/// Returns whether a line begins with its own label, such as `Explanation:`.
fn is_labelled(line: &str) -> bool {
    let text = &line[skip_marks(line)..];
    let length = text
        .find(|letter: char| !(letter.is_alphanumeric() || letter == ' '))
        .unwrap_or(text.len());
    let words = text[..length].split_whitespace().count();
    (1..=3).contains(&words)
        && text[length..]
            .trim_start_matches(decorates)
            .starts_with(':')
}

/// Finds the words inside lines, unless their sentence denies them.
fn within_lines(lines: &[(usize, &str)], before: &str, after: &str) -> Vec<Found> {
    let mut found = Vec::new();
    let first = before.chars().next();
    for (start, line) in lines {
        let marks = skip_marks(line);
        let mut last = ' ';
        for (at, letter) in line.char_indices() {
            let is_inside = std::mem::replace(&mut last, letter).is_alphanumeric();
            let may_begin =
                first.is_some_and(|first| first.to_lowercase().eq(letter.to_lowercase()));
            if is_inside || at <= marks || !may_begin {
                continue;
            }
            let Some((length, _)) = eat_words(&line[at..], before) else {
                continue;
            };
            if found.len() > MAX_FOUND {
                return found;
            }
            let mut from = at.saturating_sub(MAX_LENGTH);
            while !line.is_char_boundary(from) {
                from += 1;
            }
            let preceding = line[from..at].to_lowercase();
            let sentence = preceding
                .rsplit(['.', '!', '?', ';'])
                .next()
                .unwrap_or_default();
            let mut words = sentence.split(|letter: char| !letter.is_alphanumeric());
            if words.any(|word| DENYING.contains(&word))
                || preceding
                    .trim_end_matches([' ', ',', '"', '“', '`', '\''])
                    .ends_with("e.g.")
            {
                continue;
            }
            // `a line beginning with "Instructions:", so:`
            let is_quoted = line[..at].ends_with(['"', '`', '“', '\''])
                && line[at + length..].starts_with(['"', '`', '”', '\'']);
            if is_quoted {
                continue;
            }
            let mut repairs = vec![format!("found `{before}` inside of a line")];
            let value = cut(before_tag(&line[at + length..]), after, &mut repairs);
            found.push(Found {
                value,
                span: start + at..start + line.len(),
                repairs,
                is_list: false,
            });
        }
    }
    found
}

/// Returns whether nothing follows a text in the answer.
fn is_last(reply: &str, found: &Found) -> bool {
    reply
        .get(found.span.end..)
        .is_some_and(|rest| !rest.contains(char::is_alphanumeric))
}

/// Returns whether what follows a text begins a sentence that takes it back.
fn takes_back(rest: &str) -> bool {
    let lower = rest.to_lowercase().replace('’', "'");
    let sentences = lower.split(['\n', '.', '!', '?']);
    sentences.map(str::trim).any(|sentence| {
        [
            "wait,",
            "wait ",
            "scratch that",
            "make that",
            "or alternatively",
            "please ignore",
            "ignore this",
            "this is wrong",
            "that is wrong",
            "that's wrong",
            "alternatively",
            "i cannot see",
            "i can't see",
            "on second thought",
            "actually, ",
            "actually no",
            "hold on",
            "sorry, ",
            "oops",
            "no, ",
            "correction:",
            "looking again,",
        ]
        .iter()
        .any(|words| sentence.starts_with(words))
            || [
                "should say",
                "should read",
                "should have said",
                "should have been",
            ]
            .iter()
            .any(|words| sentence.contains(words))
    })
}

/// Returns why something that stands after the words is no text.
fn unusable(text: &str, is_last: bool) -> Option<String> {
    let lower = text.to_lowercase().replace('’', "'");
    let begins = |words: &[&str]| words.iter().any(|word| lower.starts_with(word));
    if begins(&[
        "i'm sorry",
        "i am sorry",
        "sorry",
        "unfortunately",
        "i cannot",
        "i can't",
        "i am unable",
        "i'm unable",
        "i am not able",
        "i'm not able",
        "as an ai",
        "unable to",
        "not able to",
        "cannot determine",
        "can't determine",
        "i don't know",
        "i do not know",
        "not sure",
        "none,",
        "nothing to ",
    ]) {
        return Some("Your answer holds an apology where the text is expected.".to_owned());
    }
    let is_lost = ["make out", "tell", "say which", "see where"]
        .iter()
        .any(|seen| {
            ["i can't ", "i cannot ", "i am unable to ", "i'm unable to "]
                .iter()
                .any(|unable| lower.contains(&format!("{unable}{seen}")))
        });
    if is_lost {
        return Some("Your answer says in its text that it cannot see something.".to_owned());
    }
    let is_remark = lower.starts_with('(') && lower.ends_with(')')
        || begins(&["please look", "please note", "see the", "refer to"]);
    if is_remark || (lower.contains(" | ") || lower.ends_with('|')) {
        return Some(
            "Your answer holds a remark or a table where the text is expected.".to_owned(),
        );
    }
    let orders: Vec<&str> = lower.split(['.', ';', ',']).map(str::trim).collect();
    let is_forbidden = |order: &&str| {
        let forbids = ["do not ", "don't ", "never "];
        !has_letters(order) || forbids.iter().any(|it| order.starts_with(it))
    };
    if has_letters(&lower) && orders.iter().all(is_forbidden) {
        return Some("Your answer only says what not to do.".to_owned());
    }
    if lower.ends_with('?') {
        return Some("Your answer asks something where the text is expected.".to_owned());
    }
    // `<pick point>`, `[pick point]`
    let is_word = |letter: char| letter.is_alphabetic() || letter == ' ';
    let has_blank = [('<', '>'), ('[', ']')].iter().any(|(open, close)| {
        let blank = lower
            .split_once(*open)
            .and_then(|(_, rest)| rest.split_once(*close));
        blank.is_some_and(|(blank, _)| blank.len() > 1 && blank.chars().all(is_word))
    });
    if has_blank {
        return Some("Your answer leaves a blank in the text.".to_owned());
    }
    if [
        "no wait",
        "no, wait",
        "i mean:",
        "scratch that",
        "correction:",
    ]
    .iter()
    .any(|turn| lower.contains(turn))
    {
        return Some("Your answer takes back a part of the text.".to_owned());
    }
    let offers_another = [
        ", or, ",
        ", or if ",
        " or else ",
        ", or fold ",
        ", or pick ",
        ", or bring ",
        ", or carry ",
        ", or take ",
        ", or place ",
        ", or move ",
        ", or the other way",
        " or alternatively ",
        ", or maybe ",
        ", or perhaps ",
        ", or possibly ",
        "; or ",
    ]
    .iter()
    .any(|joint| lower.contains(joint));
    let chooses_none = offers_another
        || (format!(" {lower}").contains(" either ") && lower.contains(" or "))
        || lower.contains("not sure which")
        || (lower.starts_with("if ")
            && lower.split([';', '.', ',']).skip(1).any(|clause| {
                let first = clause.split_whitespace().next().unwrap_or_default();
                ["if", "otherwise", "else"].contains(&first)
            }));
    if chooses_none {
        return Some("Your answer leaves more than one text open.".to_owned());
    }
    let ends_open = [
        "the", "a", "an", "to", "of", "and", "or", "with", "from", "onto", "at", "in", "on", "by",
        "until", "its",
    ];
    let last = lower
        .rsplit(|letter: char| !letter.is_alphanumeric())
        .next()
        .unwrap_or_default();
    if is_last && ends_open.contains(&last) {
        return Some(format!("Your answer is cut off after `{last}`."));
    }
    None
}

/// Returns whether a character is only decoration: Markdown, quotation marks, LaTeX.
fn decorates(letter: char) -> bool {
    matches!(
        letter,
        '*' | '_' | '`' | '"' | '\'' | '“' | '”' | '$' | '\\' | '~'
    )
}

/// Returns the length of the marks of a list, a heading, a table or a tag at the start of a line.
fn skip_marks(line: &str) -> usize {
    let is_mark = |letter: char| {
        letter.is_whitespace()
            || decorates(letter)
            || matches!(
                letter,
                '-' | '•' | '·' | '#' | '>' | '+' | '{' | '[' | '<' | '|' | '→'
            )
    };
    let rest = line.trim_start_matches(is_mark);
    let behind = rest.trim_start_matches(|letter: char| letter.is_ascii_digit());
    let rest = match behind.strip_prefix(['.', ')']) {
        Some(behind) if behind.len() + 1 < rest.len() => behind.trim_start_matches(is_mark),
        _ => rest,
    };
    line.len() - rest.len()
}

/// Returns the length of the words at the start of a text, in any case and spacing, and whether they are exact.
///
/// The colon at their end may be missing if the line ends there, or be the end of a tag or of a table's cell.
fn eat_words(text: &str, words: &str) -> Option<(usize, bool)> {
    let mut rest = text;
    let mut is_exact = true;
    // The words may be a tag, `<instruction>`; the marks before it are skipped already.
    let words = words.trim_start_matches(['<', '[', '*', '#', ' ']);
    let wanted = words.trim_end_matches([':', '=', ' ', '>']);
    for letter in wanted.chars() {
        if letter.is_whitespace() {
            let trimmed =
                rest.trim_start_matches(|found: char| found.is_whitespace() || decorates(found));
            is_exact &= rest.len() == trimmed.len() + 1;
            rest = trimmed;
            continue;
        }
        if !rest.starts_with(letter) {
            let trimmed = rest.trim_start_matches(|found: char| decorates(found) || found == ' ');
            is_exact &= trimmed.len() == rest.len();
            rest = trimmed;
        }
        let found = rest.chars().next()?;
        if !found.to_lowercase().eq(letter.to_lowercase()) {
            return None;
        }
        is_exact &= found == letter;
        rest = &rest[found.len_utf8()..];
    }
    if wanted.len() == words.trim_end().len() {
        let ends = !rest.starts_with(char::is_alphanumeric);
        return ends.then_some((text.len() - rest.len(), is_exact));
    }
    let mut sign = rest.trim_start_matches(|found: char| decorates(found) || found == ' ');
    // `Instructions (alternative): Fold it.`
    if let Some((remark, behind)) = sign.strip_prefix('(').and_then(|it| it.split_once(')'))
        && !{ remark.split(' ') }.any(|word| DENYING.contains(&&*word.to_lowercase()))
        && sign.len() - behind.len() <= MAX_REMARK
        && behind
            .trim_start_matches(decorates)
            .starts_with([':', '：'])
    {
        is_exact = false;
        sign = behind.trim_start_matches(decorates);
    }
    let after_sign = sign.trim_start_matches([':', '=', '：', '>', '|', '→']);
    // `Instructions - Fold it.`
    let after_sign = [" - ", " – ", " — "]
        .iter()
        .find_map(|dash| rest.trim_start_matches(decorates).strip_prefix(dash))
        .unwrap_or(after_sign);
    let is_there = after_sign.len() < sign.len();
    let is_heading = sign.is_empty() && !rest.starts_with(char::is_alphanumeric);
    if !is_there && !is_heading {
        return None;
    }
    is_exact &= rest.starts_with(words[wanted.len()..].trim_end());
    Some((text.len() - after_sign.len(), is_exact))
}

/// Returns whether a text only holds the place of one.
fn is_placeholder(text: &str) -> bool {
    let bare = text.trim().trim_end_matches('.').trim().to_lowercase();
    let inside = |open: char, close: char| {
        bare.starts_with(open) && bare.ends_with(close) && !bare[open.len_utf8()..].contains(open)
    };
    // `Instructions: ...`, so here it is
    let dots = bare.trim_start_matches(['.', '…']);
    let is_open = dots.len() < bare.len() && dots.starts_with([',', ';', ':']);
    let describes = [
        "one sentence ",
        "a sentence ",
        "one line ",
        "a single sentence ",
        "your ",
    ];
    is_open
        || describes.iter().any(|words| bare.starts_with(words))
        || PLACEHOLDERS.contains(&&*bare)
        || PLACEHOLDERS.contains(&text.trim())
        || inside('<', '>')
        || inside('[', ']')
        || inside('{', '}')
}

/// Takes the text up to `after`, without the decoration around it.
fn cut(rest: &str, after: &str, repairs: &mut Vec<String>) -> String {
    let rest = rest.trim();
    // YAML's marks of a text of several lines.
    let rest = [">-", "|-", ">", "|"]
        .iter()
        .find_map(|mark| rest.strip_prefix(mark))
        .unwrap_or(rest)
        .trim_start();
    let ends = rest.match_indices(after).map(|(at, _)| at).find(|at| {
        let next = rest[at + after.len()..].chars().next();
        next.is_none_or(|next| {
            next.is_whitespace() || decorates(next) || matches!(next, ')' | '}' | ']')
        })
    });
    let text = match ends.filter(|_| !after.is_empty()) {
        Some(end) => &rest[..end],
        None => {
            if !after.is_empty() && !rest.is_empty() {
                repairs.push(format!(
                    "took the text to the end of the line, as `{after}` is missing"
                ));
            }
            rest
        }
    };
    let is_quoted = text.trim_start().starts_with(['"', '“']);
    let mut bare = text.trim_matches(|letter: char| letter.is_whitespace() || decorates(letter));
    if is_quoted {
        bare = bare.trim_end_matches(|letter: char| {
            matches!(letter, ',' | '}') || decorates(letter) || letter.is_whitespace()
        });
    }
    // What opened before the text closes after it: `print("…")`, `\\boxed{…}`.
    while let Some(close) = bare
        .chars()
        .next_back()
        .filter(|last| matches!(last, ')' | '}' | ']'))
    {
        let open = match close {
            ')' => '(',
            '}' => '{',
            _ => '[',
        };
        if bare.matches(open).count() >= bare.matches(close).count() {
            break;
        }
        bare = bare[..bare.len() - 1]
            .trim_end_matches(|letter: char| letter.is_whitespace() || decorates(letter));
    }
    let plain = unmarked(bare);
    if plain.len() != text.trim().len() {
        repairs.push("removed the markdown or quotes around the text".to_owned());
    }
    plain
}

/// Removes the Markdown inside of a text: `**only**`, `__hem__`, `*corner*`.
fn unmarked(text: &str) -> String {
    let plain = text.replace("**", "").replace("__", "").replace('`', "");
    let mut kept = String::with_capacity(plain.len());
    let mut letters = plain.chars().peekable();
    while let Some(letter) = letters.next() {
        let is_inside = kept.ends_with(char::is_alphanumeric)
            && letters.peek().is_some_and(|next| next.is_alphanumeric());
        let is_mark = letter == '*' && !(kept.ends_with(' ') && letters.peek() == Some(&' '));
        if !is_mark || is_inside {
            kept.push(letter);
        }
    }
    kept
}
