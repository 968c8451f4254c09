//! Cuts an answer into words, numbers and signs.
//!
//! Markdown, LaTeX, quotation marks and full-width forms disappear here, so that nothing after it has to know them.
//! Bytes keep their places: a token says where it stands in the answer.

use super::wordlist::{self, words};

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// Letters; `pick_x` and `pickX` are two words.
    Word,
    /// Digits with at most one decimal point, without a sign: `10`, `.5`.
    Number,
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

    /// Returns whether it is this word, in any case.
    pub fn is(&self, word: &str) -> bool {
        self.kind == Kind::Word && self.text.eq_ignore_ascii_case(word)
    }

    /// Returns whether it is one of these words.
    pub fn is_any(&self, words: &[&str]) -> bool {
        self.kind == Kind::Word && wordlist::is_any(self.text, words)
    }

    /// Returns whether it is this sign.
    pub fn is_sign(&self, sign: char) -> bool {
        self.kind == Kind::Sign(sign)
    }
}

/// The end of a tagged part, `</pick>`.
pub(super) const TAG_END: char = '⊣';

/// Signs of several characters, and the sign that they mean; longer ones first.
const JOINED: [(&str, char); 9] = [
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

/// LaTeX commands that mean a sign or a word.
const COMMANDS: [(&str, &str); 15] = [
    ("circ", "°"),
    ("degree", "°"),
    ("times", "*"),
    ("cdot", "*"),
    ("div", "/"),
    ("rightarrow", "→"),
    ("Rightarrow", "→"),
    ("longrightarrow", "→"),
    ("to", "→"),
    ("approx", "≈"),
    ("pm", "±"),
    ("pi", "pi"),
    ("frac", "frac"),
    ("dfrac", "frac"),
    ("tfrac", "frac"),
];

/// Abbreviations with points inside.
const ABBREVIATIONS: [&str; 2] = ["i.e.", "e.g."];

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

/// How much of a line is looked at for its marks, bytes.
const MAX_MARKS: usize = 120;

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
        } else if first.is_whitespace() || is_invisible(first) || is_emoji(first) {
            self.skip(width, Gap::Space);
        } else if digit(first).is_some() || (first == '.' && self.begins_decimals(rest)) {
            let length = number_length(rest);
            self.push(Kind::Number, length);
        } else if let Some(word) = ABBREVIATIONS.iter().find(|word| {
            rest.get(..word.len())
                .is_some_and(|start| start.eq_ignore_ascii_case(word))
        }) {
            self.push(Kind::Word, word.len());
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
        let mut most = rest.len().min(MAX_MARKS);
        while !rest.is_char_boundary(most) {
            most -= 1;
        }
        let line = &rest[..rest[..most].find('\n').unwrap_or(most)];
        let trimmed = line.trim();
        let is_ruler = trimmed.len() >= 3
            && ['-', '=', '_', '*']
                .iter()
                .any(|sign| trimmed.chars().all(|letter| letter == *sign));
        if is_ruler || trimmed.starts_with("```") || trimmed.starts_with("~~~") {
            self.skip(line.len(), Gap::Block);
            return true;
        }
        let heading = line.len() - line.trim_start_matches('#').len();
        if heading > 0 && line[heading..].starts_with(' ') {
            self.skip(heading, Gap::Block);
            return true;
        }
        // A ticked box; those that are not ticked are set aside.
        if ["[x] ", "[X] ", "[✓] ", "[✔] "]
            .iter()
            .any(|mark| line.starts_with(mark))
        {
            self.skip(line.find(' ').unwrap_or(3), Gap::Item);
            return true;
        }
        let mut letters = line.chars();
        let (first, second) = (letters.next(), letters.next());
        let blank = |letter: Option<char>| letter.is_some_and(char::is_whitespace);
        if matches!(first, Some('-' | '*' | '+' | '•' | '·' | '–' | '◦' | '▪')) && blank(second)
        {
            self.skip(first.map_or(0, char::len_utf8), Gap::Item);
            return true;
        }
        let digits = line.len()
            - line
                .trim_start_matches(|letter: char| letter.is_ascii_digit())
                .len();
        let behind = &line[digits..];
        let is_number = (1..=2).contains(&digits) && behind.starts_with(['.', ')']);
        let is_letter =
            digits == 0 && first.is_some_and(|it| it.is_ascii_lowercase()) && second == Some(')');
        if (is_number && blank(behind.chars().nth(1))) || (is_letter && blank(line.chars().nth(2)))
        {
            self.skip(digits.max(1) + 1, Gap::Item);
            return true;
        }
        false
    }

    fn begins_decimals(&self, rest: &str) -> bool {
        let is_joined = self.gap == Gap::None && self.before().is_some_and(char::is_alphanumeric);
        !is_joined
            && rest
                .chars()
                .nth(1)
                .is_some_and(|next| next.is_ascii_digit())
    }

    fn sign(&mut self, first: char, rest: &'t str) {
        let width = first.len_utf8();
        if let Some((length, gap)) = formatting(rest) {
            return self.skip(length, gap);
        }
        match first {
            '\\' => self.command(rest),
            // LaTeX aligns at it.
            '&' if rest[1..].trim_start().starts_with('=') => self.skip(1, Gap::Space),
            '*' | '＊' => self.star(rest),
            '·' | '•' if self.separates(&rest[width..]) => self.push(Kind::Sign('|'), width),
            '{' | '｛' => {
                self.braces.push(false);
                self.push(Kind::Sign('{'), width);
            }
            '}' | '｝' => {
                if self.braces.pop() == Some(true) {
                    self.skip(width, Gap::None);
                } else {
                    self.push(Kind::Sign('}'), width);
                }
            }
            '^' => {
                let circle = rest[1..].trim_start_matches(['{', '\\']);
                let opened = rest.len() - circle.len();
                let length = ["circ", "∘", "°", "degree"]
                    .iter()
                    .find(|word| circle.starts_with(**word))
                    .map(|word| opened + word.len());
                match length {
                    Some(length) => {
                        let close = usize::from(rest[length..].starts_with('}'));
                        self.push(Kind::Sign('°'), length + close);
                    }
                    None => self.push(Kind::Sign('^'), width),
                }
            }
            '<' if rest.starts_with("</") => {
                let length = rest.bytes().take(60).position(|byte| byte == b'>');
                self.push(Kind::Sign(TAG_END), length.map_or(2, |length| length + 1));
            }
            '/' if rest.starts_with("/>") => self.push(Kind::Sign(TAG_END), 2),
            '_' | '`' | '"' | '\'' | '“' | '”' | '‘' | '’' | '„' | '«' | '»' | '「' | '」'
            | '『' | '』' | '$' => {
                self.skip(width, Gap::None);
            }
            _ => self.push(Kind::Sign(plain(first)), width),
        }
    }

    /// A dot between blanks separates fields if a word is behind it: `(10, 20) · Direction: 45 deg`.
    fn separates(&self, after: &str) -> bool {
        let behind = after.trim_start_matches([' ', '*', '_', '`']);
        // `3 · π`, `0.5 · edge`
        let is_number = { self.found.last() }.is_some_and(|last| last.kind == Kind::Number);
        let multiplies = is_number && behind.starts_with(char::is_lowercase);
        self.before() == Some(' ')
            && after.starts_with(' ')
            && behind.starts_with(char::is_alphabetic)
            && !multiplies
    }

    /// `*` multiplies between two operands; otherwise it is Markdown.
    fn star(&mut self, rest: &str) {
        let run = rest.len() - rest.trim_start_matches('*').len();
        let run = run.max(rest.chars().next().map_or(1, char::len_utf8));
        let after = rest[run..].chars().next();
        let joins = |letter: Option<char>| {
            letter.is_some_and(|it| it.is_alphanumeric() || matches!(it, '(' | 'π'))
        };
        let blank = |letter: Option<char>| letter.is_some_and(|it| it == ' ');
        let before = self.before();
        let is_between = (blank(before) && blank(after))
            || (before.is_some_and(|it| it.is_ascii_digit() || it == ')' || it == 'π')
                && joins(after));
        if is_between && run <= 2 {
            self.push(Kind::Sign(if run == 1 { '*' } else { '^' }), run);
        } else {
            self.skip(run, Gap::None);
        }
    }

    fn command(&mut self, rest: &'t str) {
        let name = &rest[1..];
        let length = name
            .find(|letter: char| !letter.is_ascii_alphabetic())
            .unwrap_or(name.len());
        if length == 0 {
            // `\(`, `\[`, `\,`, `\%`, `\_`
            let next = name.chars().next();
            match next {
                Some('%' | '#' | '&' | '{' | '}') | None => self.skip(1, Gap::None),
                Some('\\') => self.skip(2, Gap::Line),
                Some(next) if next.is_whitespace() => self.skip(1, Gap::Space),
                Some(next) => self.skip(1 + next.len_utf8(), Gap::None),
            }
            return;
        }
        // `\begin{aligned}`
        if let ("begin" | "end", Some(environment)) =
            (&name[..length], name[length..].strip_prefix('{'))
        {
            let letters = environment
                .find(|letter: char| !(letter.is_ascii_alphabetic() || letter == '*'))
                .unwrap_or(environment.len());
            if environment[letters..].starts_with('}') {
                return self.skip("\\{}".len() + length + letters, Gap::Line);
            }
        }
        if let Some((_, meaning)) = COMMANDS
            .iter()
            .find(|(command, _)| *command == &name[..length])
        {
            let first = meaning.chars().next().unwrap_or(' ');
            self.at += 1;
            if first.is_alphabetic() {
                // `\dfrac` is `frac`.
                self.at += length - meaning.len();
                self.push(Kind::Word, meaning.len());
            } else {
                self.push(Kind::Sign(first), length);
            }
            return;
        }
        if name[..length].starts_with('n') && length != 2 && !name[length..].starts_with('{') {
            // A line break that was escaped twice: `\nPlace`.
            self.skip(2, Gap::Line);
            return;
        }
        self.skip(1 + length, Gap::None);
        if self.rest().starts_with('{') {
            self.braces.push(true);
            self.skip(1, Gap::None);
        }
    }
}

