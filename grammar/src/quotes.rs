//! Finds the text of a line that lacks one of its two quotes.
//!
//! In: the tree and its faults. Out: the faults, one in place of those of each such line. A quote is tried at the ends
//! of the words of each text, and the place after which most of the line parses tells which text is meant. The other
//! faults are those of the file with the quote in that place.

use crate::fault::{Fault, Problem};
use crate::faults;
use crate::limits;
use crate::rules::{FabParser, Rule};
use crate::source::Span;
use crate::tree::{Kind, Node, Tree};
use crate::vocabulary::block;
use pest::Parser;
use std::ops::Range;

/// How many places are tried on a line.
const MOST_PLACES: usize = 24;

/// How many words before a quote are tried as the beginning of its text.
const MOST_BEGINNINGS: usize = 6;

/// The longest piece that is tried, bytes: each try parses it again.
const MOST_BYTES: usize = 16 << 10;

/// How many lines of a file are looked at.
const MOST_LINES: usize = 16;

/// A line with an odd number of quotes, which are at these bytes.
struct Line {
    range: Range<usize>,
    quotes: Vec<usize>,
}

/// A place where a quote may be missing.
struct Place {
    at: usize,
    /// Whether texts often end there.
    is_likely: bool,
    fault: Fault,
}

/// Replaces the faults of lines with a quote too few.
pub(crate) fn mend(tree: &Tree, mut faults: Vec<Fault>) -> Vec<Fault> {
    if faults.is_empty() {
        return faults;
    }
    let lines = odd_lines(tree.text());
    let all = match lines.as_slice() {
        [] => return faults,
        _ => faults::all(tree),
    };
    if { all.iter() }.any(|fault| fault.problem == Problem::UnclosedText) {
        return faults;
    }
    let lines = lines.into_iter().filter(|line| {
        let first = all.partition_point(|fault| fault.span.start < line.range.start);
        let own = all[first..].iter();
        let mut own = { own }
            .take_while(|fault| fault.span.start <= line.range.end)
            .peekable();
        own.peek().is_some()
            && own.all(|fault| !matches!(fault.problem, Problem::WrongQuotes { .. }))
    });
    let missing: Vec<(Range<usize>, usize, Fault)> = { lines.take(MOST_LINES) }
        .map(|line| {
            let place = missing(tree, &line);
            (line.range, place.at, place.fault)
        })
        .collect();
    if missing.is_empty() {
        return faults;
    }
    let mut mended = tree.text().to_owned();
    for (_, at, _) in missing.iter().rev() {
        mended.insert(*at, '"');
    }
    if limits::check(tree.file(), &mended).is_ok()
        && let Ok(pairs) = FabParser::parse(Rule::file, &mended)
    {
        (faults, _) = faults::collect(&Tree::from_pairs(tree.file(), &mended, pairs));
        let before = |byte: usize| {
            let added = missing.iter().enumerate();
            byte - added.filter(|(number, it)| it.1 + number < byte).count()
        };
        let back = |span: &mut Span| {
            span.start = before(span.start);
            span.end = before(span.end);
        };
        for fault in &mut faults {
            back(&mut fault.span);
            match &mut fault.problem {
                Problem::MissingClose { opened, .. } => back(opened),
                Problem::StrayClose { early: Some(early) }
                | Problem::OutsideTask {
                    early: Some(early), ..
                } => back(early),
                _ => {}
            }
        }
    }
    faults.retain(|fault| {
        let on = |(line, ..): &(Range<usize>, usize, Fault)| {
            line.start <= fault.span.start && fault.span.start <= line.end
        };
        !missing.iter().any(on)
    });
    faults.extend(missing.into_iter().map(|(_, _, fault)| fault));
    faults.sort_by_key(|fault| fault.span);
    faults
}

/// Returns the lines with an odd number of quotes outside of long texts and comments.
fn odd_lines(text: &str) -> Vec<Line> {
    let mut lines = Vec::new();
    let (mut at, mut start, mut is_text) = (0, 0, false);
    let mut quotes = Vec::new();
    loop {
        let rest = &text[at..];
        let found = rest.find(['"', '#', '\\', '\r', '\n']);
        at += found.unwrap_or(rest.len());
        let rest = &text[at..];
        let next = rest.chars().next();
        at += match next {
            Some('"') if !is_text && rest.starts_with("\"\"\"") => {
                let length = rest[3..].find("\"\"\"").map_or(rest.len(), |end| end + 6);
                if rest[..length].contains('\n') {
                    quotes.clear();
                    start = at + length;
                }
                length
            }
            Some('"') => {
                quotes.push(at);
                is_text = !is_text;
                1
            }
            Some('\\') if is_text && rest[1..].starts_with(['"', '\\']) => 2,
            Some('#') if !is_text => rest.find(['\r', '\n']).unwrap_or(rest.len()),
            Some('\r' | '\n') | None => {
                let quotes = std::mem::take(&mut quotes);
                if quotes.len() % 2 == 1 {
                    let range = start..at;
                    lines.push(Line { range, quotes });
                }
                is_text = false;
                start = at + 1;
                1
            }
            Some(_) => 1,
        };
        if next.is_none() {
            return lines;
        }
    }
}

