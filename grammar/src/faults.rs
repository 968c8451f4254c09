//! Finds out what is wrong with the junk in a tree.
//!
//! In: the tree. Out: [`Fault`]s in source order. Each piece of junk is parsed again by the strict rule for its
//! place, which gives the exact position and what was expected there. One line gives one fault, and a line of junk
//! directly after another none, unless it looks like a new statement. Nothing is reported behind a brace or a quote
//! without a partner: nobody knows which line belongs to which block there.

use crate::fault::{Fault, Problem};
use crate::measure::{is_word, measure, token_at, unexpected};
use crate::rules::Rule;
use crate::source::Span;
use crate::tree::{Kind, Node, Tree};
use crate::vocabulary::{block, words};
use std::ops::Range;

/// Returns the faults of a tree, in source order.
pub(crate) fn collect(tree: &Tree) -> Vec<Fault> {
    let mut all = Vec::new();
    for parent in tree.nodes() {
        let mut previous: Option<Node<'_>> = None;
        for child in parent.children().filter(|child| !child.kind().is_trivia()) {
            all.extend(judge(parent, previous, child));
            previous = Some(child);
        }
        all.extend(missing_condition(parent));
    }
    all.sort_by_key(|fault| fault.span);
    let is_same_line = |one: &Fault, next: &Fault| {
        let between = &tree.text()[one.span.start..next.span.start];
        !between.contains(['\n', '\r'])
    };
    let lines = all.chunk_by(is_same_line);
    let mut faults: Vec<Fault> = lines.flat_map(|on_line| of_line(tree, on_line)).collect();
    drop_consequences(tree, &mut faults);
    faults
}

/// Drops what follows from a brace or a quote without a partner.
fn drop_consequences(tree: &Tree, faults: &mut Vec<Fault>) {
    let has_half_text = tree.text().matches("\"\"\"").count() % 2 == 1;
    let is_tear = |fault: &Fault| is_tear(tree, fault, has_half_text);
    let is_missing_close = |fault: &Fault| matches!(fault.problem, Problem::MissingClose { .. });
    // A text without an end has taken the `}`, or a block without `{`.
    let takes_close = |fault: &Fault| match fault.problem {
        Problem::UnclosedString | Problem::UnopenedString | Problem::UnclosedText => is_tear(fault),
        Problem::MissingOpen { .. } => true,
        _ => false,
    };
    if faults.iter().any(takes_close) {
        faults.retain(|fault| !is_missing_close(fault));
    }
    if let Some(first) = faults.iter().position(is_missing_close)
        && let Some(inside) = section_inside(tree, faults[first].span)
    {
        faults.truncate(first);
        faults.push(inside);
    }
    // `experts NAME` is a section of a task, too.
    let is_of_experts = |fault: &Fault| matches!(&fault.problem, Problem::MissingOpen { block } if block == "experts");
    if let Some(fault) = faults.iter_mut().find(|fault| is_of_experts(fault))
        && closed_early(tree, fault.span.start).is_some()
        && let Some(start) = tree.text()[..fault.span.start].rfind("experts")
    {
        let word = "experts".to_owned();
        fault.span = tree.span(start..start + word.len());
        fault.problem = Problem::OutsideTask { word, early: None };
    }
    if let Some(tear) = faults.iter().position(is_tear) {
        let further = faults.split_off(tear + 1);
        let found = closed_early(tree, faults[tear].span.start);
        if let Problem::StrayClose { early } | Problem::OutsideTask { early, .. } =
            &mut faults[tear].problem
        {
            *early = found;
        }
        faults.extend(further.into_iter().filter(is_local));
    }
}

/// Reports the section that ends an unclosed block, if its own `}` is too many: it stands inside of the block.
fn section_inside(tree: &Tree, open: Span) -> Option<Fault> {
    let closes_more = |node: Node<'_>| {
        let text = node.text();
        node.kind() == Kind::Stray && text.matches('}').count() > text.matches('{').count()
    };
    let block = tree.node_at(open.start).parent()?;
    let end = block.range().end;
    let start = end + (tree.text()[end..].len() - tree.text()[end..].trim_start().len());
    let word = token_at(tree.text(), start..tree.text().len());
    let is_section = words(Kind::Task).contains(&word) && tree.nodes().any(closes_more);
    is_section.then(|| Fault {
        span: tree.span(start..start + word.len()),
        problem: Problem::UnknownWord {
            word: word.to_owned(),
            candidates: words(block.kind()),
            words: Vec::new(),
            block: Some(block_word(block)),
        },
    })
}

