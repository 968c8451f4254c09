//! Turns syntax faults into diagnostics.
//!
//! In: a fault from the grammar. Out: a diagnostic, with a repair if one is likely.

mod mistakes;

use crate::diag::{Code, Diagnostic, among, nearest};
use crate::lang::goal::METRICS;
use fab_grammar::{Fault, Kind, Problem, Span};
use mistakes::{Change, Place};

/// Makes the diagnostic for a fault of `text`, a whole file.
pub(crate) fn diagnose(fault: &Fault, text: &str) -> Diagnostic {
    let span = fault.span;
    let new = |code: Code, message: &str| Diagnostic::new(code, span, message);
    match &fault.problem {
        Problem::TooLong { bytes, limit } => new(
            Code::FileTooLong,
            &format!("the file has {bytes} bytes, at most {limit} are accepted"),
        ),
        Problem::TooDeep { limit } => new(
            Code::NestedTooDeep,
            &format!("more than {limit} brackets and braces are open at once"),
        ),
        Problem::LongWord { limit } => new(
            Code::WordTooLong,
            &format!("a word has more than {limit} letters"),
        ),
        Problem::MergeConflict { markers } => merge_conflict(markers, text),
        Problem::Unexpected {
            found,
            expected,
            words,
        } => {
            let place = Place {
                found: found.as_deref().unwrap_or_default(),
                expected,
                words,
                before: &text[..span.start],
                rest: &text[span.start..],
            };
            unexpected(span, &place)
        }
        Problem::UnknownWord {
            word,
            candidates,
            words,
            block,
        } => unknown_word(span, word, (candidates, words), block.as_deref()),
        Problem::MissingOpen { block } => new(Code::MissingBrace, &format!("`{block}` has no `{{`"))
            .label("expected `{`")
            .likely(span, " {"),
        Problem::MissingClose { block } => new(
            Code::MissingBrace,
            &format!("the `{{` of `{block}` is never closed"),
        )
        .label("stays open")
        .help("add a `}` where the block ends"),
        Problem::MissingName { after } => new(
            Code::MissingName,
            &format!("`{after}` is not followed by a name"),
        )
        .label("expected a name")
        .help("a name begins with a letter and has only letters without accents, digits and `_`; words of the language cannot be names"),
        Problem::Surplus { found } => surplus(span, found, text),
        Problem::StrayClose { early } => {
            let diagnostic = new(Code::StrayBrace, "this `}` closes nothing");
            match early {
                Some(early) => diagnostic
                    .also(*early, "this one is probably too many")
                    .help("remove it, or the one above"),
                None => diagnostic.help("remove it, or look for a `}` too many above"),
            }
        }
        Problem::OutsideTask { word, early } => {
            let diagnostic = new(
                Code::SectionOutsideTask,
                &format!("`{word}` is outside of any task"),
            )
            .help("move it between the braces of a `task`; perhaps a `}` above closes the task too early");
            let early = early.iter();
            early.fold(diagnostic, |it, early| {
                it.also(*early, "this one is probably too many")
            })
        }
        Problem::TrailingComma => new(Code::TrailingComma, "a list ends with a comma")
            .help("remove the comma, or add another part")
            .edit(span, ""),
        Problem::UnclosedString => new(Code::UnclosedText, "the text does not end on this line")
            .help("close it with `\"`; a text of several lines is written between `\"\"\"` and `\"\"\"`"),
        Problem::UnopenedString => new(
            Code::UnclosedText,
            "this text has no quote at its beginning",
        )
        .help("open it with `\"`")
        .likely(Span::new(span.file, span.start..span.start), "\""),
        Problem::UnclosedText => new(Code::UnclosedText, "the text that begins here does not end")
            .help("close it with `\"\"\"`"),
        Problem::WrongQuotes { right } => {
            let diagnostic = new(Code::WrongQuotes, "these quotes are not of the right kind")
                .help("write straight double quotes `\"`");
            if keeps_text(text, span, right) {
                diagnostic.edit(span, right.clone())
            } else {
                diagnostic
            }
        }
        Problem::BadEscape => new(Code::BadEscape, "this `\\` escapes nothing")
            .help("write `\\\\` for a backslash and `\\\"` for a quote; a text of several lines is written between `\"\"\"` and `\"\"\"`, and folders are separated by `/`"),
        Problem::LoneBraces => {
            let line = text[span.end..].lines().next().unwrap_or_default();
            let message = match line.split_once("}}") {
                Some((between, _)) if !between.contains("{{") => {
                    format!("expected a name between `{{{{` and `}}}}`, found `{}`", between.trim())
                }
                _ => "expected a name and `}}` after `{{`".to_owned(),
            };
            new(Code::LoneBraces, &message)
                .help("write `{{ name }}` for a value, `{{ \"{{\" }}` for two literal braces")
        }
    }
}

