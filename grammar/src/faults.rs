//! Finds out what is wrong with the junk in a tree.
//!
//! In: the tree. Out: [`Fault`]s in source order. Each piece of junk is parsed again by the strict rule for its
//! place, which gives the exact position and what was expected there. A line of junk directly after another is not
//! reported unless it looks like a new statement, so one mistake gives one fault.

use crate::fault::{Fault, Problem};
use crate::measure::{is_word, measure, token_at, unexpected};
use crate::misspelt::{Strict, misspelt, parses_without};
use crate::rules::Rule;
use crate::source::Span;
use crate::tree::{Kind, Node, Tree};
use crate::vocabulary::{block, blocks, words};
use std::collections::BTreeSet;

/// Returns the faults of a tree, in source order, and whether its braces or triple quotes do not match.
pub(crate) fn collect(tree: &Tree) -> (Vec<Fault>, bool) {
    let mut faults = all(tree);
    let is_torn = torn(tree, &faults).is_some();
    drop_consequences(tree, &mut faults);
    let early = |fault: &&mut Fault| match &fault.problem {
        Problem::StrayClose { .. } | Problem::OutsideTask { .. } => true,
        Problem::UnknownWord { block, .. } => block.is_none(),
        // `experts NAME` is a section of a task, and `experts NAME {` stands outside of tasks.
        Problem::MissingOpen { block } => {
            let node = tree.node_at(fault.span.start.saturating_sub(1));
            let is_in_task = { node.ancestors() }.any(|outer| outer.kind() == Kind::Task);
            !is_in_task && words(Kind::Task).contains(&&**block)
        }
        _ => false,
    };
    if let Some(fault) = faults.iter_mut().find(early) {
        let found = closed_early(tree, fault.span.start);
        let word = match &fault.problem {
            Problem::UnknownWord { word, .. } => Some(word.clone()),
            Problem::MissingOpen { block } => Some(block.clone()),
            _ => None,
        };
        if let (Some(word), Some(_)) = (word, found) {
            let begin = tree.text()[..fault.span.start].rfind(&word);
            let begin = begin.filter(|_| matches!(fault.problem, Problem::MissingOpen { .. }));
            fault.span = begin.map_or(fault.span, |at| tree.span(at..at + word.len()));
            fault.problem = Problem::OutsideTask { word, early: None };
        }
        if let Problem::StrayClose { early } | Problem::OutsideTask { early, .. } =
            &mut fault.problem
        {
            *early = found;
        }
    }
    (faults, is_torn)
}

/// Returns the first `}` that stands further in than the line of its `{`, in the last item before a byte.
fn closed_early(tree: &Tree, byte: usize) -> Option<Span> {
    let text = tree.text();
    let items = tree.root().children();
    let item = { items }
        .filter(|item| item.child(Kind::Open).is_some() && item.range().start < byte)
        .last()?;
    let blocks = tree.nodes().filter(|block| {
        item.range().start <= block.range().start && block.range().end <= item.range().end
    });
    let early = blocks.filter_map(|block| {
        let open = block.child(Kind::Open)?.range().start;
        let close = block.child(Kind::Close)?;
        let (indent, begins_line) = margin(text, close.range().start);
        let is_early = begins_line && indent > margin(text, open).0;
        (is_early && close.range().start < byte).then(|| close.span())
    });
    early.min()
}

/// Returns every fault of a tree with those that others cause, in source order.
pub(crate) fn all(tree: &Tree) -> Vec<Fault> {
    let mut faults = Vec::new();
    for parent in tree.nodes() {
        let mut previous: Option<Node<'_>> = None;
        for child in parent.children().filter(|child| !child.kind().is_trivia()) {
            faults.extend(judge(parent, previous, child));
            previous = Some(child);
        }
        faults.extend(lacking(parent));
    }
    faults.sort_by_key(|fault| fault.span);
    faults
}

/// How many faults are reported beside the first brace or quote without a partner.
const MOST_BESIDE_TORN: usize = 2;