/// Returns the range of the line of a byte.
fn line_at(text: &str, byte: usize) -> Range<usize> {
    let start = text[..byte].rfind(['\n', '\r']).map_or(0, |at| at + 1);
    let length = text[byte..].find(['\n', '\r']);
    start..length.map_or(text.len(), |length| byte + length)
}

/// Returns which faults of one line are reported: the first, and those that depend on nothing else.
fn of_line(tree: &Tree, faults: &[Fault]) -> Vec<Fault> {
    if !faults.iter().any(is_local)
        && let Some(quote) = unpaired_quote(tree, faults[0].span)
    {
        return vec![quote];
    }
    let first = faults.iter().position(|fault| !is_local(fault));
    let kept = { faults.iter().enumerate() }
        .filter(|(index, fault)| is_local(fault) || Some(*index) == first);
    kept.map(|(_, fault)| fault.clone()).collect()
}

/// Returns whether a fault has neither a cause nor a consequence elsewhere.
fn is_local(fault: &Fault) -> bool {
    matches!(
        fault.problem,
        Problem::WrongQuotes { .. } | Problem::BadEscape
    )
}

/// Returns whether lines after a fault are in the wrong block.
///
/// - `has_half_text`: whether the file has an odd number of triple quotes.
fn is_tear(tree: &Tree, fault: &Fault, has_half_text: bool) -> bool {
    match &fault.problem {
        Problem::MissingClose { .. }
        | Problem::StrayClose { .. }
        | Problem::OutsideTask { .. }
        | Problem::UnclosedText => true,
        // The text has taken a brace of its line.
        Problem::UnclosedString | Problem::UnopenedString => {
            let text = &tree.text()[fault.span.start..line_at(tree.text(), fault.span.start).end];
            let text = text.replace("{{", "").replace("}}", "");
            text.contains(['{', '}'])
        }
        // The end of a text whose beginning is missing begins another one.
        Problem::Unexpected { expected, .. } => {
            has_half_text && expected.contains(&"a text in quotes")
        }
        _ => false,
    }
}

/// Finds the text that lacks one of its two quotes, on a line with an odd number of them.
///
/// - `fault`: the first place of the line that does not parse.
fn unpaired_quote(tree: &Tree, fault: Span) -> Option<Fault> {
    let line = line_at(tree.text(), fault.start);
    let text = &tree.text()[line.clone()];
    let leaf = tree.node_at(line.start);
    if text.contains("\"\"\"")
        || leaf
            .ancestors()
            .any(|outer| outer.kind() == Kind::BlockText)
    {
        return None;
    }
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
    let unclosed = |start: usize| Fault {
        span: tree.span(start..line.start + text.trim_end().len()),
        problem: Problem::UnclosedString,
    };
    let quotes = quotes(text);
    if quotes.len().is_multiple_of(2) {
        return None;
    }
    for pair in quotes.chunks(2) {
        let opening = pair[0];
        // A closing quote touches its text.
        if text[..opening].ends_with(|last: char| is_part(last) || ".!?".contains(last)) {
            let word = line.start + text[..opening].trim_end_matches(is_part).len();
            return Some(Fault {
                span: tree.span(fault.start.min(word)..line.start + opening + 1),
                problem: Problem::UnopenedString,
            });
        }
        let begins_text =
            |at: usize| text[at + 1..].starts_with(|next| is_part(next) || next == '{');
        if pair.get(1).is_none_or(|closing| begins_text(*closing)) {
            return Some(unclosed(line.start + opening));
        }
    }
    None
}

