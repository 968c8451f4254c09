//! Cuts an answer into words, numbers and signs.
//!
//! Markdown, LaTeX, quotation marks and full-width forms disappear here, so that nothing after it has to know them.
//! Bytes keep their places: a token says where it stands in the answer.

use crate::invisible::is_invisible;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// Letters; `pick_x` and `pickX` are two words.
    Word,
    /// Digits with at most one decimal point, without a sign: `10`, `.5`.
    Number,
    /// An opening tag, `<pick>`, `<parameter=pick>`; its text is what stands between the brackets.
    Tag,
    /// Anything else, in its plain form: `(` for `（`, `→` for `->`, `⊣` for the end of a tagged part.
    Sign(char),
}

/// What stands before a token, from close to far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Gap {
    /// Nothing, or decoration.
    None,
    /// Blanks.
    Space,
    /// The end of a line.
    Line,
    /// The mark of a list item or heading.
    Item,
    /// An empty line, a ruler, a code fence.
    Block,
}

/// A piece of an answer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'t> {
    pub kind: Kind,
    pub text: &'t str,
    /// Where it begins, bytes.
    pub at: usize,
    pub gap: Gap,
}

impl Token<'_> {
    /// Returns where it ends.
    pub fn end(&self) -> usize {
        self.at + self.text.len()
    }

    /// Returns whether it is one of these words.
    pub fn is_any(&self, words: &str) -> bool {
        self.kind == Kind::Word && is_any(self.text, words)
    }

    /// Returns whether it is this sign.
    pub fn is_sign(&self, sign: char) -> bool {
        self.kind == Kind::Sign(sign)
    }
}

/// Returns whether a word is in a list, in any case.
///
/// - `words`: with blanks between them.
pub(super) fn is_any(word: &str, words: &str) -> bool {
    words.split(' ').any(|it| word.eq_ignore_ascii_case(it))
}

/// The end of a tagged part, `</pick>`.
pub(super) const TAG_END: char = '⊣';

/// Signs of several characters, and the sign that they mean; longer ones first.
const JOINED: [(&str, char); 10] = [
    ("//", '#'),
    ("-->", '→'),
    ("==>", '→'),
    ("->", '→'),
    ("=>", '→'),
    (":=", '='),
    ("===", '='),
    ("==", '='),
    ("...", '…'),
    ("..", '…'),
];

/// LaTeX commands that mean a sign or a word; the others only format.
const COMMANDS: [(&str, &str); 7] = [
    ("circ degree", "°"),
    ("times cdot", "*"),
    ("rightarrow Rightarrow longrightarrow to", "→"),
    ("approx", "≈"),
    ("pm", "±"),
    ("pi", "pi"),
    ("frac dfrac tfrac", "frac"),
];

/// Returns the tokens of a text.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut lexer = Lexer {
        text,
        at: 0,
        gap: Gap::Block,
        found: Vec::new(),
        braces: Vec::new(),
    };
    while lexer.at < text.len() {
        lexer.step();
    }
    lexer.found
}

struct Lexer<'t> {
    text: &'t str,
    at: usize,
    gap: Gap,
    found: Vec<Token<'t>>,
    /// For each open brace, whether it only wraps: `\text{`.
    braces: Vec<bool>,
}