/// Returns the first fault that says that braces or triple quotes do not match.
pub(crate) fn torn(tree: &Tree, faults: &[Fault]) -> Option<usize> {
    // The rest of a task that was closed too early.
    let strays = tree.nodes().filter(|node| node.kind() == Kind::Stray);
    let rests: BTreeSet<usize> = strays
        .filter(|node| closes_more(node.text()))
        .map(|node| trimmed(node).start)
        .collect();
    faults.iter().position(|fault| {
        let says_so = matches!(
            fault.problem,
            Problem::MissingClose { .. }
                | Problem::StrayClose { .. }
                | Problem::OutsideTask { .. }
                | Problem::UnclosedText
        ) || fault.problem == Problem::UnclosedString
            && closes_more(&tree.text()[fault.span.range()]);
        says_so || rests.contains(&fault.span.start)
    })
}

/// Drops faults that a brace or a quote without a partner causes further down: there, lines are in the wrong block.
fn drop_consequences(tree: &Tree, faults: &mut Vec<Fault>) {
    if tree.nodes().any(swallows_braces) {
        faults.retain(|fault| !matches!(fault.problem, Problem::MissingClose { .. }));
    }
    drop_of_unclosed(tree, faults);
    drop_on_a_head(tree, faults);
    drop_of_unopened(tree, faults);
    let Some(torn) = torn(tree, faults) else {
        return;
    };
    let before = faults[..torn].iter().take(MOST_BESIDE_TORN);
    let reported = { before }.position(|fault| closes_on(tree, fault));
    let mut number = 0;
    faults.retain(|fault| {
        number += 1;
        // These do not depend on the block that they are in.
        let is_local = matches!(
            fault.problem,
            Problem::WrongQuotes { .. } | Problem::BadEscape
        );
        let is_kept = match reported {
            Some(reported) => number <= reported + 1,
            None => number <= MOST_BESIDE_TORN || number == torn + 1,
        };
        is_local || is_kept
    });
}

/// Drops all but one of the faults on a line between a block's first word and its `{`.
fn drop_on_a_head(tree: &Tree, faults: &mut Vec<Fault>) {
    let text = tree.text();
    let lacks_open = |fault: &Fault| matches!(fault.problem, Problem::MissingOpen { .. });
    // What is too many stands before a `{` that is there.
    let mut surplus = BTreeSet::new();
    faults.dedup_by(|later, earlier| {
        let between = text.get(earlier.span.end..later.span.start);
        let is_same_line = between.is_some_and(|between| !between.contains(['\n', '\r']));
        if !lacks_open(earlier) || !is_same_line {
            return false;
        }
        if lacks_open(later) {
            return true;
        }
        if line_at(text, later.span.start).1.contains('{') {
            surplus.insert(earlier.span.start);
            return false;
        }
        between.is_some_and(|between| between.trim().is_empty())
    });
    faults.retain(|fault| !lacks_open(fault) || !surplus.contains(&fault.span.start));
}

/// Drops what a missing `"""` causes: the lines of the text are read as statements, and its end as a beginning.
fn drop_of_unopened(tree: &Tree, faults: &mut Vec<Fault>) {
    let text = tree.text();
    let unopened = { faults.iter() }.find_map(|fault| match &fault.problem {
        Problem::Unexpected {
            found, expected, ..
        } if expected.contains(&"a text in quotes") => {
            let (_, line) = line_at(text, fault.span.start);
            let has_text = line.contains('"') || found.as_deref() == Some("}");
            (!has_text).then_some(fault.span.start)
        }
        _ => None,
    });
    let Some(start) = unopened else {
        return;
    };
    // A text that was opened has an end; that of this one is alone.
    let Some(end) = text[start..]
        .find("\"\"\"")
        .map(|length| start + length + 3)
    else {
        return;
    };
    if text[end..].matches("\"\"\"").count() % 2 == 1 {
        return;
    }
    faults.retain(|fault| match fault.problem {
        Problem::MissingClose { opened, .. } => opened.start > start,
        _ => fault.span.start <= start || fault.span.start > end,
    });
}

