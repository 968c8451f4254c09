//! Turns syntax faults into diagnostics.
//!
//! In: a fault from the grammar. Out: a diagnostic, with a repair if one is likely.

mod additions;
mod mistakes;

use crate::diag::{Code, Diagnostic, among, keeps_content, nearest};
use fab_grammar::Span;
use fab_grammar::{Fault, Kind, Problem};
use mistakes::listed;

/// Makes the diagnostic for a fault of `text`, a whole file.
pub(crate) fn diagnose(fault: &Fault, text: &str) -> Diagnostic {
    let span = fault.span;
    match &fault.problem {
        Problem::TooLong { bytes, limit } => {
            Diagnostic::new(Code::FileTooLong, span, format!("the file has {bytes} bytes, at most {limit} are accepted"))
        }
        Problem::TooDeep { limit } => {
            Diagnostic::new(Code::NestedTooDeep, span, format!("more than {limit} brackets and braces are open at once"))
        }
        Problem::LongWord { limit } => {
            Diagnostic::new(Code::WordTooLong, span, format!("a word has more than {limit} letters"))
        }
        Problem::Unexpected { found, expected, is_surplus } => {
            let diagnostic = unexpected(span, found.as_deref(), expected, text);
            match found.as_deref() {
                Some(sign @ (":" | "=")) if *is_surplus && diagnostic.edits.is_empty() && diagnostic.help.is_empty() => {
                    diagnostic.help(format!("remove the `{sign}`")).likely(span, "")
                }
                _ => diagnostic,
            }
        }
        // `check far { … } esle "Too far."`
        Problem::UnknownWord { word, block: Some(block), .. }
            if block == "verify"
                && additions::help_for_word(word, Some(block)).is_none()
                && text[..span.start].trim_end().ends_with('}')
                && text[span.end..].trim_start_matches(' ').starts_with('"') =>
        {
            Diagnostic::new(Code::Unexpected, span, format!("expected `else`, found `{word}`")).meant(span, "else")
        }
        Problem::UnknownWord { word, candidates, block } => additions::behind_change(word, span, text)
            .unwrap_or_else(|| unknown_word(span, word, candidates, block.as_deref())),
        Problem::Misspelt { word, meant } => {
            let message = format!("expected {}, found `{word}`", among(meant.iter().copied()));
            let diagnostic = Diagnostic::new(Code::Unexpected, span, message);
            match meant.as_slice() {
                _ if word == "on" && is_behind_point(&text[..span.start]) => {
                    Diagnostic::new(Code::Unexpected, span, "expected `within`, found `on`")
                        .help("write `within` and a mask, as in `pick within cloth`")
                }
                [only] => diagnostic.meant(span, only),
                _ => diagnostic,
            }
        }
        Problem::MissingOpen { block } if let Some(extends) = word_after(text, span, "extends")
            && let Some(help) = additions::added_to(block) =>
        {
            Diagnostic::new(Code::Unexpected, extends, "expected `{`, found `extends`").help(help)
        }
        Problem::MissingOpen { block } => {
            Diagnostic::new(Code::MissingBrace, span, format!("`{block}` has no `{{`")).label("expected `{`").likely(span, " {")
        }
        Problem::MissingClose { block, .. } => {
            Diagnostic::new(Code::MissingBrace, span, format!("the `{{` of `{block}` is never closed"))
                .label("stays open")
                .help(match begins_again(block, span, text) {
                    true => format!("the next line begins `{block}` again: remove one of the two, or add a `}}` where the first ends"),
                    false => "add a `}` where the block ends".to_owned(),
                })
        }
        Problem::MissingName { after } => {
            Diagnostic::new(Code::MissingName, span, format!("`{after}` is not followed by a name"))
                .label("expected a name")
                .help(match sign_before_name(&text[span.start..span.end]) {
                    Some(sign) => format!("remove the `{sign}`"),
                    None => "a name begins with a letter and has only letters without accents, digits and `_`; words of the language cannot be names".to_owned(),
                })
        }
        Problem::Surplus { found } => {
            let diagnostic =
                Diagnostic::new(Code::Unexpected, span, format!("expected `{{`, found `{found}`"));
            let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
            let touches = text[..span.start].ends_with(is_part);
            let continues_a_word = touches && !found.starts_with(['(', ',', ':']);
            let head = text[..span.start].lines().next_back().unwrap_or_default().trim_start();
            let is_task = head.starts_with("task ");
            if is_task && found.starts_with(',') && head.contains(" extends ") {
                return diagnostic.help(format!("a task extends one other: remove the `{found}`"));
            }
            if is_task && !continues_a_word && head.contains(" extends ") && base_of(found).is_some() {
                return diagnostic.help(format!("a task extends one other: remove `{found}`"));
            }
            if is_task && !continues_a_word && let Some(base) = base_of(found) {
                let gap = if touches { " " } else { "" };
                return diagnostic
                    .help(format!("did you mean `extends {base}`?"))
                    .likely(span, format!("{gap}extends {base}"));
            }
            if found.starts_with('+')
                && let Some(help) = head.split_whitespace().next().and_then(additions::added_to)
            {
                return diagnostic.help(help);
            }
            if is_task && let Some((second, _)) = found.split_once(" extends ") {
                return diagnostic.help(format!("a task has one name: remove `{second}`, or the one before it"));
            }
            if !is_task && let Some(condition) = found.strip_prefix("if ") {
                return diagnostic.meant(span, &format!("when {condition}"));
            }
            if !found.contains(char::is_alphanumeric) {
                diagnostic.help(format!("remove the `{found}`")).likely(span, "")
            } else if continues_a_word {
                diagnostic.help("a name has only letters without accents, digits and `_`")
            } else if fab_grammar::is_keyword(found) {
                diagnostic.help(format!("write `{{` before `{found}`, or remove `{found}`"))
            } else {
                diagnostic.help(format!("remove `{found}`"))
            }
        }
        Problem::StrayClose { early } => {
            let diagnostic = Diagnostic::new(Code::StrayBrace, span, "this `}` closes nothing");
            match early {
                Some(early) => diagnostic.also(*early, "this one is probably too many").help("remove it, or the one above"),
                None => diagnostic.help("remove it, or look for a `}` too many above"),
            }
        }
        Problem::OutsideTask { word, early } => {
            let diagnostic = Diagnostic::new(Code::SectionOutsideTask, span, format!("`{word}` is outside of any task"))
                .help("move it between the braces of a `task`; perhaps a `}` above closes the task too early");
            early.iter().fold(diagnostic, |it, early| it.also(*early, "this one is probably too many"))
        }
        Problem::TrailingComma => Diagnostic::new(Code::TrailingComma, span, "a list ends with a comma")
            .help("remove the comma, or add another part")
            .edit(span, ""),
        Problem::UnclosedString => Diagnostic::new(Code::UnclosedText, span, "the text does not end on this line").help(
            match has_stray_quote(text, span.start) {
                true => "one `\"` of this line is too many, or one is missing",
                false => "close it with `\"`; a text of several lines is written between `\"\"\"` and `\"\"\"`",
            },
        ),
        Problem::UnopenedString => {
            let start = Span { end: span.start, ..span };
            Diagnostic::new(Code::UnclosedText, span, "this text has no quote at its beginning")
                .help("open it with `\"`")
                .likely(start, "\"")
        }
        Problem::UnclosedText => Diagnostic::new(Code::UnclosedText, span, "the text that begins here does not end")
            .help("close it with `\"\"\"`"),
        Problem::WrongQuotes { right } => {
            let diagnostic = Diagnostic::new(Code::WrongQuotes, span, "these quotes are not of the right kind")
                .help("write straight double quotes `\"`");
            // Where it is unclear which quotes enclose the text, any edit would change it.
            if keeps_content(text, span, right) { diagnostic.edit(span, right.clone()) } else { diagnostic }
        }
        Problem::BadEscape if text[span.end..].starts_with('n') && !is_behind_use(text, span) => {
            Diagnostic::new(Code::BadEscape, span, "this `\\` escapes nothing")
                .help("write a text of several lines between `\"\"\"` and `\"\"\"`; folders are separated by `/`")
        }
        Problem::BadEscape => Diagnostic::new(Code::BadEscape, span, "this `\\` escapes nothing")
            .help("write `\\\\` for a backslash and `\\\"` for a quote; folders are separated by `/`"),
        Problem::LoneBraces => {
            let line = text[span.end..].lines().next().unwrap_or_default();
            let message = match line.split_once("}}") {
                Some((between, _)) if !between.contains("{{") => format!("expected a name between `{{{{` and `}}}}`, found `{}`", between.trim()),
                _ => "expected a name and `}}` after `{{`".to_owned(),
            };
            Diagnostic::new(Code::LoneBraces, span, message)
                .help("write `{{ name }}` for a value, `{{ \"{{\" }}` for two literal braces")
        }
    }
}