impl<'t> Lexer<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn before(&self) -> Option<char> {
        self.text[..self.at].chars().next_back()
    }

    fn push(&mut self, kind: Kind, length: usize) {
        self.found.push(Token {
            kind,
            text: &self.text[self.at..self.at + length],
            at: self.at,
            gap: self.gap,
        });
        self.at += length;
        self.gap = Gap::None;
    }

    fn skip(&mut self, length: usize, gap: Gap) {
        self.at += length;
        self.gap = self.gap.max(gap);
    }

    fn step(&mut self) {
        let rest = self.rest();
        let Some(first) = rest.chars().next() else {
            return;
        };
        if self.gap >= Gap::Line && self.marks_line(rest) {
            return;
        }
        let width = first.len_utf8();
        if first == '\n' || first == '\r' {
            let lines = rest.len() - rest.trim_start_matches(['\r', '\n', ' ', '\t']).len();
            let is_empty_line = rest[..lines].matches('\n').count() > 1;
            self.skip(lines, if is_empty_line { Gap::Block } else { Gap::Line });
        } else if first.is_whitespace() || first.is_control() || is_invisible(first) {
            self.skip(width, Gap::Space);
        } else if digit(first).is_some() || (number_length(rest) > 0 && !self.is_in_word()) {
            let length = number_length(rest);
            self.push(Kind::Number, length);
        } else if first.is_alphabetic() {
            self.push(Kind::Word, word_length(rest));
        } else if let Some((joined, sign)) =
            JOINED.iter().find(|(joined, _)| rest.starts_with(joined))
        {
            self.push(Kind::Sign(*sign), joined.len());
        } else {
            self.sign(first, rest);
        }
    }

    /// Skips what marks a line: a bullet, a number of a list, a heading, a ruler, a code fence.
    fn marks_line(&mut self, rest: &str) -> bool {
        // No mark is longer.
        let line = &rest[..rest.floor_char_boundary(120)];
        let line = &line[..line.find('\n').unwrap_or(line.len())];
        let is_ruler =
            |sign: char| line.trim().len() > 2 && line.trim().chars().all(|it| it == sign);
        let is_fence = line.starts_with("```") || line.starts_with("~~~");
        let heading = line.len() - line.trim_start_matches('#').len();
        let digits = line.bytes().take_while(u8::is_ascii_digit).count();
        let is_number = (1..=2).contains(&digits) && line[digits..].starts_with(['.', ')']);
        let bullet = line.chars().next().filter(|it| "-*+•·–◦▪".contains(*it));
        let (length, gap) = match bullet {
            _ if is_fence || ['-', '=', '_', '*'].into_iter().any(is_ruler) => {
                self.skip(line.len(), Gap::Block);
                return true;
            }
            _ if heading > 0 => (heading, Gap::Block),
            _ if is_number => (digits + 1, Gap::Item),
            Some(bullet) => (bullet.len_utf8(), Gap::Item),
            None => return false,
        };
        let is_apart = line[length..].starts_with(char::is_whitespace);
        if is_apart {
            self.skip(length, gap);
        }
        is_apart
    }

    fn is_in_word(&self) -> bool {
        self.gap == Gap::None && self.before().is_some_and(char::is_alphanumeric)
    }

    fn sign(&mut self, first: char, rest: &'t str) {
        let width = first.len_utf8();
        match first {
            '\\' => self.command(rest),
            '*' => self.star(rest),
            // LaTeX aligns at it.
            '&' => self.skip(width, Gap::Space),
            '{' => {
                self.braces.push(false);
                self.push(Kind::Sign('{'), width);
            }
            '}' if self.braces.pop() == Some(true) => self.skip(width, Gap::None),
            '^' => {
                self.skip(width, Gap::None);
                self.wrap();
            }
            '<' => match tag(rest) {
                Some((inside, length)) => self.tag(inside, length),
                None => self.push(Kind::Sign('<'), width),
            },
            _ if "_`\"'“”‘’„«»「」『』$".contains(first) => {
                self.skip(width, Gap::None)
            }
            _ => self.push(Kind::Sign(plain(first)), width),
        }
    }

    fn tag(&mut self, inside: &'t str, length: usize) {
        let name = inside.trim_start_matches('/');
        let name_length = name.find(|it: char| !it.is_ascii_alphanumeric());
        let name = &name[..name_length.unwrap_or(name.len())];
        if let Some((_, gap)) = FORMATTING.iter().find(|(tags, _)| is_any(name, tags)) {
            self.skip(length, *gap);
        } else if inside.starts_with('/') {
            self.push(Kind::Sign(TAG_END), length);
        } else {
            self.push(Kind::Tag, length);
            if let Some(last) = self.found.last_mut() {
                (last.text, last.at) = (inside, last.at + 1);
            }
        }
    }

    /// Skips an opening brace that only wraps: `\text{`.
    fn wrap(&mut self) {
        if self.rest().starts_with('{') {
            self.braces.push(true);
            self.skip(1, Gap::None);
        }
    }

    /// `*` multiplies between two operands; otherwise it is Markdown.
    fn star(&mut self, rest: &str) {
        let run = rest.len() - rest.trim_start_matches('*').len();
        let after = rest[run..].chars().next().unwrap_or(' ');
        let before = self.before().unwrap_or(' ');
        let is_between = (before == ' ' && after == ' ')
            || ((before.is_ascii_digit() || before == ')')
                && (after.is_alphanumeric() || after == '('));
        match is_between && run == 1 {
            true => self.push(Kind::Sign('*'), 1),
            false => self.skip(run, Gap::None),
        }
    }

    fn command(&mut self, rest: &'t str) {
        let name = &rest[1..];
        let length = name.bytes().take_while(u8::is_ascii_alphabetic).count();
        let (name, behind) = name.split_at(length);
        // `\(`, `\,`, `\%`
        if name.is_empty() {
            let next = behind.chars().next().unwrap_or(' ');
            let is_line = next == '\\' || next == '\n';
            let is_kept = "%#&{}".contains(next);
            let width = if is_kept { 0 } else { next.len_utf8() };
            let length = (1 + width).min(rest.len());
            return self.skip(length, if is_line { Gap::Line } else { Gap::None });
        }
        let known = COMMANDS
            .iter()
            .find(|(names, _)| names.split(' ').any(|it| it == name));
        if let Some((_, meaning)) = known {
            self.skip(1, Gap::None);
            let first = meaning.chars().next().unwrap_or(' ');
            match first.is_alphabetic() {
                // `\dfrac` is `frac`.
                true => {
                    self.skip(length - meaning.len(), Gap::None);
                    self.push(Kind::Word, meaning.len());
                }
                false => self.push(Kind::Sign(first), length),
            }
        } else if name.starts_with('n') && !behind.starts_with('{') {
            // A line break that was escaped twice: `\nPlace`.
            self.skip(2, Gap::Line);
        } else {
            let is_block = name == "begin" || name == "end" || name == "item";
            // `\begin{aligned}`
            let named = if is_block {
                behind.strip_prefix('{')
            } else {
                None
            };
            let environment = named.and_then(|it| it.bytes().take(40).position(|it| it == b'}'));
            let length = length + 1 + environment.map_or(0, |length| length + 2);
            self.skip(length, if is_block { Gap::Line } else { Gap::None });
            self.wrap();
        }
    }
}