/// Returns the parts of a line before and from a byte; of a very long one, what is near.
fn line_at(text: &str, byte: usize) -> (&str, &str) {
    let near = text.floor_char_boundary(byte.saturating_sub(MOST_LINE));
    let far = text.floor_char_boundary(byte.saturating_add(MOST_LINE));
    let before = text[near..byte].rsplit(['\n', '\r']).next();
    let after = text[byte..far].split(['\n', '\r']).next();
    (before.unwrap_or_default(), after.unwrap_or_default())
}

/// Returns whether a fault is at a `}` that is too many, as its line shows, or the one before it.
fn closes_on(tree: &Tree, fault: &Fault) -> bool {
    let text = tree.text();
    let (before, after) = line_at(text, fault.span.start);
    let end = fault.span.start - before.len();
    let above = text[..end].trim_end_matches(['\n', '\r']);
    let (above, _) = line_at(above, above.len());
    let is_statement = above.contains(|letter: char| letter.is_alphanumeric());
    let is_brace = matches!(fault.problem, Problem::StrayClose { .. });
    let here = [before, after].concat();
    !is_brace && (closes_inside(&here) || is_statement && closes_inside(above))
}

/// Returns whether a line closes more braces than it opens; the one with which it begins closes a block above it.
fn closes_inside(line: &str) -> bool {
    let line = line.trim_start();
    let mut is_text = false;
    let mut depth = 0;
    for letter in line.strip_prefix('}').unwrap_or(line).chars() {
        match letter {
            '"' => is_text = !is_text,
            '#' if !is_text => break,
            '{' if !is_text => depth += 1,
            '}' if !is_text => depth -= 1,
            _ => {}
        }
    }
    depth < 0
}

/// In a file with more unclosed blocks, nobody knows which line belongs to which.
const MOST_UNCLOSED: usize = 8;

/// How far from the beginning of its line a fault may be for the line's first word to be looked at, bytes.
const MOST_LINE: usize = 4096;

/// Drops what the unclosed blocks cause: the lines of the block around them are read as lines of theirs.
fn drop_of_unclosed(tree: &Tree, faults: &mut Vec<Fault>) {
    let unclosed: Vec<(Node<'_>, Span)> = { faults.iter() }
        .filter_map(|fault| match fault.problem {
            Problem::MissingClose { opened, .. } => {
                Some((tree.node_at(opened.start).parent()?, opened))
            }
            _ => None,
        })
        .collect();
    if unclosed.is_empty() || unclosed.len() > MOST_UNCLOSED {
        return;
    }
    let begins_outer = |block: Node<'_>, byte: usize| {
        let (before, after) = line_at(tree.text(), byte);
        let line = byte - before.len();
        let whole = [before, after].concat();
        let first = token_at(whole.trim_start(), 0..whole.trim_start().len());
        line > block.range().start && { block.ancestors() }
            .any(|outer| words(outer.kind()).contains(&first))
    };
    // A block without `{` takes the `}` of the one around it.
    let taken: Vec<usize> = { faults.iter() }
        .filter(|fault| matches!(fault.problem, Problem::MissingOpen { .. }))
        .map(|fault| fault.span.start)
        .collect();
    // What is outside of tasks because a block took the `}` of the one around it.
    let torn_off =
        { tree.nodes() }.filter(|node| node.kind() == Kind::Stray && closes_more(node.text()));
    let torn_off: BTreeSet<usize> = torn_off.map(|node| trimmed(node).start).collect();
    let mut strays: Vec<usize> = { faults.iter() }
        .map(|fault| fault.span.start)
        .filter(|at| torn_off.contains(at))
        .collect();
    // Braces that were reported themselves.
    let opening: BTreeSet<usize> = { faults.iter() }
        .filter(|fault| may_open_too_many(tree, fault))
        .map(|fault| fault.span.start)
        .collect();
    let mut misplaced = Vec::new();
    faults.retain(|fault| {
        let at = fault.span.start;
        if let Problem::MissingClose { opened, .. } = fault.problem {
            let block = tree.node_at(opened.start).parent();
            let Some(block) = block else {
                return true;
            };
            if let Some(word) = misplaced_at_end(block)
                && let Some(place) = strays.iter().position(|stray| *stray > word.start)
            {
                misplaced.push((block, word, strays.remove(place)));
                return false;
            }
            let is_in = |at: &usize| block.range().contains(at);
            let holds_unclosed = { unclosed.iter() }
                .any(|(_, inner)| opened.end <= inner.start && is_in(&inner.start));
            // What is in an inner block that is closed is another fault.
            let inner = block
                .children()
                .filter(|it| it.child(Kind::Close).is_some());
            let last = inner.last().map_or(opened.end, |it| it.range().end);
            let is_behind = |at: &usize| last <= *at && is_in(at);
            return !holds_unclosed && !taken.iter().any(is_in) && !opening.iter().any(is_behind);
        }
        let depends = matches!(
            fault.problem,
            Problem::Unexpected { .. } | Problem::UnknownWord { .. } | Problem::Misspelt { .. }
        );
        !depends
            || opening.contains(&at)
            || !unclosed.iter().any(|(block, opened)| {
                let is_in = opened.end <= at && at < block.range().end;
                is_in && (block.kind() == Kind::Check || begins_outer(*block, at))
            })
    });
    faults.retain(|fault| {
        !misplaced
            .iter()
            .any(|(.., stray)| *stray == fault.span.start)
    });
    faults.extend(misplaced.into_iter().map(|(block, word, _)| Fault {
        span: word,
        problem: Problem::UnknownWord {
            word: tree.text()[word.range()].to_owned(),
            candidates: words(block.kind()),
            block: Some(block_word(block)),
        },
    }));
    faults.sort_by_key(|fault| fault.span);
}

