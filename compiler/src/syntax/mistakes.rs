//! Common mistakes: signs and words of other programming languages, and typographic characters.

use crate::diag::{Code, Diagnostic};
use crate::lang::material::PROPERTIES;
use fab_grammar::Span;

/// Words that a name follows, and what to write if it is missing.
const NAMED: [(&str, &str); 4] = [
    (
        "component",
        "the component has no name: write `component NAME \"…\"`",
    ),
    ("const", "the constant has no name: write `const NAME = …`"),
    (
        "demos",
        "name the stage that is told them: `demos STAGE from \"…\"`",
    ),
    ("model", "write `model vision` or `model text`"),
];

/// Names of points of the cloth, which brackets follow.
const POINTS: [&str; 4] = ["corner", "middle", "point", "between"];

/// Makes the diagnostic for the text at `span` if it is a common mistake.
///
/// - `found`: the text there.
/// - `expected`: what would fit, in backticks where it is literal; may be empty.
/// - `text`: the whole file.
pub(super) fn recognise(
    found: &str,
    span: Span,
    expected: &[&str],
    text: &str,
) -> Option<Diagnostic> {
    let expects = |words: &str| expected.contains(&words);
    let rest = &text[span.start..];
    let before = text[..span.start].trim_end();
    let usual = || {
        let message = match expected {
            [] => format!("unexpected `{found}`"),
            _ => format!("expected {}, found `{found}`", listed(expected)),
        };
        Diagnostic::new(Code::Unexpected, span, message)
    };
    // The sign may be longer than the text found.
    let sign = |sign: &str| Span {
        end: span.start + sign.len(),
        ..span
    };
    let fault = |span: Span, message: String| Diagnostic::new(Code::Unexpected, span, message);
    let written = |wrong: &str, right: &str| {
        fault(
            sign(wrong),
            format!("`{wrong}` is written `{}` here", right.trim()),
        )
        .help(format!("write `{}`", right.trim()))
        .edit(sign(wrong), right)
    };
    // A word needs blanks where its sign needs none: `near&&far`, `!near`.
    let word = |wrong: &str, right: &str| {
        let blank = |beside: Option<char>, bracket: &str| match beside {
            Some(it) if !it.is_whitespace() && !bracket.contains(it) => " ",
            _ => "",
        };
        let before = blank(text[..span.start].chars().next_back(), "({");
        let after = blank(rest[wrong.len()..].chars().next(), ")}");
        written(wrong, &format!("{before}{right}{after}"))
    };
    for (wrong, right) in [("&&", "and"), ("||", "or")] {
        if rest.starts_with(wrong) {
            return Some(word(wrong, right));
        }
    }
    if rest.starts_with("//") {
        return Some(written("//", "#"));
    }
    let is_word = |first: char| first.is_alphanumeric() || first == '_';
    let named = last_word(before).filter(|_| expects("a name"));
    // `cloth grid const(55, 55)`
    if let Some((start, word)) = named
        && found == "("
        && fab_grammar::is_keyword(word)
        && last_word(before[..start].trim_end()).is_some_and(|(_, it)| !fab_grammar::is_keyword(it))
    {
        let span = Span {
            start,
            end: start + word.len(),
            ..span
        };
        return Some(fault(span, format!("unexpected `{word}`")).help("remove it"));
    }
    let mut rows = NAMED.iter();
    if let Some((_, help)) = named.and_then(|(_, word)| rows.find(|(row, _)| *row == word))
        && (!found.starts_with(is_word) || fab_grammar::is_keyword(found))
        && !found.starts_with(['{', '}'])
    {
        let behind = rest[found.len()..].trim_start_matches(' ');
        // `const ) near = 10px`
        let is_named =
            behind.starts_with(is_word) && !found.starts_with(is_word) && !found.starts_with('"');
        return Some(match is_named {
            _ if found == "override" && before.ends_with("component") => {
                usual().help("write `override` before `component`")
            }
            true => usual().help("remove it"),
            false => usual().help(*help),
        });
    }
    if let Some(diagnostic) = comma_missing(found, span, expected, text) {
        return Some(diagnostic);
    }
    Some(match found {
        ":" if expects("`=`") && rest.starts_with(":=") => written(":=", "="),
        ":" if expects("an argument") && let Some((start, label)) = argument_without_comma(before) => {
            let end = before[..start].trim_end().len();
            let word = Span {
                start,
                end: start + label.len(),
                ..span
            };
            let message = format!("expected `,`, found `{label}`");
            let gap = Span {
                start: end,
                end,
                ..span
            };
            Diagnostic::new(Code::Unexpected, word, message)
                .help("write `,` before it")
                .likely(gap, ",")
        }
        ":" if expects("an argument")
            && text[..span.start].ends_with(',')
            && let Some((start, name)) = last_word(before[..before.len() - 1].trim_end())
            && before[..start].trim_end().ends_with([',', '(']) =>
        {
            usual().help(format!("remove the `,` behind `{name}`"))
        }
        ":" if expects("an argument") && before.ends_with(',') => {
            usual().help("write the argument's name before the `:`, or remove the `:`")
        }
        ":" if rest.starts_with(":=") && !expected.is_empty() => {
            let message = format!("expected {}, found `:=`", listed(expected));
            fault(sign(":="), message)
                .help("remove the `:=`")
                .likely(sign(":="), "")
        }
        ":" if expected.is_empty() && let Some((comma, name)) = field_after_comma(before) => {
            let comma = Span {
                start: comma,
                end: comma + 1,
                ..span
            };
            usual()
                .help(format!("remove the `,` before `{name}`: fields have no comma between them"))
                .likely(comma, "")
        }
        "skip" if expects("`without`") => {
            usual().help("write `else skip`; `then without NAME, else skip` leaves out a check first")
        }
        "=" if expects("`:`") => usual().help("write `:`").edit(span, ":"),
        ":" if expects("`=`") => usual().help("write `=`").edit(span, "="),
        "=" if expects("`)`") && before.ends_with('(') => usual().help("remove it"),
        "=" if expects("`)`") => usual()
            .help("an argument's name is followed by `:`")
            .edit(span, ":"),
        "→" | "=>" | "–>" | "—>" | "⇒" | "to" if expects("`->`") => {
            usual().help("write `->`").edit(span, "->")
        }
        "!" if !rest.starts_with("!=") => word("!", "not"),
        "&" => word("&", "and"),
        "|" => word("|", "or"),
        ":" if expects("`{`") => {
            usual().help("a block is between braces: write `{` here, and `}` where it ends")
        }
        "[" | "(" if expects("`{`") => usual().help("write `{`").likely(span, "{"),
        "=" if is_in_condition(before) => fault(span, "`=` is not a comparison".to_owned())
            .help("write `<`, `<=`, `>` or `>=`; words and counts may also be compared with `==`"),
        "=" if is_in_goal(before) => fault(span, "`=` is not a comparison".to_owned())
            .help("write `<` or `<=` for a measure that falls as the cloth is folded, `>` or `>=` for one that grows"),
        "<" | "<=" | ">" | ">=" | "==" if expected.is_empty() && text[..span.start].trim_end_matches([' ', '\t']).ends_with(|it: char| is_word(it) || it == ')') => fault(
            span,
            format!("a comparison has two sides, and `{found}` begins a third"),
        )
        .help("write two comparisons joined by `and`"),
        ";" => fault(span, "`;` is not part of the language".to_owned())
            .help("remove it: a statement ends with its line, and parts of a list have `,` between them")
            .edit(span, ""),
        "/" if rest.starts_with("/*") => {
            fault(sign("/*"), "`/*` does not begin a comment".to_owned())
                .help("a comment begins with `#` and ends with its line")
        }
        "True" | "False" | "None" | "true" | "false" | "none" if expected.is_empty() => {
            fault(span, format!("expected a condition, found `{found}`"))
                .help("a condition compares values; remove it if it always holds")
        }
        "." if rest[1..].starts_with(|next: char| next.is_ascii_digit())
            && last_word(&text[..span.start]).is_some() =>
        {
            return None;
        }
        "." if rest[1..].starts_with(|next: char| next.is_ascii_digit())
            && text[..span.start].ends_with(|last: char| last.is_ascii_digit()) =>
        {
            fault(span, "a number has one decimal point".to_owned())
                .help("remove one of its points")
        }
        "." if rest[1..].starts_with(|next: char| next.is_ascii_digit()) => {
            fault(span, "a number begins with a digit".to_owned())
                .help("write `0` before the point")
                .edit(
                    Span {
                        end: span.start,
                        ..span
                    },
                    "0",
                )
        }
        "," if is_decimal_comma(before, &rest[1..]) => {
            let usual = fault(
                span,
                "the decimal separator is a point, not a comma".to_owned(),
            );
            match thousands(before, &rest[1..]) {
                Some((whole, group)) => usual.help(format!(
                    "write `{whole}{group}`, since digits are not grouped, or `{whole}.{group}` if that was meant"
                )),
                None => usual.help("write `.`").likely(span, "."),
            }
        }
        _ if found.starts_with('_')
            && found[1..].starts_with(|next: char| next.is_ascii_digit())
            && text[..span.start].ends_with(|last: char| last.is_ascii_digit()) =>
        {
            fault(span, "a number is written without `_`".to_owned())
                .help(format!("write `{}{}`", last_number(before), &found[1..]))
                .edit(span, &found[1..])
        }
        _ if found.starts_with('_') && text[..span.start].ends_with(is_word) => {
            let whole = &text[before.trim_end_matches(is_word).len()..span.end];
            let start = span.end - whole.len();
            fault(Span { start, ..span }, format!("`{whole}` is not a number with a unit"))
                .help("a unit has letters alone, such as `10px`; a name begins with a letter")
        }
        _ if found.starts_with(|first: char| first.is_ascii_digit() || "+-".contains(first))
            && text[..span.start].ends_with(['e', 'E'])
            && text[..span.start - 1].ends_with(|last: char| last.is_ascii_digit()) =>
        {
            fault(span, "a number has no exponent".to_owned()).help("write all of its digits")
        }
        _ if found.starts_with('"') && before.ends_with('}') && line_of(before).trim() == "}" && text[..span.start].ends_with(' ') => {
            fault(span, "expected `else`, found a text".to_owned())
                .help("write `else` before it: the message of a check is behind `else`")
                .likely(Span { end: span.start, ..span }, "else ")
        }
        _ if rest.starts_with("\"\"\"") && line_of(&text[..span.start]).trim().is_empty() && !before.ends_with([',', '=']) => {
            fault(sign("\"\"\""), "expected a word, found a text".to_owned())
                .help("write before it whose text it is, such as `say` or `reply`")
        }
        _ if rest.starts_with("\"\"\"") => fault(
            sign("\"\"\""),
            "a text of several lines is not allowed here".to_owned(),
        )
        .help("write one line between `\"` and `\"`"),
        _ if before.ends_with("expect reject") && found.starts_with(char::is_alphabetic) => {
            fault(span, format!("expected `(`, found `{found}`"))
                .help(format!("write `expect reject({found})`"))
        }
        "," if expected.is_empty() && closes_behind(rest) => usual()
            .help("the `)` behind it closes nothing: write the `(` in front of the first value"),
        ")" if last_open(before).is_none() && line_of(before).contains("()") => {
            fault(span, "this `)` closes nothing".to_owned())
                .help("the `()` before it is closed too early: write the values between its brackets")
        }
        ")" if last_open(before).is_none() && line_of(&text[..span.start]).trim().is_empty() => {
            fault(span, "this `)` closes nothing".to_owned())
                .help("a line begins with a word: write one in its place, or remove it")
        }
        ")" if last_open(before).is_none() => fault(span, "this `)` closes nothing".to_owned())
            .help("write the `(` that it closes, or remove it"),
        "}" if before.ends_with(',') && let Some(open) = last_open(before) => usual()
            .help("remove it, or close the `(` first")
            .also(
                Span {
                    start: open,
                    end: open + 1,
                    ..span
                },
                "this `(` is open",
            ),
        "}" | ")" if before.ends_with(',') => usual().help("remove the comma before it"),
        _ if (expects("`->`") || expects("`at`"))
            && let Some((_, word)) = last_word(before)
            && POINTS.contains(&word) =>
        {
            let help = match rest[found.len()..].starts_with('(') {
                true => format!("remove it: `{word}` is followed by `(`"),
                false => format!("`{word}` is followed by `(`"),
            };
            usual().help(help)
        }
        "," if expects("`)`") && rest[1..].trim_start().starts_with(')') => {
            usual().help("remove the comma").likely(span, "")
        }
        _ if expects("a name")
            && found.starts_with(|first: char| first.is_ascii_digit())
            && text[..span.start].ends_with(',')
            && before[..before.len() - 1].ends_with(|last: char| last.is_ascii_digit()) =>
        {
            let comma = Span {
                start: span.start - 1,
                end: span.start,
                ..span
            };
            fault(
                comma,
                "the decimal separator is a point, not a comma".to_owned(),
            )
            .help("write `.`")
            .likely(comma, ".")
        }
        _ if expects("`)`")
            && found.starts_with(|first: char| first.is_ascii_digit())
            && last_word(before).is_some_and(|(_, word)| word == "depth") =>
        {
            usual().help(format!("write `<` or `>` between them: `depth < {found}`"))
        }
        _ if expects("`)`")
            && found.starts_with(|first: char| first.is_ascii_digit())
            && last_word(before).is_some_and(|(_, word)| !fab_grammar::is_keyword(word)) =>
        {
            let end = Span {
                start: before.len(),
                end: before.len(),
                ..span
            };
            usual()
                .help("an argument's name is followed by `:`")
                .likely(end, ":")
        }
        _ if expects("`)`")
            && expects("`,`")
            && found.starts_with(is_word)
            && !fab_grammar::is_keyword(found)
            && before.ends_with(|last: char| is_word(last) || last == ')') =>
        {
            let end = Span {
                start: before.len(),
                end: before.len(),
                ..span
            };
            // `ring(last.place, mirror middle(…))`
            let may_be_extra = rest[found.len()..].starts_with('(')
                && last_word(before).is_some();
            match may_be_extra {
                true => usual().help("remove one of the two words, or write `,` between them"),
                false => usual().help("write `,` before it").likely(end, ","),
            }
        }
        _ if expects("a value")
            && rest[found.len()..].starts_with(':')
            && last_open(before).is_some() =>
        {
            usual().help("an argument with a name belongs to a call: the call's name is missing before the `(`")
        }
        // `cloth (33, 33, material: cotton)`
        _ if expected == ["`)`"] && found == "," && last_open(before).is_some_and(|at| text[..at].ends_with(' ')) => {
            usual().help("a name is missing before the `(`, such as `grid`")
        }
        _ if expects("`of`") && matches!(found, "from" | "to" | "off" | "at" | "in" | "on") => {
            usual().meant(span, "of")
        }
        _ if expects("`=`") && before.ends_with("given last") => {
            let gap = Span {
                start: before.len(),
                end: span.start,
                ..span
            };
            usual()
                .help(format!("write `given last.{found}`"))
                .likely(gap, ".")
        }
        _ if expects("a condition") && before.ends_with("when") => {
            usual().help("write `when` and a condition, such as `when step > 1`, or remove `when`")
        }
        _ if found.starts_with('"') && is_behind_check(before) && (expected.is_empty() || expects("`else`")) => {
            fault(span, format!("expected `else`, found `{found}`"))
                .help("write `else` before it")
                .likely(
                    Span {
                        end: span.start,
                        ..span
                    },
                    "else ",
                )
        }
        // `const near far = 10px`
        _ if expected == ["`=`"]
            && found.starts_with(|it: char| it.is_alphabetic())
            && rest[found.len()..].trim_start().starts_with('=') =>
        {
            usual().help("remove one of the two names")
        }
        _ if expected == ["`=`"] && found.starts_with(|first: char| is_word(first) || "\"-".contains(first)) => {
            let start = Span {
                end: span.start,
                ..span
            };
            usual().help("write `=` before it").likely(start, "= ")
        }
        _ if found.starts_with(is_word) && last_word(before).is_some_and(|(_, word)| word == "use") => {
            let path = rest.split_whitespace().next().unwrap_or(found);
            let whole = sign(path);
            usual()
                .help(format!("write `use \"{path}\"`"))
                .likely(whole, format!("\"{path}\""))
        }
        _ if expected == ["`most`"] => usual()
            .help("write `most`: the answer with the highest measure is taken"),
        "<" | "<=" | "=" | "==" | ":" if before.ends_with("trust overlap") => {
            fault(sign(found), format!("expected `>`, found `{found}`"))
                .help("write `>`: twins are trusted above the stated overlap")
        }
        "=" if before.ends_with("trust overlap >") => usual()
            .help("remove it: twins are trusted above the stated overlap")
            .likely(span, ""),
        "skip" if expects("`refuse`") => usual()
            .help("write `else refuse`, or leave it out: then the step is taken without rehearsal"),
        "subgoals" if rest.starts_with("subgoals(") => usual().meant(span, "subgoal"),
        "actions" if before.ends_with("read") => usual().meant(span, "action"),
        "“" | "”" | "'" | "‘" | "’" => usual().help("write straight double quotes `\"`"),
        "]" if last_open(before).is_some() => usual().help("write `)`").likely(span, ")"),
        "[" | "]" => {
            usual().help("lists have no brackets; write the parts with commas between them")
        }
        _ if fab_grammar::is_keyword(found) && expected == ["a name"] => usual().help(format!(
            "`{found}` is a word of the language; {}",
            match before.ends_with(',') {
                true => "choose another name, or remove the comma before it",
                false => "choose another name",
            }
        )),
        _ => return None,
    })
}