/// Tags that only format text, and what they put before the next token.
const FORMATTING: &[(&[&str], Gap)] = &[
    (
        words!("dl table pre hr h1 h2 h3 h4 details body"),
        Gap::Block,
    ),
    (words!("dt tbody tr p br div ul ol center"), Gap::Line),
    (words!("dd th td"), Gap::Space),
    (
        words!("b strong i em u code kbd mark span font sub"),
        Gap::None,
    ),
    (words!("li"), Gap::Item),
];

/// Returns the length of a tag that only formats text.
fn formatting(text: &str) -> Option<(usize, Gap)> {
    let inside = text.strip_prefix('<')?.trim_start_matches('/');
    let opened = text.len() - inside.len();
    let name = inside.find(|letter: char| !letter.is_ascii_alphanumeric())?;
    let (_, gap) = FORMATTING
        .iter()
        .find(|(tags, _)| wordlist::is_any(&inside[..name], tags))?;
    let end = inside.bytes().take(80).position(|byte| byte == b'>')?;
    Some((opened + end + 1, *gap))
}

/// Returns a decimal digit, of normal or full width.
pub(super) fn digit(letter: char) -> Option<char> {
    match letter {
        '0'..='9' => Some(letter),
        '０'..='９' => char::from_u32(u32::from(letter) - u32::from('０') + u32::from('0')),
        _ => None,
    }
}