/// Returns the word at which an unclosed block ends if it begins a line of a block around it.
fn misplaced_at_end(block: Node<'_>) -> Option<Span> {
    if block.child(Kind::Close).is_some() {
        return None;
    }
    let tree = block.tree();
    let after = &tree.text()[block.range().end..];
    let start = block.range().end + (after.len() - after.trim_start().len());
    let word = token_at(tree.text(), start..tree.text().len());
    let mut outer = { block.ancestors() }.filter(|outer| outer.kind() != Kind::File);
    let is_outer = outer.any(|outer| words(outer.kind()).contains(&word));
    is_outer.then(|| tree.span(start..start + word.len()))
}

/// Guesses whether a fault is at a token that stands in place of a `}`: it ends its line, which opens a block, or is
/// all of it.
fn may_stand_for_close(tree: &Tree, fault: &Fault) -> bool {
    let (before, after) = line_at(tree.text(), fault.span.start);
    let token = token_at(after, 0..after.len());
    let is_last = after[token.len()..].trim().is_empty();
    is_last
        && !token.is_empty()
        && (before.trim().is_empty() || before.contains('{') && !before.contains('}'))
}

/// Guesses whether a fault is at a `{` or `"""` that is too many, or at what stands in place of a `}`.
fn may_open_too_many(tree: &Tree, fault: &Fault) -> bool {
    let found = match &fault.problem {
        Problem::Unexpected { found, .. } => found.as_deref(),
        Problem::UnknownWord { word, .. } => Some(word.as_str()),
        Problem::TrailingComma => None,
        _ => return false,
    };
    let (before, after) = line_at(tree.text(), fault.span.start);
    let line = before.trim_start();
    let first = token_at(line, 0..line.len());
    let begins_block = first == "check" || blocks().iter().any(|block| block.name() == first);
    let is_head = !before.contains('{') && begins_block;
    let is_behind_open = before.trim_end().ends_with('{') && after.contains('{');
    may_stand_for_close(tree, fault)
        || is_behind_open
        || after.starts_with("\"\"\"")
        || !is_head && (after.starts_with('{') || found.is_some_and(|it| it.starts_with('{')))
}

/// Returns whether a text has more closing braces than opening ones.
fn closes_more(text: &str) -> bool {
    text.matches('}').count() > text.matches('{').count()
}