/// Returns whether a line is a `use`, whose text is a path.
fn is_behind_use(text: &str, span: Span) -> bool {
    let line = text[..span.start].lines().next_back().unwrap_or_default();
    line.trim_start().starts_with("use")
}

/// Returns whether a text ends with the name of a point of the action.
fn is_behind_point(before: &str) -> bool {
    let before = before.trim_end();
    before.ends_with("pick") || before.ends_with("place")
}

/// Returns the sign with which a text begins, if a name follows it: `) folding`.
fn sign_before_name(text: &str) -> Option<char> {
    let sign = text.chars().next().filter(char::is_ascii_punctuation)?;
    let rest = text[1..].trim_start();
    (rest.starts_with(|it: char| it.is_ascii_alphabetic()) && !"_\"'".contains(sign))
        .then_some(sign)
}

/// Returns whether a line has another quote behind the one at `start`, or this one begins no text: `" = 10mm`, `lib/a.fab"`.
fn has_stray_quote(text: &str, start: usize) -> bool {
    let line = text[start..].lines().next().unwrap_or_default();
    let behind = line.strip_prefix('"').unwrap_or_default();
    let ends_word = text[..start].ends_with(|it: char| it.is_alphanumeric());
    let begins_none = match behind.trim().is_empty() {
        // A text of several lines may begin here.
        true => ends_word,
        false => behind.starts_with([' ', '=', ')', ',', '}']),
    };
    begins_none || line.matches('"').count() > 1
}

