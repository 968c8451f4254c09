//! Finds objects in an answer: JSON, and what models write in its place.
//!
//! In: a text. Out: each object with its members, as pieces of the text. Single quotes, keys without quotes, tuples,
//! comments and trailing commas are tolerated. Nesting is bounded, and time is linear in the text's length.

use std::ops::Range;

/// The most lists and objects inside one another.
const MAX_DEPTH: usize = 24;

/// A value of an object.
#[derive(Debug)]
pub(super) struct Node {
    /// Where it stands, with its brackets or quotation marks.
    pub span: Range<usize>,
    pub shape: Shape,
}

/// A member of an object.
#[derive(Debug)]
pub(super) struct Member {
    pub key: String,
    /// Where the key begins.
    pub at: usize,
    pub value: Node,
}

/// What a value is.
#[derive(Debug)]
pub(super) enum Shape {
    Object(Vec<Member>),
    List(Vec<Node>),
    /// A string, without its marks and escapes.
    Text(String),
    /// Anything else, as written: a number, `null`, `45 deg`.
    Bare(String),
}

/// Returns the outermost objects of a text, in order.
pub(super) fn objects(text: &str) -> Vec<Node> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(length) = text[at..].find(['{', '[']) {
        let start = at + length;
        let mut parser = Parser {
            text,
            at: start,
            deepest: start,
        };
        match parser.value(0) {
            Some(node) if holds_members(&node) => {
                at = node.span.end;
                found.push(node);
            }
            Some(_) => at = start + 1,
            // What was looked at and is no object is not looked at again.
            None => at = parser.deepest.max(start + 1),
        }
        while !text.is_char_boundary(at) {
            at += 1;
        }
    }
    found
}

/// Parses a whole text as one object.
pub(super) fn whole(text: &str) -> Option<Node> {
    let start = text.len() - text.trim_start().len();
    let mut parser = Parser {
        text,
        at: start,
        deepest: start,
    };
    parser.value(0).filter(holds_members)
}

fn holds_members(node: &Node) -> bool {
    match &node.shape {
        Shape::Object(members) => !members.is_empty(),
        Shape::List(items) => items.iter().any(holds_members),
        Shape::Text(_) | Shape::Bare(_) => false,
    }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    /// How far an object was recognised before it turned out to be none.
    deepest: usize,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn blanks(&mut self) {
        loop {
            let rest = self.rest();
            let trimmed = rest.trim_start();
            let comment = trimmed.starts_with("//") || trimmed.starts_with("# ");
            let skipped = rest.len() - trimmed.len();
            let line = if comment {
                trimmed.find('\n').unwrap_or(trimmed.len())
            } else {
                0
            };
            self.at += skipped + line;
            if line == 0 {
                return;
            }
        }
    }

    fn value(&mut self, depth: usize) -> Option<Node> {
        if depth > MAX_DEPTH {
            return None;
        }
        let start = self.at;
        let shape = match self.peek()? {
            '{' => self.object(depth)?,
            '[' => self.list(']', depth)?,
            '(' => self.list(')', depth)?,
            mark @ ('"' | '\'' | '“') => Shape::Text(self.string(mark)?),
            _ => self.bare()?,
        };
        Some(Node {
            span: start..self.at,
            shape,
        })
    }

    fn object(&mut self, depth: usize) -> Option<Shape> {
        self.at += 1;
        let mut members = Vec::new();
        loop {
            self.blanks();
            match self.peek()? {
                '}' => {
                    self.at += 1;
                    return Some(Shape::Object(members));
                }
                ',' => {
                    self.at += 1;
                    continue;
                }
                _ => {}
            }
            let at = self.at;
            let key = match self.peek()? {
                mark @ ('"' | '\'' | '“') => self.string(mark)?,
                _ => {
                    let is_key = |letter: char| {
                        letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.')
                    };
                    let length = self.rest().find(|letter| !is_key(letter))?;
                    if length == 0 {
                        return None;
                    }
                    let key = self.rest()[..length].to_owned();
                    self.at += length;
                    key
                }
            };
            self.blanks();
            if !matches!(self.peek()?, ':' | '：' | '=') {
                return None;
            }
            self.at += self.peek()?.len_utf8();
            self.blanks();
            let value = self.value(depth + 1)?;
            members.push(Member { key, at, value });
            self.deepest = self.at;
            self.blanks();
            if !matches!(self.peek()?, ',' | '}') {
                return None;
            }
        }
    }

    fn list(&mut self, close: char, depth: usize) -> Option<Shape> {
        self.at += 1;
        let mut items = Vec::new();
        loop {
            self.blanks();
            match self.peek()? {
                found if found == close => {
                    self.at += 1;
                    return Some(Shape::List(items));
                }
                ',' => self.at += 1,
                _ => {
                    items.push(self.value(depth + 1)?);
                    self.blanks();
                    let next = self.peek()?;
                    if next != ',' && next != close {
                        return None;
                    }
                }
            }
        }
    }

    fn string(&mut self, mark: char) -> Option<String> {
        let close = if mark == '“' { '”' } else { mark };
        self.at += mark.len_utf8();
        let mut text = String::new();
        let mut letters = self.rest().char_indices();
        while let Some((index, letter)) = letters.next() {
            match letter {
                '\\' => match letters.next()?.1 {
                    'n' => text.push('\n'),
                    't' => text.push('\t'),
                    'u' => {
                        let code: String =
                            letters.by_ref().take(4).map(|(_, letter)| letter).collect();
                        let letter = u32::from_str_radix(&code, 16).ok().and_then(char::from_u32);
                        text.push(letter.unwrap_or('\u{fffd}'));
                    }
                    other => text.push(other),
                },
                _ if letter == close => {
                    self.at += index + letter.len_utf8();
                    return Some(text);
                }
                _ => text.push(letter),
            }
        }
        self.deepest = self.text.len();
        None
    }

    /// A number or words up to the end of the member.
    fn bare(&mut self) -> Option<Shape> {
        let length = self
            .rest()
            .find([',', '}', ']', ')', '\n', '{', '[', '(', '"'])?;
        let text = self.rest()[..length].trim_end();
        if text.is_empty() {
            return None;
        }
        let text = text.to_owned();
        self.at += text.len();
        Some(Shape::Bare(text))
    }
}