/// Returns whether an unclosed text has swallowed the end of a block.
fn swallows_braces(end: Node<'_>) -> bool {
    if end.kind().is_junk() {
        // Junk reads texts as statements do, and a quote too many makes the end of its line a text.
        let lines = end.text().lines();
        let torn = lines.filter(|line| line.matches('"').count() % 2 == 1);
        return torn
            .filter_map(|line| line.rsplit_once('"'))
            .any(|(_, text)| closes_more(text));
    }
    let is_unclosed = matches!(end.kind(), Kind::NoQuote | Kind::NoTriple);
    let is_last = end.kind() == Kind::NoTriple && end.range().end == end.tree().text().len();
    is_unclosed && (is_last || end.parent().is_some_and(|text| closes_more(text.text())))
}

fn judge(parent: Node<'_>, previous: Option<Node<'_>>, node: Node<'_>) -> Option<Fault> {
    let span = trimmed(node);
    let first = |bytes: usize, span: Span| Span {
        end: span.start + bytes,
        ..span
    };
    let (span, problem) = match node.kind() {
        Kind::NoOpen if previous.is_none_or(|head| lacking(head).is_none()) => {
            if let Some(bracket) = other_bracket(parent) {
                return Some(unexpected(node.tree(), bracket, vec!["`{`"]));
            }
            let head = trimmed(previous.unwrap_or(node));
            let problem = Problem::MissingOpen {
                block: block_word(parent),
            };
            let end = Span {
                start: head.end,
                ..head
            };
            (end, problem)
        }
        Kind::NoClose => {
            let blocks = std::iter::successors(Some(parent), |outer| robbed(*outer));
            let block = blocks.last().unwrap_or(parent);
            let opened = block.child(Kind::Open)?.span();
            let problem = Problem::MissingClose {
                block: block_word(block),
                opened,
            };
            (opened, problem)
        }
        Kind::NoQuote => (parent.span(), Problem::UnclosedString),
        Kind::NoTriple => (first(3, parent.span()), Problem::UnclosedText),
        Kind::Surplus if lacking(parent).is_none() => {
            if let Some(fault) = misspelt_in_head(parent, node) {
                return Some(fault);
            }
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
            let rest = Span {
                end: node.tree().text().len(),
                ..node.span()
            };
            return Some(unexpected(node.tree(), rest, vec!["a condition"]));
        }
        Kind::LoneBraces => {
            if let Some(fault) = wrong_in_placeholder(node) {
                return Some(fault);
            }
            (node.span(), Problem::LoneBraces)
        }
        Kind::Stray => return Some(stray(node)),
        // The bracket in place of `{` was reported; the one that closes it is no other slip.
        Kind::Junk | Kind::JunkSection | Kind::JunkCondition
            if other_bracket(parent).is_some_and(|bracket| {
                bracket.start == span.start || matches!(node.text().trim(), "]" | ")")
            }) =>
        {
            return None;
        }
        Kind::Junk | Kind::JunkSection => return junk(parent, previous, node),
        Kind::JunkCondition | Kind::JunkGuard => {
            let measured = measure(node.tree(), Rule::only_expr, span);
            let fault = measured.unwrap_or_else(|| unexpected(node.tree(), span, Vec::new()));
            return misspelt_expr(node.tree(), span, fault.span.start).or(Some(fault));
        }
        _ => return None,
    };
    Some(Fault { span, problem })
}

/// Returns the `[`, `(` or `:` that stands directly after the head of a block without `{`.
fn other_bracket(block: Node<'_>) -> Option<Span> {
    let text = block.tree().text();
    // It comes right after the head; blocks may have many children.
    let mut first = block.children().take(8);
    let start = first.find(|it| it.kind() == Kind::NoOpen)?.range().start;
    let start = start + (text[start..].len() - text[start..].trim_start().len());
    let is_bracket = text[start..].starts_with(['[', '(', ':']);
    is_bracket.then(|| block.tree().span(start..start + 1))
}

/// How far a line may begin and still tell by its indentation where a block ends, bytes.
const MOST_INDENT: usize = 256;

/// Returns how far in the line of a byte begins, and whether the line begins there. Many blocks may be on one long line.
fn margin(text: &str, at: usize) -> (usize, bool) {
    let near = &text[text.floor_char_boundary(at.saturating_sub(MOST_INDENT))..at];
    let before = near.rsplit('\n').next().unwrap_or(near);
    let words = before.trim_start();
    (before.len() - words.len(), words.is_empty())
}