fn number_length(text: &str) -> usize {
    let digits = |text: &str| {
        text.find(|letter| digit(letter).is_none())
            .unwrap_or(text.len())
    };
    let whole = digits(text);
    match text[whole..].chars().next() {
        Some(point @ ('.' | '．')) => {
            let decimals = digits(&text[whole + point.len_utf8()..]);
            if decimals == 0 {
                whole
            } else {
                whole + point.len_utf8() + decimals
            }
        }
        _ => whole,
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

/// Returns whether a character has no width: joiners, marks of direction, a byte order mark.
fn is_invisible(letter: char) -> bool {
    matches!(letter, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}' | '\u{ad}')
        || letter.is_control()
}

/// Returns whether a character is a picture that says nothing; crosses and arrows do.
fn is_emoji(letter: char) -> bool {
    matches!(letter, '\u{fe0f}' | '\u{2600}'..='\u{27bf}' | '\u{1f300}'..='\u{1faff}')
        && !matches!(
            letter,
            '✗' | '✘' | '❌' | '➔' | '➜' | '➡' | '🚫' | '❨' | '❩'
        )
}

/// Returns the plain form of a sign.
fn plain(sign: char) -> char {
    match sign {
        '（' | '❨' => '(',
        '）' | '❩' => ')',
        '［' | '【' | '⟦' => '[',
        '］' | '】' | '⟧' => ']',
        '〈' | '⟨' | '＜' => '<',
        '〉' | '⟩' | '＞' => '>',
        '，' | '、' => ',',
        '：' | '∶' => ':',
        '；' => ';',
        '。' | '．' => '.',
        '＝' => '=',
        '－' | '−' | '﹣' | '‐' | '‑' => '-',
        '—' | '―' | '‒' => '–',
        '＋' => '+',
        '／' | '÷' | '∕' | '⁄' => '/',
        '×' | '·' | '⋅' | '∗' => '*',
        '％' => '%',
        '｜' => '|',
        '⇒' | '⟶' | '➜' | '➔' | '➡' | '⟹' => '→',
        '≃' | '≅' | '～' | '~' => '≈',
        'º' | '˚' | '∘' => '°',
        '！' => '!',
        '？' => '?',
        _ => sign,
    }
}