/// Returns the places of the quotes of a line, without escaped ones and those in its comment.
fn quotes(line: &str) -> Vec<usize> {
    let mut quotes = Vec::new();
    let mut letters = line.char_indices();
    while let Some((at, letter)) = letters.next() {
        let is_text = quotes.len() % 2 == 1;
        match letter {
            '"' => quotes.push(at),
            '\\' if is_text => drop(letters.next()),
            '#' if !is_text => break,
            _ => {}
        }
    }
    quotes
}

fn judge(parent: Node<'_>, previous: Option<Node<'_>>, node: Node<'_>) -> Option<Fault> {
    let tree = node.tree();
    let span = trimmed(node);
    let first = |bytes: usize, span: Span| Span {
        end: span.start + bytes,
        ..span
    };
    let (span, problem) = match node.kind() {
        Kind::NoOpen => return missing_open(parent, previous?),
        Kind::NoClose => return missing_close(parent),
        Kind::NoQuote => (parent.span(), Problem::UnclosedString),
        Kind::NoTriple => (first(3, parent.span()), Problem::UnclosedText),
        Kind::NoName => return missing_name(parent),
        Kind::Surplus if parent.child(Kind::NoName).is_none() => {
            let found = node.text().trim().to_owned();
            (span, Problem::Surplus { found })
        }
        Kind::CurlyText => (node.span(), wrong_quotes(node, "\"\"\"")),
        Kind::CurlyString | Kind::SingleString => (node.span(), wrong_quotes(node, "\"")),
        Kind::BadEscape => (node.span(), Problem::BadEscape),
        // A placeholder must be on one line, so texts keep their lines.
        Kind::Placeholder if node.text().contains(['\n', '\r']) => {
            (first(2, node.span()), Problem::LoneBraces)
        }
        Kind::NoCondition => {
            let rest = tree.span(node.range().start..tree.text().len());
            return Some(unexpected(tree, rest, vec!["a condition"]));
        }
        Kind::LoneBraces => {
            let inside = wrong_in_placeholder(node);
            return inside.or(Some(Fault {
                span: node.span(),
                problem: Problem::LoneBraces,
            }));
        }
        Kind::Stray => return Some(stray(node)),
        Kind::Junk | Kind::JunkSection => return junk(parent, previous, node),
        Kind::JunkCondition | Kind::JunkGuard => {
            let measured = measure(tree, Rule::only_expr, span);
            return measured.or_else(|| Some(unexpected(tree, span, Vec::new())));
        }
        _ => return None,
    };
    Some(Fault { span, problem })
}

/// Reports a block without `{`, at the end of its head or at another sign that stands there instead.
fn missing_open(block: Node<'_>, head: Node<'_>) -> Option<Fault> {
    if head.child(Kind::NoName).is_some() {
        return None;
    }
    let tree = block.tree();
    let end = trimmed(head).end;
    let behind = tree.text()[end..].trim_start();
    if behind.starts_with(['[', '(', ':']) {
        let next = tree.text().len() - behind.len();
        return Some(unexpected(tree, tree.span(next..next + 1), vec!["`{`"]));
    }
    let block = block_word(block);
    Some(Fault {
        span: tree.span(end..end),
        problem: Problem::MissingOpen { block },
    })
}

/// Reports a block without `}`; if the indentation shows that an inner one took it, the inner one.
fn missing_close(block: Node<'_>) -> Option<Fault> {
    let innermost =
        std::iter::successors(Some(block), |outer| inner_with_close_of(*outer)).last()?;
    Some(Fault {
        span: innermost.child(Kind::Open)?.span(),
        problem: Problem::MissingClose {
            block: block_word(innermost),
        },
    })
}