/// Returns the inner block that took the `}` of a block that is never closed, as the indentation shows.
fn robbed(outer: Node<'_>) -> Option<Node<'_>> {
    let text = outer.tree().text();
    let (outer_margin, _) = margin(text, outer.child(Kind::Open)?.range().start);
    let mut inner = outer.children();
    inner.find(|block| {
        let ends = [Kind::Open, Kind::Close].map(|kind| block.child(kind));
        let [Some(open), Some(close)] = ends else {
            return false;
        };
        margin(text, open.range().start).0 > outer_margin
            && margin(text, close.range().start) == (outer_margin, true)
    })
}

/// Reports a head without a name, and a check without a condition.
fn lacking(node: Node<'_>) -> Option<Fault> {
    let needs_name = match node.kind() {
        Kind::Extends => true,
        Kind::Head => node.parent()?.kind().needs_name(),
        _ => false,
    };
    if needs_name && node.child(Kind::Name).is_none() {
        let word = node.child(Kind::Token)?;
        let behind = Span {
            start: word.span().end,
            ..word.span()
        };
        let problem = Problem::MissingName {
            after: word.text().to_owned(),
        };
        let span = node.child(Kind::Surplus).map_or(behind, trimmed);
        return Some(Fault { span, problem });
    }
    let has = |kind| node.child(kind).is_some();
    if node.kind() != Kind::Check || !has(Kind::Open) || has(Kind::Expr) || has(Kind::JunkCondition)
    {
        return None;
    }
    let problem = Problem::Unexpected {
        found: Some("}".to_owned()),
        expected: vec!["a condition"],
        is_surplus: false,
    };
    let span = node.child(Kind::Close)?.span();
    Some(Fault { span, problem })
}

/// Finds a misspelt `extends` or `when` between the name of a block and its `{`.
fn misspelt_in_head(head: Node<'_>, surplus: Node<'_>) -> Option<Fault> {
    let tree = head.tree();
    let start = head.range().start;
    let length = tree.text()[surplus.range().end..].find('{')?;
    let piece = tree.span(start..surplus.range().end + length + 1);
    let strict = Strict {
        rule: Rule::only_head,
        begins: &[],
    };
    misspelt(tree, strict, piece, trimmed(surplus).start)
}

/// Finds a misspelt word, or what is wrong in a call, between the two braces of a placeholder and their `}}` on the
/// same line.
fn wrong_in_placeholder(braces: Node<'_>) -> Option<Fault> {
    let (tree, start) = (braces.tree(), braces.range().end);
    let line = tree.text()[start..].split(['\n', '\r', '{']).next()?;
    let piece = tree.span(start..start + line.find("}}")?);
    let fault = measure(tree, Rule::only_expr, piece)?;
    let is_open = tree.text()[start..fault.span.start].contains('(');
    misspelt_expr(tree, piece, fault.span.start).or(is_open.then_some(fault))
}

fn misspelt_expr(tree: &Tree, piece: Span, failed: usize) -> Option<Fault> {
    let strict = Strict {
        rule: Rule::only_expr,
        begins: &[],
    };
    misspelt(tree, strict, piece, failed)
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
        Problem::OutsideTask {
            word: first.to_owned(),
            early: None,
        }
    } else {
        let line = tree.text()[span.range()].split(['\n', '\r']).next();
        let line = Span {
            end: span.start + line.map_or(0, str::len),
            ..span
        };
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
            block: None,
        }
    };
    let span = Span {
        end: span.start + first.len(),
        ..span
    };
    Fault { span, problem }
}