fn merge_conflict(markers: &[Span], text: &str) -> Diagnostic {
    let line = |span: &Span| text[..span.start].matches('\n').count() + 1;
    let (first, last) = (markers[0], markers[markers.len() - 1]);
    let lines = if first == last {
        format!("in line {}", line(&first))
    } else {
        format!("in lines {} to {}", line(&first), line(&last))
    };
    let message = format!("a merge conflict is not resolved, {lines}");
    let diagnostic = Diagnostic::new(Code::MergeConflict, first, message)
        .help("keep one of the two versions, and remove the lines with `<<<<<<<`, `=======` and `>>>>>>>`");
    let others = markers[1..].iter();
    others.fold(diagnostic, |it, marker| it.also(*marker, "belongs to it"))
}

fn unexpected(span: Span, place: &Place<'_>) -> Diagnostic {
    let is_invisible = !place.found.is_empty()
        && place
            .found
            .chars()
            .all(fab_program::invisible::is_invisible);
    let found = if place.found.is_empty() {
        "the end of the line".to_owned()
    } else if is_invisible {
        format!("an invisible character, `{}`", place.found.escape_unicode())
    } else {
        format!("`{}`", place.found)
    };
    let message = |found: &str| {
        if place.expected.is_empty() {
            format!("unexpected {}", found.trim_start_matches("an "))
        } else {
            format!("expected {}, found {found}", listed(place.expected))
        }
    };
    let usual = Diagnostic::new(Code::Unexpected, span, message(&found));
    if is_invisible {
        return usual.help("remove it").likely(span, "");
    }
    if let Some(decimal) = decimal_comma(span, place) {
        return decimal;
    }
    if let Some((start, word)) = word_before_number(place) {
        let message = format!("expected `,`, found `{word}`");
        let at_word = Span::new(span.file, start..start + word.len());
        return Diagnostic::new(Code::Unexpected, at_word, message)
            .help("write `,` before it")
            .likely(Span::new(span.file, start..start), ", ");
    }
    if let Some(meant) = misspelt(place) {
        let message = format!("expected `{meant}`, found `{}`", place.found);
        return Diagnostic::new(Code::Unexpected, span, message).meant(span, meant);
    }
    if let Some((mistake, found)) = mistakes::recognise(place) {
        if found.is_empty() {
            return usual.help(mistake.help);
        }
        let span = Span::new(span.file, span.start..span.start + found.len());
        let message = if mistake.message.is_empty() {
            message(&format!("`{found}`"))
        } else {
            mistake.message.replace("{}", found)
        };
        let before = Span::new(span.file, span.start..span.start);
        let diagnostic = Diagnostic::new(Code::Unexpected, span, message).help(mistake.help);
        return match mistake.change {
            Change::Nothing => diagnostic,
            Change::Write(right) => diagnostic.edit(span, apart(right, place, found)),
            Change::MayWrite(right) => diagnostic.likely(span, apart(right, place, found)),
            Change::MayInsert(text) => diagnostic.likely(before, text),
        };
    }
    match mistakes::open_bracket(place.before).filter(|_| place.expected.contains(&"`)`")) {
        Some(start) => usual.also(Span::new(span.file, start..start + 1), "this `(` is open"),
        None => usual,
    }
}