fn unexpected(span: Span, found: Option<&str>, expected: &[&str], text: &str) -> Diagnostic {
    let is_blank = found.is_some_and(|found| found.chars().all(has_no_width));
    let found_words = match found {
        None => "the end of the line".to_owned(),
        Some(found) if is_blank => format!("an invisible character, `{}`", found.escape_unicode()),
        Some(found) => format!("`{found}`"),
    };
    let message = match expected {
        [] => format!("unexpected {}", found_words.trim_start_matches("an ")),
        _ => format!("expected {}, found {found_words}", listed(expected)),
    };
    let diagnostic = Diagnostic::new(Code::Unexpected, span, message);
    if is_blank {
        return diagnostic.help("remove it").likely(span, "");
    }
    if let Some(help) = additions::help(found, span, expected, text) {
        return diagnostic.help(help);
    }
    if let Some(found) = found
        && let Some(mistake) = mistakes::recognise(found, span, expected, text)
    {
        return mistake;
    }
    let open = mistakes::last_open(&text[..span.start]).filter(|_| expected.contains(&"`)`"));
    match open {
        Some(start) => {
            let bracket = Span {
                start,
                end: start + 1,
                ..span
            };
            diagnostic.also(bracket, "this `(` is open")
        }
        None if expected.is_empty() && follows_value(found, span, text) => diagnostic
            .help("a sign such as `<` or a word such as `and` is missing before it, or it has to be removed"),
        None if expected.is_empty() && begins_statement(span, text) => {
            diagnostic.help(match found {
                Some("{") => "a block begins with a word: write it before the `{`, or remove the `{`",
                Some(path) if path.ends_with(".fab\"") => "write `use` before it",
                Some(word) if word.starts_with(char::is_alphabetic) => match line_begins(span, text) {
                    true => "remove it, or join it to the line above, with a word such as `and` or a comma",
                    false => "remove it, or write it on a line of its own",
                },
                _ => "a statement begins with a word: write one in its place, or remove it",
            })
        }
        None => diagnostic,
    }
}

