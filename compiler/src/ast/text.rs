//! Texts: what a model will read, with the places where values go.
//!
//! A text between triple quotes loses the indentation that its lines share, its first line break and its
//! last; every line end becomes a line feed. Nothing else is changed.

use super::expr::{self, Expr};
use crate::source::{FileId, Span};
use fab_grammar::{Kind, Node};
use std::ops::Range;

/// A text as a sequence of literal pieces and placeholders.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    /// The whole text with its quotes.
    pub span: Span,
    /// Where its first character stands.
    pub start: usize,
    pub pieces: Vec<Piece>,
}

#[derive(Clone, Debug)]
pub(crate) enum Piece {
    Literal(String),
    Value(Expr),
}

impl Text {
    /// Returns the text if it has no placeholders.
    pub fn plain(&self) -> Option<String> {
        let mut plain = String::new();
        for piece in &self.pieces {
            match piece {
                Piece::Literal(text) => plain.push_str(text),
                Piece::Value(_) => return None,
            }
        }
        Some(plain)
    }

    pub fn is_blank(&self) -> bool {
        self.plain().is_some_and(|text| text.trim().is_empty())
    }

    /// Returns the number of bytes of its literal pieces.
    pub fn literal_bytes(&self) -> usize {
        let length = |piece: &Piece| match piece {
            Piece::Literal(text) => text.len(),
            Piece::Value(_) => 0,
        };
        self.pieces.iter().map(length).sum()
    }
}

/// Reads the text below `node`; quotes of the wrong kind are read as if they were right.
pub(super) fn first(file: FileId, node: Node<'_>) -> Option<Text> {
    node.children().find_map(|child| text(file, child))
}

/// Reads one node; None where it is no text.
pub(super) fn text(file: FileId, node: Node<'_>) -> Option<Text> {
    let span = Span::new(file, node.span());
    let pieces = match node.kind() {
        Kind::BlockText => return Some(block(file, node)),
        Kind::String => line(file, node),
        // The wrong quotes are an error already; the words only keep later errors away.
        Kind::CurlyText | Kind::CurlyString | Kind::SingleString => {
            vec![Piece::Literal(node.text().to_owned())]
        }
        _ => return None,
    };
    let quote = node.text().chars().next().map_or(0, char::len_utf8);
    Some(Text {
        span,
        start: span.start + quote,
        pieces,
    })
}

fn line(file: FileId, node: Node<'_>) -> Vec<Piece> {
    let mut pieces = Pieces::default();
    for child in node.children() {
        match child.kind() {
            Kind::StringChars => pieces.literal(child.text()),
            Kind::Escape => pieces.literal(&child.text()[1..]),
            Kind::Placeholder => pieces.placeholder(file, child),
            _ => {}
        }
    }
    pieces.list
}

fn block(file: FileId, node: Node<'_>) -> Text {
    let quotes = 3;
    let is_closed = node.child(Kind::NoTriple).is_none();
    let raw = &node.text()[quotes..node.text().len() - if is_closed { quotes } else { 0 }];
    let body = node.span().start + quotes;
    let lines = lines(raw);
    let opens_with_break = lines
        .first()
        .is_some_and(|line| raw[line.clone()].trim().is_empty())
        && lines.len() > 1;
    let closes_with_break = lines
        .last()
        .is_some_and(|line| raw[line.clone()].trim().is_empty())
        && lines.len() > 1;
    let kept = usize::from(opens_with_break)
        ..(lines.len() - usize::from(closes_with_break)).max(usize::from(opens_with_break));
    let indent = shared_indent(raw, &lines[kept.clone()], opens_with_break);
    let placeholders: Vec<Node<'_>> = node.all(Kind::Placeholder).collect();
    let mut pieces = Pieces::default();
    let mut start = None;
    for (number, line) in lines[kept.clone()].iter().enumerate() {
        if number > 0 {
            pieces.literal("\n");
        }
        let has_indent = number > 0 || opens_with_break;
        let blanks =
            raw[line.clone()].len() - raw[line.clone()].trim_start_matches([' ', '\t']).len();
        let from = line.start + if has_indent { indent.min(blanks) } else { 0 };
        start.get_or_insert(body + from);
        pieces.between(file, node, &placeholders, body + from..body + line.end);
    }
    Text {
        span: Span::new(file, node.span()),
        start: start.unwrap_or(body),
        pieces: pieces.list,
    }
}

/// Returns the lines' places, without their ends.
fn lines(raw: &str) -> Vec<Range<usize>> {
    let mut lines = Vec::new();
    let mut start = 0;
    let mut bytes = raw.bytes().enumerate().peekable();
    while let Some((at, byte)) = bytes.next() {
        if !matches!(byte, b'\n' | b'\r') {
            continue;
        }
        lines.push(start..at);
        start = at + 1;
        if byte == b'\r' && bytes.next_if(|(_, next)| *next == b'\n').is_some() {
            start += 1;
        }
    }
    lines.push(start..raw.len());
    lines
}

/// Returns the number of blanks that all lines with words begin with; the one behind the quotes does not count.
fn shared_indent(raw: &str, lines: &[Range<usize>], first_counts: bool) -> usize {
    let mut shared: Option<&str> = None;
    for line in lines
        .iter()
        .skip(usize::from(!first_counts))
        .map(|line| &raw[line.clone()])
    {
        let words = line.trim_start_matches([' ', '\t']);
        if words.is_empty() {
            continue;
        }
        let blanks = &line[..line.len() - words.len()];
        shared = Some(match shared {
            None => blanks,
            Some(before) => {
                &before[..before
                    .bytes()
                    .zip(blanks.bytes())
                    .take_while(|(a, b)| a == b)
                    .count()]
            }
        });
    }
    shared.map_or(0, str::len)
}

#[derive(Default)]
struct Pieces {
    list: Vec<Piece>,
}

impl Pieces {
    fn literal(&mut self, text: &str) {
        if text.is_empty() {
            return;
        }
        match self.list.last_mut() {
            Some(Piece::Literal(before)) => before.push_str(text),
            _ => self.list.push(Piece::Literal(text.to_owned())),
        }
    }

    fn placeholder(&mut self, file: FileId, node: Node<'_>) {
        if let Some(literal) = node.child(Kind::Literal) {
            let text = literal.text();
            self.literal(&text[1..text.len() - 1]);
        }
        if let Some(value) = expr::first(file, node) {
            self.list.push(Piece::Value(value));
        }
    }

    /// Adds what lies in `range`, a part of one line; a placeholder never spans lines.
    fn between(
        &mut self,
        file: FileId,
        block: Node<'_>,
        placeholders: &[Node<'_>],
        range: Range<usize>,
    ) {
        let text = |part: Range<usize>| {
            &block.text()[part.start - block.span().start..part.end - block.span().start]
        };
        let first = placeholders.partition_point(|node| node.span().start < range.start);
        let mut at = range.start;
        for node in placeholders[first..]
            .iter()
            .take_while(|node| node.span().end <= range.end)
        {
            self.literal(text(at..node.span().start));
            self.placeholder(file, *node);
            at = node.span().end;
        }
        self.literal(text(at..range.end));
    }
}