fn junk(parent: Node<'_>, previous: Option<Node<'_>>, node: Node<'_>) -> Option<Fault> {
    let tree = node.tree();
    let known = words(parent.kind());
    let span = trimmed(node);
    let first = token_at(tree.text(), span.range());
    let follows_junk =
        previous.is_some_and(|before| matches!(before.kind(), Kind::Junk | Kind::JunkSection));
    if follows_junk && !looks_like_statement(node.kind(), node.text().trim(), first, known) {
        return None;
    }
    // The missing `{` was reported where this word stands.
    if first == "extends" && parent.child(Kind::NoOpen).is_some() {
        return None;
    }
    if first == "," && span.range().len() == 1 {
        let problem = Problem::TrailingComma;
        return Some(Fault { span, problem });
    }
    // A remainder is parsed together with the statement before it, because that rule knows what may follow.
    let begins =
        known.is_empty() && looks_like_statement(node.kind(), node.text().trim(), first, known);
    let statement = previous.filter(|before| is_statement(before.kind()) && !begins);
    let rule = block(parent.kind())?.line();
    // A word that begins a line of this block begins a statement, even on the line of another one.
    let is_own = || known.contains(&first) && measure(tree, rule, span).is_some();
    let continued = statement.filter(|before| before.is_cut() && !is_own());
    let whole = Span {
        start: continued.map_or(span.start, |before| before.range().start),
        ..span
    };
    let strict = Strict {
        rule,
        begins: known,
    };
    let measured = measure(tree, strict.rule, whole);
    let unknown = |word: &str| Problem::UnknownWord {
        word: word.to_owned(),
        candidates: known,
        block: Some(block_word(parent)),
    };
    if let Some(fault) = &measured
        && let Some(mut fault) = misspelt(tree, strict, whole, fault.span.start)
    {
        if let Problem::Misspelt { word, meant } = &fault.problem
            && meant.iter().any(|meant| known.contains(meant))
        {
            fault.problem = unknown(word);
        }
        return Some(fault);
    }
    // A word that joins may begin the next line.
    if let Some(before) = statement.filter(|before| !before.is_cut()) {
        let joined = Span {
            start: before.range().start,
            ..span
        };
        let failed = measure(tree, strict.rule, joined).map_or(span.start, |it| it.span.start);
        if let Some(fault) = misspelt(tree, strict, joined, failed) {
            return Some(fault);
        }
    }
    if let Some(mut fault) = measured
        && fault.span.start > whole.start
    {
        if let Problem::Unexpected { is_surplus, .. } = &mut fault.problem {
            *is_surplus = parses_without(tree, strict.rule, whole, fault.span);
        }
        return Some(fault);
    }
    if is_word(first) && !known.is_empty() && !known.contains(&first) {
        let problem = unknown(first);
        let span = Span {
            end: span.start + first.len(),
            ..span
        };
        return Some(Fault { span, problem });
    }
    let begins_with_name = known.is_empty();
    let expected = begins_with_name.then_some("a name");
    Some(unexpected(tree, span, expected.into_iter().collect()))
}

/// Returns whether a line of junk looks like a new statement.
fn looks_like_statement(kind: Kind, line: &str, first: &str, known: &[&str]) -> bool {
    let rest = line[first.len()..].trim_start_matches([' ', '\t']);
    if known.is_empty() {
        return is_word(first) && rest.starts_with([':', '=']);
    }
    // Misspelt words are recognised only for sections: inside a section, an unclosed block would look the same.
    let is_section = kind == Kind::JunkSection;
    known.contains(&first) || is_section && is_word(first) && opens_block(rest)
}

/// Returns whether a line goes on with `{`, or with a name or a text and `{`: a block, perhaps misspelt.
fn opens_block(rest: &str) -> bool {
    let line = rest.split(['\n', '\r']).next().unwrap_or(rest);
    let head = line.split('{').next().unwrap_or(line);
    head.len() < line.len() && head.len() < 64 && head.split_whitespace().count() <= 1
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
    let right = requoted(node.text(), quotes.len(), quotes);
    Problem::WrongQuotes { right }
}

/// Replaces `count` characters at each end by straight quotes.
fn requoted(text: &str, count: usize, quotes: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let is_quote = |character: &char| {
        matches!(
            character,
            '"' | '\'' | '“' | '”' | '„' | '‟' | '«' | '»' | '‘' | '’'
        )
    };
    let closing = characters
        .iter()
        .skip(count)
        .rev()
        .take(count)
        .take_while(|character| is_quote(character))
        .count();
    let body: String = characters
        [count.min(characters.len())..characters.len().saturating_sub(closing).max(count)]
        .iter()
        .collect();
    format!("{quotes}{body}{quotes}")
}
