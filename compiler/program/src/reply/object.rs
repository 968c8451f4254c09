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
        let (node, deepest) = parse(text, start);
        at = match node {
            Some(node) if holds_members(&node) => {
                let end = node.span.end;
                found.push(node);
                end
            }
            Some(_) => start + 1,
            // What was looked at and is no object is not looked at again.
            None => text.ceil_char_boundary(deepest.max(start + 1)),
        };
    }
    found
}

/// Parses a whole text as one object.
fn whole(text: &str) -> Option<Node> {
    let start = text.len() - text.trim_start().len();
    parse(text, start).0.filter(holds_members)
}

/// Parses a value; returns it, and how far an object was recognised before it turned out to be none.
fn parse(text: &str, start: usize) -> (Option<Node>, usize) {
    let mut parser = Parser {
        text,
        at: start,
        deepest: start,
    };
    (parser.value(0), parser.deepest)
}

/// Moves a value, with all that is in it, to another place.
fn move_to(node: &mut Node, span: &Range<usize>) {
    node.span = span.clone();
    match &mut node.shape {
        Shape::Object(members) => members.iter_mut().for_each(|member| {
            member.at = span.start;
            move_to(&mut member.value, span);
        }),
        Shape::List(items) => items.iter_mut().for_each(|item| move_to(item, span)),
        Shape::Text(_) | Shape::Bare(_) => {}
    }
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
    deepest: usize,
}

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn eat(&mut self, letter: char) -> bool {
        let is_there = self.rest().starts_with(letter);
        self.at += if is_there { letter.len_utf8() } else { 0 };
        is_there
    }

    /// Skips white space and comments.
    fn blanks(&mut self) {
        loop {
            let rest = self.rest().trim_start();
            self.at = self.text.len() - rest.len();
            if !rest.starts_with("//") && !rest.starts_with("# ") {
                return;
            }
            self.at += rest.find('\n').unwrap_or(rest.len());
            self.deepest = self.at;
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
            mark @ ('"' | '\'' | '“') => {
                let text = self.string(mark)?;
                // The arguments of a call are often an object in a string, which says where they stand.
                match whole(&text) {
                    Some(mut inner) => {
                        move_to(&mut inner, &(start..self.at));
                        inner.shape
                    }
                    None => Shape::Text(text),
                }
            }
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
            if self.eat('}') {
                return Some(Shape::Object(members));
            }
            if self.eat(',') {
                continue;
            }
            let at = self.at;
            let key = self.key()?;
            self.blanks();
            if !self.eat(':') && !self.eat('：') && !self.eat('=') {
                return None;
            }
            self.blanks();
            let value = self.value(depth + 1)?;
            members.push(Member { key, at, value });
            self.deepest = self.at;
            self.ends_item('}')?;
        }
    }

    fn key(&mut self) -> Option<String> {
        if let mark @ ('"' | '\'' | '“') = self.peek()? {
            return self.string(mark);
        }
        let is_key = |letter: char| letter.is_alphanumeric() || "_-.".contains(letter);
        let length = self.rest().find(|letter| !is_key(letter))?;
        let key = self.rest()[..length].to_owned();
        self.at += length;
        (length > 0).then_some(key)
    }

    /// Checks that an item ends here: with a comma, or with what closes its list.
    fn ends_item(&mut self, close: char) -> Option<()> {
        self.blanks();
        (self.rest().starts_with(',') || self.rest().starts_with(close)).then_some(())
    }

    fn list(&mut self, close: char, depth: usize) -> Option<Shape> {
        self.at += 1;
        let mut items = Vec::new();
        loop {
            self.blanks();
            if self.eat(close) {
                return Some(Shape::List(items));
            }
            if !self.eat(',') {
                items.push(self.value(depth + 1)?);
                self.ends_item(close)?;
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
                // An opening mark that repeats without an end would be looked at again from each.
                _ if letter == mark => return None,
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