/// Returns the place of the last `(` on this line that is still open; brackets in texts do not count.
pub(super) fn last_open(before: &str) -> Option<usize> {
    let start = before.rfind('\n').map_or(0, |line_break| line_break + 1);
    let mut open = Vec::new();
    let mut is_text = false;
    for (at, letter) in before[start..].char_indices() {
        match letter {
            '"' => is_text = !is_text,
            '(' if !is_text => open.push(start + at),
            ')' if !is_text => drop(open.pop()),
            _ => {}
        }
    }
    open.pop()
}

/// Returns the last line of a text.
fn line_of(before: &str) -> &str {
    before.rsplit('\n').next().unwrap_or(before)
}

/// Returns whether the rest of a line has a `)` whose `(` is missing.
fn closes_behind(rest: &str) -> bool {
    let line = rest.split(['\n', '#']).next().unwrap_or(rest);
    let mut depth = 0;
    line.chars().any(|letter| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth < 0
    })
}

/// Returns the place of a comma in `actions` that only a name follows, and the name.
fn field_after_comma(before: &str) -> Option<(usize, &str)> {
    let (start, name) = last_word(before)?;
    let list = before[..start].trim_end();
    let line = list.rsplit(['{', '}']).next().unwrap_or(list);
    let is_list = list.ends_with(',') && line.contains(" of ");
    is_list.then(|| (list.len() - 1, name))
}