/// Tags that only format text, and what they put before the next token.
const FORMATTING: [(&str, Gap); 3] = [
    (
        "dl table pre hr h1 h2 h3 h4 details body li dt tbody tr p br div ul ol center",
        Gap::Line,
    ),
    ("dd th td", Gap::Space),
    ("b strong i em u code kbd mark span font sub", Gap::None),
];

/// The longest tag, bytes.
const MAX_TAG: usize = 120;

/// Returns what stands between the brackets of a tag at the start of a text, and the length of the whole.
fn tag(text: &str) -> Option<(&str, usize)> {
    let inside = text.strip_prefix('<')?;
    let length = inside.bytes().take(MAX_TAG).position(|it| it == b'>')?;
    let inside = &inside[..length];
    let name = inside.trim_start_matches('/');
    let is_tag = name.starts_with(|it: char| it.is_ascii_alphabetic()) && !inside.contains('\n');
    is_tag.then_some((inside, length + 2))
}

/// Returns the plain form of a character of full width: `(` for `（`.
fn narrow(letter: char) -> char {
    match letter {
        '！'..='～' => char::from_u32(u32::from(letter) - 0xfee0).unwrap_or(letter),
        _ => letter,
    }
}

/// Returns a decimal digit, of normal or full width.
pub(super) fn digit(letter: char) -> Option<char> {
    Some(narrow(letter)).filter(char::is_ascii_digit)
}

fn number_length(text: &str) -> usize {
    let digits = |text: &str| {
        let length = text.find(|letter| digit(letter).is_none());
        length.unwrap_or(text.len())
    };
    let whole = digits(text);
    let Some(behind) = text[whole..].strip_prefix(['.', '．']) else {
        return whole;
    };
    match digits(behind) {
        0 => whole,
        decimals => text.len() - behind.len() + decimals,
    }
}

fn word_length(text: &str) -> usize {
    let mut before = ' ';
    for (at, letter) in text.char_indices() {
        let follows = text[at + letter.len_utf8()..].chars().next();
        let is_inside = matches!(letter, '\'' | '’') && follows.is_some_and(char::is_alphabetic);
        let is_new_word = before.is_lowercase() && letter.is_uppercase();
        if is_new_word || !(letter.is_alphanumeric() || is_inside) {
            return at;
        }
        before = letter;
    }
    text.len()
}

/// Returns the plain form of a sign.
fn plain(sign: char) -> char {
    match narrow(sign) {
        '【' => '[',
        '】' => ']',
        '⟨' => '<',
        '⟩' => '>',
        '、' => ',',
        '。' => '.',
        '−' | '‐' | '‑' => '-',
        '—' | '―' | '‒' => '–',
        '÷' | '∕' | '⁄' => '/',
        '×' | '·' | '⋅' | '∗' => '*',
        '⇒' | '⟶' | '➜' | '➔' | '➡' | '⟹' => '→',
        '≃' | '≅' | '~' => '≈',
        'º' | '˚' | '∘' => '°',
        narrow => narrow,
    }
}