/// Finds the place of the missing quote of a line.
fn missing(tree: &Tree, line: &Line) -> Place {
    let text = tree.text();
    let mut places = places(tree, line);
    let likely = places.iter().filter(|place| place.is_likely).count();
    let mut spare = MOST_PLACES.saturating_sub(likely);
    places.retain(|place| {
        let is_kept = place.is_likely || spare > 0;
        spare -= usize::from(is_kept && !place.is_likely);
        is_kept
    });
    places.truncate(MOST_PLACES);
    let (heads, start) = statement(tree, line);
    let mut best: Option<(usize, Place)> = None;
    if heads.len() + line.range.end - start <= MOST_BYTES {
        for place in places {
            let (before, after) = (&text[start..place.at], &text[place.at..line.range.end]);
            let left = left_over(tree, &format!("{heads}{before}\"{}", after.trim_end()));
            if best.as_ref().is_none_or(|(least, _)| left < *least) {
                best = Some((left, place));
            }
            if left == 0 {
                break;
            }
        }
    }
    let whole = || left_over(tree, &format!("{heads}{}", &text[start..line.range.end]));
    match best {
        Some((left, place)) if left == 0 || left < whole() => place,
        _ => Place {
            at: line.range.end,
            is_likely: true,
            fault: unclosed(tree, line, line.quotes[0]),
        },
    }
}

fn unclosed(tree: &Tree, line: &Line, opening: usize) -> Fault {
    let span = tree.span(opening..line.range.end);
    let problem = Problem::UnclosedString;
    Fault { span, problem }
}

/// Returns the places on a line where a quote may be missing: at the ends of the words of each text, then at the
/// beginnings of the words between them.
fn places(tree: &Tree, line: &Line) -> Vec<Place> {
    let text = tree.text();
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut places = Vec::new();
    for (number, opening) in line.quotes.iter().enumerate().step_by(2) {
        let next = line.quotes.get(number + 1);
        let body = &text[opening + 1..next.map_or(line.range.end, |next| *next)];
        let mut ends: Vec<(usize, bool)> = Vec::new();
        // Where the last letter that is no blank ends.
        let mut end = 0;
        for (at, letter) in body.char_indices() {
            if ",){}".contains(letter) {
                ends.push((end, true));
            } else if !is_part(letter) && end == at && body[..at].ends_with(is_part) {
                ends.push((at, false));
            }
            if !letter.is_whitespace() {
                end = at + letter.len_utf8();
            }
        }
        ends.push((end, true));
        ends.dedup_by(|later, earlier| {
            let is_same = later.0 == earlier.0;
            earlier.1 |= is_same && later.1;
            is_same
        });
        places.extend(ends.into_iter().map(|(end, is_likely)| Place {
            at: opening + 1 + end,
            is_likely,
            fault: unclosed(tree, line, *opening),
        }));
    }
    for (number, closing) in line.quotes.iter().enumerate().step_by(2) {
        let start = number.checked_sub(1).map(|before| line.quotes[before] + 1);
        let start = start.unwrap_or(line.range.start);
        let gap = &text[start..*closing];
        // A closing quote touches its text.
        if gap.ends_with([' ', '\t']) {
            continue;
        }
        let begins = gap
            .char_indices()
            .filter(|(at, letter)| letter.is_alphabetic() && !gap[..*at].ends_with(is_part));
        let begins: Vec<usize> = begins.map(|(at, _)| start + at).collect();
        places.extend(begins.iter().rev().take(MOST_BEGINNINGS).map(|at| Place {
            at: *at,
            is_likely: true,
            fault: Fault {
                span: tree.span(*at..closing + 1),
                problem: Problem::UnopenedString,
            },
        }));
    }
    places
}

/// Returns the heads of the blocks around a line, and where the statement on it begins.
fn statement(tree: &Tree, line: &Line) -> (String, usize) {
    let text = &tree.text()[line.range.clone()];
    let first = line.range.start + (text.len() - text.trim_start().len());
    let leaf = tree.node_at(first);
    let is_statement = |node: &Node<'_>| {
        let begins_block = matches!(
            node.kind(),
            Kind::Head | Kind::Extends | Kind::Open | Kind::NoOpen
        );
        !begins_block
            && node
                .parent()
                .is_some_and(|parent| block(parent.kind()).is_some())
    };
    let Some(statement) = std::iter::once(leaf)
        .chain(leaf.ancestors())
        .find(is_statement)
    else {
        return (String::new(), first);
    };
    let mut heads: Vec<&str> = { statement.ancestors() }
        .filter_map(|outer| {
            let open = outer.child(Kind::Open)?.range().end;
            tree.text().get(outer.range().start..open)
        })
        .collect();
    heads.reverse();
    (heads.concat(), statement.range().start.min(first))
}

/// Returns how many bytes at the end of a piece do not parse.
fn left_over(tree: &Tree, piece: &str) -> usize {
    if limits::check(tree.file(), piece).is_err() {
        return piece.len();
    }
    let Ok(pairs) = FabParser::parse(Rule::file, piece) else {
        return piece.len();
    };
    let mut wrong = pairs.flatten().filter_map(|pair| {
        let (kind, start) = (Kind::of(pair.as_rule()), pair.as_span().start());
        let is_wrong = kind.is_junk()
            || matches!(
                kind,
                Kind::NoOpen | Kind::NoQuote | Kind::NoCondition | Kind::LoneBraces
            );
        // Blocks may go on below the line.
        let is_early = kind == Kind::NoClose && start < piece.len();
        (is_wrong || is_early).then(|| (piece.len() - start).max(1))
    });
    wrong.next().unwrap_or(0)
}