/// Returns the name at the end of a line that an argument stands before, without a comma between them.
fn argument_without_comma(before: &str) -> Option<(usize, &str)> {
    let (start, label) = last_word(before)?;
    let line = before[..start].rsplit(['\n', '{']).next()?.trim_end();
    let is_value = line.ends_with(|last: char| last.is_alphanumeric() || last == ')');
    let is_property = PROPERTIES
        .iter()
        .any(|row| row.call.signature.name == label);
    (is_value && line.contains(':') && !is_property).then_some((start, label))
}

/// Returns whether a check ends here, on this line.
fn is_behind_check(before: &str) -> bool {
    let line = before.rsplit('\n').next().unwrap_or(before);
    before.ends_with('}') && line.split_whitespace().any(|word| word == "check")
}

/// Returns whether a position is in a condition on the same line: in a check's braces, or behind `when`.
fn is_in_condition(before: &str) -> bool {
    let line = before.rsplit('\n').next().unwrap_or(before);
    line.trim_start().starts_with("check ") && line.contains('{') || line.contains(" when ")
}

/// Returns whether a position is in a goal on the same line.
fn is_in_goal(before: &str) -> bool {
    let line = before.rsplit(['\n', '{', '}']).next().unwrap_or(before);
    line.trim_start().starts_with("goal ")
}