/// Returns the block that ends where the indentation shows the end of the block around it.
fn inner_with_close_of(outer: Node<'_>) -> Option<Node<'_>> {
    let text = outer.tree().text();
    let (outer_margin, _) = margin(text, outer.child(Kind::Open)?.range().start);
    let mut inner = outer.children();
    inner.find(|block| {
        let (Some(open), Some(close)) = (block.child(Kind::Open), block.child(Kind::Close)) else {
            return false;
        };
        margin(text, open.range().start).0 > outer_margin
            && margin(text, close.range().start) == (outer_margin, true)
    })
}

/// Returns the first `}` before a byte that stands further in than the line of its `{`.
fn closed_early(tree: &Tree, byte: usize) -> Option<Span> {
    let text = tree.text();
    let ends = { tree.nodes() }.filter_map(|block| {
        let (open, close) = (block.child(Kind::Open)?, block.child(Kind::Close)?);
        let (indent, begins_line) = margin(text, close.range().start);
        let is_early = begins_line && indent > margin(text, open.range().start).0;
        (is_early && close.range().start < byte).then(|| close.span())
    });
    ends.min()
}

/// Returns how far in the line of a byte begins, and whether the line begins there.
fn margin(text: &str, at: usize) -> (usize, bool) {
    // Many blocks may be on one long line.
    const MOST: usize = 256;
    let near = &text[text.floor_char_boundary(at.saturating_sub(MOST))..at];
    let before = near.rsplit('\n').next().unwrap_or(near);
    let words = before.trim_start();
    (before.len() - words.len(), words.is_empty())
}

/// Reports a head without a name.
fn missing_name(head: Node<'_>) -> Option<Fault> {
    let word = head.children().next()?;
    let end = word.range().end;
    let behind = head.tree().span(end..end);
    Some(Fault {
        span: head.child(Kind::Surplus).map_or(behind, trimmed),
        problem: Problem::MissingName {
            after: word.text().to_owned(),
        },
    })
}

/// Reports a check without a condition.
fn missing_condition(node: Node<'_>) -> Option<Fault> {
    let has = |kind| node.child(kind).is_some();
    if node.kind() != Kind::Check || !has(Kind::Open) || has(Kind::Expr) || has(Kind::JunkCondition)
    {
        return None;
    }
    let close = node.child(Kind::Close)?.span();
    Some(unexpected(node.tree(), close, vec!["a condition"]))
}

/// Finds what is wrong between the two braces of a placeholder and their `}}` on the same line, if it is in a call or
/// before a word.
fn wrong_in_placeholder(braces: Node<'_>) -> Option<Fault> {
    let (tree, start) = (braces.tree(), braces.range().end);
    let line = tree.text()[start..].split(['\n', '\r', '{']).next()?;
    let piece = tree.span(start..start + line.find("}}")?);
    let fault = measure(tree, Rule::only_expr, piece)?;
    let is_open = tree.text()[start..fault.span.start].contains('(');
    (is_open || is_word(&tree.text()[fault.span.range()])).then_some(fault)
}

/// Returns the keyword of a block.
fn block_word(block: Node<'_>) -> String {
    let head = block.children().next().map_or("", Node::text);
    let word = head.split_whitespace().next();
    word.unwrap_or_default().to_owned()
}

fn stray(node: Node<'_>) -> Fault {
    let tree = node.tree();
    let span = trimmed(node);
    let first = token_at(tree.text(), span.range());
    let items = words(Kind::File);
    let problem = if first.starts_with('}') {
        Problem::StrayClose { early: None }
    } else if words(Kind::Task).contains(&first) && !items.contains(&first) {
        let word = first.to_owned();
        Problem::OutsideTask { word, early: None }
    } else {
        let line = tree.span(span.start..line_at(tree.text(), span.start).end);
        if items.contains(&first)
            && let Some(fault) = measure(tree, Rule::only_item, line)
        {
            return fault;
        }
        if !is_word(first) {
            return unexpected(tree, span, Vec::new());
        }
        Problem::UnknownWord {
            word: first.to_owned(),
            candidates: items,
            words: Vec::new(),
            block: None,
        }
    };
    let span = tree.span(span.start..span.start + first.len());
    Fault { span, problem }
}

fn junk(parent: Node<'_>, previous: Option<Node<'_>>, node: Node<'_>) -> Option<Fault> {
    let tree = node.tree();
    let known = words(parent.kind());
    let span = trimmed(node);
    let first = token_at(tree.text(), span.range());
    let is_junk = |before: Node<'_>| matches!(before.kind(), Kind::Junk | Kind::JunkSection);
    if previous.is_some_and(is_junk) && !looks_like_statement(node, first, known) {
        return None;
    }
    // The bracket in place of `{` was reported.
    if matches!(node.text().trim(), "]" | ")") && parent.child(Kind::NoOpen).is_some() {
        return None;
    }
    if node.text().trim() == "," {
        let problem = Problem::TrailingComma;
        return Some(Fault { span, problem });
    }
    let rule = block(parent.kind())?.line;
    let before = previous.filter(|before| is_statement(before.kind()));
    // What a statement may go on with is known to its own rule.
    let joined = before.and_then(|before| {
        let whole = tree.span(before.range().start..span.end);
        measure(tree, rule, whole)
    });
    let ends_line = |before: Node<'_>| {
        let gap = &tree.text()[before.range().end..span.start];
        gap.contains(['\n', '\r'])
    };
    let unknown = |span: Span, words: Vec<&'static str>| Fault {
        span,
        problem: Problem::UnknownWord {
            word: tree.text()[span.range()].to_owned(),
            candidates: known,
            words,
            block: Some(block_word(parent)),
        },
    };
    if let Some(before) = before.filter(|before| !ends_line(*before) && !known.contains(&first)) {
        // The first word of the line was read as the end of the line before.
        let line = line_at(tree.text(), span.start).start;
        let line = span.start - tree.text()[line..span.start].trim_start().len();
        let word = token_at(tree.text(), line..span.start);
        let ends_before = before.range().start < line && line + word.len() == before.range().end;
        if ends_before && is_word(word) && !known.is_empty() {
            return Some(unknown(tree.span(line..line + word.len()), Vec::new()));
        }
        return joined.or_else(|| Some(unexpected(tree, span, Vec::new())));
    }
    if let Some(fault) = measure(tree, rule, span)
        && fault.span.start > span.start
    {
        return Some(fault);
    }
    // A word that begins a line may go on with the statement before it.
    let joined = joined.filter(|fault| fault.span.start == span.start);
    if !is_word(first) || known.is_empty() {
        let expected = known.is_empty().then_some("a name");
        let alone = unexpected(tree, span, expected.into_iter().collect());
        // If nothing is expected, the statement before is complete.
        let is_needed = |fault: &Fault| matches!(&fault.problem, Problem::Unexpected { expected, .. } if !expected.is_empty());
        return joined.filter(is_needed).or(Some(alone));
    }
    let words = match joined.map(|fault| fault.problem) {
        Some(Problem::Unexpected { words, .. }) => words,
        _ => Vec::new(),
    };
    Some(unknown(
        tree.span(span.start..span.start + first.len()),
        words,
    ))
}