/// Returns whether the word of a block comes directly behind its `{`, as in a line that stands there twice.
fn begins_again(block: &str, open: Span, text: &str) -> bool {
    let next = text[open.end..].trim_start();
    let behind = next.strip_prefix(block);
    behind.is_some_and(|rest| {
        !rest.starts_with(|letter: char| letter.is_alphanumeric() || letter == '_')
    })
}

/// Returns the place of a word if it comes next on the line.
fn word_after(text: &str, span: Span, word: &str) -> Option<Span> {
    let rest = &text[span.end..];
    let start = span.end + (rest.len() - rest.trim_start_matches([' ', '\t']).len());
    let end = start + word.len();
    (text.get(start..end)? == word).then_some(Span { start, end, ..span })
}

/// Returns whether a character takes no room, so that nobody sees it.
fn has_no_width(character: char) -> bool {
    matches!(
        character,
        '\u{ad}' | '\u{200b}'..='\u{200d}' | '\u{2060}' | '\u{feff}'
    )
}

/// Returns whether a token stands at the beginning of a line, or behind a brace.
fn begins_statement(span: Span, text: &str) -> bool {
    let before = text[..span.start].trim_end_matches([' ', '\t']);
    before.is_empty() || before.ends_with(['\n', '{', '}'])
}

/// Returns whether a token is the first of its line.
fn line_begins(span: Span, text: &str) -> bool {
    let before = text[..span.start].trim_end_matches([' ', '\t']);
    before.is_empty() || before.ends_with('\n')
}

/// Returns whether a word or a number stands directly after another one on its line.
fn follows_value(found: Option<&str>, span: Span, text: &str) -> bool {
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
    let before = text[..span.start].trim_end_matches([' ', '\t']);
    found.is_some_and(|found| found.starts_with(is_part))
        && before.ends_with(|letter: char| is_part(letter) || letter == ')')
}

fn unknown_word(span: Span, word: &str, candidates: &[&str], block: Option<&str>) -> Diagnostic {
    let place = match block {
        Some("task") => "a task has no section".to_owned(),
        Some(block) => format!("`{block}` has no"),
        None => "a file has no".to_owned(),
    };
    let diagnostic = Diagnostic::new(Code::UnknownWord, span, format!("{place} `{word}`"));
    if let Some(help) = additions::help_for_word(word, block) {
        return diagnostic.help(help);
    }
    if let Some(meant) = nearest(word, candidates.iter().copied()) {
        return diagnostic.meant(span, meant);
    }
    let mut blocks = fab_grammar::blocks().iter();
    match blocks.find(|block| block.words().contains(&word)) {
        Some(block) if block.kind() == Kind::File => {
            diagnostic.help("it stands outside of tasks, at the beginning of the file")
        }
        Some(block) => diagnostic.help(format!("it belongs in `{}`", block.name())),
        None => diagnostic.help(format!(
            "a line here begins with {}",
            among(candidates.iter().copied())
        )),
    }
}

/// Returns the task that other languages' words after the name of a task say it builds on: `inherits folding`, `(folding)`.
fn base_of(found: &str) -> Option<&str> {
    let words = found.split(|letter: char| !(letter.is_alphanumeric() || letter == '_'));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    let (base, before) = words.split_last()?;
    let says_so = |word: &&str| {
        [
            "inherits",
            "from",
            "of",
            "is",
            "like",
            "based",
            "on",
            "derives",
            "implements",
        ]
        .contains(word)
    };
    before.iter().all(says_so).then_some(*base)
}