/// Makes the diagnostic for parts of a list without a comma between them.
fn comma_missing(found: &str, span: Span, expected: &[&str], text: &str) -> Option<Diagnostic> {
    if expected != ["`,`"] {
        return None;
    }
    let message = |found: &str| format!("expected `,`, found `{found}`");
    let before = text[..span.start].trim_end();
    if matches!(found, "and" | "&" | "+" | ";" | "|") {
        let diagnostic = Diagnostic::new(Code::Unexpected, span, message(found));
        return Some(diagnostic.help("write `,`").likely(span, ","));
    }
    let is_word = |first: char| first.is_alphanumeric() || first == '_' || first == '"';
    if !found.starts_with(is_word) {
        return None;
    }
    // `model text temperature 0`: the word before the number was read as a value.
    let (start, found) = match last_word(before) {
        Some((start, word)) if found.starts_with(|first: char| first.is_ascii_digit()) => {
            (start, word)
        }
        _ => (span.start, found),
    };
    let end = text[..start].trim_end().len();
    let word = Span {
        start,
        end: start + found.len(),
        ..span
    };
    let gap = Span {
        start: end,
        end,
        ..span
    };
    let diagnostic = Diagnostic::new(Code::Unexpected, word, message(found));
    Some(diagnostic.help("write `,` before it").likely(gap, ","))
}