/// Returns whether a line of junk looks like a new statement.
fn looks_like_statement(junk: Node<'_>, first: &str, known: &[&str]) -> bool {
    if known.is_empty() {
        let rest = junk.text().trim()[first.len()..].trim_start_matches([' ', '\t']);
        return is_word(first) && rest.starts_with([':', '=']);
    }
    // A misspelt word is recognised only if it opens a section.
    let opens_section = junk.kind() == Kind::JunkSection && junk.text().contains('{');
    known.contains(&first) || opens_section && is_word(first)
}

fn is_statement(kind: Kind) -> bool {
    let begins_block = matches!(kind, Kind::Head | Kind::Extends | Kind::Open | Kind::NoOpen);
    !begins_block && !kind.is_junk()
}

/// Returns a node's span without the blanks around it.
fn trimmed(node: Node<'_>) -> Span {
    let span = node.span();
    let start = span.end - node.text().trim_start().len();
    let end = start + node.text().trim().len();
    Span { start, end, ..span }
}

/// Writes a text with straight quotes.
fn wrong_quotes(node: Node<'_>, quotes: &str) -> Problem {
    let is_quote = |letter: char| "\"'“”„‟«»‘’".contains(letter);
    let text = node.text();
    let length = |count: usize| text.chars().take(count).map(char::len_utf8).sum::<usize>();
    let opening = length(quotes.len());
    let n_closing = text[opening..].chars().rev().take(quotes.len());
    let n_closing = n_closing.take_while(|letter| is_quote(*letter));
    let closing: usize = n_closing.map(char::len_utf8).sum();
    let right = format!("{quotes}{}{quotes}", &text[opening..text.len() - closing]);
    Problem::WrongQuotes { right }
}
