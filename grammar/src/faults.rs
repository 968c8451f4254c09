//! Says what is wrong with the pieces of a tree that do not fit.
//!
//! In: the tree. Out: [`Fault`]s in source order. A piece of junk is measured against the strict rule of
//! its place, which gives the exact position and what was expected there. A line of junk right after
//! another is silent unless it looks like a statement of its own, so that one slip gives one fault.

use crate::fault::{Fault, Problem};
use crate::measure::{is_word, measure, token_at, unexpected};
use crate::rules::Rule;
use crate::tree::{Kind, Node, Tree};
use crate::vocabulary::{EXAMPLE, ITEMS, SECTIONS, STAGE, SUBGOALS, TEST, VERIFY, parts};
use std::ops::Range;

/// Returns every fault of a tree, in source order.
pub(crate) fn collect(tree: &Tree) -> Vec<Fault> {
    let mut faults = Vec::new();
    for parent in tree.nodes() {
        let mut previous: Option<Node<'_>> = None;
        for child in parent.children() {
            if child.kind().is_trivia() {
                continue;
            }
            faults.extend(judge(tree, parent, previous, child));
            previous = Some(child);
        }
        faults.extend(lacking(parent));
    }
    faults.sort_by_key(|fault| (fault.span.start, fault.span.end));
    drop_consequences(tree, &mut faults);
    faults
}

/// An unclosed text swallows every `}` behind it; those are not missing.
fn drop_consequences(tree: &Tree, faults: &mut Vec<Fault>) {
    let swallowed = tree
        .nodes()
        .any(|node| node.kind() == Kind::NoTriple && node.span().start == tree.text().len());
    if swallowed {
        faults.retain(|fault| !matches!(fault.problem, Problem::MissingClose { .. }));
    }
}

fn judge(
    tree: &Tree,
    parent: Node<'_>,
    previous: Option<Node<'_>>,
    node: Node<'_>,
) -> Option<Fault> {
    let fault = |span, problem| Some(Fault { span, problem });
    match node.kind() {
        Kind::NoOpen => {
            let end = previous.map_or(node.span().start, |head| trimmed(head).end);
            let has_name_fault = previous.is_some_and(|head| lacking(head).is_some());
            if has_name_fault {
                None
            } else {
                fault(
                    end..end,
                    Problem::MissingOpen {
                        block: block_word(parent),
                    },
                )
            }
        }
        Kind::NoClose => {
            let opened = parent.child(Kind::Open)?.span();
            fault(
                opened.clone(),
                Problem::MissingClose {
                    block: block_word(parent),
                    opened,
                },
            )
        }
        Kind::NoQuote => fault(parent.span(), Problem::UnclosedString),
        Kind::NoTriple => fault(
            parent.span().start..parent.span().start + 3,
            Problem::UnclosedText,
        ),
        Kind::Surplus if lacking(parent).is_none() => {
            let span = trimmed(node);
            fault(
                span.clone(),
                Problem::Surplus {
                    found: tree.text()[span].to_owned(),
                },
            )
        }
        Kind::CurlyText => fault(
            node.span(),
            Problem::WrongQuotes {
                right: requoted(node.text(), 3, "\"\"\""),
            },
        ),
        Kind::CurlyString | Kind::SingleString => fault(
            node.span(),
            Problem::WrongQuotes {
                right: requoted(node.text(), 1, "\""),
            },
        ),
        Kind::BadEscape => fault(node.span(), Problem::BadEscape),
        // A placeholder stands on one line, so that texts keep their lines.
        Kind::Placeholder if node.text().contains(['\n', '\r']) => {
            let start = node.span().start;
            fault(start..start + 2, Problem::LoneBraces)
        }
        Kind::LoneBraces => fault(node.span(), Problem::LoneBraces),
        Kind::Stray => Some(stray(tree, node)),
        Kind::Junk | Kind::JunkSection => junk(tree, parent, previous, node),
        Kind::JunkCondition | Kind::JunkGuard => {
            let span = trimmed(node);
            Some(
                measure(tree, Rule::only_expr, span.clone())
                    .unwrap_or_else(|| unexpected(tree, span.start, span.end, Vec::new())),
            )
        }
        _ => None,
    }
}

/// Reports a head without a name, and a check without a condition.
fn lacking(node: Node<'_>) -> Option<Fault> {
    match node.kind() {
        Kind::TaskHead
        | Kind::Extends
        | Kind::StageHead
        | Kind::CheckHead
        | Kind::ExpertsHead
        | Kind::VariantHead
            if node.child(Kind::Name).is_none() =>
        {
            let word = node.children().find(|child| child.kind() == Kind::Token)?;
            let span = node
                .child(Kind::Surplus)
                .map_or(word.span().end..word.span().end, trimmed);
            Some(Fault {
                span,
                problem: Problem::MissingName {
                    after: word.text().to_owned(),
                },
            })
        }
        Kind::Check
            if node.child(Kind::Expr).is_none() && node.child(Kind::JunkCondition).is_none() =>
        {
            let close = node.child(Kind::Open).and(node.child(Kind::Close))?;
            let problem = Problem::Unexpected {
                found: Some("}".to_owned()),
                expected: vec!["a condition"],
            };
            Some(Fault {
                span: close.span(),
                problem,
            })
        }
        _ => None,
    }
}