/// Returns the word at the end of a text, and where it begins; `None` if there is a number or a sign.
fn last_word(before: &str) -> Option<(usize, &str)> {
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let word = &before[before.trim_end_matches(is_part).len()..];
    let is_word = word.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_');
    is_word.then(|| (before.len() - word.len(), word))
}

/// Returns the digits at the end of a text.
fn last_number(before: &str) -> &str {
    &before[before
        .trim_end_matches(|last: char| last.is_ascii_digit())
        .len()..]
}

/// Returns whether a comma is between two digits of a number.
fn is_decimal_comma(before: &str, after: &str) -> bool {
    let is_digit = |character: char| character.is_ascii_digit();
    before.ends_with(is_digit) && after.starts_with(is_digit)
}

/// Returns the digits beside a comma that may separate thousands: at most three before it, three after it.
fn thousands<'t>(before: &'t str, after: &'t str) -> Option<(&'t str, &'t str)> {
    let digit = |character: char| character.is_ascii_digit();
    let whole = &before[before.trim_end_matches(digit).len()..];
    let group = &after[..after.len() - after.trim_start_matches(digit).len()];
    (whole.len() <= 3 && group.len() == 3).then_some((whole, group))
}

/// Joins expectations, which have their own backticks.
pub(super) fn listed(expected: &[&str]) -> String {
    match expected {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => expected.concat(),
    }
}