/// Returns the word of the language that is misspelt at a place.
fn misspelt(place: &Place<'_>) -> Option<&'static str> {
    let letters = |word: &str| {
        let mut letters: Vec<char> = word.chars().collect();
        letters.sort_unstable();
        letters
    };
    let words = place.words.iter().copied();
    // Two short words are near each other by chance.
    let is_near = |meant: &str| place.found.len() > 2 || letters(meant) == letters(place.found);
    nearest(place.found, words.filter(|meant| is_near(meant)))
}

/// Returns a word with the blanks that it needs where its sign needs none: `near&&far`.
fn apart(word: &str, place: &Place<'_>, found: &str) -> String {
    let is_word = word.starts_with(|first: char| first.is_ascii_lowercase());
    let touches = |beside: Option<char>, brackets: &str| {
        is_word && beside.is_some_and(|it| !it.is_whitespace() && !brackets.contains(it))
    };
    let blank = |is_needed: bool| if is_needed { " " } else { "" };
    let before = blank(touches(place.before.chars().next_back(), "({"));
    let after = blank(touches(place.rest[found.len()..].chars().next(), ")}"));
    format!("{before}{word}{after}")
}

/// Recognises a number with a comma in place of its point: before the fraction, or behind it.
fn decimal_comma(span: Span, place: &Place<'_>) -> Option<Diagnostic> {
    let is_digit = |letter: char| letter.is_ascii_digit();
    let (before, after, at) = match place.before.strip_suffix(',') {
        Some(before) => (before, place.rest, span.start - 1),
        None => (place.before, place.rest.strip_prefix(',')?, span.start),
    };
    if !before.ends_with(is_digit) || !after.starts_with(is_digit) {
        return None;
    }
    let comma = Span::new(span.file, at..at + 1);
    let message = "the decimal separator is a point, not a comma";
    let diagnostic = Diagnostic::new(Code::Unexpected, comma, message);
    // `1,000` is more often a thousand than one.
    let is_group = after.len() - after.trim_start_matches(is_digit).len() == 3;
    Some(if is_group {
        diagnostic.help("write `.` before a fraction; digits are not grouped")
    } else {
        diagnostic.help("write `.`").likely(comma, ".")
    })
}

/// Returns the word before a number that does not fit: of `model vision temperature 0.2` the setting's name, which was
/// read as the value of the one before it.
fn word_before_number<'t>(place: &Place<'t>) -> Option<(usize, &'t str)> {
    if place.expected != ["`,`"] || !place.found.starts_with(|it: char| it.is_ascii_digit()) {
        return None;
    }
    let before = place.before.trim_end();
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let start = before.trim_end_matches(is_part).len();
    let word = &before[start..];
    let is_word = word.starts_with(|first: char| first.is_ascii_alphabetic());
    is_word.then_some((start, word))
}

/// Reports a line that begins with an unknown word.
///
/// - `fitting`: the words that begin such a line, and those that go on with the line before.
fn unknown_word(
    span: Span,
    word: &str,
    (candidates, words): (&[&'static str], &[&'static str]),
    block: Option<&str>,
) -> Diagnostic {
    let message = match block {
        Some("task") => format!("a task has no section `{word}`"),
        Some(block) => format!("`{block}` has no `{word}`"),
        None => format!("a file has no `{word}`"),
    };
    let diagnostic = Diagnostic::new(Code::UnknownWord, span, message);
    if let Some(help) = mistakes::misplaced(word, block.unwrap_or("file")) {
        return diagnostic.help(help);
    }
    if let Some(meant) = nearest(word, candidates.iter().copied()) {
        return diagnostic.meant(span, meant);
    }
    if let Some(meant) = nearest(word, words.iter().copied()) {
        let message = format!("expected `{meant}`, found `{word}`");
        return Diagnostic::new(Code::Unexpected, span, message).meant(span, meant);
    }
    if let Some(row) = METRICS.iter().find(|row| row.metric.as_str() == word) {
        let example = row.example;
        return diagnostic.help(format!("a task's goal begins with `goal`: `{example}`"));
    }
    let mut blocks = fab_grammar::blocks().iter();
    match blocks.find(|block| block.words.contains(&word)) {
        Some(block) if block.kind == Kind::File => {
            diagnostic.help("it stands outside of tasks, at the beginning of the file")
        }
        Some(block) => diagnostic.help(format!("it belongs in `{}`", block.name)),
        None => diagnostic.help(format!(
            "a line here begins with {}",
            among(candidates.iter().copied())
        )),
    }
}