/// Returns the keyword of a block.
fn block_word(block: Node<'_>) -> String {
    let word = block
        .children()
        .next()
        .and_then(|head| head.text().split_whitespace().next());
    word.unwrap_or_default().to_owned()
}

fn stray(tree: &Tree, node: Node<'_>) -> Fault {
    let span = trimmed(node);
    let first = token_at(tree.text(), span.start, span.end);
    let word_span = span.start..span.start + first.len();
    if first == "}" {
        return Fault {
            span: word_span,
            problem: Problem::StrayClose,
        };
    }
    if SECTIONS.contains(&first) && !ITEMS.contains(&first) {
        return Fault {
            span: word_span,
            problem: Problem::OutsideTask {
                word: first.to_owned(),
            },
        };
    }
    if ITEMS.contains(&first) {
        let line_end = tree.text()[span.clone()]
            .find(['\n', '\r'])
            .map_or(span.end, |length| span.start + length);
        if let Some(fault) = measure(tree, Rule::only_item, span.start..line_end) {
            return fault;
        }
    }
    if is_word(first) {
        let problem = Problem::UnknownWord {
            word: first.to_owned(),
            known: ITEMS,
            block: None,
        };
        return Fault {
            span: word_span,
            problem,
        };
    }
    unexpected(tree, span.start, span.end, Vec::new())
}

fn junk(
    tree: &Tree,
    parent: Node<'_>,
    previous: Option<Node<'_>>,
    node: Node<'_>,
) -> Option<Fault> {
    let (rule, known): (Rule, &'static [&'static str]) = match parent.kind() {
        Kind::Task => (Rule::only_section, SECTIONS),
        Kind::Variant => (Rule::only_section, parts()),
        Kind::Annotate => (Rule::only_keypoint, &[]),
        Kind::Example => (Rule::only_example_part, EXAMPLE),
        Kind::Test => (Rule::only_test_part, TEST),
        Kind::Subgoals => (Rule::only_subgoals_part, SUBGOALS),
        Kind::Keypoints => (Rule::only_keypoint, &[]),
        Kind::Actions => (Rule::only_field, &[]),
        Kind::Stage => (Rule::only_stage_part, STAGE),
        Kind::Verify => (Rule::only_verify_part, VERIFY),
        Kind::Experts => (Rule::only_sequence, &["sequence"]),
        _ => (Rule::only_fold, &["fold"]),
    };
    let span = trimmed(node);
    let first = token_at(tree.text(), span.start, span.end);
    let follows_junk =
        previous.is_some_and(|before| matches!(before.kind(), Kind::Junk | Kind::JunkSection));
    if follows_junk && !looks_like_statement(&tree.text()[span.clone()], first, known) {
        return None;
    }
    if first == "," && span.len() == 1 {
        return Some(Fault {
            span,
            problem: Problem::TrailingComma,
        });
    }
    // A remainder is measured together with the statement before it: that knows what may follow.
    let continued = previous.filter(|before| is_statement(before.kind()) && before.is_cut());
    let start = continued.map_or(span.start, |before| before.span().start);
    if let Some(fault) = measure(tree, rule, start..span.end)
        && fault.span.start > start
    {
        return Some(fault);
    }
    if is_word(first) && !known.is_empty() && !known.contains(&first) {
        let problem = Problem::UnknownWord {
            word: first.to_owned(),
            known,
            block: Some(block_word(parent)),
        };
        return Some(Fault {
            span: span.start..span.start + first.len(),
            problem,
        });
    }
    let expected = if known.is_empty() {
        vec!["a name"]
    } else {
        Vec::new()
    };
    Some(unexpected(tree, span.start, span.end, expected))
}

/// Returns whether a line of junk could be a statement of its own.
fn looks_like_statement(line: &str, first: &str, known: &[&str]) -> bool {
    let rest = line[first.len()..].trim_start_matches([' ', '\t']);
    if known.is_empty() {
        is_word(first) && rest.starts_with([':', '='])
    } else {
        // Only sections are recognised misspelt: inside of them an unclosed block would look the same.
        let are_sections = known.contains(&"verify");
        known.contains(&first) || are_sections && is_word(first) && opens_block(rest)
    }
}

/// Returns whether a line goes on with `{`, or with a name or a text and `{`: a block, perhaps misspelt.
fn opens_block(rest: &str) -> bool {
    let line = rest.split(['\n', '\r']).next().unwrap_or(rest);
    let head = line.split('{').next().unwrap_or(line);
    head.len() < line.len() && head.len() < 64 && head.split_whitespace().count() <= 1
}

fn is_statement(kind: Kind) -> bool {
    !matches!(
        kind,
        Kind::Open
            | Kind::NoOpen
            | Kind::Junk
            | Kind::JunkSection
            | Kind::TaskHead
            | Kind::Extends
            | Kind::StageHead
            | Kind::SubgoalsHead
            | Kind::DemonstrateHead
            | Kind::KeypointsHead
            | Kind::ActionsHead
            | Kind::VerifyHead
            | Kind::ExpertsHead
            | Kind::SequenceHead
            | Kind::AnnotateHead
            | Kind::VariantHead
            | Kind::ExampleHead
            | Kind::TestHead
    )
}

fn trimmed(node: Node<'_>) -> Range<usize> {
    let span = node.span();
    let start = span.end - node.text().trim_start().len();
    let end = start + node.text().trim().len();
    start..end
}

/// Replaces `count` characters at either end by straight quotes.
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