/// Reports what stands between the name of a block and its `{`.
fn surplus(span: Span, found: &str, text: &str) -> Diagnostic {
    let head = text[..span.start].rsplit(['\n', '{', '}']).next();
    let head = head.unwrap_or_default().trim_start();
    let is_sign = |it: char| !it.is_alphanumeric() && it != '_';
    let first = found.split(is_sign).next().unwrap_or_default();
    let is_task = head.starts_with("task ");
    let join = if is_task { "extends" } else { "when" };
    if nearest(first, [join]).is_some() {
        let message = format!("expected `{join}`, found `{first}`");
        let span = Span::new(span.file, span.start..span.start + first.len());
        return Diagnostic::new(Code::Unexpected, span, message).meant(span, join);
    }
    let message = format!("expected `{{`, found `{found}`");
    let diagnostic = Diagnostic::new(Code::Unexpected, span, message);
    let touches = !head.ends_with(is_sign);
    if let Some(condition) = found.strip_prefix("if ") {
        return diagnostic.meant(span, &format!("when {condition}"));
    }
    if found.starts_with('+') {
        return diagnostic.help("to add to what is inherited, write `check NAME { … } else \"…\"` or `say NAME in STAGE after NAME` in the task itself");
    }
    if is_task && head.contains(" extends ") {
        return diagnostic.help(format!("a task extends one other: remove `{found}`"));
    }
    // `task half(base)`, `task half inherits base`
    if is_task
        && (found.starts_with('(') || !touches)
        && let Some(base) = found.rsplit(is_sign).find(|it| !it.is_empty())
    {
        return diagnostic.help(format!("did you mean `extends {base}`?"));
    }
    if touches && !found.starts_with(['(', ',', ':']) {
        return diagnostic.help("a name has only letters without accents, digits and `_`");
    }
    diagnostic.help(format!("remove `{found}`"))
}

/// Returns whether only the quotes of a text change: nothing in it means something else between straight quotes, and
/// no quote of its kind without a partner is beside it, as in `'don't'`.
fn keeps_text(text: &str, span: Span, right: &str) -> bool {
    const PAIRS: [&str; 7] = ["''", "“”", "„”", "„“", "‟”", "«»", "‘’"];
    let mut written = text[span.range()].chars();
    let (first, last) = (written.next(), written.next_back());
    let pair: String = first.into_iter().chain(last).collect();
    if !PAIRS.contains(&pair.as_str()) {
        return false;
    }
    let body = right.trim_matches('"');
    if right.starts_with("\"\"\"") {
        return first != Some('\'') && !body.contains("\"\"\"");
    }
    let is_end = |letter: char| letter == '\n' || letter == '\r';
    let before = text[..span.start].rsplit(is_end).next().unwrap_or_default();
    let after = text[span.end..].split(is_end).next().unwrap_or_default();
    // Beside another quote, as in `''"`, the new ones would begin a text of several lines.
    let is_apart = !before.ends_with('"') && !after.starts_with('"');
    let is_quote = |letter: char| pair.contains(letter);
    let is_paired = |beside: &str| beside.matches(is_quote).count().is_multiple_of(2);
    let means_more = |letter: char| is_quote(letter) || "\"\\{".contains(letter);
    is_apart && !body.contains(means_more) && is_paired(before) && is_paired(after)
}

/// Joins expectations, which have their own backticks.
fn listed(expected: &[&str]) -> String {
    match expected {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => expected.concat(),
    }
}
